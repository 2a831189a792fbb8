//! Result of matching a layout against a folder.

use crate::assumption::{Assumption, Evidence, Subject};
use crate::io::files::timestamps::times_of_names;
use crate::source::rgbd::calibration::Calibration;
use crate::source::rgbd::depth_code::DepthCode;
use crate::source::rgbd::depth_scale::Units;
use crate::source::rgbd::error::RgbdError;
use crate::source::rgbd::folder::{Folder, has_extension, name_of};
use crate::source::rgbd::options::INVERT_POSES;
use crate::source::rgbd::pairs::{Pairs, by_name};
use crate::source::rgbd::pose_file::read_pose;
use crate::source::rgbd::stored_image::StoredImage;
use crate::source::rgbd::trajectory::{Trajectory, last_number};
use glam::DAffine3;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// A layout of recordings.
pub(in crate::source::rgbd) struct Layout {
    /// Its name, for people.
    pub(in crate::source::rgbd) name: &'static str,
    /// Predicate that returns true if a folder has the layout's names, before anything in it is read.
    pub(super) is_likely: fn(&Folder) -> bool,
    /// The recording in a folder; `None` if the folder has another layout.
    pub(super) find: fn(&Folder) -> Result<Option<FoundRecording>, RgbdError>,
}

impl Layout {
    /// A layout that names alone do not identify.
    pub(super) const fn new(
        name: &'static str,
        find: fn(&Folder) -> Result<Option<FoundRecording>, RgbdError>,
    ) -> Self {
        Self {
            name,
            is_likely: |_| false,
            find,
        }
    }
}

/// A recording as described by its folder or file.
#[derive(Debug)]
pub(in crate::source::rgbd) struct FoundRecording {
    pub(in crate::source::rgbd) frames: Vec<FrameImages>,
    pub(in crate::source::rgbd) code: DepthCode,
    /// Origin of the units of `code`.
    pub(in crate::source::rgbd) units: Units,
    pub(in crate::source::rgbd) assumptions: Vec<Assumption>,
    /// Notes on skipped parts, one sentence each.
    pub(in crate::source::rgbd) notes: Vec<String>,
    /// Descriptions of truncated or damaged files, one sentence each; not among the notes.
    pub(in crate::source::rgbd) damage: Vec<String>,
}

/// Images of a frame, and its known data.
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
        last_number(name.rsplit_once('.').map_or(name, |(stem, _)| stem))
    }

    /// The name of its depth image.
    fn name(&self) -> String {
        name_of(self.depth.path()).to_owned()
    }
}

