//! What the palette offers, and what choosing it does.

use crate::app::command::{BINDINGS, Command};
use crate::app::open_panels::PanelId;
use crate::app::presets::built_in;
use crate::bench::Suite;
use crate::bench::suites;
use crate::scene::describe::{Described, Shorthand, Value, Values};
use crate::scene::{Background, Settings};
use crate::source::Example;
use egui::ThemePreference;
use std::borrow::Cow;

/// Commands that have no key.
const WITHOUT_KEYS: &[(&str, Command)] = &[
    ("Open a folder", Command::OpenFolder),
    ("Open the demo", Command::OpenDemo),
    ("Open an example: LiDAR survey", Command::OpenExample(Example::Lidar)),
    ("Open an example: depth image", Command::OpenExample(Example::Depth)),
    ("Open an example: animated model", Command::OpenExample(Example::Model)),
    ("Close the sequence", Command::CloseSequence),
    ("Begin again from defaults", Command::BeginAgain),
    ("Use this look for new files", Command::UseAsDefaults),
    ("Compare with a folder", Command::CompareFolder),
    ("Close comparison", Command::CloseComparison),
    ("Show or hide thumbnails over the timeline", Command::ToggleThumbnails),
    ("Make thumbnails anew", Command::RedoThumbnails),
    ("Look from the sensor", Command::LookFromSensor),
    ("Show or hide the legend", Command::TogglePanel(PanelId::LEGEND)),
    ("Show or hide the scale bar", Command::ToggleScaleBar),
    ("Theme of the system", Command::Theme(ThemePreference::System)),
    ("Light theme", Command::Theme(ThemePreference::Light)),
    ("Dark theme", Command::Theme(ThemePreference::Dark)),
    ("Save a picture as a file of a name", Command::SaveScreenshotAs),
    ("Record the live stream, or end that", Command::ToggleRecording),
    ("Export the camera path", Command::ExportPath),
    ("New camera path", Command::NewPath),
    ("Open a camera path", Command::OpenPath),
    ("Save the camera path", Command::SavePath),
    ("Save the camera path as a file of a name", Command::SavePathAs),
    ("Save the session as a file of a name", Command::SaveSessionAs),
    (
        "About pointreel: version, adapter, folders",
        Command::TogglePanel(PanelId::ABOUT),
    ),
    ("Show the last benchmark", Command::TogglePanel(PanelId::BENCHMARK)),
];

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
#[derive(Debug, Clone, Copy)]
pub(in crate::app) enum Action {
    /// Runs a command.
    Run(Command),
    /// Gives the setting of this key a value.
    Set(&'static str, Value),
    /// Gives the settings that a word is short for their values.
    Take(&'static Shorthand),
    /// Draws as the built-in preset at this place.
    BuiltIn(usize),
    /// Draws as this person's preset at this place.
    Preset(usize),
    /// Starts a benchmark.
    Measure(&'static Suite),
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
}

impl Entry {
    fn new(text: impl Into<Cow<'static, str>>, hint: &'static str, action: Action) -> Self {
        let text = text.into();
        Self {
            text,
            hint,
            keys: "",
            action,
        }
    }

    /// A command without keys.
    pub(in crate::app) fn of_command(text: &'static str, command: Command) -> Self {
        Self::new(text, "", Action::Run(command))
    }
}

/// All that there is to find but panels: commands, values of settings, presets and benchmarks.
pub(super) fn entries(presets: &[String]) -> Vec<Entry> {
    let with_keys = BINDINGS.iter().map(|binding| Entry {
        keys: binding.keys,
        ..Entry::of_command(binding.text, binding.command)
    });
    let without = WITHOUT_KEYS
        .iter()
        .map(|&(text, command)| Entry::of_command(text, command));
    let settings = Settings::default().settings();
    let settings = settings.into_iter().flat_map(|(described, _)| values_of(described));
    let built_in = built_in().into_iter().enumerate();
    let built_in =
        built_in.map(|(place, (name, what, _))| Entry::new(format!("Preset: {name}"), what, Action::BuiltIn(place)));
    let presets = presets.iter().enumerate();
    let presets = presets.map(|(place, name)| Entry::new(format!("Preset: {name}"), "", Action::Preset(place)));
    let measured = suites::all().map(|suite| {
        Entry::new(
            format!("Benchmark: {}", suite.title),
            suite.hint,
            Action::Measure(suite),
        )
    });
    let in_panel = IN_PANEL.iter();
    let in_panel = in_panel.map(|&(text, hint, title)| Entry::new(text, hint, Action::ShowSetting(title)));
    let commands = with_keys.chain(without).chain(in_panel);
    commands
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
