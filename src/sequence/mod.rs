//! A sequence of point clouds through time: finding its files, preparing its frames ahead of the playhead, playing it.
//!
//! [`Sequence::discover`] orders files without reading them. [`crate::timeline::Clock`] determines the frame that is
//! due. A [`Loader`] decodes and prepares frames on worker threads in the order in which the clock will request them,
//! and caches as many as a byte budget allows:
//!
//! ```no_run
//! use pointreel::sequence::{Loader, LoaderOptions, Needs, Sequence};
//! use pointreel::timeline::Direction;
//! use std::sync::Arc;
//!
//! let sequence = Arc::new(Sequence::discover(&["scans/".into()])?);
//! let loader = Loader::new(sequence, LoaderOptions::default())?;
//! let needs = Needs::default();
//! loader.request(0, Direction::Forward, &needs);   // never blocks; frames 0, 1, 2 … are on their way
//! let frame = loader.wait(0, &needs)?;             // without a window; a window polls `Loader::get`
//! println!("{} points", frame.points.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod coloring;
mod detail;
mod effort;
mod error;
mod frames;
mod gaps;
mod loader;
mod needs;
mod prepare;
mod records;
mod scaled;
mod space;
mod stamps;
mod watch;

pub use crate::natural::natural_order;
pub use crate::source::{DecodeFailure, FrameEntry, OpenOptions, Recording, SequenceError, Shape};
pub use coloring::{
    ColorHints, ColorRange, ColorSource, Coloring, DistanceFrom, FieldName, HeightAxis, Paint, PaintValues,
    ParseColoringError, UNIFORM_COLOR, plain_field_name, value_kind,
};
pub use detail::Detail;
pub use error::FrameError;
pub use frames::Sequence;
pub use gaps::{NumberGap, number_gaps};
#[cfg(test)]
pub(crate) use loader::simulation;
pub use loader::{FrameFacts, FrameState, Loader, LoaderOptions, LoaderStats, Reading, ReadingStage, Slot};
pub use needs::Needs;
pub use prepare::{PrepareCounters, PreparedFrame, PreparedMesh, Timings, complete, prepare, prepare_part};
pub use scaled::NO_VALUE_COLOR;
pub use watch::watch;

// The loader hands sequences and frames to worker threads.
const _: fn() = || {
    fn shared<T: Send + Sync>() {}
    shared::<std::sync::Arc<Sequence>>();
    shared::<PreparedFrame>();
    shared::<FrameError>();
};
