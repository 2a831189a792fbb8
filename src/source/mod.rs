//! Where frames come from: files and recordings, depth images, photographs, sequence files, shapes with a formula, the
//! demo, streams that nobody can rewind.
//!
//! A [`Source`] knows which frames there are and what can be said of each without reading it; a [`Decoder`], one for
//! each thread that reads, makes point clouds of them. A sequence gives the frames of any source an origin, a pace and
//! a place in memory.
//!
//! To add a source: a type that implements [`Source`] and its [`Decoder`], and where a person names it: a file format
//! in [`crate::io`], a word of [`Generated`], or a row of the table here.

mod as_reel;
mod demo;
mod entry;
mod error;
mod examples;
mod files;
mod generated;
mod http;
mod list;
mod live;
mod opener;
mod options;
mod photo_sets;
mod photo_video;
mod photos;
mod questions;
mod reel;
mod rgbd;
mod scanner;
mod shapes;
mod spin;
mod standard_input;
mod traits;

pub use as_reel::AsReel;
pub use demo::demo;
pub use entry::{FrameBytes, FrameEntry};
pub use error::{OpeningChoice, SequenceError};
pub use examples::Example;
pub use files::{Files, Recording};
pub use generated::Generated;
pub use list::FrameList;
pub use live::{
    ConnectionChange, ConnectionWatch, Live, LiveState, LiveStatus, LiveStream, RecordedStream, StreamRecording,
};
pub use options::{NO_POSES, OpenOptions, SessionReach};
pub use photo_video::PhotoVideo;
pub use photos::PhotoScene;
pub use reel::Reel;
pub use rgbd::{MergedFrames, RgbdError, RgbdOptions, RgbdRecording};
pub use scanner::LiveScanner;
pub use shapes::Shape;
pub(crate) use shapes::{OUTLIERS, Sampled};
pub use spin::Spin;
pub use traits::{
    About, Capabilities, DecodeFailure, DecodedFrame, DecodedLevel, Decoder, DepthImages, FrameSample, Groups, Growth,
    ImageFiles, Meshes, Photographed, Samples, Source,
};

use crate::progress::Progress;
use opener::{Asked, Opener};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What can be opened, the first that the inputs are.
const OPENERS: &[Opener] = &[
    Opener::One(&generated::WORDS),
    Opener::One(&standard_input::STANDARD_INPUT),
    Opener::One(&scanner::ADDRESS),
    Opener::One(&live::ADDRESS),
    Opener::One(&live::RECORDING),
    Opener::One(&reel::FILE_OR_ADDRESS),
    Opener::Any(photo_sets::open_unless_depth),
    Opener::Any(|asked| rgbd::open(asked.inputs, asked.options)),
    Opener::Any(photo_sets::open_one_below),
    // Whatever nothing else is.
    Opener::Any(|asked| {
        Ok(Some(Arc::new(Files::open(
            asked.inputs,
            asked.options,
            asked.progress,
        )?)))
    }),
];

/// The source that `inputs` name: one that is [`Generated`], standard input (`-`), a sensor ([`LiveScanner`]), a stream
/// ([`LiveStream`]) or what was recorded of one ([`RecordedStream`]), a sequence file ([`Reel`]), calibrated
/// photographs of one moment ([`PhotoScene`]) or of many ([`PhotoVideo`]), a recording of depth images
/// ([`RgbdRecording`]), else files, folders and patterns. `progress` counts the files that were looked at, and may be
/// cancelled.
pub fn open(inputs: &[PathBuf], options: &OpenOptions, progress: &Progress) -> Result<Arc<dyn Source>, SequenceError> {
    let asked = Asked {
        openers: OPENERS,
        inputs,
        options,
        progress,
    };
    asked.open()
}

/// Whether `input` is a word for a source that is neither a file nor an address, such as `demo:`.
pub fn is_word(input: &Path) -> bool {
    OPENERS.iter().any(|opener| opener.has_word(input))
}
