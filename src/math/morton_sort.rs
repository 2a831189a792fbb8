//! The order of Morton codes, and so of the points they belong to.
//!
//! How it works: a radix sort from the lowest digit up (LSD), but only over the highest 36 bits of the code, the first
//! 12 octree levels. An item is one `u64`: those bits above the index of the point, so that code and index travel in 8 bytes
//! and four passes of 9 bits sort them. (More than 2²⁸ points need 31 bits for the index and leave 33 for the code.)
//!
//! ```text
//! 63 ......... 55 54 ........ 46 45 ........ 37 36 ....... 28 27 ......... 0
//!   fourth digit    third digit   second digit   first digit    point index
//! ```
//!
//! Points that share all 12 levels now stand in runs, which are sorted by the bits left: short runs by comparison,
//! long ones (an outlier far away squeezes the whole cloud into few cells) by a second radix sort.
//!
//! When it wins: at 12 levels the cells of a scanned surface hold one point, so half of the passes that a sort of
//! all 63 bits makes would move nothing. A digit in which all items agree costs no pass either. Digits of 9 bits write to 512
//! places at a time, whose lines the nearest cache holds; three passes of 11 bits take a fifth longer for a million points.
//!
//! Codes that are in order already are left alone, which one look over them tells.
//!
//! Halves of many codes, parted by the highest digit, are sorted by two threads.
//!
//! The sort is stable: equal codes stay in the order of their indices. Nothing depends on timing or threads.

use std::collections::VecDeque;

const DIGIT_BITS: u32 = 9;
const DIGIT_VALUES: usize = 1 << DIGIT_BITS;
const DIGITS: usize = 4;
const CODE_BITS: u32 = 63;

/// How code and index share an item.
#[derive(Debug, Clone, Copy)]
struct ItemLayout {
    index_bits: u32,
}

impl ItemLayout {
    /// For so many codes.
    fn of(count: usize) -> Self {
        const MOST_INDEX_BITS: u32 = 31;
        const FEWEST_INDEX_BITS: u32 = u64::BITS - DIGIT_BITS * DIGITS as u32;
        assert!(
            count as u64 <= 1 << MOST_INDEX_BITS,
            "indices of {count} points do not fit {MOST_INDEX_BITS} bits",
        );
        let index_bits = if count as u64 <= 1 << FEWEST_INDEX_BITS {
            FEWEST_INDEX_BITS
        } else {
            MOST_INDEX_BITS
        };
        Self { index_bits }
    }

    /// Bits of a code that find no room beside the index.
    fn low_bits(self) -> u32 {
        CODE_BITS + self.index_bits - u64::BITS
    }

    fn item(self, code: u64, index: u64) -> u64 {
        code >> self.low_bits() << self.index_bits | index
    }

    /// With the bits of the code that [`ItemLayout::item`] leaves out.
    fn low_item(self, code: u64, index: u64) -> u64 {
        (code & ((1 << self.low_bits()) - 1)) << self.index_bits | index
    }

    fn index(self, item: u64) -> usize {
        (item & ((1 << self.index_bits) - 1)) as usize
    }

    /// From the lowest digit up. The highest has fewer bits where the index has more.
    fn digit(self, item: u64, digit: usize) -> usize {
        (item >> (self.index_bits + DIGIT_BITS * digit as u32)) as usize & (DIGIT_VALUES - 1)
    }
}

/// Below this a comparison sort is done before the digit counters of a radix sort are cleared.
const SHORT_RUN: usize = 1024;

/// The indices of 63-bit `codes` in the order of the codes; of equal codes by ascending index.
///
/// # Panics
/// Preconditions: at most 2³¹ codes, each below 2⁶³.
pub fn order_of_codes(codes: &[u64]) -> Vec<u32> {
    let layout = ItemLayout::of(codes.len());
    if codes.is_sorted() {
        return (0..codes.len() as u32).collect();
    }
    let sorter = Sorter { codes, layout };
    let mut items = vec![0; codes.len()];
    let mut scratch = vec![0; codes.len()];
    if codes.len() < 2 * PARALLEL_CODES || rayon::current_num_threads() == 1 {
        let unsorted = codes.iter().zip(0..);
        let unsorted = unsorted.map(|(&code, index)| layout.item(code, index));
        let mut passes = Passes::over(layout, unsorted.clone());
        passes.take_first(unsorted, &mut items);
        let sorted = passes.take_others(&mut items, &mut scratch);
        sorter.sort_runs(sorted);
        return sorted
            .iter()
            .map(|&item| layout.index(item) as u32)
            .collect();
    }
    let middle = sorter.partition_near_half(&mut scratch);
    let (low, high) = items.split_at_mut(middle);
    let (parted_low, parted_high) = scratch.split_at_mut(middle);
    let mut order = vec![0; codes.len()];
    let (low_order, high_order) = order.split_at_mut(middle);
    let sort = |parted: &mut [u64], items: &mut [u64], order: &mut [u32]| {
        let mut passes = Passes::over(layout, parted.iter().copied());
        passes.take_first(parted.iter().copied(), items);
        let sorted = passes.take_others(items, parted);
        sorter.sort_runs(sorted);
        for (index, &item) in order.iter_mut().zip(&*sorted) {
            *index = layout.index(item) as u32;
        }
    };
    rayon::join(
        || sort(parted_low, low, low_order),
        || sort(parted_high, high, high_order),
    );
    order
}

