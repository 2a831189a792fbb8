//! Flat patch in space as functions of pixels: the screen-space form of a surfel, or of the face of a voxel.
//!
//! How it works: a patch is a centre `c` and two half edges `u` and `v`; a point of it is `c + p·u + q·v`. The ray
//! through a pixel, `t·d` with `d.z = −1`, meets its plane where `t·d = M·(p, q, 1)` with the columns `u, v, c` of M.
//! By Cramer's rule `p = P/W`, `q = Q/W` and `t = |det M|/W` with
//!
//! ```text
//! P = ±(v × c)·d    Q = ±(c × u)·d    W = ±(u × v)·d    the sign of det M makes W positive in front of the eye
//! ```
//!
//! which are affine in the pixel's coordinates. So a pixel is inside a disk where `P² + Q² ≤ W²`, inside a
//! parallelogram where `|P| ≤ W` and `|Q| ≤ W`, and its reversed depth is `near/t`, a multiple of W: no division until
//! something is shaded. (Weyrich et al. 2007 rasterise elliptical splats by the same homogeneous functions.)

use super::eight::Vectors;
use super::tile::LANES;
use super::view::{Affine, PixelRect, PixelView};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, mask32x8};
use glam::Vec3;

/// A patch on the screen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facet {
    pub(super) p: Affine,
    pub(super) q: Affine,
    pub(super) w: Affine,
    /// Reversed depth, `near/distance`, for each unit of `w`.
    pub(super) depth_per_w: f32,
    /// Length of the vector that `w` is the product of rays with: `w` over it and over the length of the ray is the
    /// cosine between the normal and the ray.
    pub(super) normal_length: f32,
    /// Pixels that it may cover.
    pub(super) bounds: PixelRect,
}

/// Drawn outline of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outline {
    /// The disk that touches the edges.
    Disk,
    /// All of it.
    Parallelogram,
}

/// Target that patches are drawn to, and their outline.
#[derive(Debug, Clone, Copy)]
pub(super) struct Canvas<'a> {
    pub(super) view: &'a PixelView,
    pub(super) clip: PixelRect,
    pub(super) outline: Outline,
    pub(super) cull_back_faces: bool,
    /// Minimum reach of bounds from centres, in pixels.
    pub(super) min_reach_px: f32,
}

/// Eight patches in view space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Patches<S: Simd> {
    pub(super) centers: Vectors<S>,
    /// Half edges; their cross product is the normal.
    pub(super) u: Vectors<S>,
    pub(super) v: Vectors<S>,
}

/// Eight patches on the screen, a property in each row, a patch in each lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facets {
    functions: [[f32; LANES]; 9],
    depth_per_w: [f32; LANES],
    normal_length: [f32; LANES],
    bounds: [[i32; LANES]; 4],
    are_seen: [i32; LANES],
}

impl Facet {
    /// Returns the factors on the functions `p`, `q` and `w` whose weighted sum is the dot product of a normal and the
    /// ray that has z = −1, for a normal that need not be that of this patch, whose centre and half edges are given.
    ///
    /// The ray of a pixel meets the patch at `c + p·u + q·v`, which is the ray times the distance: the dot product of
    /// the normal and that is `(n·u)·P + (n·v)·Q + (n·c)·W` over W, and the reversed depth is `near` over the distance.
    #[inline(always)]
    pub(super) fn along_rays(&self, view: &PixelView, normal: Vec3, [c, u, v]: [Vec3; 3]) -> [f32; 3] {
        let per_distance = self.depth_per_w / view.near;
        [u, v, c].map(|along| normal.dot(along) * per_distance)
    }
}

impl Facets {
    /// Patches on the screen. Some cannot be seen: if `are_asked` says so, behind the eye, outside `clip`, edge-on,
    /// turned away if those are culled, or of zero or NaN size.
    ///
    /// A function of its own for the sake of the compiler; its registers go through memory once for eight patches.
    #[inline(never)]
    pub(super) fn new<S: Simd>(simd: S, canvas: &Canvas<'_>, patches: &Patches<S>, are_asked: mask32x8<S>) -> Self {
        simd.vectorize(
            #[inline(always)]
            || Self::inlined(simd, canvas, patches, are_asked),
        )
    }

