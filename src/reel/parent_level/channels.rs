//! Colours and single numbers: interpolated between the parent and the nodes across its faces, and the remainder that
//! the parent leaves to its children.
//!
//! How it works: a child lies towards three faces of its parent. Its value is expected between the parent's, which
//! counts twice, and those of the nodes behind these faces, unless they differ so much that there must be an edge
//! between. Where parents are means, and values are exact or there is an edge, the remainder is shared by the children
//! that are left, so hardly anything is left to code for the last one. (Elsewhere the rounding errors would add up
//! there: twice the bits for a smooth surface.) Where parents have the values of their first children, these are known.
//! Later channels (green, red, blue) are predicted with the errors of those before, as colours change in brightness
//! more than in hue. Interpolated values are in 60ths: the shares of two to five values are whole numbers.
//!
//! With a step of 2 e + 1 no value is wrong by more than e, on any level, since everything is predicted from values as
//! a decoder has them.

use super::families::{Above, Families, Family, ParentValue, across, across_bits, of_counts, of_masks};
use super::lanes::Lanes;
use super::steps;
use crate::reel::coder::SymbolCoder;
use crate::reel::tree::{Faces, NONE};

/// Classes of how much the parents around differ.
// More contexts (steps of siblings, of the parent) took more bits, as more tables have to be transmitted.
const CLASSES: u8 = 7;

/// Contexts of children, of the last of a family, and of nodes outside.
const LAST: u8 = CLASSES;
const OUTSIDE: u8 = 2 * CLASSES;

/// Contexts of values.
pub(in crate::reel) const CHANNEL_CONTEXTS: usize = OUTSIDE as usize + 1;

/// Flag bit, stored with the faces that are near a parent in value: set if some faces are not near.
const EDGE: u8 = 1 << 7;

/// Parts that values are interpolated in.
const PARTS: i32 = 60;

/// Factor of the sum of their values and twice the parent's, for each number of faces.
const WEIGHTS: [u64; 4] = [30, 20, 15, 12];

/// Higher numbers of children are not distinguished.
const MAX_LEFT: usize = 255;

/// 2¹⁶ divided by each number, rounded down.
static SHARES: [i64; MAX_LEFT + 1] = shares();

const fn shares() -> [i64; MAX_LEFT + 1] {
    let mut table = [0; MAX_LEFT + 1];
    let mut number = 1;
    while number <= MAX_LEFT {
        table[number] = (1 << 16) / number as i64;
        number += 1;
    }
    table
}

/// Upper limit of the remainder owed to the children left; the remainder of very many points is not tracked beyond
/// this.
const MAX_OWED: i32 = 1 << 30;

/// Properties of the values of all levels.
#[derive(Debug, Clone, Copy)]
pub(in crate::reel) struct ChannelCoding {
    /// Odd; no value is wrong by more than half of it.
    pub(in crate::reel) step: u16,
    /// Maximum value; 255 where there are three channels.
    pub(in crate::reel) max: u16,
    pub(in crate::reel) parent_value: ParentValue,
}

/// Codes the values of a level, and leaves them as a decoder has them. The decoded values of the level above are
/// `parents`.
#[inline(always)]
pub(in crate::reel) fn code_channels<C: SymbolCoder, const N: usize>(
    coder: &mut C,
    above: Above<'_>,
    parents: &[[u16; N]],
    values: &mut [[u16; N]],
    coding: ChannelCoding,
) {
    let level = Level {
        faces: above.faces,
        parents: &parents
            .iter()
            .map(|&parent| Lanes::<N>::pack(parent))
            .collect::<Vec<u64>>(),
        step: i32::from(coding.step),
        max: i32::from(coding.max),
        parent_value: coding.parent_value,
    };
    match above.families {
        Families::Masks(masks) => level.code(coder, of_masks(masks), values),
        Families::Counts(counts, outside) => level.code(coder, of_counts(counts, outside), values),
    }
}

/// The channels of a word.
#[inline(always)]
fn lanes<const N: usize>(word: u64) -> [i32; N] {
    std::array::from_fn(|channel| Lanes::<N>::get(word, channel))
}

/// State of a level known before it is coded.
struct Level<'a, const N: usize> {
    faces: &'a [Faces],
    /// Their channels side by side.
    parents: &'a [u64],
    step: i32,
    max: i32,
    parent_value: ParentValue,
}

