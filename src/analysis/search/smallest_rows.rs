//! The k smallest numbers in each lane of a stream of rows.
//!
//! How it works: a row is sunk into the k ascending registers by a smaller and a larger each, without branches, for
//! eight lanes at a time. Eight rows at once are cheaper: a network of 19 exchanges puts them in order, the smaller
//! ones of mirrored places are the smallest of both, and 20 exchanges (32 of sixteen registers) merge them, instead of
//! the 96 (128) that sinking takes.

use super::point_tree::{LANES, LaneRow};
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8};

/// Registers that rows are merged into at a time; with some registers for the merged rows they fit the sixteen of AVX.
const TOGETHER: usize = 12;

/// Registers for a k between [`TOGETHER`] and this: spilling beyond AVX costs less than a second group.
const MORE_TOGETHER: usize = 16;

/// The k smallest numbers of each lane.
#[derive(Debug)]
pub(super) struct SmallestRows {
    k: usize,
    /// Ascending in each lane; some more than k, to fill up whole groups.
    rows: Vec<LaneRow>,
}

impl SmallestRows {
    pub(in crate::analysis) fn new(k: usize) -> Self {
        let count = if (TOGETHER + 1..=MORE_TOGETHER).contains(&k) {
            MORE_TOGETHER
        } else {
            k.next_multiple_of(TOGETHER)
        };
        Self {
            k,
            rows: vec![[f32::INFINITY; LANES]; count],
        }
    }

    /// Clears the results: from now on only numbers below `limit` count.
    pub(super) fn reset(&mut self, limit: LaneRow) {
        self.rows.fill(limit);
    }

    /// The k-th smallest numbers so far. Precondition: k is not 0.
    pub(in crate::analysis) fn largest(&self) -> &LaneRow {
        &self.rows[self.k - 1]
    }

    /// Takes the first `count` of eight rows into account.
    #[inline(always)]
    pub(super) fn offer<S: Simd>(&mut self, simd: S, rows: &[LaneRow; LANES], count: usize) {
        if let Ok(group) = <&mut [LaneRow; TOGETHER]>::try_from(self.rows.as_mut_slice()) {
            merge_or_sink(simd, group, rows, count);
        } else if let Ok(group) = <&mut [LaneRow; MORE_TOGETHER]>::try_from(self.rows.as_mut_slice()) {
            merge_or_sink(simd, group, rows, count);
        } else {
            let mut sinking = *rows;
            let (groups, _) = self.rows.as_chunks_mut::<TOGETHER>();
            for group in groups {
                let rows = sinking;
                sink(simd, group, &rows[..count], |place, below| {
                    below.store_slice(&mut sinking[place]);
                });
            }
        }
    }
}

/// Puts the smallest of both, the first `count` of `rows`, into the ascending registers of `group`.
#[inline(always)]
fn merge_or_sink<S: Simd, const N: usize>(simd: S, group: &mut [LaneRow; N], rows: &[LaneRow; LANES], count: usize) {
    // Merging four to seven rows, padded with infinities, instead of sinking them one at a time made no difference.
    if count == LANES {
        merge(simd, group, rows);
    } else {
        sink(simd, group, &rows[..count], |_, _| ());
    }
}

/// Puts `rows` where they belong in the ascending registers of `group`; rows pushed out go to `below`.
#[inline(always)]
fn sink<S: Simd, const N: usize>(
    simd: S,
    group: &mut [LaneRow; N],
    rows: &[LaneRow],
    mut below: impl FnMut(usize, f32x8<S>),
) {
    let mut registers = [f32x8::splat(simd, 0.0); N];
    for (register, row) in registers.iter_mut().zip(&*group) {
        *register = f32x8::from_slice(simd, row);
    }
    for (place, row) in rows.iter().enumerate() {
        let mut sinking = f32x8::from_slice(simd, row);
        for here in &mut registers {
            let larger = here.max(sinking);
            *here = here.min(sinking);
            sinking = larger;
        }
        below(place, sinking);
    }
    for (row, register) in group.iter_mut().zip(registers) {
        register.store_slice(row);
    }
}

/// Puts the smallest of both into the ascending registers of `group`: the eight rows are sorted by a network, and
/// merged bitonically.
#[inline(always)]
fn merge<S: Simd, const N: usize>(simd: S, group: &mut [LaneRow; N], rows: &[LaneRow; LANES]) {
    let mut sorted = [f32x8::splat(simd, 0.0); LANES];
    for (register, row) in sorted.iter_mut().zip(rows) {
        *register = f32x8::from_slice(simd, row);
    }
    sort_eight(&mut sorted);
    let mut registers = [f32x8::splat(simd, 0.0); N];
    for (register, row) in registers.iter_mut().zip(&*group) {
        *register = f32x8::from_slice(simd, row);
    }
    // The smallest of both, ascending and then descending: a bitonic sequence, which the network sorts.
    for (register, candidate) in registers.iter_mut().rev().zip(sorted) {
        *register = register.min(candidate);
    }
    if N == TOGETHER {
        sort_bitonic_twelve(&mut registers);
    } else {
        sort_bitonic_sixteen(&mut registers);
    }
    for (row, register) in group.iter_mut().zip(registers) {
        register.store_slice(row);
    }
}

