//! Covariance of ellipses in a plane, and the ellipse equivalent to it: the shape of nodes if points are ellipses.

use crate::cloud::{Ellipse, ShapeRecord, decode_ellipse, encode_ellipse, oct_decode, oct_encode};
use glam::{DVec3, Vec3};

/// Both half axes of a point's ellipse; of a circle any two.
pub(super) fn half_axes(shape: &ShapeRecord) -> [Vec3; 2] {
    let normal = oct_decode(shape.normal);
    let ellipse = decode_ellipse(shape.normal, shape.ellipse);
    if ellipse == Ellipse::CIRCLE {
        return <[Vec3; 2]>::from(normal.any_orthonormal_pair()).map(|axis| axis * shape.radius);
    }
    let [longer, shorter] = ellipse.half_axes_of_quadratic_mean(shape.radius);
    [ellipse.axis * longer, normal.cross(ellipse.axis) * shorter]
}

/// Variance of an evenly filled ellipse along a half axis, divided by the square of that half axis.
pub(super) const OF_HALF_AXIS: f64 = 0.25;

/// Accumulated covariance in the plane perpendicular to a normal.
pub(super) struct PlaneMoments {
    normal: Vec3,
    tangent: Vec3,
    bitangent: Vec3,
    /// Sums of x², xy and y² along these; in f64, as sums over many points are.
    sums: DVec3,
}

impl PlaneMoments {
    pub(super) fn across(normal: Vec3) -> Self {
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        Self {
            normal,
            tangent,
            bitangent,
            sums: DVec3::ZERO,
        }
    }

    /// Two unit vectors across the normal.
    pub(super) fn axes(&self) -> [Vec3; 2] {
        [self.tangent, self.bitangent]
    }

    pub(super) fn add(&mut self, along: Vec3, weight: f64) {
        let [x, y] = self.axes().map(|axis| f64::from(axis.dot(along)));
        self.add_products(weight * DVec3::new(x * x, x * y, y * y));
    }

    /// Adds the products x², xy and y² along the axes.
    pub(super) fn add_products(&mut self, products: DVec3) {
        self.sums += products;
    }

    /// Returns the packed ellipse with this covariance.
    pub(super) fn packed_ellipse(&self) -> u32 {
        let [xx, xy, yy] = self.sums.to_array();
        let (mean, half_difference) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let spread = half_difference.hypot(xy);
        if spread == 0.0 {
            return 0;
        }
        let ratio = ((mean - spread).max(0.0) / (mean + spread)).sqrt() as f32;
        let angle = 0.5 * xy.atan2(half_difference);
        let axis = self.tangent * angle.cos() as f32 + self.bitangent * angle.sin() as f32;
        encode_ellipse(oct_encode(self.normal), Ellipse { axis, ratio })
    }
}
