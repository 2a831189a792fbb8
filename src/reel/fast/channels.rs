//! Colours and single numbers: what the parent leaves to its children, and the node before, foretell a value.

use super::families::{Families, of_counts, of_masks};
use crate::reel::coder::{LANES, SymbolCoder, divided};

/// Classes of how much parents that follow each other differ.
const CHANGES: usize = 8;

/// Contexts of values of so many channels.
pub(in crate::reel) const fn channel_contexts(channels: usize) -> usize {
    channels * (CHANGES + 1)
}

/// States of values of so many channels: each has its own, or nodes take turns where there is but one.
pub(in crate::reel) const fn channel_lanes(channels: usize) -> usize {
    if channels == 1 { LANES } else { channels }
}

/// More children are not told apart.
const MOST_LEFT: usize = 255;

/// 2¹⁶ divided by each number, rounded down.
static PARTS: [i64; MOST_LEFT + 1] = parts();

const fn parts() -> [i64; MOST_LEFT + 1] {
    let mut table = [0; MOST_LEFT + 1];
    let mut number = 1;
    while number <= MOST_LEFT {
        table[number] = (1 << 16) / number as i64;
        number += 1;
    }
    table
}

/// Codes the values of a level, and leaves them as a decoder has them. Those of the level above are `parents`, as they
/// are decoded. Values are at most `most`; none is wrong by more than half of `step`, which is odd.
#[inline(always)]
pub(in crate::reel) fn code_channels<C: SymbolCoder, const N: usize>(
    coder: &mut C,
    families: Families<'_>,
    parents: &[[u16; N]],
    values: &mut [[u16; N]],
    step_and_most: (u16, u16),
) {
    match families {
        Families::Masks(masks) => code(coder, of_masks(masks), parents, values, step_and_most),
        Families::Counts(counts, outside) => {
            code(coder, of_counts(counts, outside), parents, values, step_and_most);
        }
    }
}

#[inline(always)]
fn code<C: SymbolCoder, const N: usize>(
    coder: &mut C,
    families: impl Iterator<Item = (usize, usize)>,
    parents: &[[u16; N]],
    mut values: &mut [[u16; N]],
    (step, most): (u16, u16),
) {
    // Not behind a reference: what it keeps stays in registers.
    let mut own = std::mem::take(coder);
    let (step, most) = (i32::from(step), i32::from(most));
    let mut last: [i32; N] = parents.first().map_or([0; N], |first| first.map(i32::from));
    let mut node = 0;
    for (parent, count) in families {
        let Some(mean) = parents.get(parent) else { break };
        let classes = classes_of(parents, parent, step);
        let mean = mean.map(i32::from);
        let children;
        (children, values) = values.split_at_mut(count.min(values.len()));
        // What all children together are on the level above, less those that are known.
        let mut rest = mean.map(|mean| i64::from(mean) * count.min(MOST_LEFT) as i64);
        for (place, value) in children.iter_mut().enumerate() {
            let left = (count - place).min(MOST_LEFT);
            let (part, limit) = (PARTS[left], i64::from(most) * left as i64);
            let is_last = left == 1;
            let mut off = 0;
            let lane = node % LANES;
            node += 1;
            for channel in 0..N {
                let expected = ((rest[channel].clamp(0, limit) * part + (1 << 15)) >> 16) as i32;
                // No branch: the numbers of children nobody can guess.
                let before = if is_last { expected } else { last[channel] };
                let class = if is_last { CHANGES } else { classes[channel] };
                let predicted = (((expected + before + 1) >> 1) + off).clamp(0, most);
                let steps = if C::DECODES {
                    0
                } else {
                    (i32::from(value[channel]) - predicted + step / 2).div_euclid(step)
                };
                let lane = if N == 1 { lane } else { channel };
                let steps = own.signed(lane, channel * (CHANGES + 1) + class, steps);
                let is = (predicted + steps * step).clamp(0, most);
                off += is - predicted;
                value[channel] = is as u16;
                last[channel] = is;
                rest[channel] -= i64::from(is);
            }
            // As many are left as were before, while they are more than are told apart.
            if count - place > MOST_LEFT {
                rest = std::array::from_fn(|channel| rest[channel] + i64::from(mean[channel]));
            }
        }
    }
    *coder = own;
}

/// For each channel how much a parent differs from the one before it and the one behind it. What varies above varies
/// below; and that is known before any child is.
#[inline(always)]
fn classes_of<const N: usize>(parents: &[[u16; N]], parent: usize, step: i32) -> [usize; N] {
    let own = parents[parent];
    let before = parents[parent.saturating_sub(1)];
    let behind = parents.get(parent + 1).copied().unwrap_or(own);
    std::array::from_fn(|channel| {
        let differing = own[channel]
            .abs_diff(before[channel])
            .saturating_add(own[channel].abs_diff(behind[channel]));
        let steps = divided(i32::from(differing), step) as u32;
        (32 - steps.leading_zeros()).min(CHANGES as u32 - 1) as usize
    })
}
