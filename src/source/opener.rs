//! Rows of the table of supported inputs ([`super::open`]).

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
    /// Table of openers, in order of precedence: the first that matches the inputs is used.
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

/// A method of opening inputs.
pub(super) enum Opener {
    /// A word and the text after its colon, from which frames are generated.
    Made(&'static Made),
    /// One input that identifies itself.
    One(&'static One),
    /// Inputs that have to be looked into: `None` where they are of another kind.
    Any(fn(Asked<'_>) -> IfOpened),
}

/// Frames that are made and not read: `demo:`, `torus:20000`. Among other inputs such a word is the name of a file.
pub(super) struct Made {
    /// Predicate that returns true for the keyword before the colon.
    pub(super) has_word: fn(&str) -> bool,
    /// Human-readable names of such inputs, as one item of a list.
    pub(super) said: fn() -> String,
    /// The frames by the word and the text after the colon; `None` if that is invalid.
    pub(super) make: fn(&str, &str) -> Option<Arc<dyn Source>>,
}

/// An input that is a sequence of its own.
pub(super) struct One {
    /// Names by which such inputs are recognised.
    pub(super) names: &'static [Name],
    pub(super) open: fn(&Path, Asked<'_>) -> Opened,
    /// Error for an input that is one of several; `None` if several inputs are never checked for it.
    pub(super) sidecar_others: Option<fn(&Path) -> SequenceError>,
}

/// Feature by which an input is recognised.
pub(super) enum Name {
    /// An address that begins so.
    Scheme(&'static str),
    /// A word that is neither a file nor an address.
    Word(&'static str),
    /// The name or the first bytes of a file, which mostly has this extension.
    File(&'static str, fn(&Path) -> bool),
}

impl Opener {
    /// The source, if the inputs are of this kind.
    fn open(&self, asked: Asked<'_>) -> IfOpened {
        match self {
            Self::Made(made) => made.open(asked),
            Self::One(one) => one.open(asked),
            Self::Any(open) => open(asked),
        }
    }

    /// Returns true if `input` is a keyword of this kind.
    pub(super) fn has_word(&self, input: &Path) -> bool {
        match self {
            Self::Made(made) => made.words_of(input).is_some(),
            Self::One(one) => one.names.iter().any(|name| name.is_word() && name.is_of(input)),
            Self::Any(_) => false,
        }
    }

    /// The extensions of its files, where it has some of its own.
    pub(super) fn extensions(&self) -> impl Iterator<Item = &'static str> {
        let names = match self {
            Self::One(one) => one.names,
            Self::Made(_) | Self::Any(_) => &[],
        };
        names.iter().filter_map(|name| match name {
            Name::File(extension, _) => Some(*extension),
            Name::Scheme(_) | Name::Word(_) => None,
        })
    }
}

impl Made {
    /// Returns the parts of `input` before and after the colon, if the former is one of its keywords.
    fn words_of<'a>(&self, input: &'a Path) -> Option<(&'a str, &'a str)> {
        let words = input.to_str()?.split_once(':')?;
        (self.has_word)(words.0).then_some(words)
    }

    fn open(&self, asked: Asked<'_>) -> IfOpened {
        let [input] = asked.inputs else { return Ok(None) };
        let Some((word, rest)) = self.words_of(input) else {
            return Ok(None);
        };
        let made = (self.make)(word, rest).ok_or_else(|| SequenceError::NotGenerated {
            input: input.display().to_string(),
            known: all_made(asked.openers),
        });
        made.map(Some)
    }
}

/// All that can be made, in a sentence.
fn all_made(openers: &[Opener]) -> String {
    let said: Vec<String> = openers
        .iter()
        .filter_map(|opener| match opener {
            Opener::Made(made) => Some((made.said)()),
            Opener::One(_) | Opener::Any(_) => None,
        })
        .collect();
    match said.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{}, or {last}", others.join(", ")),
        _ => said.concat(),
    }
}

impl One {
    /// Returns true if this opener can read `input`.
    pub(super) fn can_read(&self, input: &Path) -> bool {
        self.names.iter().any(|name| name.is_of(input))
    }

    fn open(&self, asked: Asked<'_>) -> IfOpened {
        let input = match (asked.inputs, self.sidecar_others) {
            ([input], _) => Some(input).filter(|input| self.can_read(input)),
            (_, None) => None,
            (inputs, Some(refusal)) => {
                let found = inputs.iter().find(|input| self.can_read(input));
                return found.map_or(Ok(None), |input| Err(refusal(input)));
            }
        };
        input.map(|input| (self.open)(input, asked)).transpose()
    }
}

impl Name {
    /// Returns the part of `input` after the scheme, if it has this one.
    pub(super) fn address<'a>(&self, input: &'a Path) -> Option<&'a str> {
        match self {
            Self::Scheme(scheme) => input.to_str()?.strip_prefix(scheme),
            Self::Word(_) | Self::File(..) => None,
        }
    }

    fn is_of(&self, input: &Path) -> bool {
        match self {
            Self::Scheme(_) => self.address(input).is_some(),
            Self::Word(word) => input == Path::new(word),
            Self::File(_, is_one) => is_one(input),
        }
    }

    fn is_word(&self) -> bool {
        matches!(self, Self::Word(_))
    }
}