/// Below this, codes are not shared out among threads.
const PARALLEL_CODES: usize = 1 << 14;

struct Sorter<'a> {
    codes: &'a [u64],
    layout: ItemLayout,
}

impl Sorter<'_> {
    /// Writes the items of all codes, first those with a small highest digit, then the others, both in their order; how many
    /// come first: about half, as far as whole digits allow. On two threads, a half of the codes each.
    fn partition_near_half(&self, items: &mut [u64]) -> usize {
        let layout = self.layout;
        let (front, back) = self.codes.split_at(self.codes.len() / 2);
        let highest_digit = |code: u64| layout.digit(layout.item(code, 0), DIGITS - 1);
        let count = |codes: &[u64]| {
            let mut counts = [0u32; DIGIT_VALUES];
            for &code in codes {
                counts[highest_digit(code)] += 1;
            }
            counts
        };
        let (front_counts, back_counts) = rayon::join(|| count(front), || count(back));
        let (mut front_low, mut back_low) = (0, 0);
        let mut first_high = 0;
        while front_low + back_low < self.codes.len() / 2 {
            front_low += front_counts[first_high] as usize;
            back_low += back_counts[first_high] as usize;
            first_high += 1;
        }
        let middle = front_low + back_low;
        let (low, high) = items.split_at_mut(middle);
        let (low_of_front, low_of_back) = low.split_at_mut(front_low);
        let (high_of_front, high_of_back) = high.split_at_mut(front.len() - front_low);
        let partition = |codes: &[u64], first_index: u64, low: &mut [u64], high: &mut [u64]| {
            let (mut low_count, mut high_count) = (0, 0);
            for (&code, index) in codes.iter().zip(first_index..) {
                let is_high = highest_digit(code) >= first_high;
                // Written to both, and only one moves on.
                for (items, count) in [(&mut *low, low_count), (&mut *high, high_count)] {
                    if let Some(item) = items.get_mut(count) {
                        *item = layout.item(code, index);
                    }
                }
                low_count += usize::from(!is_high);
                high_count += usize::from(is_high);
            }
        };
        rayon::join(
            || partition(front, 0, low_of_front, high_of_front),
            || partition(back, front.len() as u64, low_of_back, high_of_back),
        );
        middle
    }

    /// Sorts items that are sorted by their upper bits by the whole codes that their indices name, stably; leaves only indices
    /// right.
    fn sort_runs(&self, items: &mut [u64]) {
        let index_bits = self.layout.index_bits;
        for run in items.chunk_by_mut(|a, b| a >> index_bits == b >> index_bits) {
            if run.len() > 1 {
                self.sort_run(run);
            }
        }
    }

    /// Sorts a run of items that agree in their upper bits by the low bits of their codes; leaves only indices right.
    fn sort_run(&self, run: &mut [u64]) {
        let layout = self.layout;
        let code_of = |item: u64| self.codes[layout.index(item)];
        if run.len() <= SHORT_RUN {
            run.sort_unstable_by_key(|&item| (code_of(item), item));
            return;
        }
        for item in &mut *run {
            *item = layout.low_item(code_of(*item), layout.index(*item) as u64);
        }
        let mut passes = Passes::over(layout, run.iter().copied());
        let mut scratch = vec![0; run.len()];
        passes.take_first(run.iter().copied(), &mut scratch);
        let sorted = passes.take_others(&mut scratch, run).to_vec();
        run.copy_from_slice(&sorted);
    }
}

/// The passes of a radix sort by the bits above the index, from the lowest digit up.
struct Passes {
    layout: ItemLayout,
    item_count: usize,
    /// The digits in which items differ, and where the next item with each value goes.
    left: VecDeque<(usize, [u32; DIGIT_VALUES])>,
}