impl FoundRecording {
    /// Frames of these depth images, with times if their names have some.
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
            damage: Vec::new(),
        }
    }

    /// Gives the frames the poses of `trajectory`.
    pub(in crate::source::rgbd) fn take_poses(&mut self, trajectory: &Trajectory) {
        let numbers: Vec<Option<usize>> = self.frames.iter().map(FrameImages::number).collect();
        let times: Vec<Option<Duration>> = self.frames.iter().map(|frame| frame.time).collect();
        let names: Vec<String> = self.frames.iter().map(FrameImages::name).collect();
        let poses = trajectory.poses_of(&times, &numbers, &names);
        let stamps = trajectory
            .stamps()
            .filter(|stamps| !stamps.is_empty() && stamps.len() == self.frames.len());
        if let Some(stamps) = stamps.filter(|_| times.iter().all(Option::is_none)) {
            let span = stamps[stamps.len() - 1].saturating_sub(stamps[0]).as_secs_f64();
            let value = format!("{span:.3} s for {} frames", stamps.len());
            let why = "the list of poses has a time for each frame";
            self.assumptions
                .push(Assumption::new(Subject::FrameTimes, value, why, Evidence::File));
            for (frame, time) in self.frames.iter_mut().zip(stamps) {
                frame.time = Some(time);
            }
        }
        for (frame, pose) in self.frames.iter_mut().zip(poses) {
            frame.world_from_camera = pose;
        }
    }

    /// Gives the frames the poses in the file at `path`. A file that is not a trajectory is reported and costs the
    /// poses, not the images. True if frames have poses by it.
    pub(super) fn take_trajectory(&mut self, path: &Path) -> bool {
        match Trajectory::read_and_tell(path) {
            Ok((trajectory, takes_order)) => {
                let is_inverse = names_inverse(name_of(path));
                let trajectory_len = trajectory.len();
                self.take_poses(&if is_inverse { trajectory.inverse() } else { trajectory });
                let mut count = self.pose_count();
                // One matrix for many images is the pose of another sensor.
                if count == 1 && self.frames.len() > 2 && trajectory_len == 1 {
                    self.frames.iter_mut().for_each(|frame| frame.world_from_camera = None);
                    count = 0;
                }
                if count == 0 {
                    self.notes.push(format!(
                        "{} has no pose for any of the {} frames: times have to be within 20 ms, numbers count from 0, \
                         names are those of the depth images",
                        path.display(),
                        self.frames.len()
                    ));
                } else {
                    let mut said = direction_of(name_of(path), name_of(path));
                    if takes_order {
                        said.why
                            .push_str("; no header says the order of its quaternions: qx qy qz qw, as most write them");
                    }
                    self.assumptions.push(said);
                }
                count > 0
            }
            Err(error) => {
                self.notes.push(format!("{error}. Its poses are ignored"));
                false
            }
        }
    }

    /// Gives each frame the pose in the file of its name. A file that is not a pose costs that one. `folder` contains
    /// the files.
    pub(super) fn take_pose_files(&mut self, folder: &str, files: &[PathBuf]) {
        let depths: Vec<PathBuf> = self.frames.iter().map(|frame| frame.depth.path().to_owned()).collect();
        let pairs = by_name(&depths, files);
        let is_inverse = names_inverse(folder);
        for (frame, file) in self.frames.iter_mut().zip(pairs.colors) {
            let Some(file) = file else { continue };
            match read_pose(&file) {
                Ok(pose) if is_inverse => frame.world_from_camera = pose.map(|pose| pose.inverse()),
                Ok(pose) => frame.world_from_camera = pose,
                Err(error) => self.notes.push(format!("{error}; its frame has no pose")),
            }
        }
        if self.pose_count() > 0 {
            self.assumptions
                .push(direction_of(folder, &format!("files in {folder}")));
        }
    }

    /// Frames with a pose.
    pub(in crate::source::rgbd) fn pose_count(&self) -> usize {
        self.frames
            .iter()
            .filter(|frame| frame.world_from_camera.is_some())
            .count()
    }
}

/// Returns true if a name indicates that poses map from the world to the camera.
fn names_inverse(name: &str) -> bool {
    const WORDS: [&str; 6] = [
        "extrinsic",
        "w2c",
        "world2cam",
        "world_to_cam",
        "worldtocam",
        "cam_from_world",
    ];
    let name = name.to_lowercase();
    WORDS.iter().any(|word| name.contains(word))
}

/// Returns the assumed direction of the poses in a file or folder called `name`.
fn direction_of(name: &str, place: &str) -> Assumption {
    const WORDS: [&str; 5] = ["c2w", "cam2world", "cam_to_world", "camtoworld", "groundtruth"];
    let lower = name.to_lowercase();
    let (value, why, evidence) = if names_inverse(name) {
        let why = format!("{place}: extrinsics lead from the world to the camera");
        ("world to camera", why, Evidence::Convention)
    } else if WORDS.iter().any(|word| lower.contains(word)) || has_extension(name, &["json", "log", "freiburg"]) {
        (
            "camera to world",
            format!("{place}: files of such names lead so"),
            Evidence::Convention,
        )
    } else {
        let why = format!("{place} does not say which way its poses lead, and most lead so");
        ("camera to world", why, Evidence::Fallback)
    };
    Assumption::new(Subject::Poses, value, why, evidence).with_option(Some(INVERT_POSES))
}
