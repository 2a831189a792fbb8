//! The nodes of a level by their parents, some parents at a time: so the symbols read stay in the cache of a core from
//! the symbols to the values.

use super::ranges::{NUMBERS, Ranges};
use super::slopes::{FLAT, OfParents, Slopes};
use crate::reel::coder::{Counts, LOG_BITS, SymbolCoder};
use crate::reel::parent_level::{Families, ParentValue};
use crate::reel::tree::OCTANTS;

/// Entries behind the nodes of a level: the eight children that a node may have are written at once.
pub(in crate::reel) const SLACK: usize = 8;

/// Parents of a block, and those without parents of one.
const PARENTS: usize = 512;

/// Families that determine the prediction of the others.
const SAMPLES: usize = 1024;

/// Bits of the shift of a level.
const SHIFT_BITS: u32 = 3;
const MAX_SHIFT: u32 = (1 << SHIFT_BITS) - 1;

/// Structure of the levels above a level.
#[derive(Debug, Clone, Copy)]
pub(in crate::reel) struct Upwards<'a> {
    pub(in crate::reel) families: Families<'a>,
    /// The masks of the level above the parents; none of the root and of points.
    pub(in crate::reel) masks: &'a [u8],
    /// The values that parents have.
    pub(in crate::reel) parent_value: ParentValue,
}

impl Upwards<'_> {
    /// Returns true if the first child of each parent has its value.
    fn knows_first(&self) -> bool {
        self.parent_value == ParentValue::FirstChild
    }

    /// Returns the number of coded children of a parent: an only child has the value of its parent.
    #[inline(always)]
    fn coded_of(&self, count: usize) -> usize {
        if count <= 1 {
            0
        } else {
            count - usize::from(self.knows_first())
        }
    }

    /// Returns the number of coded nodes of the level.
    fn coded_nodes(&self) -> usize {
        match self.families {
            Families::Masks(masks) => self.coded_of_masks(masks),
            Families::Counts(counts, outside) => self.coded_of_counts(counts) + outside,
        }
    }

    fn coded_of_masks(&self, masks: &[u8]) -> usize {
        masks.iter().map(|mask| self.coded_of(mask.count_ones() as usize)).sum()
    }

    fn coded_of_counts(&self, counts: &[u32]) -> usize {
        counts.iter().map(|&count| self.coded_of(count as usize)).sum()
    }
}

/// Coding parameters of a level, written before all nodes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Scale {
    /// Shift that selects the ranges of numbers: the larger, the more bits of each are written verbatim.
    pub(super) shift: u32,
    /// True if children are predicted along slopes.
    has_slopes: bool,
}

/// Values of a kind.
pub(super) trait Kind {
    type Value: Copy;

    /// Ranges of numbers for the shift of a level.
    fn ranges(&self, shift: u32) -> Ranges;

    /// Reconstructs a value from its parent, the slope there, and the decoded word.
    fn below(&self, parent: Self::Value, slope: [i16; 4], word: u64) -> Self::Value;

    /// Variant of [`Kind::below`] for eight values; writes the parent if nothing is coded.
    fn eight_below(
        &self,
        parent: Self::Value,
        is_coded: bool,
        slopes: Option<&Slopes>,
        words: &[u64; 8],
        below: &mut [Self::Value; 8],
    );

    /// Returns the code of a value: the symbol, and the numbers that it has ranges of.
    fn symbol(&self, parent: Self::Value, slope: [i16; 4], value: Self::Value, shift: u32) -> (u8, [i32; NUMBERS]);

    /// The slopes of parents, if there are any of this kind.
    fn slopes<'a>(slopes: &'a mut OfParents<'_>, parents: &[Self::Value]) -> Option<&'a Slopes>;
}

/// Codes the values of a level, which has [`SLACK`] entries behind them, and leaves them as a decoder has them. The
/// decoded values of the level above are `parents`; without parents, the first of them is the predecessor of the first
/// value.
#[inline(always)]
pub(super) fn code_level<C: SymbolCoder, K: Kind>(
    kind: &K,
    coder: &mut C,
    upwards: Upwards<'_>,
    parents: &[K::Value],
    values: &mut [K::Value],
) {
    // A local copy, not a reference: its state stays in registers.
    let mut own = std::mem::take(coder);
    let scale = if upwards.coded_nodes() == 0 {
        Scale::default()
    } else if C::DECODES {
        Scale {
            shift: own.raw(SHIFT_BITS, 0),
            has_slopes: own.raw(1, 0) != 0,
        }
    } else {
        let scale = scale_of(kind, upwards, parents, values);
        own.raw(SHIFT_BITS, scale.shift);
        own.raw(1, u32::from(scale.has_slopes));
        scale
    };
    let mut level = Level {
        kind,
        upwards,
        ranges: kind.ranges(scale.shift),
        scale,
        symbols: Vec::new(),
        words: Vec::new(),
    };
    match upwards.families {
        Families::Masks(masks) if C::DECODES => level.read(&mut own, masks, parents, values),
        Families::Masks(masks) => level.write(&mut own, masks, parents, values),
        Families::Counts(counts, outside) => level.code_counts(&mut own, counts, outside, parents, values),
    }
    *coder = own;
}