    #[inline(always)]
    fn inlined<S: Simd>(simd: S, canvas: &Canvas<'_>, patches: &Patches<S>, are_asked: mask32x8<S>) -> Self {
        let view = canvas.view;
        let zero = f32x8::splat(simd, 0.0);
        // Sizes are relative to the distance, so that products of small or large numbers neither underflow nor
        // overflow.
        let largest_edge = patches.u.largest().max(patches.v.largest());
        let per_scale = 1.0 / patches.centers.largest().max(largest_edge);
        let c = patches.centers.times(per_scale);
        let (u, v) = (patches.u.times(per_scale), patches.v.times(per_scale));
        let normal = u.cross(v);
        let determinant = normal.dot(c);
        let normal_length = normal.dot(normal).sqrt();
        let sign = f32x8::splat(simd, 1.0).copysign(determinant);
        let (p, q, w) = (v.cross(c), c.cross(u), normal);
        let depth_per_w = view.near * per_scale / determinant.abs();
        // False where the determinant is 0 or NaN.
        let mut are_seen =
            are_asked & depth_per_w.simd_lt(f32x8::splat(simd, f32::INFINITY)) & normal_length.simd_gt(zero);
        if canvas.cull_back_faces {
            are_seen &= determinant.simd_le(zero);
        }
        let near = view.near * per_scale;
        let bounds = bounds(simd, canvas, [c, u, v], [p, q, w], near);
        let [left, top, right, bottom] = bounds;
        are_seen &= left.simd_lt(right) & top.simd_lt(bottom);
        let [p, q, w] = [p.times(sign), q.times(sign), w.times(sign)];
        let [p, q, w] = [along_rays(view, p), along_rays(view, q), along_rays(view, w)];
        Self {
            functions: [*p[0], *p[1], *p[2], *q[0], *q[1], *q[2], *w[0], *w[1], *w[2]],
            depth_per_w: *depth_per_w,
            normal_length: *normal_length,
            bounds: [
                *simd.cvt_i32_f32x8(left),
                *simd.cvt_i32_f32x8(top),
                *simd.cvt_i32_f32x8(right),
                *simd.cvt_i32_f32x8(bottom),
            ],
            are_seen: *are_seen,
        }
    }

    /// The patch of a lane, if something of it may be seen.
    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> Option<Facet> {
        let affine = |first: usize| Affine {
            per_px: [self.functions[first][lane], self.functions[first + 1][lane]],
            at_origin: self.functions[first + 2][lane],
        };
        let [left, top, right, bottom] = &self.bounds;
        (self.are_seen[lane] != 0).then(|| Facet {
            p: affine(0),
            q: affine(3),
            w: affine(6),
            depth_per_w: self.depth_per_w[lane],
            normal_length: self.normal_length[lane],
            bounds: PixelRect {
                start: [left[lane], top[lane]],
                end: [right[lane], bottom[lane]],
            },
        })
    }
}

/// `vector · ray` as functions of pixels, where the ray through a pixel has z = −1: the factors of x and y, and the
/// value where both are 0.
#[inline(always)]
fn along_rays<S: Simd>(view: &PixelView, vectors: Vectors<S>) -> [f32x8<S>; 3] {
    let per_x = vectors.x * (1.0 / view.px_per_slope[0]);
    let per_y = vectors.y * (1.0 / view.px_per_slope[1]);
    let to_center = per_x * view.center_px[0] + per_y * view.center_px[1];
    [per_x, per_y, -vectors.z - to_center]
}

