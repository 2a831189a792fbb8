//! How programs and data sets lay recordings of depth images out in folders: a row each.
//!
//! A layout looks at names, and reads what is small: lists, poses, cameras. To add one: a file with its [`Layout`], and
//! a row of the table.

mod icl;
mod nyu;
mod open3d;
mod pattern;
mod pcl;
mod seven_scenes;
mod sun;
mod tum;

pub(super) use pattern::by_pattern;

use super::calibration::Calibration;
use super::depth_code::DepthCode;
use super::error::RgbdError;
use super::folder::{Folder, name_of};
use super::pairs::Pairs;
use super::trajectory::Trajectory;
use crate::io::timestamps::times_of_names;
use glam::DAffine3;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// A way to lay recordings out.
pub(super) struct Layout {
    /// Its name, for people.
    pub(super) name: &'static str,
    /// The recording in a folder; `None` if the folder is laid out in another way.
    find: fn(&Folder) -> Result<Option<Found>, RgbdError>,
}

/// Those that are told by more come first.
const TABLE: &[Layout] = &[
    tum::LAYOUT,
    seven_scenes::LAYOUT,
    icl::LAYOUT,
    pcl::LAYOUT,
    nyu::LAYOUT,
    sun::LAYOUT,
    open3d::LAYOUT,
];

/// The recording in `folder`; `None` if it is laid out in no way of the table.
pub(super) fn find(folder: &Folder) -> Result<Option<(&'static str, Found)>, RgbdError> {
    for layout in TABLE {
        if let Some(found) = (layout.find)(folder)? {
            return Ok(Some((layout.name, found)));
        }
    }
    Ok(None)
}

/// A recording as its folder tells it.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) frames: Vec<FrameFiles>,
    pub(super) code: DepthCode,
    /// What is left out, a sentence each.
    pub(super) notes: Vec<String>,
}

/// Files of a frame, and what is known of it.
#[derive(Debug, Clone)]
pub(super) struct FrameFiles {
    pub(super) depth: PathBuf,
    pub(super) color: Option<PathBuf>,
    pub(super) time: Option<Duration>,
    pub(super) world_from_camera: Option<DAffine3>,
    pub(super) calibration: Arc<Calibration>,
}

impl Found {
    /// Frames of these depth images, with times if their names tell some.
    fn of_pairs(depths: Vec<PathBuf>, pairs: Pairs, calibration: Calibration, code: DepthCode) -> Self {
        let names: Vec<&str> = depths.iter().map(|path| name_of(path)).collect();
        let times = times_of_names(&names);
        let calibration = Arc::new(calibration);
        let frames = depths.into_iter().zip(pairs.colors).zip(times);
        Self {
            frames: frames
                .map(|((depth, color), time)| FrameFiles {
                    depth,
                    color,
                    time,
                    world_from_camera: None,
                    calibration: Arc::clone(&calibration),
                })
                .collect(),
            code,
            notes: pairs.notes,
        }
    }

    /// Gives the frames the poses of `trajectory`.
    pub(super) fn take_poses(&mut self, trajectory: &Trajectory) {
        for (index, frame) in self.frames.iter_mut().enumerate() {
            frame.world_from_camera = trajectory.pose(index, frame.time);
        }
    }
}
