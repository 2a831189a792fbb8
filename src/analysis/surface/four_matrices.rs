//! The direction of least spread of four covariances at a time.
//!
//! How it works: the steps of [`SymmetricMat3::smallest_eigenvector`], in which a matrix mostly waits for its own roots
//! and quotients, taken by four matrices side by side. The operations and their order are the same, so results are
//! bit-identical. Both of its branches, the smallest eigenvalue standing apart from the others or not, are taken as
//! long as one of the four needs it; a matrix that is a multiple of the identity is handed back to that function.
//!
//! When it wins: over one matrix after the other, about three times on surfaces.

use crate::math::SymmetricMat3;
use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x4, f64x4, mask64x4};
use glam::DVec3;

/// Matrices side by side.
pub(in crate::analysis) const FOUR: usize = 4;

/// Three numbers of four points.
pub(super) type Triples<S> = [f64x4<S>; 3];

/// Four symmetric matrices.
#[derive(Debug, Clone, Copy)]
pub(in crate::analysis) struct FourMatrices<S: Simd> {
    /// xx, yy, zz.
    pub(in crate::analysis) diagonal: Triples<S>,
    /// xy, yz, zx.
    pub(in crate::analysis) neighbor: Triples<S>,
}

impl<S: Simd> FourMatrices<S> {
    /// Widens matrices of single precision.
    #[inline(always)]
    pub(super) fn of_singles(simd: S, diagonal: [f32x4<S>; 3], neighbor: [f32x4<S>; 3]) -> Self {
        let zero = f64x4::splat(simd, 0.0);
        let mut matrices = Self {
            diagonal: [zero; 3],
            neighbor: [zero; 3],
        };
        for entry in 0..3 {
            matrices.diagonal[entry] = widened(simd, diagonal[entry]);
            matrices.neighbor[entry] = widened(simd, neighbor[entry]);
        }
        matrices
    }

    /// One of them.
    #[cold]
    pub(in crate::analysis) fn lane(&self, lane: usize) -> SymmetricMat3 {
        let [xx, yy, zz] = self.diagonal.map(|row| row[lane]);
        let [xy, yz, xz] = self.neighbor.map(|row| row[lane]);
        SymmetricMat3 { xx, xy, xz, yy, yz, zz }
    }

    /// The sums of the eigenvalues.
    #[inline(always)]
    pub(super) fn traces(&self) -> f64x4<S> {
        let [xx, yy, zz] = self.diagonal;
        xx + yy + zz
    }

    /// The sums of the products of two eigenvalues each.
    #[inline(always)]
    pub(super) fn pairwise_products(&self) -> f64x4<S> {
        let ([xx, yy, zz], [xy, yz, xz]) = (self.diagonal, self.neighbor);
        (xx * yy - xy * xy) + (xx * zz - xz * xz) + (yy * zz - yz * yz)
    }

    /// [`SymmetricMat3::smallest_eigenvector`] of each, with the same bits.
    #[inline(always)]
    pub(in crate::analysis) fn smallest_eigenvectors(&self, simd: S) -> [DVec3; FOUR] {
        let zero = f64x4::splat(simd, 0.0);
        let one = f64x4::splat(simd, 1.0);
        let ([xx, yy, zz], [xy, yz, xz]) = (self.diagonal, self.neighbor);
        let largest = xx.abs().max(xy.abs()).max(xz.abs());
        let largest = largest.max(yy.abs()).max(yz.abs()).max(zz.abs());
        let scaled = self.times(one / largest);
        let rest = scaled.minus(scaled.traces() / 3.0);

        let ([xx, yy, zz], [xy, yz, xz]) = (rest.diagonal, rest.neighbor);
        let square_sum = xx * xx + yy * yy + zz * zz + (xy * xy + xz * xz + yz * yz) * 2.0;
        let spread = (square_sum / 6.0).sqrt();
        let determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
        let r = determinant / (spread * 2.0 * spread * spread);
        let r = r.max(-one).min(one);
        let value = spread * extreme_roots(simd, r.abs()).copysign(r);
        let (mut vector, squared) = rest.minus(value).null_vectors(simd);

        let is_smallest = r.simd_lt(zero);
        if !is_smallest.all_true() {
            let in_plane = rest.smaller_across(simd, vector);
            vector = select(simd, is_smallest, vector, in_plane);
        }
        let stands_apart = spread.simd_ge(f64x4::splat(simd, 4.0 * f64::EPSILON));
        let is_answer = stands_apart & squared.simd_gt(zero);
        let [x, y, z] = vector;
        let mut vectors = [DVec3::ZERO; FOUR];
        for (lane, vector) in vectors.iter_mut().enumerate() {
            *vector = DVec3::new(x[lane], y[lane], z[lane]);
        }
        if !is_answer.all_true() {
            let answers = simd.select_f64x4(is_answer, one, zero);
            for (lane, vector) in vectors.iter_mut().enumerate() {
                if answers[lane] == 0.0 {
                    *vector = self.lane(lane).smallest_eigenvector();
                }
            }
        }
        vectors
    }

