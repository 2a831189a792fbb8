//! Eigenvalues and eigenvectors of symmetric 3×3 matrices, in f64, without iteration over the matrix.
//!
//! How it works (after Eberly, "A Robust Eigensolver for 3×3 Symmetric Matrices", 2014): the matrix is scaled by its
//! largest entry and split into its mean eigenvalue `q` and the rest, `A = q·1 + p·B`, where the eigenvalues of `B` are
//! the roots of `t³ − 3t − 2r = 0` with `r = det(B)/2` in [−1, 1]. Of the three roots the one of the sign of `r` has
//! magnitude in [√3, 2] and is at least √3 away from both others, even when those two coincide. That eigenvalue and its
//! vector (the largest cross product of two rows of `A − λ·1`) are therefore always exact to rounding. The two others
//! live in the plane orthogonal to it, where a 2×2 problem remains that one square root solves.
//!
//! The cubic is solved by Newton's method instead of `acos` and `cos`: from the secant between its known ends it needs
//! three steps, and, made only of the basic operations that IEEE 754 rounds exactly, gives the same bits on every
//! machine.
//!
//! Degenerate matrices have a defined answer: coinciding eigenvalues get some orthonormal basis of their space, a
//! multiple of the identity the axes x, y, z. Matrices with entries that are not finite are treated as zero.

use glam::DVec3;

/// A symmetric 3×3 matrix by its six entries.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SymmetricMat3 {
    /// Row x, column x.
    pub xx: f64,
    /// Row x, column y.
    pub xy: f64,
    /// Row x, column z.
    pub xz: f64,
    /// Row y, column y.
    pub yy: f64,
    /// Row y, column z.
    pub yz: f64,
    /// Row z, column z.
    pub zz: f64,
}

/// Eigenvalues in ascending order with their orthonormal eigenvectors (a right-handed basis).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymmetricEigen {
    /// Eigenvalues, smallest first.
    pub values: [f64; 3],
    /// `vectors[i]` is a unit vector that belongs to `values[i]`.
    pub vectors: [DVec3; 3],
}

/// The eigenpair farthest from the two others, of the matrix `scale · (mean · 1 + rest)`.
struct Apart {
    scale: f64,
    mean: f64,
    rest: SymmetricMat3,
    /// Eigenvalue of `rest`.
    value: f64,
    vector: DVec3,
    is_smallest: bool,
}

impl SymmetricMat3 {
    /// Solves for all eigenvalues and eigenvectors.
    pub fn eigen(&self) -> SymmetricEigen {
        let apart = match self.stand_apart() {
            Ok(apart) => apart,
            Err(value) => {
                return SymmetricEigen {
                    values: [value; 3],
                    vectors: DVec3::AXES,
                };
            }
        };
        let (low, low_vector, high, high_vector) = apart.rest.eigen_in_plane(apart.vector);
        let (values, vectors) = if apart.is_smallest {
            ([apart.value, low, high], [apart.vector, low_vector, high_vector])
        } else {
            ([low, high, apart.value], [low_vector, high_vector, apart.vector])
        };
        SymmetricEigen {
            values: values.map(|value| (apart.mean + value) * apart.scale),
            vectors,
        }
    }

    /// `eigen().vectors[0]`, in less time where the smallest eigenvalue is the isolated one (on surfaces).
    pub fn smallest_eigenvector(&self) -> DVec3 {
        match self.stand_apart() {
            Err(_) => DVec3::X,
            Ok(apart) if apart.is_smallest => apart.vector,
            Ok(apart) => apart.rest.eigen_in_plane(apart.vector).1,
        }
    }

