//! What the palette offers, and what choosing it does.

use crate::app::command::Command;
use crate::app::presets::built_in;
use crate::bench::suites;
use crate::scene::describe::{Described, Shorthand, Value, Values};
use crate::scene::{Background, Settings};
use std::borrow::Cow;

/// What is in the panel of settings and is no setting of drawing: its name, what it does, and the title of its row.
const IN_PANEL: &[(&str, &str, &str)] = &[
    (
        "Clip to a box or a plane…",
        "What is outside is left out, of one frame or of all",
        "Clip",
    ),
    ("Up axis…", "Which axis of the file is up", "Up axis"),
    (
        "Change map…",
        "Points in the colours of their distances to another frame",
        "Change map",
    ),
    ("Onion skin…", "Ghosts of the frames before and after", "Onion skin"),
    (
        "Quality: measure…",
        "Draws the sequence in every way, for the fastest below an error",
        "Quality",
    ),
    (
        "Painted by…",
        "Whether the graphics card or the processor paints the window",
        "Painted by",
    ),
];

/// What choosing an entry does.
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
}

/// What the palette offers.
#[derive(Debug, Clone)]
pub(in crate::app) struct Entry {
    pub(in crate::app) text: Cow<'static, str>,
    /// What it does, where a name does not say enough; found as well, behind what has the words in its name.
    pub(in crate::app) hint: &'static str,
    /// As a person reads them; empty without any.
    pub(in crate::app) keys: &'static str,
    pub(in crate::app) action: Action,
    /// More of what it does; found as its name is.
    pub(in crate::app) what: &'static str,
    /// Words of other programs that find it.
    pub(in crate::app) synonyms: &'static [&'static str],
    /// Why it cannot be chosen now.
    pub(in crate::app) why_not: Option<&'static str>,
}

impl Entry {
    fn new(text: impl Into<Cow<'static, str>>, hint: &'static str, action: Action) -> Self {
        let text = text.into();
        Self {
            text,
            hint,
            keys: "",
            action,
            what: "",
            synonyms: &[],
            why_not: None,
        }
    }

    /// A command.
    pub(super) fn of_command(text: impl Into<Cow<'static, str>>, command: Command) -> Self {
        Self::new(text, "", Action::Run(command))
    }
}

/// All that there is to find but commands: values of settings, presets and benchmarks.
pub(super) fn entries(presets: &[String]) -> Vec<Entry> {
    let settings = Settings::default().settings();
    let settings = settings.into_iter().flat_map(|(described, _)| values_of(described));
    let built_in = built_in().into_iter().map(|(name, what, _)| {
        let action = Action::Give(Command::BUILT_IN_PRESET, name.into());
        Entry::new(format!("Preset: {name}"), what, action)
    });
    let presets = presets.iter().map(|name| {
        let action = Action::Give(Command::PRESET, name.clone().into());
        Entry::new(format!("Preset: {name}"), "", action)
    });
    let measured = suites::all().map(|suite| {
        let action = Action::Give(Command::RUN_BENCHMARK, suite.name().into());
        Entry::new(format!("Benchmark: {}", suite.title), suite.hint, action)
    });
    let in_panel = IN_PANEL.iter();
    let in_panel = in_panel.map(|&(text, hint, title)| Entry::new(text, hint, Action::ShowSetting(title)));
    in_panel
        .chain(settings)
        .chain(built_in)
        .chain(presets)
        .chain(measured)
        .collect()
}

/// An entry for each value of a setting; one for the setting, where its values are numbers, colours or fields.
fn values_of(described: &'static Described) -> Vec<Entry> {
    let named = |value: &str| format!("{}: {value}", described.title);
    let set = |value| Action::Set(described.key, value);
    match &described.values {
        Values::Words(words) => {
            let list = words.list.iter().enumerate();
            let list = list.map(|(place, word)| Entry::new(named(word.title), word.hint, set(Value::Word(place))));
            let shorthands = described.shorthands.iter();
            let shorthands =
                shorthands.map(|short| Entry::new(named(short.word.title), short.word.hint, Action::Take(short)));
            list.chain(shorthands).collect()
        }
        Values::Switch(_) => [("on", true), ("off", false)]
            .map(|(text, is_on)| Entry::new(named(text), described.hint, set(Value::Switch(is_on))))
            .into(),
        Values::Kinds(kinds) => {
            let kinds = kinds.iter().enumerate();
            kinds
                .map(|(place, kind)| {
                    let number = kind.number.as_ref().map_or(0.0, |number| number.usual);
                    Entry::new(named(kind.title), kind.hint, set(Value::Kind(place, number)))
                })
                .collect()
        }
        // Its title is one of a list of backgrounds in a section of the panel.
        Values::Background => Background::PRESETS
            .iter()
            .map(|&(_, title, preset)| {
                let text = format!("Background: {title}");
                Entry::new(text, "What is behind the cloud", set(Value::Background(preset)))
            })
            .collect(),
        Values::Number(_) | Values::Colors | Values::Environment => {
            vec![Entry::new(
                named("…").replace(": …", "…"),
                described.hint,
                Action::ShowSetting(described.title),
            )]
        }
    }
}
