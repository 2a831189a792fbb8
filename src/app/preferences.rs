//! What a person chose, kept between runs in a small JSON file.
//!
//! **How it works.** [`Preferences`] are the part of the window's state that outlives it. The file holds them by the words
//! of the command line, under a version number, and is taken as a whole or not at all: a file that is damaged, of another
//! version, or has a value that the window does not offer is left aside with a warning in the log. It is written a moment
//! after something was changed, so that a program that is killed has lost nothing, and never by a run in which
//! nothing was changed.

use super::state::{OpenPanels, POINT_SIZE_RANGE_PX, SPLAT_SCALE_RANGE};
use crate::kept;
use crate::octree::StopCriterion;
use crate::scene::{Background, Lod, Settings};
use crate::sequence::{ColorSource, LoopMode, MAX_SPEED, MIN_SPEED};
use egui::ThemePreference;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

/// Changes with every change of [`Stored`] that older programs, or newer ones, would misread.
const VERSION: u32 = 6;

/// A slider that is being dragged is not written at each of its steps.
const WRITE_DELAY: Duration = Duration::from_secs(1);

/// Further factor of the enlarged passes, from the slider or the command line.
const ENLARGEMENT_RANGE: RangeInclusive<f32> = 0.01..=100.0;

/// Edges of a window, logical pixels.
const WINDOW_EDGE_RANGE: RangeInclusive<f64> = 100.0..=16_384.0;

/// What the window remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preferences {
    /// How pictures are asked for.
    pub settings: Settings,
    /// What happens at the ends of a sequence.
    pub loop_mode: LoopMode,
    /// How fast it plays, forward: [`MIN_SPEED`] to [`MAX_SPEED`].
    pub speed: f64,
    /// Which panels are open; windows above them are not remembered.
    pub panels: OpenPanels,
    /// Whether small pictures are shown over the timeline.
    pub thumbnails: bool,
    /// Whether the window is light or dark.
    pub theme: ThemePreference,
    /// Size of the window in whole logical pixels, when it was neither maximised nor full screen.
    pub window_size: Option<[f64; 2]>,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            settings: Settings::default(),
            loop_mode: LoopMode::default(),
            speed: 1.0,
            panels: OpenPanels::default(),
            thumbnails: true,
            theme: ThemePreference::System,
            window_size: None,
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "a switch of the window is a word in the file"
)]
struct Stored {
    version: u32,
    primitive: String,
    renderer: String,
    splatting: String,
    strategy: String,
    splat_scale: f32,
    enlargement: f32,
    cull_back_faces: bool,
    lighting: String,
    background: String,
    colors: String,
    point_size_px: f32,
    stop: StopCriterion,
    lod: Lod,
    surfel_lod: bool,
    resolution: f32,
    footprint: String,
    normal_bits: String,
    offset_bits: String,
    loop_mode: String,
    speed: f64,
    settings_panel: bool,
    statistics_panel: bool,
    thumbnails: bool,
    /// Files from before there was a choice follow the system.
    #[serde(default = "system_theme")]
    theme: String,
    window_size: Option<[f64; 2]>,
}

fn system_theme() -> String {
    theme_name(ThemePreference::System).to_owned()
}

/// Looked at first: the rest of a file of another version may be anything.
#[derive(Deserialize)]
struct Version {
    version: u32,
}

impl Preferences {
    /// Within what the window offers, so that it is taken when it is read: the command line lets more through, and a
    /// window can be squeezed to nothing.
    fn offered(self) -> Self {
        Self {
            settings: offered_settings(self.settings),
            speed: self.speed.clamp(MIN_SPEED, MAX_SPEED),
            window_size: self
                .window_size
                .map(|size| size.map(f64::round))
                .filter(|size| size.iter().all(|edge| WINDOW_EDGE_RANGE.contains(edge))),
            ..self
        }
    }