    #[inline(always)]
    fn times(&self, factor: f64x4<S>) -> Self {
        let ([xx, yy, zz], [xy, yz, xz]) = (self.diagonal, self.neighbor);
        Self {
            diagonal: [xx * factor, yy * factor, zz * factor],
            neighbor: [xy * factor, yz * factor, xz * factor],
        }
    }

    #[inline(always)]
    fn minus(&self, shift: f64x4<S>) -> Self {
        let [xx, yy, zz] = self.diagonal;
        Self {
            diagonal: [xx - shift, yy - shift, zz - shift],
            ..*self
        }
    }

    #[inline(always)]
    fn rows(&self) -> [Triples<S>; 3] {
        let ([xx, yy, zz], [xy, yz, xz]) = (self.diagonal, self.neighbor);
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    }

    /// Unit vectors orthogonal to the two most independent rows, and how independent these were.
    #[inline(always)]
    fn null_vectors(&self, simd: S) -> (Triples<S>, f64x4<S>) {
        let rows = self.rows();
        let mut best = cross(rows[0], rows[1]);
        let mut best_squared = dot(best, best);
        for candidate in [cross(rows[0], rows[2]), cross(rows[1], rows[2])] {
            let squared = dot(candidate, candidate);
            let is_better = squared.simd_gt(best_squared);
            best = select(simd, is_better, candidate, best);
            best_squared = simd.select_f64x4(is_better, squared, best_squared);
        }
        let factor = f64x4::splat(simd, 1.0) / best_squared.sqrt();
        let [x, y, z] = best;
        ([x * factor, y * factor, z * factor], best_squared)
    }

    /// The eigenvectors of the smaller of the two eigenvalues across unit eigenvectors `axis`.
    #[inline(always)]
    fn smaller_across(&self, simd: S, axis: Triples<S>) -> Triples<S> {
        let (zero, one) = (f64x4::splat(simd, 0.0), f64x4::splat(simd, 1.0));
        let [x, y, z] = axis;
        let sign = one.copysign(z);
        let a = -one / (sign + z);
        let u = [x * y * a, sign + y * y * a, -y];
        let v = cross(axis, u);
        let [x, y, z] = self.rows();
        let times_u = [dot(x, u), dot(y, u), dot(z, u)];
        let times_v = [dot(x, v), dot(y, v), dot(z, v)];
        let (uu, uv, vv) = (dot(u, times_u), dot(u, times_v), dot(v, times_v));

        let half_difference = (uu - vv) * 0.5;
        let radius = (half_difference * half_difference + uv * uv).sqrt();
        // The one of the two vectors without cancellation.
        let is_first = half_difference.simd_ge(zero);
        let a = simd.select_f64x4(is_first, radius + half_difference, uv);
        let b = simd.select_f64x4(is_first, uv, radius - half_difference);
        let length = (a * a + b * b).sqrt();
        let has_length = length.simd_gt(zero);
        let cos = simd.select_f64x4(has_length, a / length, one);
        let sin = simd.select_f64x4(has_length, b / length, zero);
        [
            -(v[0] * cos - u[0] * sin),
            -(v[1] * cos - u[1] * sin),
            -(v[2] * cos - u[2] * sin),
        ]
    }
}

