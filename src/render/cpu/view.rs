//! From the space of a frame to pixels, as the shaders do it (`shaders/common/view.wgsl`).

use crate::scene::ScenePacket;
use glam::{Mat3, Vec3};

/// A view space that looks down −z, and the pixels of an image.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct PixelView {
    rotation: Mat3,
    eye_high: Vec3,
    eye_low: Vec3,
    pub(in crate::render) near: f32,
    pub(in crate::render) size_px: [u32; 2],
    /// Pixels from the view axis for a slope of 1, rightwards and downwards.
    pub(in crate::render) px_per_slope: [f32; 2],
    /// Principal point, where the view axis meets the image: its centre, except for a part of a larger image.
    pub(in crate::render) center_px: [f32; 2],
}

impl PixelView {
    pub(in crate::render) fn new(packet: &ScenePacket) -> Self {
        let half_size = packet.viewport_px.map(|edge| 0.5 * edge as f32);
        let focal = packet.view.focal;
        let [right, up] = packet.view.center_ndc;
        Self {
            rotation: packet.view.view_from_frame_rotation,
            eye_high: packet.view.eye_high,
            eye_low: packet.view.eye_low,
            near: packet.view.near,
            size_px: packet.viewport_px,
            px_per_slope: [focal[0] * half_size[0], -focal[1] * half_size[1]],
            center_px: [half_size[0] * (1.0 + right), half_size[1] * (1.0 - up)],
        }
    }

    /// The eye, as a sum.
    pub(super) fn eye(&self) -> [Vec3; 2] {
        [self.eye_high, self.eye_low]
    }

    /// From the axes of the frame to the axes of the view.
    pub(super) fn rotation(&self) -> Mat3 {
        self.rotation
    }

    /// Returns the length that covers the given number of pixels at a distance of 1.
    pub(super) fn length_of_px(&self, px: f32) -> f32 {
        px / self.px_per_slope[0]
    }

    /// A point relative to the eye, in the axes of the frame. Subtracting the rounded eye first is exact near the eye.
    #[inline(always)]
    pub(super) fn offset_from_eye(&self, position: [f32; 3]) -> Vec3 {
        (Vec3::from_array(position) - self.eye_high) - self.eye_low
    }

    /// A direction, or a point relative to the eye, in view space.
    #[inline(always)]
    pub(super) fn rotate(&self, offset: Vec3) -> Vec3 {
        self.rotation * offset
    }

    /// Half the extents, in view space, of the box around a box with these half extents in the frame.
    pub(super) fn rotate_extent(&self, half: Vec3) -> Vec3 {
        self.rotation.abs() * half
    }

    /// `vector · ray` as a function of pixels, where the ray through a pixel has z = −1.
    #[inline(always)]
    pub(super) fn along_rays(&self, vector: Vec3) -> Affine {
        let per_px = [vector.x / self.px_per_slope[0], vector.y / self.px_per_slope[1]];
        Affine {
            per_px,
            at_origin: -vector.z - per_px[0] * self.center_px[0] - per_px[1] * self.center_px[1],
        }
    }

    /// The pixels that may be touched by splats reaching some pixels beyond a box in view space; empty if none can be
    /// seen.
    pub(super) fn covered_px(&self, center: Vec3, half: Vec3, margin_px: f32) -> PixelRect {
        let [nearest, farthest] = [-center.z - half.z, -center.z + half.z];
        let whole = PixelRect::of_picture(self.size_px);
        if farthest < self.near {
            return PixelRect::EMPTY;
        }
        if nearest <= 0.5 * self.near || nearest.is_nan() {
            return if self.is_outside(center, half, margin_px) {
                PixelRect::EMPTY
            } else {
                whole
            };
        }
        // Slopes are farthest from 0 at the nearest distance.
        let (low, high) = (center - half, center + half);
        let widest = |slope: f32, is_outwards: bool| slope / if is_outwards { nearest } else { farthest };
        let low = Vec3::new(widest(low.x, low.x < 0.0), widest(low.y, low.y < 0.0), 0.0);
        let high = Vec3::new(widest(high.x, high.x > 0.0), widest(high.y, high.y > 0.0), 0.0);
        self.around_slopes(low, high).grown(margin_px).intersection(whole)
    }