    /// The text of the file.
    fn to_json(self) -> serde_json::Result<Vec<u8>> {
        let Settings {
            primitive,
            renderer,
            splatting,
            strategy,
            splat_scale,
            enlargement,
            cull_back_faces,
            lighting,
            background,
            colors,
            point_size_px,
            stop,
            lod,
            surfel_lod,
            resolution,
            footprint,
            normal_bits,
            offset_bits,
            // Its numbers mean nothing in the next sequence.
            clip: _,
        } = self.settings;
        serde_json::to_vec_pretty(&Stored {
            version: VERSION,
            primitive: primitive.to_string(),
            renderer: renderer.to_string(),
            splatting: splatting.to_string(),
            strategy: strategy.to_string(),
            splat_scale,
            enlargement,
            cull_back_faces,
            lighting: lighting.to_string(),
            background: format!("{}-{}", hex(background.top), hex(background.bottom)),
            colors: colors.name().to_owned(),
            point_size_px,
            stop,
            lod,
            surfel_lod,
            resolution,
            footprint: footprint.to_string(),
            normal_bits: normal_bits.to_string(),
            offset_bits: offset_bits.to_string(),
            loop_mode: loop_name(self.loop_mode).to_owned(),
            speed: self.speed,
            settings_panel: self.panels.settings,
            statistics_panel: self.panels.statistics,
            thumbnails: self.thumbnails,
            theme: theme_name(self.theme).to_owned(),
            window_size: self.window_size,
        })
    }

    /// Reads the text of a file; `Err` says what is wrong with it.
    fn from_json(bytes: &[u8]) -> Result<Self, String> {
        let Version { version } = parse_json(bytes)?;
        if version != VERSION {
            return Err(format!("it has version {version} instead of {VERSION}"));
        }
        let stored: Stored = parse_json(bytes)?;
        let settings = Settings {
            primitive: word(&stored.primitive)?,
            renderer: word(&stored.renderer)?,
            splatting: word(&stored.splatting)?,
            strategy: word(&stored.strategy)?,
            splat_scale: within("splat_scale", stored.splat_scale, SPLAT_SCALE_RANGE)?,
            enlargement: within("enlargement", stored.enlargement, ENLARGEMENT_RANGE)?,
            cull_back_faces: stored.cull_back_faces,
            lighting: word(&stored.lighting)?,
            background: word::<Background>(&stored.background)?,
            colors: named(&stored.colors, &ColorSource::ALL, ColorSource::name)?,
            point_size_px: within("point_size_px", stored.point_size_px, POINT_SIZE_RANGE_PX)?,
            stop: as_offered("stop", stored.stop, offered_stop)?,
            lod: as_offered("lod", stored.lod, Lod::offered)?,
            surfel_lod: stored.surfel_lod,
            resolution: within("resolution", stored.resolution, Settings::RESOLUTIONS)?,
            footprint: word(&stored.footprint)?,
            normal_bits: word(&stored.normal_bits)?,
            offset_bits: word(&stored.offset_bits)?,
            clip: None,
        };
        if let Some(size) = stored.window_size {
            for edge in size {
                within("window_size", edge, WINDOW_EDGE_RANGE)?;
            }
        }
        Ok(Self {
            settings,
            loop_mode: named(&stored.loop_mode, &LoopMode::ALL, loop_name)?,
            speed: within("speed", stored.speed, MIN_SPEED..=MAX_SPEED)?,
            panels: OpenPanels {
                settings: stored.settings_panel,
                statistics: stored.statistics_panel,
                ..OpenPanels::default()
            },
            thumbnails: stored.thumbnails,
            theme: named(&stored.theme, &THEMES, theme_name)?,
            window_size: stored.window_size,
        })
    }
}

/// The nearest settings that the window offers.
pub(super) fn offered_settings(settings: Settings) -> Settings {
    let clamp = |value: f32, range: RangeInclusive<f32>| value.clamp(*range.start(), *range.end());
    Settings {
        splat_scale: clamp(settings.splat_scale, SPLAT_SCALE_RANGE),
        enlargement: clamp(settings.enlargement, ENLARGEMENT_RANGE),
        point_size_px: clamp(settings.point_size_px, POINT_SIZE_RANGE_PX),
        stop: offered_stop(settings.stop),
        lod: settings.lod.offered(),
        resolution: clamp(settings.resolution, Settings::RESOLUTIONS),
        ..settings
    }
}

/// The nearest stop criterion that the window offers.
fn offered_stop(stop: StopCriterion) -> StopCriterion {
    match stop {
        StopCriterion::Loss(delta) if delta.is_nan() => StopCriterion::default(),
        StopCriterion::Loss(delta) => StopCriterion::Loss(delta.clamp(0.0, Settings::MAX_DELTA)),
        StopCriterion::Depth(depth) => StopCriterion::Depth(depth.min(*Lod::LEVELS.end())),
        StopCriterion::PointsPerOctant(points) => StopCriterion::PointsPerOctant(points.max(1)),
    }
}

