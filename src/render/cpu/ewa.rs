//! Splats filtered to the pixels they are seen in, eight at a time (`shaders/primitives/filtered_by_ewa.wgsl`).
//!
//! How it works: EWA filtering in object space (Ren et al. 2002). The Gaussian of a splat with the half edges `u` and
//! `v`, as large as its mask, is convolved with a pixel's. With J, the pixels along `u` and `v`, the sum of both
//! variances in the plane of the splat is, in units of the splat's own, `A = I + r²·(JᵀJ)⁻¹`, where r is the radius in
//! pixels of the splat that a point becomes. The new half edges are `(u v)·√A`: the symmetric root of two rows, `(A +
//! s·I)/√(trace A + 2s)` with `s = √det A`, needs no eigenvectors. The mask of the filtered splat is `1/s` times as
//! high, so that it adds as much to the image as before.

use super::eight::Vectors;
use super::view::PixelView;
use crate::render::constants::{EWA_MEAN_WEIGHT, EWA_MIN_DETERMINANT, OPAQUE_WEIGHT};
use crate::scene::SplatFilter;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};

/// Squared radius of the splat that a point becomes, in pixels.
const RADIUS2_PX: f32 = SplatFilter::RADIUS_PX * SplatFilter::RADIUS_PX;

/// Eight splats in view space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Splats<S: Simd> {
    /// Half edges, at right angles but where they are filtered.
    pub(super) u: Vectors<S>,
    pub(super) v: Vectors<S>,
    /// Factors on their masks.
    pub(super) weights: f32x8<S>,
}

/// Screen-space splats as input of the filter, approximated as if they were short.
#[derive(Debug, Clone, Copy)]
pub(super) struct OnScreen<S: Simd> {
    /// J: pixels to the right and down along both half edges.
    u: [f32x8<S>; 2],
    v: [f32x8<S>; 2],
    /// `JᵀJ`, at least the value of splats seen almost edge-on.
    uu: f32x8<S>,
    uv: f32x8<S>,
    vv: f32x8<S>,
    /// r² over the determinant of that.
    filter: f32x8<S>,
    /// s.
    root: f32x8<S>,
    weights: f32x8<S>,
}

impl<S: Simd> OnScreen<S> {
    /// `K = J·A·Jᵀ`: squares and product of how far filtered splats reach to the right and down, in pixels.
    #[inline(always)]
    pub(super) fn covariance(&self) -> [f32x8<S>; 3] {
        let Self { u, v, .. } = *self;
        // J·A, where A is symmetric.
        let (a, b, c) = self.variance();
        let of_u = [u[0].mul_add(a, v[0] * b), u[1].mul_add(a, v[1] * b)];
        let of_v = [u[0].mul_add(b, v[0] * c), u[1].mul_add(b, v[1] * c)];
        [
            of_u[0].mul_add(u[0], of_v[0] * v[0]),
            of_u[0].mul_add(u[1], of_v[0] * v[1]),
            of_u[1].mul_add(u[1], of_v[1] * v[1]),
        ]
    }

    /// Factors on the masks.
    #[inline(always)]
    pub(super) fn weights(&self) -> f32x8<S> {
        self.weights
    }

    /// A.
    #[inline(always)]
    fn variance(&self) -> (f32x8<S>, f32x8<S>, f32x8<S>) {
        (
            self.vv * self.filter + 1.0,
            -(self.uv * self.filter),
            self.uu * self.filter + 1.0,
        )
    }
}

impl<S: Simd> Splats<S> {
    /// Projects the splats to the screen at these centres.
    #[inline(always)]
    pub(super) fn on_screen(&self, simd: S, view: &PixelView, centers: Vectors<S>) -> OnScreen<S> {
        let Self { u, v, .. } = *self;
        let splat = |value: f32| f32x8::splat(simd, value);
        let per_distance = 1.0 / (-centers.z).max(splat(view.near));
        let ([u_right, u_down], [v_right, v_down]) = (
            px_along(view, centers, per_distance, u),
            px_along(view, centers, per_distance, v),
        );
        // On splats seen almost edge-on, the filter of a pixel reaches too far into the image.
        let px_per_length = per_distance * (SplatFilter::MIN_COSINE * view.px_per_slope[0]);
        let min = px_per_length * px_per_length;
        let uu = u_right.mul_add(u_right, u_down.mul_add(u_down, min * u.dot(u)));
        let vv = v_right.mul_add(v_right, v_down.mul_add(v_down, min * v.dot(v)));
        let uv = u_right.mul_add(v_right, u_down * v_down);
        let determinant = uu.mul_add(vv, -(uv * uv)).max(splat(EWA_MIN_DETERMINANT));
        let filter = RADIUS2_PX / determinant;
        let root = (uu + vv + RADIUS2_PX).mul_add(filter, splat(1.0)).sqrt();
        OnScreen {
            u: [u_right, u_down],
            v: [v_right, v_down],
            uu,
            uv,
            vv,
            filter,
            root,
            weights: weights(simd, 1.0 / root),
        }
    }

    /// Returns the filtered splats.
    #[inline(always)]
    pub(super) fn filtered(self, on_screen: &OnScreen<S>) -> Self {
        let Self { u, v, .. } = self;
        let root = on_screen.root;
        let (a, b, c) = on_screen.variance();
        let per_trace = 1.0 / (a + c + root * 2.0).sqrt();
        let (a, b, c) = ((a + root) * per_trace, b * per_trace, (c + root) * per_trace);
        Self {
            u: u.times(a).plus(v.times(b)),
            v: u.times(b).plus(v.times(c)),
            weights: on_screen.weights,
        }
    }
}

/// Returns the extent of an edge from a centre in pixels to the right and down, as if it were short.
#[inline(always)]
fn px_along<S: Simd>(view: &PixelView, centers: Vectors<S>, per_distance: f32x8<S>, edge: Vectors<S>) -> [f32x8<S>; 2] {
    let nearer = edge.z * per_distance;
    [
        centers.x.mul_add(nearer, edge.x) * per_distance * view.px_per_slope[0],
        centers.y.mul_add(nearer, edge.y) * per_distance * view.px_per_slope[1],
    ]
}

/// The masks' factors, in the unit of the weight that hides the background: of splats far smaller than a pixel it is
/// the mean weight of a surface that does, not that between three splats.
#[inline(always)]
fn weights<S: Simd>(simd: S, heights: f32x8<S>) -> f32x8<S> {
    let opaque = f32x8::splat(simd, OPAQUE_WEIGHT);
    let rising = 1.0 - heights;
    heights * opaque / rising.mul_add(f32x8::splat(simd, EWA_MEAN_WEIGHT - OPAQUE_WEIGHT), opaque)
}
