//! Recordings of depth images: every layout, real ones, broken ones.

mod broken;
mod cameras;
mod filtered;
mod kinect;
mod layouts;
mod matroska;
mod meaning;
mod messages;
mod phones;
mod real;
mod recording;
mod rewritten;
mod ros;
mod streams;
mod temporal;

pub(crate) use recording::lzf;

use glam::DVec3;
use pointreel::cloud::RawCloud;
use pointreel::sequence::{OpenOptions, Sequence, SequenceError};
use pointreel::source::RgbdOptions;
use std::path::Path;

fn open_with(folder: &Path, rgbd: RgbdOptions) -> Result<Sequence, SequenceError> {
    let options = OpenOptions {
        rgbd,
        ..OpenOptions::default()
    };
    Sequence::open(&[folder.to_owned()], &options)
}

fn open(folder: &Path) -> Sequence {
    open_with(folder, RgbdOptions::default()).unwrap()
}

fn points(cloud: &RawCloud) -> Vec<DVec3> {
    (0..cloud.positions.len())
        .map(|index| cloud.positions.get(index))
        .collect()
}
