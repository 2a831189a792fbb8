//! From the space of a cloud to the pixels of an image.

use glam::{Mat3, Vec3};
use rayon::prelude::*;

/// A view of a cloud, and the pixels of its image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScreenView {
    /// Rotation from the axes of the cloud to the view axes: right, up, backward.
    pub rotation: Mat3,
    /// The eye in the space of the cloud, rounded to f32.
    pub eye_high: Vec3,
    /// Rounding remainder of the eye position.
    pub eye_low: Vec3,
    /// Nothing nearer along the view axis is seen.
    pub near: f32,
    /// Width and height of the image.
    pub size_px: [u32; 2],
    /// Pixels from the view axis for a slope of 1, rightwards and downwards.
    pub px_per_slope: [f32; 2],
    /// Principal point: the pixel position where the view axis meets the image.
    pub center_px: [f32; 2],
}

/// A point in an image.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct ScreenPoint {
    /// From the eye, in the axes of the cloud.
    pub(super) offset: Vec3,
    /// Distance along the view axis.
    pub(super) depth: f32,
    /// Pixels from the upper left corner.
    pub(super) place_px: [f32; 2],
}

/// The points visible in an image.
#[derive(Debug, Clone, Default)]
pub struct Visible {
    /// Their places among all, ascending.
    pub slots: Vec<u32>,
    pub(super) seen: Vec<ScreenPoint>,
}

impl ScreenView {
    /// A place relative to the eye. Subtracting the rounded eye first is exact near the eye.
    #[inline(always)]
    pub(super) fn offset(&self, position: [f32; 3]) -> Vec3 {
        (Vec3::from_array(position) - self.eye_high) - self.eye_low
    }

    /// Projects a point to the screen, also outside the image; `None` before the near plane, and for NaN.
    #[inline(always)]
    pub(super) fn see(&self, position: [f32; 3]) -> Option<ScreenPoint> {
        let offset = self.offset(position);
        let in_view = self.rotation * offset;
        let depth = -in_view.z;
        // Positive, so that depths have the same order as their bits.
        (depth >= self.near && depth > 0.0 && depth < f32::INFINITY).then(|| {
            let per_depth = 1.0 / depth;
            let place = |axis: usize| in_view[axis] * per_depth * self.px_per_slope[axis] + self.center_px[axis];
            ScreenPoint {
                offset,
                depth,
                place_px: [place(0), place(1)],
            }
        })
    }

    /// Returns the number of pixels that a length covers at a distance of 1, along the axis where these are most.
    pub(super) fn px_per_unit(&self) -> f32 {
        let [x, y] = self.px_per_slope.map(f32::abs);
        x.max(y)
    }

    /// Returns this view with the image enlarged by a margin of `margin_px` pixels on each side.
    pub(super) fn with_margin(&self, margin_px: u32) -> Self {
        Self {
            size_px: self.size_px.map(|edge| edge + 2 * margin_px),
            center_px: self.center_px.map(|center| center + margin_px as f32),
            ..*self
        }
    }
}

impl ScreenPoint {
    /// The least and the largest depth.
    pub(super) fn depth_range(seen: &[Self]) -> [f32; 2] {
        let none = || [f32::INFINITY, 0.0_f32];
        seen.par_iter()
            .with_min_len(1 << 14)
            .fold(none, |[low, high], seen| [low.min(seen.depth), high.max(seen.depth)])
            .reduce(none, |a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }
}

impl Visible {
    /// Returns the number of visible points.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Returns true if no points are visible.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }
}
