//! A flat patch in space as functions of pixels: what a surfel, or the face of a voxel, is on the screen.
//!
//! How it works: a patch is a middle `c` and two half edges `u` and `v`; a point of it is `c + p·u + q·v`. The ray
//! through a pixel, `t·d` with `d.z = −1`, meets its plane where `t·d = M·(p, q, 1)` with the columns `u, v, c` of M.
//! By Cramer's rule `p = P/W`, `q = Q/W` and `t = |det M|/W` with
//!
//! ```text
//! P = ±(v × c)·d    Q = ±(c × u)·d    W = ±(u × v)·d    the sign of det M makes W positive in front of the eye
//! ```
//!
//! which are affine in the pixel's coordinates. So a pixel is inside a disk where `P² + Q² ≤ W²`, inside a parallelogram where
//! `|P| ≤ W` and `|Q| ≤ W`, and its reversed depth is `near/t`, a multiple of W: no division until something is shaded.
//! (Weyrich et al. 2007 rasterise elliptical splats by the same homogeneous functions.)

use super::view::{Affine, PixelRect, PixelView};
use glam::Vec3;

/// A patch on the screen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facet {
    pub(super) p: Affine,
    pub(super) q: Affine,
    pub(super) w: Affine,
    /// Reversed depth, `near/distance`, for each unit of `w`.
    pub(super) depth_per_w: f32,
    /// Length of the vector that `w` is the product of rays with: `w` over it and over the length of the ray is the cosine between
    /// the normal and the ray.
    pub(super) normal_length: f32,
    /// Pixels that it may cover.
    pub(super) bounds: PixelRect,
}

/// What of a patch is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outline {
    /// The disk that touches the edges.
    Disk,
    /// All of it.
    Parallelogram,
}

/// A patch in view space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Patch {
    pub(super) center: Vec3,
    /// Half edges; their cross product is the normal.
    pub(super) u: Vec3,
    pub(super) v: Vec3,
}

impl Facet {
    /// The patch on the screen; `None` where nothing of it can be seen: behind the eye, outside of `clip`, edge on, turned away
    /// if those are culled, or of no size or one that is no number.
    #[inline(always)]
    pub(super) fn new(
        view: &PixelView,
        clip: PixelRect,
        patch: Patch,
        outline: Outline,
        cull_back_faces: bool,
    ) -> Option<Self> {
        // Sizes are relative to the distance, so that products of small or large numbers are numbers.
        let scale = patch.center.abs().max(patch.u.abs()).max(patch.v.abs());
        let per_scale = 1.0 / scale.max_element();
        let c = patch.center * per_scale;
        let (u, v) = (patch.u * per_scale, patch.v * per_scale);
        let normal = u.cross(v);
        let determinant = normal.dot(c);
        let faces_away = determinant > 0.0;
        if faces_away && cull_back_faces {
            return None;
        }
        let normal_length = normal.length();
        let sign = if faces_away { 1.0 } else { -1.0 };
        let (p, q, w) = (v.cross(c) * sign, c.cross(u) * sign, normal * sign);
        let depth_per_w = view.near * per_scale / determinant.abs();
        // Also where the determinant is 0, or no number.
        if !(depth_per_w.is_finite() && normal_length > 0.0) {
            return None;
        }
        let bounds = bounds(view, [c, u, v], [p, q, w], outline, per_scale).intersection(clip);
        (!bounds.is_empty()).then(|| Self {
            p: view.along_rays(p),
            q: view.along_rays(q),
            w: view.along_rays(w),
            depth_per_w,
            normal_length,
            bounds,
        })
    }
}

