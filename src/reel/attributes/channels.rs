//! Colours, and everything else that is a few whole numbers a node: a predicting transform, lossless or within a bound.
//!
//! How it works: the value of a node is that of its parent, the mean of its children, corrected by the nodes beside it
//! that are known already. Of the last child hardly anything is left to tell, as the mean and the other children say
//! what it has to be; so the levels above the last cost little of their own. What is not predicted is divided by the
//! step and rounded: with a step of 2 e + 1 no value is wrong by more than e, on any level, since everything is
//! predicted from values as a decoder has them. Later channels of a node (green, red, blue) are predicted with what
//! the one before it was off by, as colours change in brightness more than in hue.
//!
//! What remains is coded by models that are chosen by how well parent and neighbours agree.

use crate::reel::coder::{BitCoder, MagnitudeModel, RestModels, divided};
use crate::reel::tree::{Known, NONE};
use std::ops::RangeInclusive;

/// Classes of how well what a value is predicted from agrees.
const AGREEMENTS: usize = 8;

/// Classes of what the channel before was off by.
const BEFORE: usize = 4;

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

/// What is known of what is not predicted.
#[derive(Debug, Clone)]
pub(in crate::reel) struct ChannelModels {
    models: Vec<MagnitudeModel>,
    rest: RestModels,
}

impl ChannelModels {
    /// For so many channels.
    pub(in crate::reel) fn new(channels: usize) -> Self {
        Self {
            models: vec![MagnitudeModel::default(); channels * 3 * AGREEMENTS * BEFORE],
            rest: RestModels::default(),
        }
    }
}

/// Codes the values of a level, and leaves them as a decoder has them. Those of the level above are `parents`, as they
/// are decoded. Values are within `range`; none is wrong by more than half of `step`, which is odd.
pub(in crate::reel) fn code_channels<C: BitCoder, T: Channel, const N: usize>(
    coder: &mut C,
    models: &mut ChannelModels,
    plan: &[Known],
    parents: &[[T; N]],
    values: &mut [[T; N]],
    (step, range): (u16, RangeInclusive<i32>),
) {
    let step = i32::from(step);
    let within = |value: i32| value.clamp(*range.start(), *range.end());
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
        let mut off = 0;
        for channel in 0..N {
            let mean = parent[channel].get();
            // What the children left have on average.
            let expected = within(divided((mean * (siblings + left) - sums[channel]) * 2 + left, 2 * left));
            let (mut beside, mut count) = (0, 0);
            for &neighbour in known.beside.iter().take_while(|&&neighbour| neighbour != NONE) {
                beside += values[neighbour as usize][channel].get();
                count += 1;
            }
            let (predicted, differing) = match (count, left) {
                (0, _) | (_, 1) => (expected, 0),
                (count, _) => {
                    // As much weight for the parent as for all beside it.
                    let doubled = 2 * beside + expected * count;
                    (
                        divided(2 * doubled + 3 * count, 6 * count),
                        divided((beside - expected * count).abs(), count),
                    )
                }
            };
            let predicted = within(predicted + off);
            let agreement = class_of(divided(differing, step), AGREEMENTS);
            let before = class_of(divided(off.abs(), step), BEFORE);
            let kind = if left == 1 {
                0
            } else if count == 0 {
                1
            } else {
                2
            };
            let model = &mut models.models[((channel * 3 + kind) * AGREEMENTS + agreement) * BEFORE + before];
            let steps = if C::DECODES {
                0
            } else {
                (values[node][channel].get() - predicted + step / 2).div_euclid(step)
            };
            // What damaged bytes say may be any number.
            let steps = model
                .code_signed(coder, &mut models.rest, i64::from(steps))
                .clamp(-(1 << 17), 1 << 17) as i32;
            let value = within(predicted + steps * step);
            values[node][channel] = T::of(value);
            sums[channel] += value;
            off += value - predicted;
        }
        siblings += 1;
    }
}

/// The number of bits of a number that is not negative, as one of so many classes.
#[inline(always)]
fn class_of(number: i32, classes: usize) -> usize {
    (32 - number.leading_zeros() as usize).min(classes - 1)
}
