//! Where frames come from: files and recordings, depth images, photographs, sequence files, shapes with a formula, the
//! demo, streams that nobody can rewind.
//!
//! A [`Source`] knows which frames there are and what can be said of each without reading it; a [`Decoder`], one for
//! each thread that reads, makes point clouds of them. A sequence gives the frames of any source an origin, a pace and
//! a place in memory.
//!
//! To add a source: a type that implements [`Source`] and its [`Decoder`], and where a person names it: a file format
//! in [`crate::io`], or a word of [`Generated`].

mod as_reel;
mod capabilities;
mod demo;
mod entry;
mod error;
mod examples;
mod files;
mod generated;
mod http;
mod list;
mod live;
mod options;
mod photo_sets;
mod photo_video;
mod photos;
mod reel;
mod rgbd;
mod scanner;
mod shapes;
mod spin;
mod traits;

pub use as_reel::AsReel;
pub use capabilities::{About, Capabilities, DepthImages, Groups, Growth, ImageFiles, Meshes, Photographed, Samples};
pub use demo::demo;
pub use entry::{FrameBytes, FrameEntry};
pub use error::{OpeningChoice, SequenceError};
pub use examples::Example;
pub use files::{Files, Recording};
pub use generated::Generated;
pub use list::FrameList;
use live::is_recording;
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
pub use traits::{DecodeFailure, DecodedFrame, DecodedLevel, Decoder, FrameSample, Source};

use crate::progress::Progress;
use std::path::PathBuf;
use std::sync::Arc;

/// The source that `inputs` name: one that is [`Generated`], a sensor ([`LiveScanner`]), a stream ([`LiveStream`]) or
/// what was recorded of one ([`RecordedStream`]), a sequence file ([`Reel`]), calibrated photographs of one moment
/// ([`PhotoScene`]) or of many ([`PhotoVideo`]), a recording of depth images ([`RgbdRecording`]), else files, folders
/// and patterns. `progress` counts the files that were looked at, and may be cancelled.
pub fn open(inputs: &[PathBuf], options: &OpenOptions, progress: &Progress) -> Result<Arc<dyn Source>, SequenceError> {
    if let [input] = inputs
        && let Some(generated) = Generated::of_name(input)?
    {
        return Ok(generated.source());
    }
    if let Some(scanner) = inputs.iter().find(|input| LiveScanner::is_one(input)) {
        return match inputs {
            [_] => Ok(Arc::new(LiveScanner::open(scanner, &options.read, progress)?)),
            _ => Err(SequenceError::Scanner {
                input: scanner.display().to_string(),
                problem: "a live sensor is a sequence of its own: open it without other inputs".to_owned(),
            }),
        };
    }
    if let Some(stream) = inputs.iter().find(|input| LiveStream::is_one(input)) {
        return match inputs {
            [_] => Ok(Arc::new(LiveStream::open(stream, options, progress)?)),
            _ => Err(SequenceError::Stream {
                input: stream.display().to_string(),
                problem: "a live stream is a sequence of its own: open it without other inputs".to_owned(),
            }),
        };
    }
    if let [input] = inputs
        && is_recording(input)
    {
        return Ok(Arc::new(RecordedStream::open(input, options)?));
    }
    if let Some(reel) = inputs.iter().find(|input| Reel::is_url(input) || Reel::is_one(input)) {
        return match inputs {
            [_] => Ok(Arc::new(Reel::open(reel, options)?)),
            _ => Err(SequenceError::NotAlone { path: reel.clone() }),
        };
    }
    if !rgbd::comes_before_photographs(inputs, options)
        && let Some(photographs) = photo_sets::open(inputs, options)?
    {
        return Ok(photographs);
    }
    if let Some(recording) = rgbd::open(inputs, options)? {
        return Ok(recording);
    }
    if let [input] = inputs
        && input.is_dir()
    {
        // Photographs in a folder of a recording of clouds are no reason to refuse it.
        match photo_sets::open_below(input, options) {
            Ok(Some(below)) => return Ok(below),
            Ok(None) => {}
            Err(error) => {
                return match Files::open(inputs, options, progress) {
                    // Lists of numbers next to images are no recording of clouds.
                    Ok(files) if !files.are_texts() => Ok(shared(files)),
                    Err(several @ SequenceError::Several { .. }) => Err(several),
                    _ => Err(error),
                };
            }
        }
    }
    Files::open(inputs, options, progress).map(shared)
}

fn shared(source: impl Source + 'static) -> Arc<dyn Source> {
    Arc::new(source)
}
