//! Notes: a text that is kept with the open sequence, in its session.

mod in_window;
mod panel;

/// The notes of the open sequence.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Notes {
    /// What a person wrote; empty without any.
    pub text: String,
}