impl<const N: usize> Level<'_, N> {
    #[inline(always)]
    fn code<C: SymbolCoder>(
        &self,
        coder: &mut C,
        families: impl Iterator<Item = Family> + Clone,
        values: &mut [[u16; N]],
    ) {
        // A local copy, not a reference: its state stays in registers.
        let mut own = std::mem::take(coder);
        // Predicted from the level above alone, so that symbols are read in one go. Predicted from three neighbouring
        // nodes, bit by bit, each value waited for the one before: 65 ns per node, and 5.6 instead of 2.5 bits for the
        // colours of the torus.
        let (contexts, near) = self.contexts(families.clone(), values.len());
        let mut symbols = vec![0; contexts.len()];
        if C::DECODES {
            own.symbols(&contexts, &mut symbols);
        }
        let (mut left, mut told, mut near) = (values, symbols.as_mut_slice(), near.into_iter());
        let mut last_outside = self.parents.first().copied().unwrap_or(0);
        for family in families {
            let count = family.count.min(left.len());
            let children;
            (children, left) = left.split_at_mut(count);
            let Some(&parent) = self.parents.get(family.parent) else {
                break;
            };
            if family.is_clear() {
                children.fill(lanes(parent).map(|channel: i32| channel as u16));
                continue;
            }
            let known = family.known(self.parent_value).min(count);
            let (first, children) = children.split_at_mut(known);
            first.fill(lanes(parent).map(|channel: i32| channel as u16));
            let of_family;
            (of_family, told) = told.split_at_mut(children.len().min(told.len()));
            if family.mask == 0 {
                let parent = if family.is_outside { last_outside } else { parent };
                self.code_points(&mut own, parent, children, of_family);
                if let (true, Some(&value)) = (family.is_outside, children.last()) {
                    last_outside = Lanes::<N>::pack(value);
                }
            } else {
                let near = near.next().unwrap_or(0);
                self.code_family(&mut own, family, near, children, of_family);
            }
        }
        if !C::DECODES {
            own.symbols(&contexts, &mut symbols);
        }
        *coder = own;
    }

    /// Returns the contexts of all coded nodes, and a mask of the faces of each parent with octants that are near it in
    /// value.
    #[inline(always)]
    fn contexts(&self, families: impl Iterator<Item = Family>, nodes: usize) -> (Vec<u8>, Vec<u8>) {
        let mut contexts = Vec::with_capacity(nodes);
        let mut near = Vec::with_capacity(self.parents.len());
        let limit = Lanes::<N>::limit((3 * self.max as u64) >> 4);
        for family in families {
            if family.is_outside {
                contexts.push(OUTSIDE);
            } else if family.count > 1 {
                let (class, of_parent) = self.around(family, limit);
                if family.mask != 0 {
                    near.push(of_parent);
                }
                contexts.extend(std::iter::repeat_n(class, family.count - 1));
                // The mean leaves hardly anything to the last child, the first child does not.
                if self.parent_value == ParentValue::Mean {
                    contexts.push(LAST + class);
                }
            }
        }
        (contexts, near)
    }

    /// The class of how much a parent differs from the nodes across its faces, and which of them are near it in value.
    #[inline(always)]
    fn around(&self, family: Family, limit: u64) -> (u8, u8) {
        let Some(&parent) = self.parents.get(family.parent) else {
            return (0, 0);
        };
        let (mut all, mut near, mut there) = (0, 0, 0);
        for (face, other) in family.faces(self.faces).into_iter().enumerate() {
            // No branch: it would be unpredictable.
            let is_there = other != NONE;
            let found = self.parents[if is_there { other as usize } else { 0 }];
            let differing = Lanes::<N>::differing(if is_there { found } else { parent }, parent);
            all |= differing;
            near |= u8::from(is_there && Lanes::<N>::is_within(differing, limit)) << face;
            there |= u8::from(is_there) << face;
        }
        let of_step = (self.step as u32).ilog2();
        let class = Lanes::<N>::bits(all)
            .saturating_sub(of_step)
            .min(u32::from(CLASSES) - 1);
        (class as u8, if near == there { near } else { near | EDGE })
    }

    #[inline(always)]
    fn code_family<C: SymbolCoder>(
        &self,
        coder: &mut C,
        family: Family,
        near: u8,
        children: &mut [[u16; N]],
        symbols: &mut [u8],
    ) {
        let parent = self.parents[family.parent];
        let faces = family.faces(self.faces);
        let beyond: [u64; 6] = std::array::from_fn(|face| {
            let is_near = near >> face & 1 != 0;
            let value = self.parents[if is_near { faces[face] as usize } else { 0 }];
            value & u64::from(is_near).wrapping_neg()
        });
        let mut octants = family.mask;
        if family.known(self.parent_value) > 0 {
            octants &= octants - 1;
        }
        let between = std::iter::from_fn(|| {
            let octant = octants.trailing_zeros() as usize;
            octants &= octants.wrapping_sub(1);
            // Faces only: also across edges and corners, a model without rounding took a third fewer bits for the
            // colours of the torus, and 1 % more for the walking man's.
            let [a, b, c] = across(octant).map(|face| beyond[face]);
            let count = (u32::from(near) & across_bits(octant)).count_ones() as usize;
            Some((2 * parent + a + b + c) * WEIGHTS[count])
        });
        // Only in these cases. Distributed elsewhere, the rounding errors of values add up: 5.5 instead of 2.5 bits per
        // point for the colours of the torus (steps of 5). Not distributed at edges either, the walking man's took 7.2
        // instead of 6.7.
        if self.shares_remainder(near & EDGE != 0) {
            let mut all = [[0; N]; 8];
            let mut owed = lanes(parent).map(|own: i32| PARTS * own * family.count as i32);
            for (of_child, word) in all.iter_mut().zip(between).take(children.len()) {
                *of_child = lanes(word);
                (0..N).for_each(|channel| owed[channel] -= of_child[channel]);
            }
            self.tell_exactly(coder, children, symbols, all.into_iter(), owed);
            return;
        }
        for ((child, symbol), word) in children.iter_mut().zip(symbols).zip(between) {
            self.tell(coder, child, symbol, lanes(word));
        }
    }

    /// Codes points, whose positions are unknown.
    #[inline(always)]
    fn code_points<C: SymbolCoder>(&self, coder: &mut C, parent: u64, points: &mut [[u16; N]], symbols: &mut [u8]) {
        let between = std::array::from_fn(|channel| PARTS * Lanes::<N>::get(parent, channel));
        if self.shares_remainder(false) {
            self.tell_exactly(coder, points, symbols, std::iter::repeat(between), [0; N]);
            return;
        }
        for (point, symbol) in points.iter_mut().zip(symbols) {
            self.tell(coder, point, symbol, between);
        }
    }

    /// Returns true if the error of a parent carries information about its children: it is their mean, and coding is
    /// lossless or there is an edge.
    #[inline(always)]
    fn shares_remainder(&self, is_edge: bool) -> bool {
        self.parent_value == ParentValue::Mean && (self.step == 1 || is_edge)
    }

    /// Codes a family with the expected values `between`, each with its share of the remainder.
    #[inline(always)]
    fn tell_exactly<C: SymbolCoder>(
        &self,
        coder: &mut C,
        children: &mut [[u16; N]],
        symbols: &mut [u8],
        between: impl Iterator<Item = [i32; N]>,
        mut owed: [i32; N],
    ) {
        let mut left = children.len();
        for ((child, symbol), between) in children.iter_mut().zip(symbols).zip(between) {
            let share = SHARES[left.min(MAX_LEFT)];
            let expected =
                std::array::from_fn(|channel| between[channel] + ((i64::from(owed[channel]) * share) >> 16) as i32);
            self.tell(coder, child, symbol, expected);
            for channel in 0..N {
                let is = owed[channel] + between[channel] - PARTS * i32::from(child[channel]);
                owed[channel] = is.clamp(-MAX_OWED, MAX_OWED);
            }
            left -= 1;
        }
    }

    /// Codes a node with an expected value, in parts.
    #[inline(always)]
    fn tell<C: SymbolCoder>(&self, coder: &mut C, value: &mut [u16; N], symbol: &mut u8, expected: [i32; N]) {
        let mut steps: [i32; N] = if C::DECODES {
            steps::read(coder, *symbol)
        } else {
            [0; N]
        };
        let mut off = 0;
        for channel in 0..N {
            let expected = (expected[channel] + PARTS / 2).max(0) as u32 / PARTS as u32;
            let predicted = (expected.min(self.max as u32) as i32 + off).max(0).min(self.max);
            if !C::DECODES {
                steps[channel] = (i32::from(value[channel]) - predicted + self.step / 2).div_euclid(self.step);
            }
            let is = (predicted + steps[channel] * self.step).max(0).min(self.max);
            off += is - predicted;
            value[channel] = is as u16;
        }
        if !C::DECODES {
            *symbol = steps::write(coder, steps);
        }
    }
}