/// Chooses the coding parameters that take the fewest bits, estimated from some families of a level.
fn scale_of<K: Kind>(kind: &K, upwards: Upwards<'_>, parents: &[K::Value], values: &[K::Value]) -> Scale {
    let samples = samples_of::<K>(upwards, parents, values);
    // Slopes are between means: between colours of points they save nothing (13.33 bits per point of the walking man).
    let can_slope = !upwards.knows_first() && samples.iter().any(|&(_, slope, _)| slope != [0; 4]);
    let mut best = (u64::MAX, Scale::default());
    for shift in 0..=MAX_SHIFT {
        let ranges = kind.ranges(shift);
        // Slopes do not always pay off: in a model of colours, 4.2 instead of 5.4 bits for the torus, 8.4 instead of
        // 7.2 for the walking man.
        for has_slopes in [false, true] {
            if has_slopes && !can_slope {
                continue;
            }
            let (mut counts, mut bits) = (Counts::default(), 0);
            for &(parent, slope, value) in &samples {
                let slope = if has_slopes { slope } else { [0; 4] };
                let (symbol, _) = kind.symbol(parent, slope, value, shift);
                counts.see(symbol);
                bits += ranges.bits(symbol);
            }
            let cost = counts.cost() + (bits << LOG_BITS);
            if cost < best.0 {
                best = (cost, Scale { shift, has_slopes });
            }
        }
    }
    best.1
}

/// A parent, the slope where its child is, and the child.
type Sample<V> = (V, [i16; 4], V);

/// Samples the coded values of about [`SAMPLES`] families, evenly spread.
fn samples_of<K: Kind>(upwards: Upwards<'_>, parents: &[K::Value], values: &[K::Value]) -> Vec<Sample<K::Value>> {
    let every = (parents.len() / SAMPLES).max(1);
    let (mut samples, mut next) = (Vec::new(), 0);
    let skipped = usize::from(upwards.knows_first());
    match upwards.families {
        Families::Masks(masks) => {
            let mut of_parents = OfParents::below(upwards.masks);
            for (place, (&mask, &parent)) in masks.iter().zip(parents).enumerate() {
                let slopes = K::slopes(&mut of_parents, parents).unwrap_or(&FLAT);
                let count = mask.count_ones() as usize;
                if count > 1 && place.is_multiple_of(every) {
                    let children = OCTANTS[usize::from(mask)].iter().zip(&values[next..next + count]);
                    let sample = |(&octant, &value): (&u8, &K::Value)| (parent, slopes[usize::from(octant & 7)], value);
                    samples.extend(children.skip(skipped).map(sample));
                }
                next += count;
            }
        }
        Families::Counts(counts, _) => {
            for (place, (&count, &parent)) in counts.iter().zip(parents).enumerate() {
                let children = &values[next..next + count as usize];
                if children.len() > 1 && place.is_multiple_of(every) {
                    let coded = children.iter().skip(skipped).take(SAMPLES);
                    samples.extend(coded.map(|&value| (parent, [0; 4], value)));
                }
                next += children.len();
            }
        }
    }
    samples
}

/// A level while it is coded.
struct Level<'a, K> {
    kind: &'a K,
    upwards: Upwards<'a>,
    ranges: Ranges,
    scale: Scale,
    /// Symbols of a block.
    symbols: Vec<u8>,
    /// Its words; before them one that is not coded where first children are not, so that the word of a child is at the
    /// same place from that of the first.
    words: Vec<u64>,
}

