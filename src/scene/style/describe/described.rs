//! One setting in words.

use super::conditions::Conditions;
use super::shorthand::{Given, Shorthand};
use super::values::{Value, Values};
use crate::scene::environment::Environment;
use crate::spelling::is_same_word;

/// One setting in words.
#[derive(Debug)]
pub struct Described {
    /// Its name in files of people.
    pub key: &'static str,
    /// Its option on the command line, without dashes; empty where its kinds have options, or it has one of its own.
    pub flag: &'static str,
    /// Other names of the option: earlier ones, and other programs'.
    pub other_flags: &'static [&'static str],
    /// Placeholder of the option's value, if it has no short list of words.
    pub value_name: &'static str,
    /// Help text of the option; its words and its default are appended.
    pub help: &'static str,
    /// Shown by `-h` as well as by `--help`.
    pub everyday: bool,
    /// The heading of its option.
    pub heading: &'static str,
    /// Its name in the window.
    pub title: &'static str,
    /// Its name outside of its section; empty where that is its title.
    pub full_name: &'static str,
    /// Words of people and of other programs that find it.
    pub also: &'static [&'static str],
    /// Tooltip in the window.
    pub hint: &'static str,
    /// Section of the panel it belongs to.
    pub section: Section,
    /// Condition under which it has an effect.
    pub when: When,
    /// Representation in the label of a render mode.
    pub label: Label,
    /// Permitted values.
    pub values: Values,
    /// Words for its values that also set values of other settings.
    pub shorthands: &'static [Shorthand],
}

impl Described {
    /// The rest of a description of non-default values.
    pub const USUAL: Self = Self {
        key: "",
        flag: "",
        other_flags: &[],
        value_name: "",
        help: "",
        everyday: false,
        heading: "Rendering",
        title: "",
        full_name: "",
        also: &[],
        hint: "",
        section: Section::Picture,
        when: |_| true,
        label: Label::Untold,
        values: Values::Switch(""),
        shorthands: &[],
    };

    /// Its name outside of its section.
    pub fn name(&self) -> &'static str {
        if self.full_name.is_empty() {
            self.title
        } else {
            self.full_name
        }
    }

    /// The words that the option takes: all, or the best known ones.
    pub fn words(&self) -> Vec<&'static str> {
        match self.values {
            Values::Words(words) => {
                let words = words.list.iter().chain(self.shorthands.iter().map(|short| &short.word));
                let mut words: Vec<_> = words.map(|word| word.word).collect();
                // The usual order is: on, off.
                let is_switch = words.contains(&"on");
                words.sort_by_key(|word| ["on", "off"].iter().position(|it| is_switch && it == word).unwrap_or(2));
                words
            }
            Values::Environment => Environment::BUILT_IN.iter().map(|word| word.word).collect(),
            Values::Switch(_) => vec!["on", "off"],
            _ => Vec::new(),
        }
    }

    /// True if the option alone, without a word, means `on`.
    pub fn is_switch(&self) -> bool {
        matches!(self.values, Values::Switch(_))
            || matches!(self.values, Values::Words(_)) && {
                let words = self.words();
                words.contains(&"on") && words.contains(&"off")
            }
    }

    /// A value as the option takes it; `None` for values that are not a word or a number.
    pub fn typed(&self, value: Value) -> Option<String> {
        match (&self.values, value) {
            (Values::Words(words), Value::Word(place)) => Some(words.list.get(place)?.word.to_owned()),
            (Values::Number(numbers), Value::Number(number)) => Some(numbers.typed_text(number)),
            (Values::Switch(_), Value::Switch(is_on)) => Some(if is_on { "on" } else { "off" }.to_owned()),
            (Values::Environment, Value::Environment(environment)) => Some(environment.to_string()),
            (Values::Colors, Value::Colors(colors)) => Some(colors.source.to_string()),
            _ => None,
        }
    }

    /// Parses a word or a number of the command line into a value of this setting, and of others if it is a shorthand
    /// for them. `Err` states the expected input.
    pub fn parse(&self, text: &str) -> Result<Given, String> {
        if let Some(shorthand) = self.shorthands.iter().find(|short| is_same_word(short.word.word, text)) {
            return Ok(shorthand.given.to_vec());
        }
        let value = match &self.values {
            Values::Words(words) => {
                let others = self.shorthands.iter().map(|short| short.word.word);
                let place = words.place_among(text, others).map_err(|error| error.to_string())?;
                Value::Word(place)
            }
            Values::Number(numbers) => Value::Number(numbers.parse(text)?),
            Values::Environment => match text.parse::<Environment>() {
                Ok(environment) => Value::Environment(environment),
                Err(error) => return Err(format!("{error}; built in: {}", self.words().join(", "))),
            },
            Values::Switch(_) => match text {
                "on" | "true" | "yes" | "1" => Value::Switch(true),
                "off" | "false" | "no" | "0" => Value::Switch(false),
                _ => return Err("expected on or off".to_owned()),
            },
            _ => return Err("expected no text".to_owned()),
        };
        Ok(vec![(self.key, value)])
    }

    /// The nearest value that files may hold.
    #[must_use]
    pub fn nearest(&self, value: Value) -> Value {
        match (&self.values, value) {
            (Values::Number(numbers), Value::Number(number)) => Value::Number(numbers.nearest(number)),
            (Values::Kinds(kinds), Value::Kind(place, number)) => match kinds[place].number {
                Some(ref told) if number.is_nan() => Value::Kind(place, told.usual),
                Some(ref told) => Value::Kind(place, told.numbers.nearest(number)),
                None => value,
            },
            _ => value,
        }
    }
}

/// A part of the panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Section {
    /// Size and shape of the primitives.
    Look,
    /// The renderer, and the number of pixels.
    Picture,
    /// Surfel settings.
    Surfels,
    /// Footprints that the CPU draws surfels from.
    Footprints,
    /// Octree depth.
    Octree,
    /// Level of detail: selection of the octree cells that are drawn.
    LevelOfDetail,
    /// Light.
    Shading,
    /// View-dependent texturing.
    Photos,
    /// Background and ground grid.
    Background,
    /// A place of its own.
    Own,
}

/// Condition of a setting: a query of the style.
pub type When = fn(&dyn Conditions) -> bool;

/// Representation of a setting in the label of a render mode: `{}` stands for the value as files have it, `{title}` for
/// the window's title of it.
#[derive(Debug, Clone, Copy)]
pub enum Label {
    /// Not represented in the label.
    Untold,
    /// Always.
    Always(Place, &'static str),
    /// Shown if it differs from the default.
    Unusual(Place, &'static str),
    /// In some cases.
    If(When, Place, &'static str),
}

/// Position in a label.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// First: the drawn content.
    What,
    /// Then how finely.
    HowFine,
    /// Last: who draws.
    Who,
}
