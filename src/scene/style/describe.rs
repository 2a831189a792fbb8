//! What a setting is called, which values it has, and how they are written: the one description that the panel, the
//! command line, the files, undo and the labels of benchmarks read.
//!
//! **How it works.** A group of settings is a struct whose fields stand beside their [`Described`] (`group!`). Readers
//! know no field: [`Style::edit`](super::Style::edit) shows them each description with the setting's [`Value`].

use super::background::Background;
use super::parse_error::ParseChoiceError;
use crate::sequence::Coloring;

/// One setting in words.
#[derive(Debug)]
pub struct Described {
    /// Its name in files of people.
    pub key: &'static str,
    /// Its option on the command line, without dashes; empty where its kinds have options, or it has one of its own.
    pub flag: &'static str,
    /// What the option is given, in capitals.
    pub value_name: &'static str,
    /// What the option does, before the words that it takes.
    pub help: &'static str,
    /// The heading of its option.
    pub heading: &'static str,
    /// Its name in the window.
    pub title: &'static str,
    /// What it does, in the window.
    pub hint: &'static str,
    /// Where it is in the window.
    pub section: Section,
    /// When it has an effect.
    pub when: When,
    /// How the label of a way to draw tells it.
    pub label: Label,
    /// Which values it has.
    pub values: Values,
}

impl Described {
    /// The rest of a description that says what is not usual.
    pub const USUAL: Self = Self {
        key: "",
        flag: "",
        value_name: "",
        help: "",
        heading: "Picture",
        title: "",
        hint: "",
        section: Section::Picture,
        when: When::Always,
        label: Label::Untold,
        values: Values::Switch(""),
    };

    /// The line of its option in a list of options.
    pub fn help_line(&self) -> String {
        let Values::Words(words) = self.values else {
            return self.help.to_owned();
        };
        let words: Vec<&str> = words.list.iter().map(|word| word.word).collect();
        let list = match words.as_slice() {
            [others @ .., last] if !others.is_empty() => format!("{} or {last}", others.join(", ")),
            words => words.concat(),
        };
        if self.help.is_empty() {
            list
        } else {
            format!("{}: {list}", self.help)
        }
    }

    /// A word or a number of the command line. `Err` says what was expected.
    pub fn parse(&self, text: &str) -> Result<Value, String> {
        match &self.values {
            Values::Words(words) => {
                let place = words.place_of(text).map_err(|error| error.to_string());
                place.map(Value::Word)
            }
            Values::Number(numbers) => numbers.parse(text).map(Value::Number),
            _ => Err("expected no text".to_owned()),
        }
    }

    /// The nearest value that files may hold.
    #[must_use]
    pub fn nearest(&self, value: Value) -> Value {
        match (&self.values, value) {
            (Values::Number(numbers), Value::Number(number)) => {
                Value::Number(numbers.nearest(number))
            }
            (Values::Kinds(kinds), Value::Kind(place, number)) => match kinds[place].number {
                Some(ref told) if number.is_nan() => Value::Kind(place, told.usual),
                Some(ref told) => Value::Kind(place, told.numbers.nearest(number)),
                None => value,
            },
            _ => value,
        }
    }
}

/// The value of any setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// The place of a word in [`Values::Words`].
    Word(usize),
    /// A number.
    Number(f64),
    /// Whether something is so.
    Switch(bool),
    /// The place of a kind in [`Values::Kinds`], and its number, or 0 where it has none.
    Kind(usize, f64),
    /// What is behind the cloud.
    Background(Background),
    /// Where colours come from.
    Colors(Coloring),
}