    /// Returns true if all of a box, which may reach behind the eye, is beyond one of the sides of the image.
    fn is_outside(&self, center: Vec3, half: Vec3, margin_px: f32) -> bool {
        (0..2).any(|axis| {
            let edge_px = self.size_px[axis] as f32;
            [(-margin_px, -1.0), (edge_px + margin_px, 1.0)]
                .into_iter()
                .any(|(side_px, outwards)| {
                    let slope = (side_px - self.center_px[axis]) / self.px_per_slope[axis];
                    let outwards = outwards * self.px_per_slope[axis].signum();
                    let beyond_side = outwards * (center[axis] + slope * center.z);
                    // For the corner that is farthest inwards.
                    beyond_side > half[axis] + slope.abs() * half.z
                })
        })
    }

    /// The pixels between two slopes along x and y.
    #[inline(always)]
    pub(super) fn around_slopes(&self, low: Vec3, high: Vec3) -> PixelRect {
        let px = |slope: f32, axis: usize| self.center_px[axis] + slope * self.px_per_slope[axis];
        // Rows are counted downwards.
        PixelRect::around([px(low.x, 0), px(high.x, 0)], [px(high.y, 1), px(low.y, 1)])
    }
}

/// A function of a pixel's coordinates.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Affine {
    pub(super) per_px: [f32; 2],
    /// Value of the function where both coordinates are 0: the upper left corner of the upper left pixel.
    pub(super) at_origin: f32,
}

impl Affine {
    /// Returns the value at the centre of a pixel; precise where pixels are far from the origin and the function is
    /// small.
    #[inline(always)]
    pub(super) fn at_px(&self, x: i32, y: i32) -> f32 {
        let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
        self.at_origin + self.per_px[0] * x + self.per_px[1] * y
    }
}

/// Columns `start[0]..end[0]` of rows `start[1]..end[1]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct PixelRect {
    pub(super) start: [i32; 2],
    pub(super) end: [i32; 2],
}

impl PixelRect {
    pub(super) const EMPTY: Self = Self {
        start: [0; 2],
        end: [0; 2],
    };

    pub(super) fn of_picture(size_px: [u32; 2]) -> Self {
        Self {
            start: [0; 2],
            end: size_px.map(|edge| edge as i32),
        }
    }

    /// Returns the pixels whose centres lie between these ends, and some more for rounding; none where an end is not a
    /// number.
    #[inline(always)]
    pub(super) fn around(x: [f32; 2], y: [f32; 2]) -> Self {
        // Conversions saturate, and the limit leaves space for the next addition.
        const FAR: f32 = (1 << 24) as f32;
        // By conversions, which round towards 0: `floor` is a function call on CPUs for which no features are assumed.
        let floor = |px: f32| {
            let px = px.clamp(-FAR, FAR);
            let towards_zero = px as i32;
            towards_zero - i32::from(towards_zero as f32 > px)
        };
        let start = |end: f32| floor(end - 0.51);
        let end = |end: f32| -floor(-(end + 0.51));
        Self {
            start: [start(x[0]), start(y[0])],
            end: [end(x[1]), end(y[1])],
        }
    }

    #[inline(always)]
    pub(super) fn intersection(self, other: Self) -> Self {
        let (start, end) = (other.start, other.end);
        Self {
            start: [self.start[0].max(start[0]), self.start[1].max(start[1])],
            end: [self.end[0].min(end[0]), self.end[1].min(end[1])],
        }
    }

    /// With a margin on all sides.
    fn grown(self, margin_px: f32) -> Self {
        let margin = margin_px.ceil() as i32;
        Self {
            start: [self.start[0] - margin, self.start[1] - margin],
            end: [self.end[0] + margin, self.end[1] + margin],
        }
    }

    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.start[0] >= self.end[0] || self.start[1] >= self.end[1]
    }
}
