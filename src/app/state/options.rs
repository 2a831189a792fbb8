//! Startup options of the window.

use crate::app::preferences::Preferences;
use crate::app::presets::Presets;
use crate::app::reading_choices::ReadingChoices;
use crate::app::recent::Recent;
use crate::app::work::tasks::Wake;
use crate::document::DocumentFolder;
use crate::scene::{Camera, Settings, UpAxis};
use crate::sequence::OpenOptions;
use std::fmt;
use std::sync::Arc;

/// Settings that override a document's.
#[derive(Clone)]
pub struct GivenStyle(Arc<dyn Fn(Settings) -> Settings + Send + Sync>);

impl GivenStyle {
    /// Creates the settings override applied by `over`.
    pub fn new(over: impl Fn(Settings) -> Settings + Send + Sync + 'static) -> Self {
        Self(Arc::new(over))
    }

    /// `style`, except for the given settings.
    #[must_use]
    pub fn over(&self, style: Settings) -> Settings {
        (self.0)(style)
    }
}

impl fmt::Debug for GivenStyle {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_tuple("GivenStyle")
            .field(&self.over(Settings::default()))
            .finish()
    }
}

/// Nothing is given.
impl Default for GivenStyle {
    fn default() -> Self {
        Self::new(|style| style)
    }
}

/// Initial options of a [`super::State`].
#[derive(Clone)]
pub struct StateOptions {
    /// Preferences from previous runs.
    pub preferences: Preferences,
    /// Up axis; guessed for each sequence if `None`.
    pub up: Option<UpAxis>,
    /// Settings given for this run: they override documents, and are not stored.
    pub given: GivenStyle,
    /// Initial camera of the first sequence, instead of a view that shows all of it.
    pub view: Option<Camera>,
    /// Options for opening inputs.
    pub open: OpenOptions,
    /// Show the newest frame of a folder as it comes.
    pub follow: bool,
    /// Do not start playing.
    pub paused: bool,
    /// Frame to show first, of the first sequence.
    pub frame: Option<usize>,
    /// Memory for prepared frames; the loader's default if `None`.
    pub budget_bytes: Option<usize>,
    /// Recently opened inputs.
    pub recent: Recent,
    /// Options of reading that were chosen for inputs before.
    pub reading_choices: ReadingChoices,
    /// Settings under names.
    pub presets: Presets,
    /// The folder where documents are stored; they are not if `None`.
    pub documents: Option<DocumentFolder>,
    /// The first document begins from defaults, whatever is stored of its sequence.
    pub is_fresh: bool,
    /// Wakes the window from another thread.
    pub wake: Wake,
}

impl Default for StateOptions {
    fn default() -> Self {
        Self {
            preferences: Preferences::default(),
            up: None,
            given: GivenStyle::default(),
            view: None,
            open: OpenOptions::default(),
            follow: false,
            paused: false,
            frame: None,
            budget_bytes: None,
            recent: Recent::default(),
            reading_choices: ReadingChoices::default(),
            presets: Presets::default(),
            documents: None,
            is_fresh: false,
            wake: Arc::new(|| {}),
        }
    }
}

impl fmt::Debug for StateOptions {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("StateOptions")
            .field("preferences", &self.preferences)
            .field("paused", &self.paused)
            .finish_non_exhaustive()
    }
}
