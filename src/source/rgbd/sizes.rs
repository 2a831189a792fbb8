//! Image sizes before decoding, and the size that each camera's intrinsics refer to.
//!
//! A camera file seldom states the size that its intrinsics refer to. The principal point does: it is near the image
//! centre, so that twice of it is about the size. It may be the size of the colour images, while depth images are
//! smaller; videos are not read, and there the size is a multiple of the depth images'.

use super::calibration::{Calibration, Intrinsics};
use super::layouts::FoundRecording;
use super::stored_image::StoredImage;
use crate::assumption::{Assumption, Evidence, Subject};
use crate::io::ReadOptions;
use glam::DAffine3;
use std::sync::Arc;

/// Twice a principal point is as near to the size of its image, as a share of that.
const NEAR: f64 = 0.25;

/// Sizes of the first images, as far as they can be read; failures are reported on decoding.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    pub(super) depth_px: Option<[u32; 2]>,
    pub(super) color_px: Option<[u32; 2]>,
}

impl Sizes {
    /// Unknown sizes, for images that have not arrived yet.
    pub(super) const UNKNOWN: Self = Self {
        depth_px: None,
        color_px: None,
    };

    /// Looks at the first images of `found`. Cameras that do not state their size get one.
    pub(super) fn learn(found: &mut FoundRecording, options: &ReadOptions) -> Self {
        let size_of = |image: &StoredImage| image.size_px(options);
        let first = Arc::clone(&found.frames[0].calibration);
        let color = found.frames.iter().find_map(|frame| frame.color.as_ref());
        let is_file = |image: &&StoredImage| matches!(image, StoredImage::File(_) | StoredImage::Member(_));
        let mut sizes = Self {
            // Text files do not state it.
            depth_px: size_of(&found.frames[0].depth).or(first.depth.for_size_px),
            color_px: color
                .filter(|color| first.color.is_some() || is_file(color))
                .and_then(size_of),
        };
        let mut learned: Vec<(Arc<Calibration>, Arc<Calibration>)> = Vec::new();
        for frame in &mut found.frames {
            // Frames of one camera are consecutive.
            let known = learned
                .iter()
                .rev()
                .take(8)
                .find(|(before, _)| Arc::ptr_eq(before, &frame.calibration));
            let after = if let Some((_, after)) = known {
                Arc::clone(after)
            } else {
                let after = Arc::new(sizes.completed(&frame.calibration));
                learned.push((Arc::clone(&frame.calibration), Arc::clone(&after)));
                after
            };
            frame.calibration = after;
        }
        let after = &found.frames[0].calibration;
        if first.depth.for_size_px.is_none() && after.depth.for_size_px != sizes.depth_px {
            found
                .assumptions
                .extend(after.depth.for_size_px.map(assumption_of_size));
        }
        if after.color.is_none() {
            sizes.color_px = None;
        }
        sizes
    }

    /// `calibration` with the sizes that it is for, and a camera of colours where those are another size of the same.
    fn completed(self, calibration: &Calibration) -> Calibration {
        let mut completed = calibration.clone();
        let depth = &mut completed.depth;
        depth.for_size_px = depth.for_size_px.or_else(|| self.size_of(depth));
        if let Some((color, _)) = &mut completed.color {
            color.for_size_px = color.for_size_px.or(self.color_px);
        } else if let (Some(depth_px), Some(color_px)) = (self.depth_px, self.color_px)
            && depth_px != color_px
            && is_scaled(depth_px, color_px)
        {
            completed.color = Some((completed.depth.clone(), DAffine3::IDENTITY));
        }
        completed
    }

    fn size_of(self, camera: &Intrinsics) -> Option<[u32; 2]> {
        let depth_px = self.depth_px?;
        let is_center = |size: [u32; 2]| {
            let doubled = 2.0 * camera.principal_px;
            let [width, height] = size.map(f64::from);
            (doubled.x / width - 1.0).abs() < NEAR && (doubled.y / height - 1.0).abs() < NEAR
        };
        if is_center(depth_px) {
            return Some(depth_px);
        }
        if let Some(color_px) = self
            .color_px
            .filter(|&size| is_center(size) && is_scaled(depth_px, size))
        {
            return Some(color_px);
        }
        let halves = (4.0 * camera.principal_px.x / f64::from(depth_px[0])).round();
        let larger = depth_px.map(|edge| (halves * f64::from(edge) / 2.0).round() as u32);
        let is_larger = halves > 2.0 && is_center(larger) && is_scaled(depth_px, larger);
        Some(if is_larger { larger } else { depth_px })
    }
}

/// Returns true if both sizes have the same aspect ratio.
fn is_scaled([width, height]: [u32; 2], other: [u32; 2]) -> bool {
    u64::from(width) * u64::from(other[1]) == u64::from(height) * u64::from(other[0])
}

fn assumption_of_size([width, height]: [u32; 2]) -> Assumption {
    Assumption::new(
        Subject::Camera,
        format!("its numbers are for images of {width} × {height} pixels"),
        "its principal point is at the centre of those, not of the depth images",
        Evidence::Statistics,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn learned(principal: [f64; 2], depth_px: [u32; 2], color_px: Option<[u32; 2]>) -> Calibration {
        let camera = Intrinsics::pinhole([500.0, 500.0, principal[0], principal[1]], None);
        let sizes = Sizes {
            depth_px: Some(depth_px),
            color_px,
        };
        sizes.completed(&Calibration::of_depth(camera, "a test"))
    }

    #[test]
    fn the_principal_point_determines_the_size() {
        for (principal, color_px, expected) in [
            ([319.5, 239.5], None, [640, 480]),
            ([350.0, 210.0], None, [640, 480]),
            ([955.0, 718.0], None, [1920, 1440]),
            ([958.0, 722.0], Some([1920, 1440]), [1920, 1440]),
            // Two unrelated focal lengths are not evidence.
            ([100.0, 50.0], None, [640, 480]),
        ] {
            let found = learned(principal, [640, 480], color_px);
            assert_eq!(found.depth.for_size_px, Some(expected), "{principal:?}");
        }
        assert_eq!(
            learned([958.0, 722.0], [256, 192], None).depth.for_size_px,
            Some([1920, 1440])
        );
    }

    #[test]
    fn color_images_of_another_size_and_the_same_aspect_share_the_camera() {
        let found = learned([128.0, 96.0], [256, 192], Some([1920, 1440]));
        let (color, color_from_depth) = found.color.unwrap();
        assert_eq!(color.for_size_px, Some([256, 192]));
        assert_eq!(color_from_depth, DAffine3::IDENTITY);
        for other in [Some([256, 192]), Some([100, 20]), None] {
            assert!(learned([128.0, 96.0], [256, 192], other).color.is_none());
        }
    }
}
