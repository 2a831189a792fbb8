//! Eye-dome lighting: light from depths alone, for clouds without normals.
//!
//! **How it works** (Boucheny 2009, chapter 4; as in `CloudCompare` and Potree). A pixel is as dark as its neighbours
//! stand before it: with view distances d, `exp(-strength · 300 · mean max(0, ln d - ln d_n))` over eight neighbours.
//! Logarithms make it the same in any unit. Three things are done otherwise here:
//!
//! - `ln d - ln d_n` is replaced by `d / d_n - 1`, which takes no logarithm. Steps end at [`MAX_STEP`], and up to
//!   there both differ by 1.3 %. The bound leaves a little of the colour behind a silhouette, however far behind.
//! - Neighbours are whole pixels, so their radius is rounded; steps are scaled to the requested radius. So a slope is
//!   as dark in small images as in large ones.
//! - A pixel with only background next to it has nothing in front of it. Where a surface ends there, its last pixels
//!   get [`EDGE`]: all of it where three of eight neighbours are background, as along a straight border, and none from
//!   [`EyeDomeLight::LONE`] on, so that points of one or two pixels that stand alone keep their colours. Wider points
//!   have borders of their own, so there are no edges where these are drawn.
//!
//! Orthographic views are drawn from very far away, where all distances are alike. Steps are scaled by how much farther
//! that is than the camera's distance (`ViewTransform::telephoto`): they are then relative to that distance, as they
//! are in perspective around the target.

use crate::scene::style::{EyeDome, PointSizing};
use crate::scene::{Primitive, ScenePacket};

/// Distance of neighbours in an image 720 pixels high.
const RADIUS_PX_AT_720: f32 = 1.4;

/// Gain: the darkness of steps.
const GAIN: f32 = 300.0;

/// Maximum depth step that counts, relative to the distance. Pixels with three neighbours at least that near keep 6 %
/// of their colour.
const MAX_STEP: f32 = 0.025;

/// Darkness of an edge of the cloud: exp(-0.5) of its colour.
const EDGE: f32 = 0.5;

/// Share of neighbours without depth along a straight border.
const BORDER: f32 = 3.0 / 8.0;

/// Eye-dome lighting (EDL) parameters, which darken the pixels of an image, in terms of reversed depths `near /
/// distance`.
///
/// For a pixel with the depth `r` and neighbours with `r_n`, 0 if empty, the colour is multiplied by `exp(-(Σ
/// clamp(gain · (r_n / r - 1), 0, most) + edge · b · max(LONE - b, 0)))`, where `b` is the fraction of neighbours
/// without depth. Beyond the borders of the image, neighbours are the pixels on the borders. Pixels without depth are
/// unchanged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeDomeLight {
    /// Neighbour distances: in a row or a column, and the number of columns and rows of those on diagonals.
    pub reach_px: [u32; 2],
    /// Factors on the steps to neighbours in a row or a column, and to those on diagonals.
    pub gains: [f32; 2],
    /// Maximum contribution of a step.
    pub max: f32,
    /// Darkness where the cloud ends.
    pub edge: f32,
}

impl EyeDomeLight {
    /// Share of neighbours without depth from which a pixel belongs to no surface: a corner's.
    pub const LONE: f32 = 5.0 / 8.0;

    /// The eye-dome lighting of a packet; `None` if it is off: [`Splatting::NoDepth`](crate::scene::Splatting::NoDepth)
    /// leaves no depths to shade by.
    pub fn of(packet: &ScenePacket) -> Option<Self> {
        let style = &packet.style;
        let strength = style.light.eye_dome_strength;
        let is_on = style.light.eye_dome == EyeDome::On && strength > 0.0;
        (is_on && style.leaves_depths()).then(|| {
            let light = Self::new(packet.whole_height_px().round(), packet.view.telephoto, strength);
            let are_dots = style.primitive == Primitive::Point && style.points.sizing == PointSizing::Pixels;
            if are_dots && light.frames_dots(style.points.size_px) {
                Self { edge: 0.0, ..light }
            } else {
                light
            }
        })
    }

    /// True if the sides of a dot that stands alone were taken for borders of a surface, and its corners were not: it
    /// would look like a cross.
    fn frames_dots(&self, size_px: f32) -> bool {
        size_px > 2.0 * self.reach_px[0] as f32
    }

    fn new(whole_height_px: f32, telephoto: f32, strength: f32) -> Self {
        let asked_px = RADIUS_PX_AT_720 * whole_height_px / 720.0;
        let reach_px = [asked_px, asked_px * std::f32::consts::FRAC_1_SQRT_2].map(|reach_px| reach_px.round().max(1.0));
        let [straight_px, diagonal_px] = reach_px;
        let lengths_px = [straight_px, diagonal_px * std::f32::consts::SQRT_2];
        let per_step = strength * GAIN / 8.0;
        Self {
            reach_px: reach_px.map(|reach_px| reach_px as u32),
            gains: lengths_px.map(|length_px| per_step * telephoto * asked_px / length_px),
            max: per_step * MAX_STEP,
            edge: strength * EDGE / (BORDER * (Self::LONE - BORDER)),
        }
    }

    /// Returns the halo size: the distance of the farthest neighbours, in columns or rows.
    pub fn halo_px(&self) -> u32 {
        self.reach_px[0].max(self.reach_px[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbour_distances_are_whole_pixels_that_grow_with_the_image() {
        let reach = |height_px: f32| EyeDomeLight::new(height_px, 1.0, 1.0).reach_px;
        let reaches = [90.0, 720.0, 1080.0, 2160.0, 7200.0].map(reach);
        assert_eq!(reaches, [[1, 1], [1, 1], [2, 1], [4, 3], [14, 10]]);
    }

    /// The depths of a plane that is seen at an angle go with the pixel's height: so do steps to neighbours.
    #[test]
    fn slopes_are_equally_dark_at_any_image_size() {
        let darkness = |height_px: f32| {
            let light = EyeDomeLight::new(height_px, 1.0, 1.0);
            let step_of_a_pixel = 1.0 / height_px;
            let [straight, diagonal] =
                [0, 1].map(|way| light.gains[way] * light.reach_px[way] as f32 * step_of_a_pixel);
            straight + 2.0 * diagonal
        };
        let expected = darkness(720.0);
        for height_px in [90.0, 300.0, 1080.0, 2160.0, 65_536.0] {
            let ratio = darkness(height_px) / expected;
            assert!((ratio - 1.0).abs() < 1e-4, "{height_px}: {ratio}");
        }
    }
}
