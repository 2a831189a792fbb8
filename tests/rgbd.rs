//! Recordings of depth images: every layout, real ones, broken ones.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "rgbd/broken.rs"]
mod broken;
#[path = "common/data.rs"]
mod data;
#[path = "rgbd/kinect.rs"]
mod kinect;
#[path = "rgbd/layouts.rs"]
mod layouts;
#[path = "rgbd/matroska.rs"]
mod matroska;
#[path = "rgbd/messages.rs"]
mod messages;
#[path = "rgbd/real.rs"]
mod real;
#[path = "rgbd/recording.rs"]
mod recording;
#[path = "rgbd/ros.rs"]
mod ros;
#[path = "rgbd/streams.rs"]
mod streams;
#[path = "rgbd/temporal.rs"]
mod temporal;

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