/// Widens the numbers to f64.
#[inline(always)]
pub(super) fn widened<S: Simd>(simd: S, row: f32x4<S>) -> f64x4<S> {
    let row: [f32; FOUR] = row.into();
    f64x4::from_slice(simd, &row.map(f64::from))
}

/// The roots of `t³ − 3t − 2r` in [√3, 2], by the same three steps of Newton's method.
#[inline(always)]
fn extreme_roots<S: Simd>(simd: S, r: f64x4<S>) -> f64x4<S> {
    const SQRT_3: f64 = 1.732_050_807_568_877_2;
    let mut t = f64x4::splat(simd, SQRT_3) + r * (2.0 - SQRT_3);
    for _ in 0..3 {
        let square = t * t;
        t -= (t * (square - 3.0) - r * 2.0) / (square * 3.0 - 3.0);
    }
    t
}

#[inline(always)]
fn cross<S: Simd>(a: Triples<S>, b: Triples<S>) -> Triples<S> {
    [
        a[1] * b[2] - b[1] * a[2],
        a[2] * b[0] - b[2] * a[0],
        a[0] * b[1] - b[0] * a[1],
    ]
}

#[inline(always)]
fn dot<S: Simd>(a: Triples<S>, b: Triples<S>) -> f64x4<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The first where the mask is set, else the second.
#[inline(always)]
fn select<S: Simd>(simd: S, mask: mask64x4<S>, a: Triples<S>, b: Triples<S>) -> Triples<S> {
    [
        simd.select_f64x4(mask, a[0], b[0]),
        simd.select_f64x4(mask, a[1], b[1]),
        simd.select_f64x4(mask, a[2], b[2]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    #[inline(always)]
    fn vectors<S: Simd>(simd: S, entries: &[[f64; 6]; FOUR]) -> [(DVec3, DVec3); FOUR] {
        let row = |entry: usize| {
            let row: [f64; FOUR] = std::array::from_fn(|lane| entries[lane][entry]);
            f64x4::from_slice(simd, &row)
        };
        let matrices = FourMatrices {
            diagonal: [row(0), row(1), row(2)],
            neighbor: [row(3), row(4), row(5)],
        };
        let found = matrices.smallest_eigenvectors(simd);
        std::array::from_fn(|lane| (found[lane], matrices.lane(lane).smallest_eigenvector()))
    }

    proptest! {
        // Products of small integers are singular, or have equal eigenvalues, in many cases.
        #[test]
        fn four_at_once_match_one_at_a_time_bit_for_bit(
            whole in prop::array::uniform4(prop::array::uniform6(-2i8..3)),
            broken in prop::array::uniform4(prop::array::uniform6(-1.0f64..1.0)),
            share in 0u8..3,
        ) {
            let entries = std::array::from_fn(|lane| {
                std::array::from_fn(|entry| {
                    f64::from(whole[lane][entry]) + f64::from(share) * broken[lane][entry]
                })
            });
            let pairs = dispatch!(Level::new(), simd => vectors(simd, &entries));
            for (found, expected) in pairs {
                prop_assert_eq!(found, expected);
            }
        }
    }

    #[test]
    fn zero_and_isotropic_matrices_have_a_unit_vector() {
        let entries = [
            [0.0; 6],
            [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
            [3.0, 2.0, 1.0, 0.0, 0.0, 0.0],
            [1e-300, 0.0, 0.0, 0.0, 0.0, 0.0],
        ];
        let pairs = dispatch!(Level::new(), simd => vectors(simd, &entries));
        for (found, expected) in pairs {
            assert_eq!(found, expected);
            assert!(found.is_normalized());
        }
        assert_eq!(pairs[2].0.abs(), DVec3::Z);
    }
}
