//! Words that are short for values of several settings.

use super::values::{Value, Word};

/// Values of settings, by their names in files.
pub type Given = Vec<(&'static str, Value)>;

/// A word that is short for values of several settings. It is not stored: files, undo and labels have the values.
#[derive(Debug)]
pub struct Shorthand {
    /// As one of the words of its setting.
    pub word: Word,
    /// The values that it is short for; its own setting's is the first.
    pub given: &'static [(&'static str, Value)],
}
