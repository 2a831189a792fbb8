//! Values of settings, and their names.

use super::numbers::Numbers;
use crate::scene::ParseChoiceError;
use crate::scene::environment::Environment;
use crate::scene::style::background::Background;
use crate::sequence::Coloring;
use crate::spelling::is_same_word;
use std::iter;

/// The value of any setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// The place of a word in [`Values::Words`].
    Word(usize),
    /// A number.
    Number(f64),
    /// Boolean switch.
    Switch(bool),
    /// The place of a kind in [`Values::Kinds`], and its number, or 0 where it has none.
    Kind(usize, f64),
    /// Background behind the cloud.
    Background(Background),
    /// Colour source.
    Colors(Coloring),
    /// Environment around the scene.
    Environment(Environment),
}

/// Permitted values of a setting.
#[derive(Debug)]
pub enum Values {
    /// One of these.
    Words(&'static Words),
    /// A number.
    Number(Numbers),
    /// Boolean, with a word next to the checkbox.
    Switch(&'static str),
    /// One of these, most with a number.
    Kinds(&'static [Kind]),
    /// Two colours.
    Background,
    /// A [`Coloring`].
    Colors,
    /// An [`Environment`].
    Environment,
}

/// Values that are words.
#[derive(Debug)]
pub struct Words {
    /// Noun for one of them.
    pub what: &'static str,
    /// All, in the order of lists.
    pub list: &'static [Word],
}

impl Words {
    /// The place of a word.
    pub(crate) fn place_of(&self, text: &str) -> Result<usize, ParseChoiceError> {
        self.place_among(text, iter::empty())
    }

    /// Returns the index of a word, with further words that are also expected.
    pub(super) fn place_among<'a>(
        &'a self,
        text: &str,
        others: impl Iterator<Item = &'a str>,
    ) -> Result<usize, ParseChoiceError> {
        let place = self.list.iter().position(|word| is_same_word(word.word, text));
        place.ok_or_else(|| {
            let words = self.list.iter().map(|word| word.word);
            ParseChoiceError::new(self.what, text, words.chain(others))
        })
    }
}

/// A value that is a word.
#[derive(Debug)]
pub struct Word {
    /// On the command line and in files.
    pub word: &'static str,
    /// In the window.
    pub title: &'static str,
    /// Tooltip that explains it in the window.
    pub hint: &'static str,
    /// Words of people and of other programs that find it.
    pub also: &'static [&'static str],
}

/// A kind of values.
#[derive(Debug)]
pub struct Kind {
    /// Its option on the command line, without dashes.
    pub flag: &'static str,
    /// Help text of the option.
    pub help: &'static str,
    /// Its name in the window.
    pub title: &'static str,
    /// Tooltip that explains it in the window.
    pub hint: &'static str,
    /// Representation in the label of a render mode; `{}` stands for the number.
    pub label: &'static str,
    /// Words of people and of other programs that find it.
    pub also: &'static [&'static str],
    /// Its number, if it has one.
    pub number: Option<KindNumber>,
}

/// The number of a kind.
#[derive(Debug)]
pub struct KindNumber {
    /// Placeholder for the option's value, in capitals.
    pub value_name: &'static str,
    /// Its name in the window.
    pub title: &'static str,
    /// Tooltip that explains it in the window.
    pub hint: &'static str,
    /// Default number, used where the kind is chosen and no number yet.
    pub usual: f64,
    /// Permitted numbers.
    pub numbers: Numbers,
}
