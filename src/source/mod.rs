//! Frame sources: files and recordings, depth images, posed images, sequence files, shapes with a formula, the demo,
//! streams that cannot be rewound.
//!
//! A [`Source`] knows its frames and the facts about each that need no reading; a [`Decoder`], one for each thread that
//! reads, makes point clouds of them. A sequence gives the frames of any source an origin, a pace and a place in
//! memory.
//!
//! To add a source: a type that implements [`Source`] and its [`Decoder`], and the place where a person names it: a
//! file format in [`crate::io`], or a row of the table here with its scheme, its word or how its files are recognised.

mod as_reel;
mod demo;
mod entry;
mod error;
mod examples;
mod files;
mod http;
mod list;
mod live;
mod multiview_video;
mod opener;
mod options;
mod photo_sets;
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
pub use demo::{DEMO_INPUT, demo};
pub use entry::{FrameBytes, FrameEntry};
pub use error::{OpeningChoice, SequenceError};
pub use examples::Example;
pub use files::{Files, Recording};
pub use list::FrameList;
pub use live::{
    ConnectionChange, ConnectionWatch, Live, LiveState, LiveStatus, LiveStream, RecordedStream, StreamRecording,
};
pub use multiview_video::MultiviewVideo;
pub use options::{NO_POSES, OpenOptions, SessionReach};
pub use photos::PhotoScene;
pub use reel::Reel;
pub use rgbd::{MergedFrames, RgbdError, RgbdOptions, RgbdRecording};
pub use scanner::LiveScanner;
pub use shapes::Shape;
pub(crate) use shapes::{OUTLIERS, Sampled};
pub use spin::Spin;
pub use traits::{
    About, Capabilities, DecodeFailure, DecodedFrame, DecodedLevel, Decoder, DepthImages, FrameSample, Groups, Growth,
    HasPosedImages, ImageFiles, Meshes, Samples, Source,
};

use crate::progress::Progress;
use opener::{Asked, Opener};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Table of openers, in order of precedence: the first that matches the inputs is used.
const OPENERS: &[Opener] = &[
    Opener::Made(&demo::DEMO),
    Opener::Made(&examples::EXAMPLES),
    Opener::Made(&shapes::SHAPES),
    Opener::Made(&spin::SPIN),
    Opener::One(&standard_input::STANDARD_INPUT),
    Opener::One(&scanner::ADDRESS),
    Opener::One(&live::ADDRESS),
    Opener::One(&live::RECORDING),
    Opener::One(&reel::FILE_OR_ADDRESS),
    Opener::Any(photo_sets::open_unless_depth),
    Opener::Any(|asked| rgbd::open(asked.inputs, asked.options)),
    Opener::Any(photo_sets::open_one_below),
    // Everything else.
    Opener::Any(|asked| {
        Ok(Some(Arc::new(Files::open(
            asked.inputs,
            asked.options,
            asked.progress,
        )?)))
    }),
];

/// Opens the source named by `inputs`: generated frames (`demo:`), standard input (`-`), a sensor ([`LiveScanner`]), a
/// stream ([`LiveStream`]) or a recording of one ([`RecordedStream`]), a sequence file ([`Reel`]), calibrated images of
/// one time step ([`PhotoScene`]) or of many ([`MultiviewVideo`]), a recording of depth images ([`RgbdRecording`]),
/// otherwise files, folders and patterns. `progress` counts the files that were checked, and may be cancelled.
pub fn open(inputs: &[PathBuf], options: &OpenOptions, progress: &Progress) -> Result<Arc<dyn Source>, SequenceError> {
    let asked = Asked {
        openers: OPENERS,
        inputs,
        options,
        progress,
    };
    asked.open()
}

/// Returns true if `input` is a keyword for a source that is neither a file nor an address, such as `demo:`.
pub fn is_word(input: &Path) -> bool {
    OPENERS.iter().any(|opener| opener.has_word(input))
}

/// Returns true if `input` is an address, of any scheme: an address that no source supports is not a file either.
pub fn is_address(input: &str) -> bool {
    input.contains("://")
}

/// Extensions of the files that can be opened, without dot, in lower case.
pub fn supported_extensions() -> impl Iterator<Item = &'static str> {
    let own = OPENERS.iter().flat_map(Opener::extensions);
    crate::io::supported_extensions().chain(rgbd::extensions()).chain(own)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn opened(input: &str) -> Result<Arc<dyn Source>, String> {
        let opened = open(&[input.into()], &OpenOptions::default(), &Progress::default());
        opened.map_err(|error| error.to_string())
    }

    #[test]
    fn words_before_a_colon_select_sources() {
        for (input, first) in [
            ("demo:", "demo/frame_0000.ply"),
            ("example:lidar", "example:lidar"),
            ("sphere:", "shape/sphere"),
            ("sphere:12", "shape/sphere"),
            ("spin:torus", "spin:torus:100000"),
            ("spin:torus:5000", "spin:torus:5000"),
        ] {
            assert!(is_word(Path::new(input)), "{input}");
            assert_eq!(opened(input).unwrap().entry(0).path, Path::new(first));
        }
        assert!(is_word(Path::new("-")));
        for file in [
            "scan.ply",
            "C:\\scans",
            "a:b",
            "sphere",
            "spin",
            "",
            "tcp://:1",
            "http://a/b.reel",
        ] {
            assert!(!is_word(Path::new(file)), "{file}");
        }
    }

    #[test]
    fn errors_after_the_colon_are_reported() {
        for wrong in [
            "sphere:0",
            "sphere:many",
            "torus:50000001",
            "spin:",
            "spin:dodo:10",
            "spin:torus:-1",
            "demo:1",
            "example:",
            "example:dodo",
        ] {
            let said = "is nothing that can be made: name demo:, an example (lidar, depth, model), such as \
                        example:lidar, a shape (sphere, torus, cube, saddle) and 1 to 50000000 points, such as \
                        torus:100000, or a turning one, spin:torus:100000";
            assert_eq!(opened(wrong).err(), Some(format!("{wrong} {said}")));
        }
    }
}
