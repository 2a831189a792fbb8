//! Failed opening: inputs that were to be opened and cannot be shown, and those that are not shown yet.

use crate::source::OpeningChoice;
use std::path::PathBuf;

/// Inputs that could not be shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FailedOpening {
    /// Display name of the inputs.
    pub name: String,
    /// Why, in full.
    pub reason: String,
    /// The sequences that could be meant.
    pub choices: Vec<OpeningChoice>,
}

/// The inputs that were opened and have not been shown yet, of A and of B.
pub(in crate::app) type Unproven = [Vec<PathBuf>; 2];
