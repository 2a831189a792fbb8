//! Colours, and every other attribute that is a few integers per node: a predicting transform, lossless or within a
//! bound.
//!
//! How it works: the value of a node is predicted by its parent's, the mean of the siblings, corrected by the adjacent
//! nodes known already. For the last child hardly anything is left to code, as the mean and the other children
//! determine it; so the levels above the last cost little of their own. The prediction residual is divided by the step
//! and rounded: with a step of 2 e + 1 no value is wrong by more than e, on any level, since everything is predicted
//! from values as a decoder has them. Later channels of a node (green, red, blue) are predicted with the residual of
//! the one before, as colours change in brightness more than in hue.
//!
//! What remains is coded by models that are chosen by how well parent and neighbours agree.
//!
//! What bounds it: the next node waits for this one, and a channel for the one before. So everything independent is
//! computed ahead, and there is no unpredictable branch, such as on which nodes are adjacent. Independent frames have
//! no such chain ([`crate::reel::parent_level`]).

use super::value_coder::ValueCoder;
use crate::reel::coder::{BitCoder, divided};
use crate::reel::tree::{Known, NONE};
use std::ops::RangeInclusive;

/// Classes of the agreement of the values that one is predicted from.
const AGREEMENTS: usize = 8;

/// Classes of the previous channel's error.
const BEFORE: usize = 4;

/// Contexts of a channel: with adjacent nodes; without; and of a last child.
const CONTEXTS: usize = (AGREEMENTS + 2) * BEFORE;
const ALONE: usize = AGREEMENTS;
const LAST: usize = AGREEMENTS + 1;

/// Contexts of values of this number of channels.
pub(in crate::reel) const fn channel_contexts(channels: usize) -> usize {
    channels * CONTEXTS
}

/// Maximum error of a value in steps, enforced for damaged bytes.
const MAX_STEPS: i32 = 1 << 17;

/// A whole number that a node has: a value, or how it changed since the frame before.
pub(in crate::reel) trait Channel: Copy {
    fn get(self) -> i32;

    /// Precondition: it fits.
    fn of(value: i32) -> Self;
}

impl Channel for u16 {
    #[inline(always)]
    fn get(self) -> i32 {
        i32::from(self)
    }

    #[inline(always)]
    fn of(value: i32) -> Self {
        value as Self
    }
}

impl Channel for i32 {
    #[inline(always)]
    fn get(self) -> i32 {
        self
    }

    #[inline(always)]
    fn of(value: i32) -> Self {
        value
    }
}

/// Codes the values of a level, and leaves them as a decoder has them. The decoded values of the level above are
/// `parents`. Values are within `range`; none is wrong by more than half of `step`, which is odd.
#[inline(always)]
pub(in crate::reel) fn code_channels<C: BitCoder, T: Channel, const N: usize>(
    coder: &mut ValueCoder<'_, C>,
    plan: &[Known],
    parents: &[[T; N]],
    values: &mut [[T; N]],
    step: u16,
    range: RangeInclusive<i32>,
) {
    let step = i32::from(step);
    let (min, max) = range.into_inner();
    let within = |value: i32| value.max(min).min(max);
    let mut sums = [0i32; N];
    let mut siblings = 0;
    let mut last_parent = NONE;
    for (node, known) in plan.iter().enumerate() {
        if known.parent != last_parent {
            last_parent = known.parent;
            sums = [0; N];
            siblings = 0;
        }
        let parent = parents[known.parent as usize];
        let left = i32::from(known.left);
        let (neighbor, count) = neighbor_of(known, values);
        let is_alone = count == 0 || left == 1;
        let counted = count.max(1);
        let mut foreseen = [0; N];
        let mut rows = [0; N];
        for channel in 0..N {
            // The average of the remaining children.
            let all = parent[channel].get().wrapping_mul(siblings + left);
            let rest = all.wrapping_sub(sums[channel]);
            let expected = within(divided(rest.wrapping_mul(2).wrapping_add(left), 2 * left));
            // The parent has as much weight as all neighbours together.
            let doubled = 2 * neighbor[channel] + expected * counted;
            let mixed = divided(2 * doubled + 3 * counted, 6 * counted);
            let differing = divided((neighbor[channel] - expected * counted).abs(), counted);
            let agreement = class_of(divided(differing, step), AGREEMENTS);
            let alone = if left == 1 { LAST } else { ALONE };
            foreseen[channel] = if is_alone { expected } else { mixed };
            rows[channel] = if is_alone { alone } else { agreement };
        }
        let given = values[node];
        let mut off = 0;
        for channel in 0..N {
            let predicted = within(foreseen[channel] + off);
            let before = class_of(divided(off.abs(), step), BEFORE);
            let context = (channel * (AGREEMENTS + 2) + rows[channel]) * BEFORE + before;
            let steps = if C::DECODES {
                0
            } else {
                (given[channel].get() - predicted + step / 2).div_euclid(step)
            };
            let steps = coder.signed(context, steps).clamp(-MAX_STEPS, MAX_STEPS);
            let value = within(predicted + steps * step);
            values[node][channel] = T::of(value);
            // With very many points in one cell the sum predicts less and less.
            sums[channel] = sums[channel].wrapping_add(value);
            off += value - predicted;
        }
        siblings += 1;
    }
}

/// Returns the sum of the values of the adjacent nodes, and the number of these nodes.
#[inline(always)]
fn neighbor_of<T: Channel, const N: usize>(known: &Known, values: &[[T; N]]) -> ([i32; N], i32) {
    let (mut sums, mut count) = ([0; N], 0);
    for neighbour in known.adjacent {
        let is_there = neighbour != NONE;
        // No branch: their number is unpredictable.
        let value = values[if is_there { neighbour as usize } else { 0 }];
        let mask = -i32::from(is_there);
        for channel in 0..N {
            sums[channel] += value[channel].get() & mask;
        }
        count -= mask;
    }
    (sums, count)
}

/// The number of bits of a non-negative number, as one of a number of classes.
#[inline(always)]
fn class_of(number: i32, classes: usize) -> usize {
    (32 - number.leading_zeros() as usize).min(classes - 1)
}
