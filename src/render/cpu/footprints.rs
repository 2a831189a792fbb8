//! Upper bounds of the screen-space reach of splats from their centres: a splat that covers no pixel centre needs no
//! patch.
//!
//! How it works: a splat is inside the ball around it. For a ball of radius ρ whose centre is seen at the distance d
//! along the view axis, with the slopes s, no point is seen farther than `ρ·√(1 + s²)/(d − ρ)` from the centre, in
//! slopes. So a splat covers no pixel if the nearest pixel centre is farther.
//!
//! When it wins: from afar, where most splats of a large cloud lie between the centres of pixels. Their directions need
//! not even be unpacked.

use super::eight::Vectors;
use super::view::PixelView;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, mask32x8};

/// For rounding, here and where pixels are tested.
const SLACK_PX: f32 = 0.02;

/// Eight splats on the screen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Footprints<S: Simd> {
    /// Squared distance from the centre of the nearest pixel.
    from_pixel2_px: f32x8<S>,
    /// Infinite where a splat is so near that it may reach around the eye.
    reach_px: f32x8<S>,
}

impl<S: Simd> Footprints<S> {
    /// Computes the footprints of splats with these centres, in view space, and this reach.
    #[inline(always)]
    pub(super) fn of(simd: S, view: &PixelView, centers: Vectors<S>, reach: f32x8<S>) -> Self {
        let splat = |value: f32| f32x8::splat(simd, value);
        let distance = -centers.z;
        let nearest = distance - reach;
        let (right, up) = (centers.x / distance, centers.y / distance);
        let [across_px, down_px] = view.px_per_slope;
        let x = from_pixel(view, right, 0);
        let y = from_pixel(view, up, 1);
        let obliquely = right.mul_add(right, up.mul_add(up, splat(1.0))).sqrt();
        let reach_px = reach * obliquely * across_px.abs().max(down_px.abs()) / nearest;
        let is_far = nearest.simd_gt(splat(view.near)) & nearest.simd_gt(reach);
        Self {
            from_pixel2_px: x.mul_add(x, y * y),
            reach_px: simd.select_f32x8(is_far, reach_px, splat(f32::INFINITY)),
        }
    }

    /// Returns a mask of the splats that may cover the centre of a pixel.
    #[inline(always)]
    pub(super) fn may_cover_centers(&self, simd: S) -> mask32x8<S> {
        let reach_px = self.reach_px + f32x8::splat(simd, SLACK_PX);
        !self.from_pixel2_px.simd_gt(reach_px * reach_px)
    }

    /// Splats that reach no farther than this many pixels.
    #[inline(always)]
    pub(super) fn are_within(&self, simd: S, px: f32) -> mask32x8<S> {
        self.reach_px.simd_le(f32x8::splat(simd, px))
    }
}

/// Returns the distance from a slope along an axis to the centre of the pixel that it is seen in.
#[inline(always)]
fn from_pixel<S: Simd>(view: &PixelView, slope: f32x8<S>, axis: usize) -> f32x8<S> {
    let px = slope * view.px_per_slope[axis] + view.center_px[axis];
    px - px.floor() - 0.5
}

#[cfg(test)]
mod tests {
    use super::super::facet::{Canvas, Facet, Outline};
    use super::super::tests::view_of;
    use super::super::view::PixelRect;
    use super::*;
    use fearless_simd::{Level, dispatch};
    use glam::Vec3;
    use proptest::prelude::*;

    const SIZE_PX: [u32; 2] = [64, 48];

    /// Returns true if a splat may cover the centre of a pixel, and true if it is within this many pixels.
    fn footprint(view: &PixelView, center: Vec3, reach: f32, within_px: f32) -> (bool, bool) {
        dispatch!(Level::new(), simd => {
            let footprints = Footprints::of(simd, view, Vectors::splat(simd, center), f32x8::splat(simd, reach));
            let may_cover = footprints.may_cover_centers(simd);
            let are_within = footprints.are_within(simd, within_px);
            (simd.any_true_mask32x8(may_cover), simd.any_true_mask32x8(are_within))
        })
    }

    /// The pixels that the patch of a disk covers, as they are drawn.
    fn covered(view: &PixelView, center: Vec3, normal: Vec3, radius: f32) -> Vec<[i32; 2]> {
        let canvas = Canvas {
            view,
            clip: PixelRect::of_picture(SIZE_PX),
            outline: Outline::Disk,
            cull_back_faces: false,
            min_reach_px: 0.0,
        };
        let u = normal.any_orthonormal_vector();
        let patch = [center, radius * u, radius * normal.cross(u)];
        let facet = dispatch!(Level::new(), simd => Facet::of_patch(simd, &canvas, patch));
        let Some(facet) = facet else { return Vec::new() };
        let rows = facet.bounds.start[1]..facet.bounds.end[1];
        rows.flat_map(|y| (facet.bounds.start[0]..facet.bounds.end[0]).map(move |x| [x, y]))
            .filter(|&[x, y]| {
                let [p, q, w] = [facet.p, facet.q, facet.w].map(|function| function.at_px(x, y));
                p * p + q * q <= w * w
            })
            .collect()
    }

    proptest! {
        /// Small disks, most of which cover one pixel or none.
        #[test]
        fn splats_that_cover_a_pixel_are_never_culled(
            px in [0.0f32..64.0, 0.0f32..48.0],
            distance in 0.2f32..100.0,
            normal in prop::array::uniform3(-1.0f32..1.0),
            radius_px in 0.0f32..1.5,
        ) {
            let view = view_of(SIZE_PX);
            let normal = Vec3::from_array(normal).try_normalize().unwrap_or(Vec3::X);
            let slope = |axis: usize| (px[axis] - view.center_px[axis]) / view.px_per_slope[axis];
            let center = distance * Vec3::new(slope(0), slope(1), -1.0);
            let radius = radius_px * distance / view.px_per_slope[0].abs();
            let pixels = covered(&view, center, normal, radius);
            let (may_cover, _) = footprint(&view, center, radius, 0.0);
            prop_assert!(may_cover || pixels.is_empty(), "{pixels:?}");
        }
    }

    /// A pixel is 1/32 wide at the distance of 1 there, and the view axis meets the corner of four.
    #[test]
    fn splats_between_pixel_centers_cover_none() {
        let view = view_of([64, 64]);
        let radius_px = |px: f32| 10.0 * px / view.px_per_slope[0].abs();
        let at_corner = Vec3::new(0.0, 0.0, -10.0);
        assert_eq!(footprint(&view, at_corner, radius_px(0.6), 0.7), (false, true));
        assert_eq!(footprint(&view, at_corner, radius_px(0.75), 0.7), (true, false));
    }

    #[test]
    fn splats_that_may_surround_the_eye_may_cover_every_pixel() {
        let view = view_of(SIZE_PX);
        for center in [
            Vec3::new(0.0, 0.0, -1.0),
            Vec3::new(0.0, 0.0, 1.0),
            Vec3::new(3.0, 0.0, -1e-6),
        ] {
            assert_eq!(footprint(&view, center, 2.0, 1e6), (true, false));
        }
        assert!(footprint(&view, Vec3::new(f32::NAN, 0.0, -1.0), 0.1, 1e6).0);
    }
}
