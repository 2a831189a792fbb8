//! How the window begins.

use crate::app::preferences::Preferences;
use crate::app::presets::Presets;
use crate::app::reading_choices::ReadingChoices;
use crate::app::recent::Recent;
use crate::app::work::tasks::Wake;
use crate::scene::{Camera, Choice, Primitive, UpAxis};
use crate::sequence::OpenOptions;
use std::path::PathBuf;
use std::sync::Arc;

/// How a [`super::State`] begins.
#[derive(Clone)]
pub struct StateOptions {
    /// What was chosen before.
    pub preferences: Preferences,
    /// Which axis is up; guessed for each sequence if `None`.
    pub up: Option<UpAxis>,
    /// What the first sequence is drawn as, whatever was kept with it.
    pub primitive: Option<Choice<Primitive>>,
    /// Where the first sequence is seen from, in place of a view that shows all of it.
    pub view: Option<Camera>,
    /// How inputs are opened.
    pub open: OpenOptions,
    /// Show the newest frame of a folder as it comes.
    pub follow: bool,
    /// Do not play what is opened.
    pub paused: bool,
    /// Memory for prepared frames; the loader's default if `None`.
    pub budget_bytes: Option<usize>,
    /// What was opened lately.
    pub recent: Recent,
    /// Options of reading that were chosen for inputs before.
    pub reading_choices: ReadingChoices,
    /// Settings under names.
    pub presets: Presets,
    /// The folder where range and markers of each sequence are kept; they are not if `None`.
    pub timelines: Option<PathBuf>,
    /// Wakes the window from another thread.
    pub wake: Wake,
}

impl Default for StateOptions {
    fn default() -> Self {
        Self {
            preferences: Preferences::default(),
            up: None,
            primitive: None,
            view: None,
            open: OpenOptions::default(),
            follow: false,
            paused: false,
            budget_bytes: None,
            recent: Recent::default(),
            reading_choices: ReadingChoices::default(),
            presets: Presets::default(),
            timelines: None,
            wake: Arc::new(|| {}),
        }
    }
}

impl std::fmt::Debug for StateOptions {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("StateOptions")
            .field("preferences", &self.preferences)
            .field("paused", &self.paused)
            .finish_non_exhaustive()
    }
}
