//! Camera section of `info`: the cameras that captured a sequence, and their poses.

use crate::rgbd::{Camera, Rig};
use crate::sequence::Sequence;
use glam::{DAffine3, DMat4};
use serde::Serialize;
use std::sync::Arc;

/// Cameras of one sensor and the frames that they took. As the value of `--intrinsics`, a file with it tells the same
/// cameras.
#[derive(Serialize)]
pub(in crate::cli) struct CameraInfo {
    depth: Intrinsics,
    /// Null where colours are aligned with the depth image pixel by pixel.
    color: Option<ColorIntrinsics>,
    poses: Vec<PoseInfo>,
}

/// Intrinsics of one camera, pixels; centres of pixels are at integers.
#[derive(Serialize)]
pub(super) struct Intrinsics {
    width: u32,
    height: u32,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    distortion: DistortionInfo,
}

#[derive(Serialize)]
struct DistortionInfo {
    model: &'static str,
    /// In the order of OpenCV.
    coefficients: Vec<f64>,
}

#[derive(Serialize)]
struct ColorIntrinsics {
    #[serde(flatten)]
    intrinsics: Intrinsics,
    /// Row by row.
    color_from_depth: [f64; 16],
}

#[derive(Serialize)]
struct PoseInfo {
    frame: usize,
    /// Row by row; null where nothing says it.
    world_from_camera: Option<[f64; 16]>,
}

impl CameraInfo {
    /// Returns the cameras of all frames, in the order of the first frame of each.
    pub(in crate::cli) fn of(sequence: &Sequence) -> Vec<Self> {
        let mut rigs: Vec<(Arc<Rig>, Self)> = Vec::new();
        for frame in sequence.frames() {
            let Some(sensor) = sequence.source().sensor(frame) else {
                continue;
            };
            let pose = PoseInfo {
                frame,
                world_from_camera: sensor.world_from_camera.as_ref().map(rows),
            };
            if let Some((_, info)) = rigs.iter_mut().find(|(rig, _)| *rig == sensor.rig) {
                info.poses.push(pose);
            } else {
                let info = Self::of_rig(&sensor.rig, pose);
                rigs.push((sensor.rig, info));
            }
        }
        rigs.into_iter().map(|(_, info)| info).collect()
    }

    fn of_rig(rig: &Rig, pose: PoseInfo) -> Self {
        Self {
            depth: Intrinsics::of(&rig.depth),
            color: rig.color.as_ref().map(|color| ColorIntrinsics {
                intrinsics: Intrinsics::of(&color.camera),
                color_from_depth: rows(&color.color_from_depth),
            }),
            poses: vec![pose],
        }
    }

    /// For people.
    pub(in crate::cli) fn line(&self) -> String {
        let Intrinsics {
            width,
            height,
            fx,
            fy,
            cx,
            cy,
            distortion,
        } = &self.depth;
        let lens = match distortion.model {
            "none" => "without distortion".to_owned(),
            model => format!("distortion {model}"),
        };
        let color = if self.color.is_some() {
            ", colours of another camera"
        } else {
            ""
        };
        let posed = self
            .poses
            .iter()
            .filter(|pose| pose.world_from_camera.is_some())
            .count();
        format!(
            "depth camera {width} × {height}, f {fx:.3} {fy:.3}, centre {cx:.3} {cy:.3}, {lens}{color}; {posed} of {} \
             frames with a pose",
            self.poses.len()
        )
    }
}

impl Intrinsics {
    pub(in crate::cli) fn of(camera: &Camera) -> Self {
        let [width, height] = camera.size_px();
        let (focal, principal) = (camera.focal_px(), camera.principal_px());
        Self {
            width,
            height,
            fx: focal.x,
            fy: focal.y,
            cx: principal.x,
            cy: principal.y,
            distortion: DistortionInfo {
                model: camera.distortion().name(),
                coefficients: camera.distortion().coefficients(),
            },
        }
    }
}

/// A transform as 4 × 4 numbers, row by row.
pub(in crate::cli) fn rows(transform: &DAffine3) -> [f64; 16] {
    DMat4::from(*transform).transpose().to_cols_array()
}
