//! Parse error for a word that names no choice.

/// A word that names no choice.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} `{text}`: expected {expected}")]
pub struct ParseChoiceError {
    what: &'static str,
    text: String,
    expected: String,
}

impl ParseChoiceError {
    pub(crate) fn new<'a>(what: &'static str, text: &str, expected: impl Iterator<Item = &'a str>) -> Self {
        Self {
            what,
            text: text.to_owned(),
            expected: expected.collect::<Vec<_>>().join(", "),
        }
    }
}