    /// Finds the isolated eigenpair; for a multiple of the identity, the factor.
    fn stand_apart(&self) -> Result<Apart, f64> {
        let scale = self.largest_entry();
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(0.0);
        }
        let scaled = self.scaled(1.0 / scale);
        let mean = (scaled.xx + scaled.yy + scaled.zz) / 3.0;
        let rest = scaled.shifted(-mean);
        let spread = (rest.square_sum() / 6.0).sqrt();
        // Below this the remainder is the rounding of the entries.
        if spread < 4.0 * f64::EPSILON {
            return Err(mean * scale);
        }
        let r = (rest.determinant() / (2.0 * spread * spread * spread)).clamp(-1.0, 1.0);
        let value = spread * extreme_root(r.abs()).copysign(r);
        Ok(Apart {
            scale,
            mean,
            value,
            vector: rest.shifted(-value).null_vector(),
            is_smallest: r < 0.0,
            rest,
        })
    }

    fn largest_entry(&self) -> f64 {
        // A sum propagates NaN, unlike f64::max.
        let [xx, xy, xz, yy, yz, zz] = self.entries().map(f64::abs);
        if (xx + xy + xz + yy + yz + zz).is_nan() {
            return f64::NAN;
        }
        xx.max(xy).max(xz).max(yy).max(yz).max(zz)
    }

    fn entries(&self) -> [f64; 6] {
        [self.xx, self.xy, self.xz, self.yy, self.yz, self.zz]
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            xx: self.xx * factor,
            xy: self.xy * factor,
            xz: self.xz * factor,
            yy: self.yy * factor,
            yz: self.yz * factor,
            zz: self.zz * factor,
        }
    }

    /// `self + shift · 1`.
    fn shifted(&self, shift: f64) -> Self {
        Self {
            xx: self.xx + shift,
            yy: self.yy + shift,
            zz: self.zz + shift,
            ..*self
        }
    }

    /// Sum of the squares of all nine entries.
    fn square_sum(&self) -> f64 {
        self.xx * self.xx
            + self.yy * self.yy
            + self.zz * self.zz
            + 2.0 * (self.xy * self.xy + self.xz * self.xz + self.yz * self.yz)
    }

    fn determinant(&self) -> f64 {
        self.xx * (self.yy * self.zz - self.yz * self.yz) - self.xy * (self.xy * self.zz - self.yz * self.xz)
            + self.xz * (self.xy * self.yz - self.yy * self.xz)
    }

    fn rows(&self) -> [DVec3; 3] {
        [
            DVec3::new(self.xx, self.xy, self.xz),
            DVec3::new(self.xy, self.yy, self.yz),
            DVec3::new(self.xz, self.yz, self.zz),
        ]
    }

    /// A unit vector that this matrix of rank 2 maps to zero: orthogonal to its two most independent rows.
    fn null_vector(&self) -> DVec3 {
        let [x, y, z] = self.rows();
        let mut best = x.cross(y);
        for candidate in [x.cross(z), y.cross(z)] {
            if candidate.length_squared() > best.length_squared() {
                best = candidate;
            }
        }
        best.normalize_or(DVec3::X)
    }

    /// The two eigenpairs orthogonal to the unit eigenvector `axis`, the smaller first; `low × high` is `axis`.
    fn eigen_in_plane(&self, axis: DVec3) -> (f64, DVec3, f64, DVec3) {
        let u = axis.any_orthonormal_vector();
        let v = axis.cross(u);
        let [x, y, z] = self.rows();
        let times_u = DVec3::new(x.dot(u), y.dot(u), z.dot(u));
        let times_v = DVec3::new(x.dot(v), y.dot(v), z.dot(v));
        let (uu, uv, vv) = (u.dot(times_u), u.dot(times_v), v.dot(times_v));

        let mean = 0.5 * (uu + vv);
        let half_difference = 0.5 * (uu - vv);
        let radius = (half_difference * half_difference + uv * uv).sqrt();
        // The vector of `mean + radius` is (uv, radius - half_difference) or (radius + half_difference, uv):
        // the one without cancellation.
        let (a, b) = if half_difference >= 0.0 {
            (radius + half_difference, uv)
        } else {
            (uv, radius - half_difference)
        };
        let length = (a * a + b * b).sqrt();
        let (cos, sin) = if length > 0.0 {
            (a / length, b / length)
        } else {
            (1.0, 0.0)
        };
        let high = u * cos + v * sin;
        let low = v * cos - u * sin;
        (mean - radius, -low, mean + radius, high)
    }
}