impl<K: Kind> Level<'_, K> {
    /// Reads this number of symbols, and the words of their values.
    #[inline(always)]
    fn read_words<C: SymbolCoder>(&mut self, coder: &mut C, coded: usize) {
        self.symbols.resize(coded, 0);
        coder.plain(&mut self.symbols);
        let first = usize::from(self.upwards.knows_first());
        self.words.resize(first + coded + SLACK, 0);
        for (word, &symbol) in self.words[first..].iter_mut().zip(&self.symbols) {
            *word = self.ranges.read(coder, symbol);
        }
    }

    #[inline(always)]
    fn read<C: SymbolCoder>(&mut self, coder: &mut C, masks: &[u8], parents: &[K::Value], values: &mut [K::Value]) {
        let mut of_parents = OfParents::below(self.upwards.masks);
        let mut left = values;
        for (masks, of_block) in masks.chunks(PARENTS).zip(parents.chunks(PARENTS)) {
            self.read_words(coder, self.upwards.coded_of_masks(masks));
            let count = if self.scale.has_slopes {
                self.spread::<true>(&mut of_parents, masks, of_block, parents, left)
            } else {
                self.spread::<false>(&mut of_parents, masks, of_block, parents, left)
            };
            left = left.get_mut(count..).unwrap_or_default();
        }
    }

    /// The values below the parents of a block by the words that were read; how many there are.
    #[inline(always)]
    fn spread<const HAS_SLOPES: bool>(
        &self,
        of_parents: &mut OfParents<'_>,
        masks: &[u8],
        of_block: &[K::Value],
        parents: &[K::Value],
        values: &mut [K::Value],
    ) -> usize {
        let (mut next, mut coded) = (0, 0);
        for (&mask, &parent) in masks.iter().zip(of_block) {
            let slopes = if HAS_SLOPES {
                K::slopes(of_parents, parents)
            } else {
                None
            };
            let slopes = slopes.map(|of| OCTANTS[usize::from(mask)].map(|octant| of[usize::from(octant & 7)]));
            let count = mask.count_ones() as usize;
            // Always eight at a time: their number is unpredictable.
            let (Some(words), Some(below)) = (
                self.words.get(coded..).and_then(<[u64]>::first_chunk),
                values.get_mut(next..).and_then(<[K::Value]>::first_chunk_mut),
            ) else {
                break;
            };
            self.kind.eight_below(parent, count > 1, slopes.as_ref(), words, below);
            if self.upwards.knows_first() {
                below[0] = parent;
            }
            next += count;
            coded += self.upwards.coded_of(count);
        }
        next
    }

    #[inline(always)]
    fn write<C: SymbolCoder>(&mut self, coder: &mut C, masks: &[u8], parents: &[K::Value], values: &mut [K::Value]) {
        let mut of_parents = OfParents::below(self.upwards.masks);
        let mut next = 0;
        for (masks, of_block) in masks.chunks(PARENTS).zip(parents.chunks(PARENTS)) {
            self.symbols.clear();
            for (&mask, &parent) in masks.iter().zip(of_block) {
                let slopes = if self.scale.has_slopes {
                    K::slopes(&mut of_parents, parents)
                } else {
                    None
                };
                let slopes = slopes.unwrap_or(&FLAT);
                let count = mask.count_ones() as usize;
                let children = &mut values[next..next + count];
                next += count;
                let known = count - self.upwards.coded_of(count);
                children[..known].fill(parent);
                for (child, &octant) in children.iter_mut().zip(&OCTANTS[usize::from(mask)]).skip(known) {
                    *child = self.tell(coder, parent, slopes[usize::from(octant & 7)], *child);
                }
            }
            coder.plain(&mut self.symbols);
        }
    }

    /// Writes the bits of a value and notes its symbol; returns the decoder's value.
    #[inline(always)]
    fn tell<C: SymbolCoder>(&mut self, coder: &mut C, parent: K::Value, slope: [i16; 4], value: K::Value) -> K::Value {
        let (symbol, numbers) = self.kind.symbol(parent, slope, value, self.scale.shift);
        self.symbols.push(symbol);
        let word = self.ranges.write(coder, symbol, numbers);
        self.kind.below(parent, slope, word)
    }

    /// Codes points by their cells, and those without parents, each as the one before it.
    #[inline(always)]
    fn code_counts<C: SymbolCoder>(
        &mut self,
        coder: &mut C,
        counts: &[u32],
        outside: usize,
        parents: &[K::Value],
        values: &mut [K::Value],
    ) {
        let mut left = values;
        for (counts, parents) in counts.chunks(PARENTS).zip(parents.chunks(PARENTS)) {
            self.begin(coder, self.upwards.coded_of_counts(counts));
            let mut place = 0;
            for (&count, &parent) in counts.iter().zip(parents) {
                let count = (count as usize).min(left.len());
                let children;
                (children, left) = left.split_at_mut(count);
                let known = count - self.upwards.coded_of(count);
                children[..known].fill(parent);
                for child in &mut children[known..] {
                    *child = self.one(coder, place, parent, *child);
                    place += 1;
                }
            }
            self.end(coder);
        }
        let count = outside.min(left.len());
        let Some(&first) = parents.first() else { return };
        let mut last = first;
        for of_block in left[..count].chunks_mut(PARENTS) {
            self.begin(coder, of_block.len());
            for (place, value) in of_block.iter_mut().enumerate() {
                *value = self.one(coder, place, last, *value);
                last = *value;
            }
            self.end(coder);
        }
    }

    #[inline(always)]
    fn begin<C: SymbolCoder>(&mut self, coder: &mut C, coded: usize) {
        self.symbols.clear();
        if C::DECODES {
            self.read_words(coder, coded);
        }
    }

    #[inline(always)]
    fn one<C: SymbolCoder>(&mut self, coder: &mut C, place: usize, parent: K::Value, value: K::Value) -> K::Value {
        if C::DECODES {
            let place = place + usize::from(self.upwards.knows_first());
            let word = self.words.get(place).copied().unwrap_or(0);
            return self.kind.below(parent, [0; 4], word);
        }
        self.tell(coder, parent, [0; 4], value)
    }

    #[inline(always)]
    fn end<C: SymbolCoder>(&mut self, coder: &mut C) {
        if !C::DECODES {
            coder.plain(&mut self.symbols);
        }
    }
}