/// The pixels that a patch may cover. `vectors` are `c, u, v`; `rows` what rays are multiplied with to give P, Q and W.
#[inline(always)]
fn bounds(
    view: &PixelView,
    [c, u, v]: [Vec3; 3],
    [p, q, w]: [Vec3; 3],
    outline: Outline,
    per_scale: f32,
) -> PixelRect {
    // Half the depth of a parallelogram; that of a disk is less.
    let half_depth = u.z.abs() + v.z.abs();
    let near = view.near * per_scale;
    if -c.z + half_depth < near {
        return PixelRect::EMPTY;
    }
    let nearest = -c.z - half_depth;
    if nearest <= 0.25 * near {
        return PixelRect::of_picture(view.size_px);
    }
    let (low, high) = match outline {
        // A line of pixels touches the disk where the quadratic form P² + Q² − W² has a double root along it. Its dual is
        // made of the same cross products, which do not cancel where a small disk is far away.
        Outline::Disk => {
            let per_depth2 = 1.0 / (c.z * c.z - u.z * u.z - v.z * v.z);
            let middle = (u * u.z + v * v.z - c * c.z) * per_depth2;
            let reach2 = p * p + q * q - w * w;
            let reach = reach2.max(Vec3::ZERO);
            let reach = Vec3::new(reach.y.sqrt(), reach.x.sqrt(), 0.0) * per_depth2;
            (middle - reach, middle + reach)
        }
        Outline::Parallelogram => {
            let slopes = |corner: Vec3| corner / -corner.z;
            let (a, b) = (slopes(c + u + v), slopes(c + u - v));
            let (d, e) = (slopes(c - u + v), slopes(c - u - v));
            (a.min(b).min(d.min(e)), a.max(b).max(d.max(e)))
        }
    };
    view.around_slopes(low, high)
}

#[cfg(test)]
mod tests {
    use super::super::tests::view_of;
    use super::*;
    use proptest::prelude::*;

    /// In f64, by meeting the ray of a pixel with the plane.
    fn meets(patch: &Patch, view: &PixelView, x: i32, y: i32) -> Option<([f64; 2], f64)> {
        let [c, u, v] = [patch.center, patch.u, patch.v].map(Vec3::as_dvec3);
        let slope = |axis: usize, px: i32| {
            (f64::from(px) + 0.5 - f64::from(view.middle_px[axis]))
                / f64::from(view.px_per_slope[axis])
        };
        let ray = glam::DVec3::new(slope(0, x), slope(1, y), -1.0);
        let solution = glam::DMat3::from_cols(u, v, -ray).inverse() * -c;
        (solution.z > 0.0).then_some(([solution.x, solution.y], solution.z))
    }

    proptest! {
        #[test]
        fn functions_are_those_of_rays_and_bounds_hold_the_outline(
            center in [-2.0f32..2.0, -2.0f32..2.0, -9.0f32..-0.2],
            u in prop::array::uniform3(-0.5f32..0.5),
            v in prop::array::uniform3(-0.5f32..0.5),
            scale in -8i32..8,
        ) {
            let scale = 2f32.powi(scale);
            let [center, u, v] = [center, u, v].map(|vector| scale * Vec3::from_array(vector));
            let patch = Patch { center, u, v };
            let mut view = view_of([64, 48]);
            view.near = 0.05 * scale;
            prop_assume!(u.cross(v).length() > 1e-3 * scale * scale);
            prop_assume!(u.cross(v).normalize().dot(center).abs() > 1e-2 * scale);
            for outline in [Outline::Disk, Outline::Parallelogram] {
                let facet = Facet::new(&view, PixelRect::of_picture(view.size_px), patch, outline, false);
                for y in 0..48 {
                    for x in 0..64 {
                        let Some(([p, q], distance)) = meets(&patch, &view, x, y) else { continue };
                        let extent = match outline {
                            Outline::Disk => p.hypot(q),
                            Outline::Parallelogram => p.abs().max(q.abs()),
                        };
                        if extent > 0.999 || distance < f64::from(view.near) {
                            continue;
                        }
                        let facet = facet.expect("a pixel is inside");
                        let at = |function: Affine| f64::from(function.at_px(x, y));
                        let inside = facet.bounds.intersection(PixelRect { start: [x, y], end: [x + 1, y + 1] });
                        prop_assert!(!inside.is_empty(), "{x} {y} is outside of {:?}", facet.bounds);
                        let w = at(facet.w);
                        prop_assert!((at(facet.p) / w - p).abs() < 1e-3 && (at(facet.q) / w - q).abs() < 1e-3);
                        let depth = f64::from(facet.depth_per_w) * w;
                        prop_assert!((depth * distance / f64::from(view.near) - 1.0).abs() < 1e-3);
                    }
                }
            }
        }
    }
}