/// Batcher's odd-even network.
#[inline(always)]
fn sort_eight<S: Simd>(registers: &mut [f32x8<S>; 8]) {
    let mut exchange = |low, high| exchange(registers, low, high);
    exchange(0, 1);
    exchange(2, 3);
    exchange(4, 5);
    exchange(6, 7);
    exchange(0, 2);
    exchange(1, 3);
    exchange(4, 6);
    exchange(5, 7);
    exchange(1, 2);
    exchange(5, 6);
    exchange(0, 4);
    exchange(1, 5);
    exchange(2, 6);
    exchange(3, 7);
    exchange(2, 4);
    exchange(3, 5);
    exchange(1, 2);
    exchange(3, 4);
    exchange(5, 6);
}

/// The bitonic network of sixteen, without the lowest four.
#[inline(always)]
fn sort_bitonic_twelve<S: Simd>(registers: &mut [f32x8<S>]) {
    exchange_fours(registers, 0, 8);
    exchange_fours(registers, 4, 8);
    sort_bitonic_four(registers, 0);
    sort_bitonic_four(registers, 4);
    sort_bitonic_four(registers, 8);
}

/// The bitonic network of sixteen.
#[inline(always)]
fn sort_bitonic_sixteen<S: Simd>(registers: &mut [f32x8<S>]) {
    exchange_fours(registers, 0, 8);
    exchange_fours(registers, 4, 12);
    exchange_fours(registers, 0, 4);
    exchange_fours(registers, 8, 12);
    sort_bitonic_four(registers, 0);
    sort_bitonic_four(registers, 4);
    sort_bitonic_four(registers, 8);
    sort_bitonic_four(registers, 12);
}

/// Exchanges four registers from `low` on with four from `high` on. Written out, like all here: loops are not unrolled.
#[inline(always)]
// Networks written as loops were twice as slow.
fn exchange_fours<S: Simd>(registers: &mut [f32x8<S>], low: usize, high: usize) {
    exchange(registers, low, high);
    exchange(registers, low + 1, high + 1);
    exchange(registers, low + 2, high + 2);
    exchange(registers, low + 3, high + 3);
}

/// The bitonic network of the four registers from `first` on.
#[inline(always)]
fn sort_bitonic_four<S: Simd>(registers: &mut [f32x8<S>], first: usize) {
    exchange(registers, first, first + 2);
    exchange(registers, first + 1, first + 3);
    exchange(registers, first, first + 1);
    exchange(registers, first + 2, first + 3);
}

/// Leaves the smaller of two in the first place.
#[inline(always)]
fn exchange<S: Simd>(registers: &mut [f32x8<S>], low: usize, high: usize) {
    let (a, b) = (registers[low], registers[high]);
    registers[low] = a.min(b);
    registers[high] = a.max(b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    /// Expected contents of a lane: the numbers sorted, filled up with the limit.
    fn smallest(numbers: impl Iterator<Item = f32>, limit: f32, k: usize) -> f32 {
        let mut sorted: Vec<f32> = numbers.map(|number| number.min(limit)).collect();
        sorted.sort_by(f32::total_cmp);
        sorted.get(k - 1).copied().unwrap_or(limit)
    }

    proptest! {
        // Few distinct numbers, so that many are equal; whole groups of eight and partial ones.
        #[test]
        fn the_kth_smallest_matches_a_sort_for_any_rows(
            offers in prop::collection::vec((prop::array::uniform8(prop::array::uniform8(0u8..40)), 1..=LANES), 0..8),
            limit in 1u8..60,
            k in 1usize..30,
        ) {
            let mut found = SmallestRows::new(k);
            found.reset([f32::from(limit); LANES]);
            let level = Level::new();
            let mut offered: Vec<LaneRow> = Vec::new();
            for (rows, count) in offers {
                let rows = rows.map(|row| row.map(f32::from));
                dispatch!(level, simd => found.offer(simd, &rows, count));
                offered.extend(&rows[..count]);
                for lane in 0..LANES {
                    let expected = smallest(offered.iter().map(|row| row[lane]), f32::from(limit), k);
                    prop_assert_eq!(found.largest()[lane], expected);
                }
            }
        }
    }
}
