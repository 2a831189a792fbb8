//! Preferences of the user, stored in a small JSON file.
//!
//! **How it works.** [`Preferences`] are the part of the window's state that outlives it. The file holds them in the
//! words of the command line, and outlives versions of this program: missing or unreadable values get their defaults; a
//! number that is not offered is replaced by the nearest; unknown fields are retained. Where something could not be
//! read, a copy is made before the file is rewritten (`stored/lenient.rs`). It is written a short time after something
//! was changed, so that a killed program has lost nothing, and never by a run without changes. Several windows share
//! the file: each writes only its own changes (`stored/update.rs`).

use super::open_panels::RememberedPanels;
use super::present_choice::PresentChoice;
use crate::persist::{self, Fields};
use crate::scene::Settings;
use crate::timeline::{LoopMode, MAX_SPEED, MIN_SPEED};
use egui::ThemePreference;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Changes where the same word would mean something else. Further fields and further words need no other version.
const VERSION: u32 = 6;

/// Name of the file's contents in messages.
const WHAT: &str = "the settings";

/// A slider that is being dragged is not written at each of its steps.
const WRITE_DELAY: Duration = Duration::from_secs(1);

/// Edges of a window, logical pixels.
const WINDOW_EDGE_RANGE: RangeInclusive<f64> = 100.0..=16_384.0;

/// Preferences remembered by the window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Render settings.
    #[serde(flatten)]
    pub settings: Settings,
    /// Presenter that shows images on the screen.
    pub present: PresentChoice,
    /// Loop mode: the behaviour at the ends of a sequence.
    pub loop_mode: LoopMode,
    /// Playback speed, forward: [`MIN_SPEED`] to [`MAX_SPEED`].
    pub speed: f64,
    /// Panels that are open; windows above them are not remembered.
    #[serde(flatten)]
    pub panels: RememberedPanels,
    /// Visibility of thumbnails over the timeline.
    pub thumbnails: bool,
    /// Visibility of the scale bar in the image.
    pub scale_bar: bool,
    /// Visibility of the advanced settings, which few need.
    pub advanced: bool,
    /// Light or dark theme of the window.
    #[serde(with = "Theme")]
    pub theme: ThemePreference,
    /// Size of the window in whole logical pixels, when it was neither maximised nor full screen.
    pub window_size: Option<[f64; 2]>,
    /// Left, top, right and bottom of the window of benchmarks, whole points.
    pub benchmark_place: Option<[f32; 4]>,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            settings: Settings::default(),
            present: PresentChoice::default(),
            loop_mode: LoopMode::default(),
            speed: 1.0,
            panels: RememberedPanels::default(),
            thumbnails: true,
            scale_bar: true,
            advanced: false,
            theme: ThemePreference::System,
            window_size: None,
            benchmark_place: None,
        }
    }
}

/// The words for [`ThemePreference`].
#[derive(Serialize, Deserialize)]
#[serde(remote = "ThemePreference", rename_all = "lowercase")]
enum Theme {
    Dark,
    Light,
    System,
}

impl Preferences {
    /// Clamps to the values that the window offers: the command line lets more through, people write files by hand, and
    /// a window can be squeezed to nothing.
    fn offered(self) -> Self {
        Self {
            settings: self.settings.nearest(),
            speed: self.speed.clamp(MIN_SPEED, MAX_SPEED),
            window_size: self
                .window_size
                .map(|size| size.map(f64::round))
                .filter(|size| size.iter().all(|edge| WINDOW_EDGE_RANGE.contains(edge))),
            benchmark_place: self.benchmark_place.map(|place| place.map(f32::round)).filter(
                |[left, top, right, bottom]| {
                    let edges = [right - left, bottom - top].map(f64::from);
                    edges.iter().all(|edge| WINDOW_EDGE_RANGE.contains(edge)) && left.is_finite() && top.is_finite()
                },
            ),
            ..self
        }
    }

    /// The fields of the file.
    fn to_fields(self) -> Fields {
        match serde_json::to_value(self) {
            Ok(Value::Object(fields)) => fields,
            // Preferences always serialise to an object.
            Ok(_) | Err(_) => Fields::new(),
        }
    }

    /// Reads the fields of a file.
    fn of(stored: &Fields, unread: &mut Vec<String>) -> Self {
        persist::note_later_version(stored, VERSION, unread);
        persist::fields::<Self>(stored, unread).offered()
    }
}

/// The file of the preferences, and when it is to be written next.
#[derive(Debug, Clone, Default)]
pub struct PreferencesFile {
    file: Option<PathBuf>,
    problem: Option<String>,
    /// Preferences at start or at the last write: nothing to do while they stay.
    settled: Option<Preferences>,
    /// Changed preferences, written once they have stayed for a while, and the time since when.
    changed: Option<(Preferences, Duration)>,
}

impl PreferencesFile {
    /// The user's file, and its contents.
    pub fn load() -> (Self, Preferences) {
        persist::place_of("settings.json").map_or_else(Default::default, |file| Self::load_from(&file))
    }

    /// Loads the preferences in `file`, which need not exist yet.
    pub fn load_from(file: &Path) -> (Self, Preferences) {
        let read = persist::read_leniently(file, WHAT, Preferences::of);
        let preferences = read.value;
        let this = Self {
            file: read.file,
            problem: read.problem,
            ..Self::default()
        };
        (this, preferences)
    }

    /// Returns the notice text on unreadable values, and the path of the copy.
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// Notes the preferences at `now`. The first call records the initial state of the window.
    pub(super) fn note(&mut self, preferences: Preferences, now: Duration) {
        let preferences = preferences.offered();
        let settled = *self.settled.get_or_insert(preferences);
        if preferences == settled {
            self.changed = None;
        } else if self.changed.is_none_or(|(before, _)| before != preferences) {
            self.changed = Some((preferences, now));
        }
    }

    /// When [`PreferencesFile::write_if_due`] has something to do.
    pub(super) fn next_deadline(&self) -> Option<Duration> {
        self.file.as_ref()?;
        self.changed.map(|(_, since)| since + WRITE_DELAY)
    }

    /// Writes changes made long enough before `now`.
    pub(super) fn write_if_due(&mut self, now: Duration) {
        if self.next_deadline().is_some_and(|due| due <= now) {
            self.write();
        }
    }

    /// Writes the changes. A file that cannot be written is reported in the log.
    pub(super) fn write(&mut self) {
        let (Some(file), Some((preferences, _))) = (&self.file, self.changed.take()) else {
            return;
        };
        let now = preferences.to_fields();
        // Also after a failure: it would fail again every second.
        let before = self.settled.replace(preferences).map(Preferences::to_fields);
        let written = persist::update(file, WHAT, |stored, unread| {
            persist::note_later_version(stored, VERSION, unread);
            persist::retain_readable::<Preferences>(stored, unread);
            persist::merge(stored, &before.unwrap_or_default(), &now);
            stored.insert("version".to_owned(), VERSION.into());
        });
        if let Err(reason) = written {
            log::warn!("the settings could not be written to {} ({reason})", file.display());
        }
    }
}

#[cfg(test)]
mod tests;
