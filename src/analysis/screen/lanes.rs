//! Eight floats side by side.

use fearless_simd::{Simd, f32x8};

/// SIMD width.
pub(super) const LANES: usize = 8;

/// Their sum, in an order that all machines have.
#[inline(always)]
pub(super) fn total<S: Simd>(simd: S, lanes: f32x8<S>) -> f32 {
    let (low, high) = simd.split_f32x8(lanes);
    let [a, b, c, d]: [f32; LANES / 2] = (low + high).into();
    (a + c) + (b + d)
}