/// Computes the pixel bounds that patches may cover: left, top, right, bottom. `vectors` are `c, u, v`; `rows` the
/// factors on rays that give P, Q and W, with either sign.
#[inline(always)]
fn bounds<S: Simd>(
    simd: S,
    canvas: &Canvas<'_>,
    [c, u, v]: [Vectors<S>; 3],
    [p, q, w]: [Vectors<S>; 3],
    near: f32x8<S>,
) -> [f32x8<S>; 4] {
    let Canvas {
        view, clip, outline, ..
    } = *canvas;
    let zero = f32x8::splat(simd, 0.0);
    // Half the depth of a parallelogram; a disk's is less.
    let half_depth = u.z.abs() + v.z.abs();
    let is_behind = (half_depth - c.z).simd_lt(near);
    // The bounds computed here are invalid where a patch extends behind the eye.
    let is_around_eye = (-c.z - half_depth).simd_le(near * 0.25);
    let [low_x, high_x, low_y, high_y] = match outline {
        // A line of pixels touches the disk where the quadratic form P² + Q² − W² has a double root along it. Its dual
        // consists of the same cross products, which do not cancel for a small, distant disk.
        Outline::Disk => {
            let per_depth2 = 1.0 / (c.z * c.z - u.z * u.z - v.z * v.z);
            let midpoint = |c_axis: f32x8<S>, u_axis: f32x8<S>, v_axis: f32x8<S>| {
                (u_axis * u.z + v_axis * v.z - c_axis * c.z) * per_depth2
            };
            let reach = |p_axis: f32x8<S>, q_axis: f32x8<S>, w_axis: f32x8<S>| {
                let reach2 = p_axis * p_axis + q_axis * q_axis - w_axis * w_axis;
                reach2.max(zero).sqrt() * per_depth2
            };
            let (x, half_x) = (midpoint(c.x, u.x, v.x), reach(p.y, q.y, w.y));
            let (y, half_y) = (midpoint(c.y, u.y, v.y), reach(p.x, q.x, w.x));
            [x - half_x, x + half_x, y - half_y, y + half_y]
        }
        Outline::Parallelogram => {
            let slopes = |corner: Vectors<S>| {
                let per_distance = -1.0 / corner.z;
                (corner.x * per_distance, corner.y * per_distance)
            };
            let (up, down) = (c.plus(u), c.minus(u));
            let (a, b) = (slopes(up.plus(v)), slopes(up.minus(v)));
            let (d, e) = (slopes(down.plus(v)), slopes(down.minus(v)));
            [
                a.0.min(b.0).min(d.0.min(e.0)),
                a.0.max(b.0).max(d.0.max(e.0)),
                a.1.min(b.1).min(d.1.min(e.1)),
                a.1.max(b.1).max(d.1.max(e.1)),
            ]
        }
    };
    let px = |slope: f32x8<S>, axis: usize| slope * view.px_per_slope[axis] + view.center_px[axis];
    // Rows are counted downwards.
    let mut ends = [px(low_x, 0), px(high_x, 0), px(high_y, 1), px(low_y, 1)];
    if canvas.min_reach_px > 0.0 {
        let midpoints = [px(c.x / -c.z, 0), px(c.y / -c.z, 1)];
        for (axis, midpoint) in midpoints.into_iter().enumerate() {
            ends[2 * axis] = ends[2 * axis].min(midpoint - canvas.min_reach_px);
            ends[2 * axis + 1] = ends[2 * axis + 1].max(midpoint + canvas.min_reach_px);
        }
    }
    let [left, right] = pixels_between(simd, clip, 0, [ends[0], ends[1]], is_around_eye);
    let [top, bottom] = pixels_between(simd, clip, 1, [ends[2], ends[3]], is_around_eye);
    // Empty if nothing is in front of the near plane.
    [left, top, simd.select_f32x8(is_behind, left, right), bottom]
}

/// Returns the range of pixels of `clip` along an axis whose centres are between two ends, or a hundredth of a pixel
/// beyond for rounding; all of them if the ends are not known.
#[inline(always)]
fn pixels_between<S: Simd>(
    simd: S,
    clip: PixelRect,
    axis: usize,
    [first, last]: [f32x8<S>; 2],
    are_unknown: mask32x8<S>,
) -> [f32x8<S>; 2] {
    let start = f32x8::splat(simd, clip.start[axis] as f32);
    let end = f32x8::splat(simd, clip.end[axis] as f32);
    [
        simd.select_f32x8(are_unknown, start, (first - 0.51).ceil().max(start)),
        simd.select_f32x8(are_unknown, end, (last + 0.51).floor().min(end)),
    ]
}

impl Facet {
    /// One patch by its center and its half edges.
    #[inline(always)]
    pub(super) fn of_patch<S: Simd>(simd: S, canvas: &Canvas<'_>, [center, u, v]: [Vec3; 3]) -> Option<Self> {
        let patches = Patches {
            centers: Vectors::splat(simd, center),
            u: Vectors::splat(simd, u),
            v: Vectors::splat(simd, v),
        };
        Facets::new(simd, canvas, &patches, mask32x8::splat(simd, -1)).get(0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::view_of;
    use super::*;
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    #[derive(Debug, Clone, Copy)]
    struct Patch {
        center: Vec3,
        u: Vec3,
        v: Vec3,
    }

    fn facet_of(view: &PixelView, patch: Patch, outline: Outline) -> Option<Facet> {
        let canvas = Canvas {
            view,
            clip: PixelRect::of_picture(view.size_px),
            outline,
            cull_back_faces: false,
            min_reach_px: 0.0,
        };
        dispatch!(Level::new(), simd => {
            Facet::of_patch(simd, &canvas, [patch.center, patch.u, patch.v])
        })
    }

    /// In f64, by meeting the ray of a pixel with the plane.
    fn meets(patch: &Patch, view: &PixelView, x: i32, y: i32) -> Option<([f64; 2], f64)> {
        let [c, u, v] = [patch.center, patch.u, patch.v].map(Vec3::as_dvec3);
        let slope = |axis: usize, px: i32| {
            (f64::from(px) + 0.5 - f64::from(view.center_px[axis])) / f64::from(view.px_per_slope[axis])
        };
        let ray = glam::DVec3::new(slope(0, x), slope(1, y), -1.0);
        let solution = glam::DMat3::from_cols(u, v, -ray).inverse() * -c;
        (solution.z > 0.0).then_some(([solution.x, solution.y], solution.z))
    }

    proptest! {
        #[test]
        fn splat_functions_match_rays_and_bounds_contain_the_outline(
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
                let facet = facet_of(&view, patch, outline);
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