impl Passes {
    /// Those that sort `items`.
    fn over(layout: ItemLayout, items: impl Iterator<Item = u64>) -> Self {
        let mut item_count = 0;
        let mut counts = vec![[0u32; DIGIT_VALUES]; DIGITS];
        for item in items {
            item_count += 1;
            for (digit, counts) in counts.iter_mut().enumerate() {
                counts[layout.digit(item, digit)] += 1;
            }
        }
        let differ = |counts: &[u32; DIGIT_VALUES]| {
            counts.iter().all(|&count| (count as usize) < item_count)
        };
        let places = |counts: [u32; DIGIT_VALUES]| {
            let mut next = 0;
            counts.map(|count| {
                next += count;
                next - count
            })
        };
        let digits = counts.into_iter().enumerate();
        let left = digits
            .filter(|(_, counts)| differ(counts))
            .map(|(digit, counts)| (digit, places(counts)))
            .collect();
        Self {
            layout,
            item_count,
            left,
        }
    }

    /// Writes the items to another place, by the first digit if they differ in any.
    fn take_first(&mut self, items: impl Iterator<Item = u64>, to: &mut [u64]) {
        assert_eq!(to.len(), self.item_count, "a place for each item");
        if let Some((digit, mut next)) = self.left.pop_front() {
            items.for_each(|item| scatter(self.layout.digit(item, digit), item, &mut next, to));
        } else {
            for (place, item) in to.iter_mut().zip(items) {
                *place = item;
            }
        }
    }

    /// Writes the items from one place to the other and back, by one digit after the other; the place where they are sorted.
    fn take_others<'a>(&mut self, mut from: &'a mut [u64], mut to: &'a mut [u64]) -> &'a mut [u64] {
        while let Some((digit, mut next)) = self.left.pop_front() {
            for &item in &*from {
                scatter(self.layout.digit(item, digit), item, &mut next, to);
            }
            (from, to) = (to, from);
        }
        from
    }
}

/// Puts an item where the next one with its digit goes.
fn scatter(digit: usize, item: u64, next: &mut [u32; DIGIT_VALUES], to: &mut [u64]) {
    let place = &mut next[digit];
    to[*place as usize] = item;
    *place += 1;
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn assert_sorted_like_std(codes: &[u64]) {
        let mut expected: Vec<(u64, u32)> = codes.iter().copied().zip(0..).collect();
        expected.sort_unstable();
        let expected: Vec<u32> = expected.into_iter().map(|(_, index)| index).collect();
        assert!(order_of_codes(codes) == expected, "{} codes", codes.len());
    }

    /// A fixed sequence of well-mixed 64-bit numbers (splitmix64).
    fn mixed(seed: u64) -> u64 {
        let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    #[test]
    fn nothing_one_and_equal_codes() {
        assert_sorted_like_std(&[]);
        assert_sorted_like_std(&[42]);
        assert_sorted_like_std(&vec![7; 5000]);
        assert_sorted_like_std(&[(1 << 63) - 1, 0, (1 << 63) - 1, 1]);
    }

    #[test]
    fn long_runs_and_an_outlier() {
        // All but one share the upper 33 bits and differ below.
        let mut codes: Vec<u64> = (0..20_000).map(|i| mixed(i) >> 40).collect();
        codes[123] = (1 << 63) - 1;
        assert_sorted_like_std(&codes);
    }

    #[test]
    fn runs_of_every_length_with_duplicates() {
        let codes: Vec<u64> = (0..30_000)
            .map(|i| (mixed(i) & 0x3f) << 40 | mixed(i + 7) & 0xff)
            .collect();
        assert_sorted_like_std(&codes);
    }

    /// Many enough to be parted: evenly, and where all but one share the highest digit or none is in the lower half.
    #[test]
    fn halves_by_any_number_of_threads() {
        let even: Vec<u64> = (0..70_000).map(|i| mixed(i) >> 1).collect();
        let mut low: Vec<u64> = even.iter().map(|code| code >> 12).collect();
        low[69_999] = (1 << 63) - 1;
        let mut high: Vec<u64> = even.iter().map(|code| code >> 12 | 0x7ff << 52).collect();
        high[69_999] = 0;
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap().install(|| {
                for codes in [&even, &low, &high] {
                    assert_sorted_like_std(codes);
                }
            });
        }
    }

    proptest! {
        #[test]
        fn sorts_any_codes(codes in prop::collection::vec(0u64..1 << 63, 0..600)) {
            assert_sorted_like_std(&codes);
        }
    }
}
