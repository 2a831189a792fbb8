//! Rows of the table of what can be opened ([`super::open`]).

use super::{OpenOptions, SequenceError, Source};
use crate::progress::Progress;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A source, where the inputs are of its kind.
pub(super) type IfOpened = Result<Option<Arc<dyn Source>>, SequenceError>;

/// A source that was opened.
pub(super) type Opened = Result<Arc<dyn Source>, SequenceError>;

/// Inputs that a person named, and how they are to be read.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    /// What can be opened, the first that the inputs are.
    pub(super) openers: &'static [Opener],
    pub(super) inputs: &'a [PathBuf],
    pub(super) options: &'a OpenOptions,
    /// Counts the files that were looked at, and may be cancelled.
    pub(super) progress: &'a Progress,
}

impl Asked<'_> {
    /// The source that the inputs are.
    pub(super) fn open(self) -> Opened {
        for opener in self.openers {
            if let Some(source) = opener.open(self)? {
                return Ok(source);
            }
        }
        Err(SequenceError::NoInput)
    }
}

/// A way to open inputs.
pub(super) enum Opener {
    /// One input that tells what it is.
    One(&'static One),
    /// Inputs that have to be looked into: `None` where they are of another kind.
    Any(fn(Asked<'_>) -> IfOpened),
}

/// An input that is a sequence of its own.
pub(super) struct One {
    /// Whether the input is one, by its name or its first bytes.
    pub(super) can_read: fn(&Path) -> bool,
    pub(super) open: fn(&Path, Asked<'_>) -> Opened,
    /// What is said where it is one of several; `None` where several are never looked at for it.
    pub(super) beside_others: Option<fn(&Path) -> SequenceError>,
    /// Whether it is a word, and neither a file nor an address.
    pub(super) is_word: bool,
}

impl Opener {
    /// The source, if the inputs are of this kind.
    fn open(&self, asked: Asked<'_>) -> IfOpened {
        match self {
            Self::One(one) => one.open(asked),
            Self::Any(open) => open(asked),
        }
    }

    /// Whether `input` is a word of this kind.
    pub(super) fn has_word(&self, input: &Path) -> bool {
        match self {
            Self::One(one) => one.is_word && (one.can_read)(input),
            Self::Any(_) => false,
        }
    }
}

impl One {
    fn open(&self, asked: Asked<'_>) -> IfOpened {
        let input = match (asked.inputs, self.beside_others) {
            ([input], _) => Some(input).filter(|input| (self.can_read)(input)),
            (_, None) => None,
            (inputs, Some(refusal)) => {
                let found = inputs.iter().find(|input| (self.can_read)(input));
                return found.map_or(Ok(None), |input| Err(refusal(input)));
            }
        };
        input.map(|input| (self.open)(input, asked)).transpose()
    }
}
