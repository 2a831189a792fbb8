//! Sums of colours over runs of points, read off two running sums.

use rayon::prelude::*;

/// Red, green and blue in one number, a field of 21 bits each (blue has one more).
///
/// Sums of it are taken modulo 2⁶⁴, where carries from field to field, and out of the last, do no harm: the difference
/// of two sums is right in every field as long as it has no more than [`MAX_SUMMED`] colours.
pub(super) type ColorSum = u64;

const FIELD_BITS: u32 = 21;

/// The sums of this many colours fit a field.
pub(super) const MAX_SUMMED: u32 = 1 << 13;

/// Colours whose sums are made together: few, so that registers and the first cache hold them until they are in their
/// place.
const SUM_BLOCK: usize = 64;

/// Such blocks that are worth handing to another thread.
const BLOCKS_PER_TASK: usize = 256;

/// Colours summed before each of the points and after the last. One more than there are points.
pub(super) fn running_sums(colors: &[[u8; 4]]) -> Vec<ColorSum> {
    let (blocks, rest) = colors.as_chunks::<SUM_BLOCK>();
    // Summing colours in parts and propagating them upwards afterwards was slower on one thread.
    let totals = blocks.par_iter().with_min_len(BLOCKS_PER_TASK).map(total);
    let mut sums_before: Vec<ColorSum> = totals.collect();
    let mut sum: ColorSum = 0;
    for before in &mut sums_before {
        sum = sum.wrapping_add(std::mem::replace(before, sum));
    }
    let mut last = [sum; SUM_BLOCK];
    for (before, &color) in last.iter_mut().zip(rest) {
        *before = sum;
        sum = add(sum, color);
    }
    last[rest.len()..].fill(sum);
    let sums = blocks.par_iter().zip(sums_before).with_min_len(BLOCKS_PER_TASK);
    // Whole arrays, because those can be collected into uninitialised memory.
    let sums: Vec<[ColorSum; SUM_BLOCK]> = sums
        .map(|(block, mut sum)| {
            block.map(|color| {
                let before = sum;
                sum = add(sum, color);
                before
            })
        })
        .chain(rayon::iter::once(last))
        .collect();
    let mut sums = sums.into_flattened();
    sums.truncate(colors.len() + 1);
    sums
}

#[inline(always)]
fn add(sum: ColorSum, color: [u8; 4]) -> ColorSum {
    let color = ColorSum::from(u32::from_le_bytes(color));
    let red = color & 0xff;
    let green = (color & 0xff00) << (FIELD_BITS - 8);
    let blue = (color & 0xff_0000) << (2 * FIELD_BITS - 16);
    sum.wrapping_add(red | green | blue)
}

/// The sum of a block, in fields of 16 bits, two in one number; a field holds the sum of this many bytes.
fn total(colors: &[[u8; 4]; SUM_BLOCK]) -> ColorSum {
    let (mut red_and_blue, mut green) = (0, 0);
    for &color in colors {
        let color = u32::from_le_bytes(color);
        red_and_blue += color & 0xff_00ff;
        green += color >> 8 & 0xff;
    }
    let [red, green, blue] = [red_and_blue & 0xffff, green, red_and_blue >> 16].map(ColorSum::from);
    red | green << FIELD_BITS | blue << (2 * FIELD_BITS)
}

/// One channel of the sum of at most [`MAX_SUMMED`] colours.
#[inline(always)]
pub(super) fn field_of(sum: ColorSum, channel: u32) -> u32 {
    (sum >> (channel * FIELD_BITS)) as u32 & ((1 << FIELD_BITS) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocked_prefix_sums_match_sequential_ones() {
        for count in [0, 1, 63, 64, 65, 128, 1000, 3 * BLOCKS_PER_TASK * SUM_BLOCK + 7] {
            let color = |i: usize| [i, i / 3, i / 7, i / 11].map(|channel| (channel % 256) as u8);
            let colors: Vec<[u8; 4]> = (0..count).map(color).collect();
            let mut sum = 0;
            let mut expected = vec![0];
            expected.extend(colors.iter().map(|&color| {
                sum = add(sum, color);
                sum
            }));
            assert!(running_sums(&colors) == expected, "{count} colours");
        }
        let white = [[255; 4]; SUM_BLOCK];
        assert_eq!([0, 1, 2].map(|channel| field_of(total(&white), channel)), [255 * 64; 3]);
    }
}
