//! The two paths along a line.

use super::penalties::Table;
use super::step::{BORDERS, Before, step};
use fearless_simd::{Level, Simd, dispatch};

/// Writes the sums of both paths. Preconditions: `costs` and `sums` have the same number of labels for each pixel of
/// `brightness`.
pub(super) fn sum(brightness: &[u8], table: &Table, costs: &[u8], sums: &mut [u16]) {
    let count = costs.len() / brightness.len();
    sums.fill(0);
    dispatch!(Level::new(), simd => {
        go(simd, 0..brightness.len(), brightness, table, count, costs, sums);
        go(simd, (0..brightness.len()).rev(), brightness, table, count, costs, sums);
    });
}

#[inline(always)]
fn go<S: Simd>(
    simd: S,
    columns: impl Iterator<Item = usize>,
    brightness: &[u8],
    table: &Table,
    count: usize,
    costs: &[u8],
    sums: &mut [u16],
) {
    // No path leads to the first pixel: costs of 0 add nothing.
    let mut before = vec![0; count + BORDERS];
    let mut after = vec![u8::MAX - table.p1; count + BORDERS];
    let mut min = 0;
    let mut last = None;
    for x in columns {
        let p2 = last.map_or(0, |last: usize| table.p2(brightness[last], brightness[x]));
        let path = Before {
            costs: &before,
            min,
            p2,
        };
        let labels = x * count..(x + 1) * count;
        let costs = &costs[labels.clone()];
        [min] = step::<_, 1, true>(simd, costs, table.p1, [path], &mut [&mut after], &mut sums[labels]);
        std::mem::swap(&mut before, &mut after);
        if last.is_none() {
            after.fill(u8::MAX - table.p1);
        }
        last = Some(x);
    }
}