/// Which values a setting has.
#[derive(Debug)]
pub enum Values {
    /// One of these.
    Words(&'static Words),
    /// A number.
    Number(Numbers),
    /// Yes or no, with a word beside the box.
    Switch(&'static str),
    /// One of these, most with a number.
    Kinds(&'static [Kind]),
    /// Two colours.
    Background,
    /// A [`Coloring`].
    Colors,
}

/// Values that are words.
#[derive(Debug)]
pub struct Words {
    /// What one of them is.
    pub what: &'static str,
    /// All, in the order of lists.
    pub list: &'static [Word],
}

impl Words {
    /// The place of a word.
    pub(crate) fn place_of(&self, text: &str) -> Result<usize, ParseChoiceError> {
        let place = self.list.iter().position(|word| word.word == text);
        place.ok_or_else(|| {
            let words = self.list.iter().map(|word| word.word);
            ParseChoiceError::new(self.what, text, words)
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
    /// What it means, in the window.
    pub hint: &'static str,
}

/// A kind of values.
#[derive(Debug)]
pub struct Kind {
    /// Its option on the command line, without dashes.
    pub flag: &'static str,
    /// What the option does.
    pub help: &'static str,
    /// Its name in the window.
    pub title: &'static str,
    /// What it means, in the window.
    pub hint: &'static str,
    /// How the label of a way to draw tells it; `{}` stands for the number.
    pub label: &'static str,
    /// Its number, if it has one.
    pub number: Option<KindNumber>,
}

/// The number of a kind.
#[derive(Debug)]
pub struct KindNumber {
    /// What the option is given, in capitals.
    pub value_name: &'static str,
    /// Its name in the window.
    pub title: &'static str,
    /// What it means, in the window.
    pub hint: &'static str,
    /// Where the kind is chosen and no number yet.
    pub usual: f64,
    /// Which numbers there are.
    pub numbers: Numbers,
}

/// Which numbers a setting may be.
#[derive(Debug)]
pub struct Numbers {
    /// In files; the nearest one is taken.
    pub kept: [f32; 2],
    /// On the slider.
    pub offered: [f32; 2],
    /// On the command line.
    pub typed: Typed,
    /// How they are shown.
    pub unit: Unit,
    /// Digits behind the point at most.
    pub decimals: usize,
    /// Equal ways on the slider are equal factors.
    pub is_logarithmic: bool,
}

/// Which numbers the command line takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Typed {
    /// Finite ones above 0.
    Positive,
    /// Finite ones from 0 up.
    NotNegative,
    /// Those that files may hold; the text says what they are.
    Kept(&'static str),
    /// Whole ones that files may hold.
    Whole,
    /// Whole ones from 1 up.
    WholePositive,
}

/// How numbers are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// As they are, and this after them.
    Is(&'static str),
    /// In percent, and moved in steps of five.
    Share,
    /// In percent, which the slider moves, and rounded to tenths of them.
    Percent,
}

impl Numbers {
    /// Any number above 0 from the command line, without unit.
    pub const USUAL: Self = Self {
        kept: [0.0, 1.0],
        offered: [0.0, 1.0],
        typed: Typed::Positive,
        unit: Unit::Is(""),
        decimals: 2,
        is_logarithmic: false,
    };

    /// Whether they are whole.
    pub fn are_whole(&self) -> bool {
        matches!(self.typed, Typed::Whole | Typed::WholePositive)
    }

    /// The nearest number that files may hold.
    fn nearest(&self, number: f64) -> f64 {
        let [least, most] = self.kept.map(f64::from);
        number.clamp(least, most)
    }

    /// A number of the command line. `Err` says what was expected.
    pub fn parse(&self, text: &str) -> Result<f64, String> {
        let [least, most] = self.kept;
        let number = || match self.typed {
            Typed::Whole | Typed::WholePositive => text.parse::<u32>().ok().map(f64::from),
            _ => text.parse::<f32>().ok().map(f64::from),
        };
        let is_taken = |number: &f64| match self.typed {
            Typed::Positive => number.is_finite() && *number > 0.0,
            Typed::NotNegative => number.is_finite() && *number >= 0.0,
            Typed::Kept(_) | Typed::Whole => self.nearest(*number) == *number,
            Typed::WholePositive => *number >= 1.0,
        };
        number().filter(is_taken).ok_or_else(|| match self.typed {
            Typed::Positive => "expected a number above 0".to_owned(),
            Typed::NotNegative => "expected a number from 0 up".to_owned(),
            Typed::Kept(expected) => format!("expected {expected}"),
            Typed::Whole => format!("expected a whole number from {least} to {most}"),
            Typed::WholePositive => "expected a whole number from 1 up".to_owned(),
        })
    }

    /// A number in a label.
    pub fn told(&self, number: f64) -> String {
        match self.unit {
            Unit::Is(_) => (number as f32).to_string(),
            Unit::Share | Unit::Percent => format!("{:.0} %", number * 100.0),
        }
    }
}

/// A part of the panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Section {
    /// What is drawn, and by whom.
    Picture,
    /// How surfels are.
    Surfels,
    /// What the processor draws surfels from.
    Footprints,
    /// How points are.
    Points,
    /// How voxels are.
    Cubes,
    /// How deep the octree goes.
    Octree,
    /// Which of its cells are drawn.
    LevelOfDetail,
    /// Light.
    Shading,
    /// What is beside the cloud.
    Background,
    /// A place of its own.
    Own,
}

/// When a setting has an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// Whatever is drawn.
    Always,
    /// Surfels are drawn.
    Surfels,
    /// Surfels are drawn, enlarged.
    EnlargedSurfels,
    /// Surfels are drawn, from byte codes if the processor draws.
    CodedSurfels,
    /// Points are drawn.
    Points,
    /// Voxels are drawn.
    Voxels,
    /// Cells of the octree are drawn.
    Cells,
    /// Surfels or voxels are drawn.
    Lit,
    /// What is drawn leaves depths.
    Depths,
    /// Depths shade what is drawn.
    EyeDome,
    /// The GPU draws.
    Gpu,
}

/// How the label of a way to draw tells a setting: `{}` stands for the value as files have it, `{title}` for that of the
/// window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Label {
    /// It does not.
    Untold,
    /// Whatever it is.
    Always(Place, &'static str),
    /// Where it is not as by default.
    Unusual(Place, &'static str),
    /// In some cases.
    If(When, Place, &'static str),
}

/// Where in a label.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// First: what is drawn.
    What,
    /// Then how finely.
    HowFine,
    /// Last: who draws.
    Who,
}

/// What can be a setting.
pub trait Setting: Sized {
    /// As any setting.
    fn value(&self) -> Value;

    /// From any setting; `None` if it is none of these.
    fn from_value(value: Value) -> Option<Self>;

    /// Shows this with its description to `edit`, and takes what that makes of it.
    fn edit(
        &mut self,
        described: &'static Described,
        edit: &mut dyn FnMut(&'static Described, Value) -> Value,
    ) {
        let before = self.value();
        let after = edit(described, before);
        if after != before
            && let Some(value) = Self::from_value(after)
        {
            *self = value;
        }
    }
}

impl Setting for f32 {
    fn value(&self) -> Value {
        Value::Number(f64::from(*self))
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Number(number) => Some(number as Self),
            _ => None,
        }
    }
}

impl Setting for bool {
    fn value(&self) -> Value {
        Value::Switch(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Switch(is_on) => Some(is_on),
            _ => None,
        }
    }
}

impl Setting for Background {
    fn value(&self) -> Value {
        Value::Background(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Background(background) => Some(background),
            _ => None,
        }
    }
}

impl Setting for Coloring {
    fn value(&self) -> Value {
        Value::Colors(*self)
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Colors(coloring) => Some(coloring),
            _ => None,
        }
    }
}

/// Writes a group of settings once: each field with its name in files, its default and its description.
macro_rules! group {
    (
        $(#[$doc:meta])* $group:ident {
            $($(#[$field_doc:meta])* $field:ident: $type:ty = $default:expr, $key:literal $described:ident { $($text:tt)* })+
        }
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(default)]
        pub struct $group {
            $($(#[$field_doc])* #[serde(rename = $key)] pub $field: $type,)+
        }

        impl $group {
            $(
                #[doc = concat!("The description of `", stringify!($field), "`.")]
                pub const $described: $crate::scene::describe::Described = $crate::scene::describe::Described {
                    key: $key,
                    $($text)*
                    ..$crate::scene::describe::Described::USUAL
                };
            )+

            /// Shows each setting with its description to `edit`, and takes what that makes of it.
            pub(super) fn edit(
                &mut self,
                edit: &mut dyn FnMut(
                    &'static $crate::scene::describe::Described,
                    $crate::scene::describe::Value,
                ) -> $crate::scene::describe::Value,
            ) {
                $($crate::scene::describe::Setting::edit(&mut self.$field, &Self::$described, edit);)+
            }
        }

        impl Default for $group {
            fn default() -> Self {
                Self { $($field: $default,)+ }
            }
        }
    };
}
pub(super) use group;
