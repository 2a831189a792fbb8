//! The window: a player for sequences, on winit and egui.
//!
//! **How it works.** [`State`] is plain data and knows neither a window nor a GPU: the open sequence with its playhead
//! ([`crate::playback::Player`]), camera, settings, notices, and its features (`features`). `State::update` moves the
//! playhead and reports visible changes. Only then does the window run the panels and, if the
//! [`crate::scene::ScenePacket`] differs from the last one, draw a new 3-D image into a texture that the central panel
//! shows.
//!
//! A feature is a folder and a row of one table (`features/table.rs`), which connects each to the window. Its panels
//! take the data that they draw and return requests; `in_window.rs` gives them their part of the state and executes the
//! requests. Keys, menus, the list of commands and scripts call one table of commands (`commands`). Long operations
//! (dialogs, finding files, writing images, benchmarks) run on named threads ([`Tasks`]); their results come back
//! through a bounded channel as an [`Outcome`], taken by the feature that knows its type.
//!
//! **Idle.** The event loop sleeps until an event, a loader's or task's wake, or the clock's next deadline. A paused,
//! untouched window has none of these: it draws nothing, traverses nothing, uploads nothing. [`Counters`] prove it.

mod appearance;
mod color_sources;
mod command;
mod commands;
mod drawing;
mod features;
mod first_look;
mod fly;
mod focus;
mod grip;
mod meter;
mod motion;
mod notices;
mod open_panels;
mod pacing;
pub mod paint;
mod panel_row;
pub mod panels;
mod preferences;
mod present;
mod present_choice;
mod presets;
mod reading_choices;
mod recent;
mod script;
mod sequence_name;
mod settings_row;
mod side;
mod state;
mod theme;
mod widgets;
mod window;
mod window_bench;
mod work;

pub use appearance::Appearance;
pub use command::{Chord, Command, CommandRow, GESTURES, Keys, Menu};
pub use commands::commands;
pub use features::Features;
pub use features::benchmark::{
    Benchmark, BenchmarkEnded, BenchmarkJob, BenchmarkSetup, BenchmarkTable, ReportFormat, SoFar,
};
pub use features::camera_path::{Draft, PathEditor, PathFile};
pub use features::clipping::Clipping;
pub use features::comparison::{Comparison, PictureDifference, PicturePair};
pub use features::export::{Export, ExportEnded, ExportSubject, Exported};
pub use features::inspection::measuring::Measurement;
pub use features::inspection::{Anchor, Inspected, Inspection, Tool};
pub use features::labels::Labels;
pub use features::notes::Notes;
pub use features::palette::Palette;
pub use features::quality::{MeasuredQuality, QualityLimits};
pub use features::save::{Estimated, Estimates, PrecisionKind, Save, SaveEnded, SaveFormat};
pub use features::split_view::{FrameDistances, Layout, OneWay, SplitView};
pub use features::temporal::{ChangeMap, ComposedFrame, OnionSkin, Temporal};
pub use features::thumbnails::{Delivery, Thumbnails};
pub use features::timeline::{Markers, Quantity, Timeline};
pub use features::trails::{Traced, TrailField, Trails};
pub use fly::Fly;
pub use motion::{CameraMotion, Turntable};
pub use notices::{Notice, Notices, Severity};
pub use open_panels::{OpenPanels, PanelId, RememberedPanels};
pub use preferences::{Preferences, PreferencesFile};
pub use present_choice::PresentChoice;
pub use presets::{Preset, Presets};
pub use reading_choices::{ReadingChoices, open_as_chosen};
pub use recent::Recent;
pub use script::{Script, ScriptError};
pub use side::Side;
pub use state::{
    Counters, FailedOpening, FoundSequence, GivenStyle, GraphicsInfo, OpeningFacts, SavedSession, SessionQuestion,
    Shared, State, StateOptions, Stored, Viewport, VisibleChange, WindowRequest,
};
pub use theme::apply_theme;
pub use window::{AppError, Options, bench_window, run};
pub use work::files::SavedFile;
pub use work::outcome::{Message, Outcome};
pub use work::tasks::{TaskFailed, TaskOutcome, Tasks, Wake};
pub use work::works::{Progress, Work, WorkKind, Works};
