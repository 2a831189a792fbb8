//! Error of a text that is not a colour source.

/// A text that is not a colour source.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not a {what}: expected {expected}")]
pub struct ParseColoringError {
    pub(in crate::sequence) what: &'static str,
    pub(in crate::sequence) text: String,
    pub(in crate::sequence) expected: &'static str,
}
