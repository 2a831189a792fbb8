//! Along which directions Voronoi cells are measured.

/// Directions in the tangent plane along which a cell is measured.
// 24 instead of 32 save only 5 % of the time for the radii.
pub(super) const DIRECTIONS: usize = 32;

/// Directions in one quarter of the circle, both ends included. Those in the others are their opposites, along which
/// everything is as long with the opposite sign, and their mirror images, along which the products are the same.
pub(super) const QUARTER: usize = DIRECTIONS / 4 + 1;

/// Cosines and sines of the evenly spaced directions of one quarter.
pub(super) fn quarter_circle() -> [[f32; 2]; QUARTER] {
    std::array::from_fn(|direction| {
        let turn = direction as f64 / DIRECTIONS as f64;
        let (sine, cosine) = (turn * std::f64::consts::TAU).sin_cos();
        [cosine as f32, sine as f32]
    })
}
