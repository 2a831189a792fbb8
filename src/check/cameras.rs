//! Two cameras in one sequence: images of another size, or another lens, from some frame on.
//!
//! A camera that focuses changes its focal length by a per cent or two from frame to frame; another camera, or another
//! mode of one, by more.

use super::{Finding, FindingKind, FrameFacts};
use crate::messages::{frame_by_index, grouped};
use crate::rgbd::Camera;
use crate::sequence::{FrameError, Sequence};

/// Share by which the focal length of one camera may change.
const FOCUS: f64 = 0.05;

/// Camera that captured a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Taken {
    image_px: [u32; 2],
    /// As a share of the width of the image.
    focal: f64,
}

/// The first frame that another camera took than the frames before it, with all others that it took.
pub(super) fn changed_camera(sequence: &Sequence, facts: &[Result<FrameFacts, FrameError>]) -> Option<Finding> {
    let taken: Vec<(usize, Taken)> = facts
        .iter()
        .enumerate()
        .filter_map(|(index, facts)| {
            let image_px = facts.as_ref().ok()?.image_px?;
            let sensor = sequence.source().sensor(index)?;
            Some((index, Taken::of(&sensor.rig.depth, image_px)))
        })
        .collect();
    let (first, usual) = *taken.first()?;
    let frames: Vec<(usize, Taken)> = taken
        .into_iter()
        .filter(|(_, taken)| taken.differs_from(usual))
        .collect();
    let (index, other) = *frames.first()?;
    Some(Finding {
        kind: FindingKind::ChangedCamera,
        severity: FindingKind::ChangedCamera.severity(),
        message: format!(
            "{} of {} frames were taken by another camera than {} ({}), from {} on ({}): open them as a sequence of \
             their own",
            grouped(frames.len()),
            grouped(facts.len()),
            frame_by_index(first),
            usual.words(),
            frame_by_index(index),
            other.words()
        ),
        frames: frames.into_iter().map(|(index, _)| index).collect(),
    })
}

impl Taken {
    fn of(camera: &Camera, image_px: [u32; 2]) -> Self {
        Self {
            image_px,
            focal: camera.focal_px().x / f64::from(camera.size_px()[0]),
        }
    }

    fn differs_from(self, other: Self) -> bool {
        self.image_px != other.image_px || (self.focal / other.focal - 1.0).abs() > FOCUS
    }

    fn words(self) -> String {
        let [width, height] = self.image_px;
        let focal_px = self.focal * f64::from(width);
        format!("{width} × {height} pixels, focal length {focal_px:.1} px")
    }
}
