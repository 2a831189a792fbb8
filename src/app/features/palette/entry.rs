//! Entries of the palette, and the effect of choosing one.

use super::rank::Text;
use crate::app::command::{Command, NumberUse, Offer};
use crate::app::settings_row::NamedRow;
use crate::scene::describe::{Described, Kind, Numbers, Shorthand, Unit, Value, Values};
use crate::scene::{Background, Settings};
use std::borrow::Cow;

/// Effect of choosing an entry.
#[derive(Debug, Clone)]
pub(in crate::app) enum Action {
    /// Runs a command.
    Run(Command),
    /// Gives the setting of this key a value.
    Set(&'static str, Value),
    /// Gives the settings that a word is short for their values.
    Take(&'static Shorthand),
    /// Gives a command a value.
    Give(Command, Cow<'static, str>),
    /// Shows the row of this title in the panel of settings.
    ShowSetting(&'static str),
    /// Begins another query with this text.
    Type(Cow<'static, str>),
}

/// An entry of the palette.
#[derive(Debug, Clone)]
pub(in crate::app) struct Entry {
    pub(in crate::app) text: Cow<'static, str>,
    /// A sentence about it; found as well, ranked below entries with the words in their names.
    pub(in crate::app) hint: &'static str,
    /// Its keys as display text; empty without any.
    pub(in crate::app) keys: &'static str,
    pub(in crate::app) action: Action,
    /// Another name, found as its text is.
    pub(in crate::app) other_name: Cow<'static, str>,
    /// Words of people and of other programs that find it: of its row, and of its value.
    pub(in crate::app) also: [&'static [&'static str]; 2],
    /// The reason why it cannot be chosen now.
    pub(in crate::app) why_not: Option<&'static str>,
    pub(super) number: NumberUse,
}

impl Entry {
    fn new(text: impl Into<Cow<'static, str>>, hint: &'static str, action: Action) -> Self {
        Self {
            text: text.into(),
            hint,
            keys: "",
            action,
            other_name: "".into(),
            also: [&[], &[]],
            why_not: None,
            number: NumberUse::None,
        }
    }

    /// A command.
    pub(super) fn of_command(text: impl Into<Cow<'static, str>>, command: Command) -> Self {
        Self::new(text, "", Action::Run(command))
    }

    /// A value that a command takes.
    pub(super) fn of_offer(offer: Offer, command: Command) -> Self {
        let action = if offer.is_begun {
            Action::Type(offer.value)
        } else {
            Action::Give(command, offer.value)
        };
        Self {
            also: [offer.also, &[]],
            why_not: offer.why_not,
            number: offer.number,
            ..Self::new(offer.text, offer.hint, action)
        }
    }

    /// A row of the panel of settings.
    pub(super) fn of_row(row: &NamedRow) -> Self {
        Self {
            also: [row.also, &[]],
            other_name: row.title.into(),
            ..Self::new(row.text, row.hint, Action::ShowSetting(row.title))
        }
    }

    fn also(self, row: &'static [&'static str], value: &'static [&'static str]) -> Self {
        Self {
            also: [row, value],
            ..self
        }
    }

    /// Texts to rank it by.
    pub(super) fn texts(&self, bonus: f32) -> Text<'_> {
        Text {
            title: &self.text,
            other_title: &self.other_name,
            also: self.also,
            hint: self.hint,
            number: self.number,
            bonus,
        }
    }
}

/// Entries of all settings; `number` is the one in the query.
pub(super) fn of_settings(number: Option<f64>) -> impl Iterator<Item = Entry> {
    let settings = Settings::default().settings().into_iter();
    settings.flat_map(move |(described, _)| {
        let with_number = number.and_then(|number| number_of(described, number));
        let kinds = number.into_iter().flat_map(|number| kinds_of(described, number));
        let named = values_of(described).into_iter();
        kinds.chain(with_number).chain(named).collect::<Vec<_>>()
    })
}

/// An entry for each value of a setting; one for the setting, where its values are numbers, colours or fields.
fn values_of(described: &'static Described) -> Vec<Entry> {
    let named = |value: &str| format!("{}: {value}", described.name());
    let set = |value| Action::Set(described.key, value);
    match &described.values {
        Values::Words(words) => {
            let list = words.list.iter().enumerate();
            let list = list.map(|(place, word)| {
                let entry = Entry::new(named(word.title), word.hint, set(Value::Word(place)));
                entry.also(described.also, word.also)
            });
            let shorthands = described.shorthands.iter();
            let shorthands = shorthands.map(|short| {
                let entry = Entry::new(named(short.word.title), short.word.hint, Action::Take(short));
                entry.also(described.also, short.word.also)
            });
            list.chain(shorthands).collect()
        }
        Values::Switch(_) => [("on", true), ("off", false)]
            .map(|(text, is_on)| {
                let entry = Entry::new(named(text), described.hint, set(Value::Switch(is_on)));
                entry.also(described.also, &[])
            })
            .into(),
        Values::Kinds(kinds) => {
            let kinds = kinds.iter().enumerate();
            kinds
                .map(|(place, kind)| {
                    let number = kind.number.as_ref().map_or(0.0, |number| number.usual);
                    let entry = Entry::new(named(kind.title), kind.hint, set(Value::Kind(place, number)));
                    entry.also(described.also, kind.also)
                })
                .collect()
        }
        Values::Background => Background::PRESETS
            .iter()
            .map(|&(_, title, preset)| {
                let entry = Entry::new(named(title), described.hint, set(Value::Background(preset)));
                entry.also(described.also, &[])
            })
            .collect(),
        Values::Number(_) | Values::Environment => {
            let show = Action::ShowSetting(described.title);
            let entry = Entry::new(format!("{}…", described.name()), described.hint, show);
            vec![entry.also(described.also, &[])]
        }
        // Colours are offered by a command: they depend on the open sequence.
        Values::Colors => Vec::new(),
    }
}

/// The entry that gives a setting a number.
fn number_of(described: &'static Described, number: f64) -> Option<Entry> {
    let Values::Number(numbers) = &described.values else {
        return None;
    };
    let number = taken(numbers, number)?;
    let text = format!("Set {} to {}", begun_small(described.name()), shown(numbers, number));
    let action = Action::Set(described.key, Value::Number(number));
    Some(Entry {
        number: NumberUse::WithWords,
        ..Entry::new(text, described.hint, action).also(described.also, &[])
    })
}

/// The entries that give a setting a kind of value with a number.
fn kinds_of(described: &'static Described, number: f64) -> Vec<Entry> {
    let Values::Kinds(kinds) = &described.values else {
        return Vec::new();
    };
    let entry = |(place, kind): (usize, &'static Kind)| {
        let told = kind.number.as_ref()?;
        let number = taken(&told.numbers, number)?;
        let number_text = shown(&told.numbers, number);
        let text = format!("{}: {} {number_text}", described.name(), kind.title);
        let action = Action::Set(described.key, Value::Kind(place, number));
        Some(Entry {
            number: NumberUse::WithWords,
            other_name: told.title.into(),
            ..Entry::new(text, kind.hint, action).also(described.also, kind.also)
        })
    };
    kinds.iter().enumerate().filter_map(entry).collect()
}

/// A number that a setting takes. People write fractions as percentages, too.
fn taken(numbers: &Numbers, number: f64) -> Option<f64> {
    let is_fraction = matches!(numbers.unit, Unit::Share | Unit::Percent);
    let number = if is_fraction && number > 1.0 {
        number / 100.0
    } else {
        number
    };
    numbers.parse(&number.to_string()).ok()
}

fn shown(numbers: &Numbers, number: f64) -> String {
    match numbers.unit {
        Unit::Is(unit) => format!("{}{unit}", numbers.typed_text(number)),
        Unit::Share | Unit::Percent => numbers.told(number),
    }
}

/// A title in a sentence: its first letter is small, if it does not begin with an abbreviation.
fn begun_small(title: &str) -> String {
    let mut letters = title.chars();
    match (letters.next(), letters.clone().next()) {
        (Some(first), Some(second)) if second.is_lowercase() => first.to_lowercase().chain(letters).collect(),
        _ => title.to_owned(),
    }
}
