//! What a layout finds in a folder.

use crate::assumption::Assumption;
use crate::io::timestamps::times_of_names;
use crate::source::rgbd::calibration::Calibration;
use crate::source::rgbd::depth_code::DepthCode;
use crate::source::rgbd::depth_scale::Units;
use crate::source::rgbd::error::RgbdError;
use crate::source::rgbd::folder::{Folder, name_of};
use crate::source::rgbd::pairs::{Pairs, by_name};
use crate::source::rgbd::stored_image::StoredImage;
use crate::source::rgbd::trajectory::{Trajectory, read_pose};
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
    /// How the units of `code` are known.
    pub(in crate::source::rgbd) units: Units,
    pub(in crate::source::rgbd) assumptions: Vec<Assumption>,
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

impl FrameImages {
    /// The last number in the name of its depth image.
    pub(super) fn number(&self) -> Option<usize> {
        let name = name_of(self.depth.path());
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        let digits = stem.rsplit(|c: char| !c.is_ascii_digit()).find(|run| !run.is_empty());
        digits?.parse().ok()
    }
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
            units: Units::Certain,
            assumptions: Vec::new(),
            notes: pairs.notes,
        }
    }

    /// Gives the frames the poses of `trajectory`.
    pub(in crate::source::rgbd) fn take_poses(&mut self, trajectory: &Trajectory) {
        let numbers: Vec<Option<usize>> = self.frames.iter().map(FrameImages::number).collect();
        let times: Vec<Option<Duration>> = self.frames.iter().map(|frame| frame.time).collect();
        let poses = trajectory.poses_of(&times, &numbers);
        for (frame, pose) in self.frames.iter_mut().zip(poses) {
            frame.world_from_camera = pose;
        }
    }

    /// Gives each frame the pose in the file of its name. A file that is no pose costs that one.
    pub(super) fn take_pose_files(&mut self, files: &[PathBuf]) {
        let depths: Vec<PathBuf> = self.frames.iter().map(|frame| frame.depth.path().to_owned()).collect();
        let pairs = by_name(&depths, files);
        for (frame, file) in self.frames.iter_mut().zip(pairs.colors) {
            let Some(file) = file else { continue };
            match read_pose(&file) {
                Ok(pose) => frame.world_from_camera = pose,
                Err(error) => self.notes.push(format!("{error}; its frame has no pose")),
            }
        }
    }
}
