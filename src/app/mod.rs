//! The window: a player for sequences, on winit and egui.
//!
//! **How it works.** [`State`] is plain data and knows neither a window nor a GPU: the open sequence with its playhead
//! ([`crate::playback::Player`]), camera, settings, notices and what panels are open. Panels (`fn timeline_ui(ui, &mut
//! State)`) read and change it; keys become [`Command`]s through one table that the help window shows as well.
//! `State::update` moves the playhead and says whether something can be seen to have changed. Only then does the window
//! run the panels and, if the [`crate::scene::ScenePacket`] differs from the last one, draw a new 3-D picture into a
//! texture that the central panel shows. Whatever takes long (dialogs, finding files, writing images, benchmarks) runs
//! on a named thread and comes back as an [`Outcome`] through a bounded channel.
//!
//! **Idle.** The event loop sleeps until an event, a loader's or task's wake, or the clock's next deadline. A paused,
//! untouched window has none of these: it draws nothing, traverses nothing, uploads nothing. [`Counters`] prove it.

mod benchmark;
mod beside;
mod camera_path;
mod command;
mod comparison;
mod drawing;
mod export;
mod fly;
mod focus;
mod grip;
mod history;
mod in_view;
mod inspection;
mod levels;
mod measuring;
mod meter;
mod motion;
mod notices;
mod pacing;
pub mod paint;
mod palette;
pub mod panels;
mod preferences;
mod present;
mod present_choice;
mod presets;
mod progress;
mod recent;
mod state;
mod tasks;
mod temporal;
mod theme;
mod thumbnails;
mod timeline;
mod trails;
mod trial;
mod window;

pub use benchmark::{Benchmark, BenchmarkJob, BenchmarkTable};
pub use beside::{Beside, FrameDistances, Layout, OneWay};
pub use camera_path::{Draft, PathEditor};
pub use command::{BINDINGS, Binding, Chord, Command, GESTURES};
pub use comparison::{Comparison, PictureDifference, PicturePair, Side};
pub use export::{Export, Exported, Subject};
pub use fly::Fly;
pub use history::{Edited, History};
pub use inspection::{Anchor, Inspected, Inspection, Tool};
pub use measuring::{Gauge, Measurement};
pub use motion::Turntable;
pub use notices::{Notice, Notices, Severity};
pub use palette::Palette;
pub use panels::QualityLimits;
pub use preferences::{Preferences, PreferencesFile};
pub use present_choice::PresentChoice;
pub use presets::{Preset, Presets};
pub use progress::{Progress, Work, WorkKind, Works};
pub use recent::Recent;
pub use state::{
    Change, Counters, GraphicsInfo, OpenPanels, State, StateOptions, Viewport, WindowRequest,
};
pub use tasks::{DialogKind, Outcome, ReportFormat, Tasks, Wake};
pub use temporal::{ChangeMap, Made, OnionSkin, Temporal};
pub use theme::apply_theme;
pub use thumbnails::{Delivery, Thumbnails};
pub use timeline::{Marker, Markers, Quantity, Timeline};
pub use trails::{Traced, TrailField, Trails};
pub use window::{AppError, Options, bench_window, run};
