//! What a layout finds in a folder.

use crate::io::timestamps::times_of_names;
use crate::source::rgbd::calibration::Calibration;
use crate::source::rgbd::depth_code::DepthCode;
use crate::source::rgbd::error::RgbdError;
use crate::source::rgbd::folder::{Folder, name_of};
use crate::source::rgbd::pairs::Pairs;
use crate::source::rgbd::stored_image::StoredImage;
use crate::source::rgbd::trajectory::Trajectory;
use glam::DAffine3;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// A way to lay recordings out.
pub(in crate::source::rgbd) struct Layout {
    /// Its name, for people.
    pub(in crate::source::rgbd) name: &'static str,
    /// The recording in a folder; `None` if the folder is laid out in another way.
    pub(super) find: fn(&Folder) -> Result<Option<FoundRecording>, RgbdError>,
}

/// A recording as its folder or file tells it.
#[derive(Debug)]
pub(in crate::source::rgbd) struct FoundRecording {
    pub(in crate::source::rgbd) frames: Vec<FrameImages>,
    pub(in crate::source::rgbd) code: DepthCode,
    /// What is left out, a sentence each.
    pub(in crate::source::rgbd) notes: Vec<String>,
}

/// Images of a frame, and what is known of it.
#[derive(Debug, Clone)]
pub(in crate::source::rgbd) struct FrameImages {
    pub(in crate::source::rgbd) depth: StoredImage,
    pub(in crate::source::rgbd) color: Option<StoredImage>,
    pub(in crate::source::rgbd) time: Option<Duration>,
    pub(in crate::source::rgbd) world_from_camera: Option<DAffine3>,
    pub(in crate::source::rgbd) calibration: Arc<Calibration>,
}

impl FoundRecording {
    /// Frames of these depth images, with times if their names tell some.
    pub(super) fn of_pairs(depths: Vec<PathBuf>, pairs: Pairs, calibration: Calibration, code: DepthCode) -> Self {
        let names: Vec<&str> = depths.iter().map(|path| name_of(path)).collect();
        let times = times_of_names(&names);
        let calibration = Arc::new(calibration);
        let frames = depths.into_iter().zip(pairs.colors).zip(times);
        Self {
            frames: frames
                .map(|((depth, color), time)| FrameImages {
                    depth: depth.into(),
                    color: color.map(StoredImage::from),
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
    pub(in crate::source::rgbd) fn take_poses(&mut self, trajectory: &Trajectory) {
        for (index, frame) in self.frames.iter_mut().enumerate() {
            frame.world_from_camera = trajectory.pose(index, frame.time);
        }
    }
}