/// A choice that the window offers as it is.
fn as_offered<T: PartialEq + Copy + std::fmt::Debug>(
    name: &str,
    value: T,
    offered: impl Fn(T) -> T,
) -> Result<T, String> {
    if offered(value) == value {
        Ok(value)
    } else {
        Err(format!("{name} is {value:?}, which is not offered"))
    }
}

fn parse_json<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<T, String> {
    serde_json::from_slice(bytes).map_err(|reason| reason.to_string())
}

fn word<T: FromStr<Err: ToString>>(text: &str) -> Result<T, String> {
    text.parse().map_err(|reason: T::Err| reason.to_string())
}

fn named<T: Copy>(text: &str, all: &[T], name: impl Fn(T) -> &'static str) -> Result<T, String> {
    let found = all.iter().copied().find(|&choice| name(choice) == text);
    found.ok_or_else(|| format!("`{text}` is no choice of this program"))
}

fn within<T>(name: &str, value: T, range: RangeInclusive<T>) -> Result<T, String>
where
    T: PartialOrd + std::fmt::Display,
{
    if range.contains(&value) {
        return Ok(value);
    }
    let (start, end) = (range.start(), range.end());
    Err(format!("{name} is {value}, not within {start} to {end}"))
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn loop_name(loop_mode: LoopMode) -> &'static str {
    match loop_mode {
        LoopMode::Off => "off",
        LoopMode::Loop => "loop",
        LoopMode::PingPong => "ping-pong",
    }
}

const THEMES: [ThemePreference; 3] = [
    ThemePreference::System,
    ThemePreference::Light,
    ThemePreference::Dark,
];

fn theme_name(theme: ThemePreference) -> &'static str {
    match theme {
        ThemePreference::System => "system",
        ThemePreference::Light => "light",
        ThemePreference::Dark => "dark",
    }
}

/// The file of the preferences, and when it is to be written next.
#[derive(Debug, Clone, Default)]
pub struct PreferencesFile {
    file: Option<PathBuf>,
    /// What the window began with or was last written: nothing to do while it stays.
    settled: Option<Preferences>,
    /// What is written once it has stayed for a while, and since when it is so.
    changed: Option<(Preferences, Duration)>,
}

impl PreferencesFile {
    /// This person's file, and what is in it.
    pub fn load() -> (Self, Preferences) {
        kept::place_of("settings.json").map_or_else(Default::default, Self::load_from)
    }

    /// What is in `file`, which need not be there yet. A file that cannot be used is told of in the log.
    pub fn load_from(file: PathBuf) -> (Self, Preferences) {
        let preferences = read(&file).unwrap_or_else(|reason| {
            log::warn!(
                "the settings in {} cannot be used ({reason}): the window opens with its own",
                file.display()
            );
            Preferences::default()
        });
        let this = Self {
            file: Some(file),
            ..Self::default()
        };
        (this, preferences)
    }

    /// Notes how things are at `now`. What the first call is told is how the window began.
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

    /// Writes what was changed long enough before `now`.
    pub(super) fn write_if_due(&mut self, now: Duration) {
        if self.next_deadline().is_some_and(|due| due <= now) {
            self.write();
        }
    }

    /// Writes what was changed. A file that cannot be written is told of in the log.
    pub(super) fn write(&mut self) {
        let (Some(file), Some((preferences, _))) = (&self.file, self.changed.take()) else {
            return;
        };
        // Also after a failure: it would be the same each second.
        self.settled = Some(preferences);
        let written = preferences
            .to_json()
            .map_err(std::io::Error::other)
            .and_then(|bytes| kept::replace(file, &bytes));
        if let Err(reason) = written {
            log::warn!(
                "the settings could not be written to {} ({reason})",
                file.display()
            );
        }
    }
}

fn read(file: &Path) -> Result<Preferences, String> {
    match kept::read(file)? {
        Some(bytes) => Preferences::from_json(&bytes),
        None => Ok(Preferences::default()),
    }
}

#[cfg(test)]
mod tests;
