//! A step of paths from pixel to pixel, 32 disparities at a time.
//!
//! Of each path, only its costs less their previous minimum are stored, which fit a byte: Lᵣ(p, d) = C(p, d) +
//! min(Lᵣ(q, d), Lᵣ(q, d ± 1) + P1, min Lᵣ(q, ·) + P2) − min Lᵣ(q, ·) ≤ 62 + P2.

use crate::stereo::matching::costs::LANES;
use fearless_simd::{Simd, SimdBase, SimdInt, u8x32, u16x16};

/// Costs of a path at one pixel are stored between two that are never chosen.
pub(super) const BORDERS: usize = 2;

/// State of a path at the previous pixel.
#[derive(Clone, Copy)]
pub(super) struct Before<'a> {
    /// Costs at the pixel before, with [`BORDERS`].
    pub(super) costs: &'a [u8],
    /// Their smallest.
    pub(super) min: u8,
    pub(super) p2: u8,
}

/// Takes `N` paths that meet at a pixel one step on, and adds them to `sums` if `IS_SUMMED`. Returns the smallest cost
/// of each. Preconditions: `pixel` has a multiple of 32 costs, `sums` the same number if they are wanted, all others
/// two more.
#[inline(always)]
pub(super) fn step<S: Simd, const N: usize, const IS_SUMMED: bool>(
    simd: S,
    pixel: &[u8],
    p1: u8,
    before: [Before<'_>; N],
    after: &mut [&mut [u8]; N],
    sums: &mut [u16],
) -> [u8; N] {
    let p1 = u8x32::splat(simd, p1);
    let min = before.map(|path| u8x32::splat(simd, path.min));
    let jump = before.map(|path| u8x32::splat(simd, path.min + path.p2));
    let mut min_after = [u8x32::splat(simd, u8::MAX); N];
    for at in (0..pixel.len()).step_by(LANES) {
        let cost = u8x32::from_slice(simd, &pixel[at..at + LANES]);
        let mut sum = [u16x16::splat(simd, 0); 2];
        for path in 0..N {
            let costs = &before[path].costs[at..at + LANES + BORDERS];
            let below = u8x32::from_slice(simd, &costs[..LANES]);
            let same = u8x32::from_slice(simd, &costs[1..=LANES]);
            let above = u8x32::from_slice(simd, &costs[2..]);
            let near = below.min(above) + p1;
            let best = same.min(near).min(jump[path]);
            let cost = cost + best - min[path];
            cost.store_slice(&mut after[path][at + 1..=at + LANES]);
            min_after[path] = min_after[path].min(cost);
            if IS_SUMMED {
                let (low, high) = simd.split_u8x32(cost);
                sum = [sum[0] + simd.widen_u8x16(low), sum[1] + simd.widen_u8x16(high)];
            }
        }
        if IS_SUMMED {
            let sums = &mut sums[at..at + LANES];
            let (low, high) = sums.split_at_mut(LANES / 2);
            (u16x16::from_slice(simd, low) + sum[0]).store_slice(low);
            (u16x16::from_slice(simd, high) + sum[1]).store_slice(high);
        }
    }
    min_after.map(|min| smallest(simd, min))
}

#[inline(always)]
fn smallest<S: Simd>(simd: S, lanes: u8x32<S>) -> u8 {
    let (low, high) = simd.split_u8x32(lanes);
    let sixteen = low.min(high);
    let mut min = u8::MAX;
    for &lane in sixteen.as_slice() {
        min = min.min(lane);
    }
    min
}
