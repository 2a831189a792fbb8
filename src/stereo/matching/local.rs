//! The local winner: costs summed over a square around each pixel. Fast, and only as good as the content of its square.
//!
//! Sums of columns are carried from line to line and sums of squares from pixel to pixel, one line added and one taken
//! away, so the time does not depend on the size of the square. Beyond the border, border costs are repeated, so that
//! all squares weigh the same and left and right can be compared. It wins for small images in a hurry: 128 × 128 pixels
//! take a few milliseconds. Elsewhere semi-global matching fills the gaps it leaves, and has cleaner borders.

use super::constants::MAX_RADIUS;
use super::costs::{Costs, MAX_COST};
use crate::stereo::StereoError;
use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

/// Lines of a task.
const LINES: usize = 16;

/// Maximum bytes of a line of costs.
const MAX_LINE_BYTES: usize = 64 << 20;

const _: () = assert!((2 * MAX_RADIUS + 1).pow(2) * MAX_COST as usize <= u16::MAX as usize);

/// Sums costs over squares of 2 `radius` + 1 pixels and writes the result of `winners` for the sums of each line to the
/// line of `out`. A radius above [`MAX_RADIUS`] is taken as that.
///
/// # Errors
/// [`StereoError::TooLarge`].
pub(in crate::stereo) fn local<T: Send>(
    costs: &impl Costs,
    radius: usize,
    out: &mut [T],
    winners: impl Fn(&mut [u16], &mut [T]) + Sync,
) -> Result<(), StereoError> {
    let radius = radius.min(MAX_RADIUS);
    let [width, height] = costs.size();
    let line = width * costs.count();
    if line > MAX_LINE_BYTES {
        let bytes = |line: usize| ((line * (LINES + 2 * radius + 4)) as u64) >> 20;
        return Err(StereoError::TooLarge {
            needed_mib: bytes(line),
            max_mib: bytes(MAX_LINE_BYTES),
        });
    }
    out.par_chunks_mut(LINES * width).enumerate().for_each(|(task, out)| {
        let from = task * LINES;
        let to = from + out.len() / width;
        let first = from.saturating_sub(radius);
        let last = (to + radius).min(height);
        let mut pixel_costs = vec![0; (last - first) * line];
        costs.fill(first..last, &mut pixel_costs);
        let row = |y: usize| {
            let at = (y.saturating_sub(radius).min(height - 1) - first) * line;
            &pixel_costs[at..at + line]
        };
        // Line y of the image is at y + radius here, so that indices of lines before the first one are not negative.
        let mut columns = vec![0_u16; line];
        for y in from..from + 2 * radius {
            dispatch!(Level::new(), _simd => add(&mut columns, row(y)));
        }
        let mut sums = vec![0_u16; line];
        for (y, out) in (from..to).zip(out.chunks_exact_mut(width)) {
            dispatch!(Level::new(), _simd => {
                add(&mut columns, row(y + 2 * radius));
                sum_along(&columns, width, radius, &mut sums);
                subtract(&mut columns, row(y));
            });
            winners(&mut sums, out);
        }
    });
    Ok(())
}

#[inline(always)]
fn add(columns: &mut [u16], costs: &[u8]) {
    for (sum, &cost) in columns.iter_mut().zip(costs) {
        *sum += u16::from(cost);
    }
}

#[inline(always)]
fn subtract(columns: &mut [u16], costs: &[u8]) {
    for (sum, &cost) in columns.iter_mut().zip(costs) {
        *sum -= u16::from(cost);
    }
}

#[inline(always)]
fn sum_along(columns: &[u16], width: usize, radius: usize, sums: &mut [u16]) {
    let count = columns.len() / width;
    let column = |x: usize| {
        let at = x.saturating_sub(radius).min(width - 1) * count;
        &columns[at..at + count]
    };
    let mut running = vec![0_u16; count];
    for x in 0..2 * radius {
        for (sum, &column) in running.iter_mut().zip(column(x)) {
            *sum += column;
        }
    }
    for (x, sums) in sums.chunks_exact_mut(count).enumerate() {
        let (new, old) = (column(x + 2 * radius), column(x));
        for (((sum, running), &new), &old) in sums.iter_mut().zip(&mut running).zip(new).zip(old) {
            let whole = *running + new;
            *sum = whole;
            *running = whole - old;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stereo::matching::costs::Volume;

    #[test]
    fn sums_match_all_pixels_of_the_window() {
        for ([width, height], radius) in [([1, 1], 2), ([5, 40], 1), ([23, 19], 3), ([4, 3], 15), ([6, 6], 0)] {
            let volume = Volume::random([width, height], 32, 5);
            let mut found = vec![Vec::new(); width * height];
            local(&volume, radius, &mut found, |sums, out| {
                for (out, sums) in out.iter_mut().zip(sums.chunks_exact(32)) {
                    *out = sums.to_vec();
                }
            })
            .unwrap();
            let inside = |at: i64, count: usize| at.clamp(0, count as i64 - 1) as usize;
            let reach = radius as i64;
            for (at, found) in found.iter().enumerate() {
                let (x, y) = ((at % width) as i64, (at / width) as i64);
                for (label, &found) in found.iter().enumerate() {
                    let mut sum = 0;
                    for dy in -reach..=reach {
                        for dx in -reach..=reach {
                            let place = inside(y + dy, height) * width + inside(x + dx, width);
                            sum += u16::from(volume.costs[place * 32 + label]);
                        }
                    }
                    assert_eq!(found, sum, "{x}, {y}, {label} of {width} × {height}, radius {radius}");
                }
            }
        }
    }
}