/// The root of `t³ − 3t − 2r` in [√3, 2], for `r` in [0, 1].
fn extreme_root(r: f64) -> f64 {
    const SQRT_3: f64 = 1.732_050_807_568_877_2;
    let mut t = SQRT_3 + (2.0 - SQRT_3) * r;
    for _ in 0..3 {
        let square = t * t;
        t -= (t * (square - 3.0) - 2.0 * r) / (3.0 * square - 3.0);
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn from_diagonal(values: [f64; 3]) -> SymmetricMat3 {
        SymmetricMat3 {
            xx: values[0],
            yy: values[1],
            zz: values[2],
            ..SymmetricMat3::default()
        }
    }

    /// `Σ value · vector · vectorᵀ`.
    fn compose(values: [f64; 3], vectors: [DVec3; 3]) -> SymmetricMat3 {
        let sum = |f: fn(DVec3) -> f64| (0..3).map(|i| values[i] * f(vectors[i])).sum();
        SymmetricMat3 {
            xx: sum(|v| v.x * v.x),
            xy: sum(|v| v.x * v.y),
            xz: sum(|v| v.x * v.z),
            yy: sum(|v| v.y * v.y),
            yz: sum(|v| v.y * v.z),
            zz: sum(|v| v.z * v.z),
        }
    }

    /// Ascending, orthonormal, right-handed, and composing to the matrix again, each to `tolerance` of its size.
    fn check(matrix: &SymmetricMat3, tolerance: f64) {
        let SymmetricEigen { values, vectors } = matrix.eigen();
        let size = matrix.largest_entry().max(f64::MIN_POSITIVE);
        assert!(values[0] <= values[1] && values[1] <= values[2], "{values:?}");
        for i in 0..3 {
            assert!((vectors[i].length() - 1.0).abs() < tolerance);
            assert!(vectors[i].dot(vectors[(i + 1) % 3]).abs() < tolerance);
        }
        assert!(vectors[0].cross(vectors[1]).dot(vectors[2]) > 0.0);
        assert_eq!(matrix.smallest_eigenvector(), vectors[0]);
        let again = compose(values, vectors);
        for (found, expected) in again.entries().iter().zip(matrix.entries()) {
            assert!((found - expected).abs() <= tolerance * size, "{again:?} for {matrix:?}");
        }
    }

    #[test]
    fn known_matrices() {
        let eigen = from_diagonal([3.0, 1.0, 2.0]).eigen();
        for (found, expected) in eigen.values.into_iter().zip([1.0, 2.0, 3.0]) {
            assert!((found - expected).abs() < 1e-15);
        }
        assert!(eigen.vectors[0].abs().abs_diff_eq(DVec3::Y, 1e-15));

        // [[2,-1,0],[-1,2,-1],[0,-1,2]]: 2 - √2, 2, 2 + √2.
        let chain = SymmetricMat3 {
            xx: 2.0,
            xy: -1.0,
            xz: 0.0,
            yy: 2.0,
            yz: -1.0,
            zz: 2.0,
        };
        let root = 2f64.sqrt();
        for (found, expected) in chain.eigen().values.into_iter().zip([2.0 - root, 2.0, 2.0 + root]) {
            assert!((found - expected).abs() < 1e-14, "{found} for {expected}");
        }
    }

    #[test]
    fn degenerate_matrices_have_a_basis() {
        let line = DVec3::new(1.0, -2.0, 0.5).normalize();
        let other = line.any_orthonormal_vector();
        let normal = line.cross(other);
        for values in [
            [0.0, 0.0, 0.0],
            [1.0, 1.0, 1.0],
            [0.0, 0.0, 5.0],
            [0.0, 5.0, 5.0],
            [-1.0, -1.0, 4.0],
            [1.0, 1.0 + 1e-15, 1.0 + 2e-15],
            [0.0, 1e-20, 1.0],
        ] {
            check(&from_diagonal(values), 1e-14);
            check(&compose(values, [normal, other, line]), 1e-14);
        }
    }

    #[test]
    fn entries_that_are_not_finite_count_as_zero() {
        for bad in [f64::NAN, f64::INFINITY] {
            let eigen = SymmetricMat3 {
                xy: bad,
                ..from_diagonal([1.0; 3])
            }
            .eigen();
            assert_eq!(eigen.values, [0.0; 3]);
            assert_eq!(eigen.vectors, DVec3::AXES);
        }
    }

    proptest! {
        #[test]
        fn eigen_decompositions_recompose(entries in prop::array::uniform6(-1.0f64..1.0), exponent in -150i32..150) {
            let [xx, xy, xz, yy, yz, zz] = entries;
            check(&SymmetricMat3 { xx, xy, xz, yy, yz, zz }.scaled(10f64.powi(exponent)), 1e-13);
        }

        #[test]
        fn the_normal_of_a_pancake_is_exact(x in -1.0f64..1.0, y in -1.0f64..1.0, z in -1.0f64..1.0,
            flat in 0.0f64..0.1, wide in 0.5f64..1.0) {
            let direction = DVec3::new(x, y, z);
            prop_assume!(direction.length() > 1e-3);
            let normal = direction.normalize();
            let u = normal.any_orthonormal_vector();
            let eigen = compose([flat, wide, 1.0], [normal, u, normal.cross(u)]).eigen();
            prop_assert!(eigen.vectors[0].cross(normal).length() < 1e-13);
        }
    }
}
