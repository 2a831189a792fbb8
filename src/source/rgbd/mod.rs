//! Recordings of depth images: folders as sensors, programs and data sets write them, and messages of ROS.
//!
//! A frame is an ordinary cloud, one point per pixel, in the frame of its camera. So all that works with clouds works
//! with them; [`DepthImages`](super::DepthImages) additionally gives cameras and pose. The files of a recording are
//! found once ([`layouts`]), by names and small text files. A decoder reads an image, filters it and gives its pixels
//! their colours ([`crate::rgbd`]).

mod calibration;
mod camera_info;
mod decoder;
mod depth_code;
mod depth_scale;
mod error;
mod folder;
mod frames_before;
mod joined;
mod kinect;
mod layouts;
mod member_image;
mod merged;
mod moving_frames;
mod options;
mod pairs;
mod pose_file;
mod pose_json;
mod pose_table;
mod probe;
mod received;
mod record3d;
mod recorder;
mod recorders;
mod recording;
mod sizes;
mod stored_image;
mod text;
mod topics;
mod trajectory;

pub use error::RgbdError;
pub(super) use frames_before::{FramesBefore, GROUP_FRAMES};
pub use merged::MergedFrames;
pub(super) use options::INVERT_POSES;
pub use options::RgbdOptions;
pub(super) use pose_file::read_pose;
pub(super) use received::ReceivedFrames;
pub(super) use recorders::extensions;
pub use recording::RgbdRecording;
pub(super) use text::{number_lines, read as read_text};
pub(super) use trajectory::{Trajectory, last_number, matrix, rigid};

use super::{OpenOptions, SequenceError, Source};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Returns true if the folder contains a depth image recording, by names alone: lists and poses are not read.
pub(super) fn is_likely(folder: &Path) -> bool {
    folder::Folder::read(folder).is_ok_and(|folder| layouts::is_likely(&folder))
}

/// Returns true if `inputs` are one folder whose depth images take precedence over the posed images of its
/// `transforms.json`.
pub(super) fn comes_before_photos(inputs: &[PathBuf], options: &OpenOptions) -> bool {
    match inputs {
        [folder] if folder.is_dir() && !options.dense => {
            folder::Folder::read(folder).is_ok_and(|folder| layouts::has_depths_sidecar_transforms(&folder))
        }
        _ => false,
    }
}

/// The recording that `inputs` are; `None` for inputs of another kind.
///
/// # Errors
/// [`SequenceError::Rgbd`], once it is identified as a recording.
pub(super) fn open(inputs: &[PathBuf], options: &OpenOptions) -> Result<Option<Arc<dyn Source>>, SequenceError> {
    let found = RgbdRecording::open(inputs, options).map_err(|error| SequenceError::Rgbd(Box::new(error)))?;
    let Some(recording) = found else {
        return match options.rgbd.merge {
            Some(range) => Err(SequenceError::Rgbd(Box::new(RgbdError::NotMerged {
                first: range.0,
                last: range.1,
                reason: "the input is not a recording of depth images, so their poses are unknown".to_owned(),
            }))),
            None => Ok(None),
        };
    };
    match options.rgbd.merge {
        None => Ok(Some(Arc::new(recording))),
        Some((first, last)) => {
            let merged =
                MergedFrames::of(recording, first, last).map_err(|error| SequenceError::Rgbd(Box::new(error)))?;
            Ok(Some(Arc::new(merged)))
        }
    }
}
