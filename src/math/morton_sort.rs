//! Sorting by Morton codes: points are put in the order in which an octree visits them.
//!
//! How it works: codes, each with its payload, are first parted into 4,096 buckets by their highest twelve bits
//! (the cells of octree level 4), chunk by chunk. Then each bucket is gathered from all chunks and sorted.
//!
//! ```text
//! codes ── chunks of 65,536 ──► each chunk parted ── bucket after bucket, from all chunks ──► sorted
//!          a task each          into buckets         a task each
//! ```
//!
//! A bucket is sorted as *items* ([`super::items`]): numbers that have the bits in which its codes differ above an
//! index. Of up to 8,192 codes an item has all bits that a bucket leaves to differ, so that codes are read off the
//! sorted items; of more, the lowest give place, and where items are alike in all others, the codes are looked up. Most
//! of a surface is in order after two passes. Clouds that are not surfaces, or that an outlier squeezes into few cells,
//! leave more, which is then sorted by comparison.
//!
//! When it wins: each point is moved once through memory, to its bucket, and all else happens in the L1 and L2 caches,
//! while a radix sort of the whole moves it once per digit and then fetches the payload of each code from anywhere.
//! Codes are made chunk by chunk as they are parted, and never written to memory before. Tasks share nothing.
//!
//! Codes that are in order already, which one pass over them checks, are left alone.
//!
//! Up to 2¹⁷ codes fit into the caches, and [`super::few_codes`] sorts them without buckets.
//!
//! The sort is stable: equal codes stay in the order in which they were given. Nothing depends on timing or threads.

use super::{few_codes, items};
use rayon::prelude::*;
use std::ops::Range;

/// The indices of 63-bit `codes` in the order of the codes; of equal codes by ascending index.
///
/// # Panics
/// Preconditions: at most 2³² codes, each below 2⁶³.
pub fn order_of_codes(codes: &[u64]) -> Vec<u32> {
    assert!(
        codes.len() as u64 <= 1 << 32,
        "indices of {} codes do not fit 32 bits",
        codes.len()
    );
    if codes.is_sorted() {
        return (0..codes.len() as u32).collect();
    }
    if codes.len() <= few_codes::MAX {
        let mut items = codes.to_vec();
        few_codes::make_items(&mut items);
        few_codes::sort(&mut items, &mut vec![0; codes.len()], |index| codes[index]);
        return items.into_iter().map(|item| few_codes::index_of(item) as u32).collect();
    }
    order_in_buckets(codes)
}

fn order_in_buckets(codes: &[u64]) -> Vec<u32> {
    let write_codes = |range, out: &mut [u64]| out.copy_from_slice(&codes[range]);
    let buckets = Buckets::new(codes.len(), write_codes, |index| index as u32);
    let mut order = vec![0; codes.len()];
    buckets.sort_each(&mut order, vec![(); BUCKETS], |_, ()| {});
    order
}

const CODE_BITS: u32 = 63;
// 2,048 buckets instead of 512 took 0.91 of the time, 4,096 0.89; 64 were not faster (1,000,000 points, one thread).
const BUCKET_BITS: u32 = 12;
const BUCKETS: usize = 1 << BUCKET_BITS;

/// Codes that are parted together: their source and target are near the size of an L2 cache, and a
/// bucket's part of it, on a surface, is longer than a few cache lines.
// 32,768 codes took 0.88 of the time, 65,536 0.85, all at once 0.93; 131,072 took 0.83, but are too few tasks for
// 200,000 points.
const CHUNK: usize = 1 << 16;

/// Codes and their payloads, parted by the highest bits of the codes.
pub(crate) struct Buckets<T> {
    chunks: Vec<Parted<T>>,
    /// Codes of each bucket in all chunks.
    lens: Vec<usize>,
}

/// The codes of a chunk by bucket, within that in the order given.
struct Parted<T> {
    codes: Vec<u64>,
    carried: Vec<T>,
    /// End index of each bucket.
    ends: [u32; BUCKETS],
}

impl<T: Copy + Default + Send + Sync> Buckets<T> {
    /// Parts `count` 63-bit codes, which `write_codes` writes for any range of them, each with the payload that
    /// `carried` returns for its index.
    pub(crate) fn new(
        count: usize,
        write_codes: impl Fn(Range<usize>, &mut [u64]) + Sync,
        carried: impl Fn(usize) -> T + Sync,
    ) -> Self {
        let chunks: Vec<Parted<T>> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map_init(Vec::new, |codes, chunk| {
                let range = CHUNK * chunk..count.min(CHUNK * (chunk + 1));
                codes.resize(range.len(), 0);
                write_codes(range.clone(), codes);
                Parted::new(codes, |index| carried(range.start + index))
            })
            .collect();
        let mut lens = vec![0; BUCKETS];
        for chunk in &chunks {
            let mut start = 0;
            for (len, &end) in lens.iter_mut().zip(&chunk.ends) {
                *len += (end - start) as usize;
                start = end;
            }
        }
        Self { chunks, lens }
    }

    /// The part of `out` that belongs to each bucket. Precondition: one entry per code.
    pub(crate) fn places<'o, O>(&self, mut out: &'o mut [O]) -> Vec<&'o mut [O]> {
        let place = |&len: &usize| out.split_off_mut(..len);
        self.lens.iter().filter_map(place).collect()
    }

    /// Writes to `carried` the items that go with each code, in their order, and passes the codes of each bucket to
    /// `write`, in order, with the output slice of the bucket. Items without codes are skipped.
    pub(crate) fn sort_each<P: Send>(&self, carried: &mut [T], places: Vec<P>, write: impl Fn(&[u64], P) + Sync) {
        // Buckets share nothing. A radix sort in which all threads write to one array (atomics) took twice as long on
        // two threads as two independent halves.
        self.places(carried)
            .into_par_iter()
            .zip(places)
            .enumerate()
            .filter(|&(bucket, _)| self.lens[bucket] > 0)
            .for_each_init(Sorter::default, |sorter, (bucket, (carried, place))| {
                write(sorter.sort(self, bucket, carried), place);
            });
    }
}

impl<T: Copy + Default> Parted<T> {
    /// Parts codes, each with the payload that `carried` returns for its index.
    fn new(codes: &[u64], carried: impl Fn(usize) -> T) -> Self {
        let mut parted_codes = vec![0; codes.len()];
        let mut parted_carried = vec![T::default(); codes.len()];
        let mut ends = [0; BUCKETS];
        items::scatter(codes, &mut ends, bucket_of, |index, code, place| {
            parted_codes[place] = code;
            parted_carried[place] = carried(index);
        });
        Self {
            codes: parted_codes,
            carried: parted_carried,
            ends,
        }
    }

    /// Returns the contents of a bucket.
    fn piece(&self, bucket: usize) -> (&[u64], &[T]) {
        let start = bucket.checked_sub(1).map_or(0, |before| self.ends[before]);
        let piece = start as usize..self.ends[bucket] as usize;
        (&self.codes[piece.clone()], &self.carried[piece])
    }
}

fn bucket_of(code: u64) -> usize {
    (code >> (CODE_BITS - BUCKET_BITS)) as usize % BUCKETS
}

/// Sorts one bucket after another in the same memory.
#[derive(Default)]
struct Sorter<T> {
    items: Vec<u64>,
    scratch: Vec<u64>,
    next: Vec<u32>,
    /// In the order of the chunks, if items have no space for all their bits.
    codes: Vec<u64>,
    carried: Vec<T>,
}

impl<T: Copy + Default> Sorter<T> {
    /// The codes of a bucket in order; their payloads are written to `carried`.
    fn sort(&mut self, buckets: &Buckets<T>, bucket: usize, carried: &mut [T]) -> &[u64] {
        let pieces = || buckets.chunks.iter().map(|chunk| chunk.piece(bucket));
        let (mut all, mut any) = (u64::MAX, 0);
        for &code in pieces().flat_map(|(codes, _)| codes) {
            all &= code;
            any |= code;
        }
        let layout = ItemLayout::new(all ^ any, carried.len());
        self.items.clear();
        self.codes.clear();
        self.carried.clear();
        for (codes, carried) in pieces() {
            let indexed = (self.items.len() as u64..).zip(codes);
            self.items
                .extend(indexed.map(|(index, &code)| layout.item(code, index)));
            self.carried.extend_from_slice(carried);
            if !layout.has_all {
                self.codes.extend_from_slice(codes);
            }
        }
        self.scratch.resize(self.items.len(), 0);
        self.sort_items(layout);
        for (carried, &item) in carried.iter_mut().zip(&self.items) {
            *carried = self.carried[layout.index_of(item)];
        }
        for item in &mut self.items {
            *item = if layout.has_all {
                layout.code(*item, all)
            } else {
                self.codes[layout.index_of(*item)]
            };
        }
        &self.items
    }

    fn sort_items(&mut self, layout: ItemLayout) {
        /// Up to this many items are sorted by comparison in less time than the counters of a radix sort are cleared.
        const FEW: usize = 64;
        /// The counters of a digit of this width are a quarter of an L1 cache.
        const MAX_DIGIT_BITS: u32 = 11;
        let count = self.items.len();
        // Three bits divide a surface into four. One more level, so that few cells contain two points.
        let telling_bits = if count > FEW {
            (count.ilog2() * 3 / 2 + 4).min(layout.differing_bits())
        } else {
            0
        };
        items::sort(
            &mut self.items,
            &mut self.scratch,
            &mut self.next,
            telling_bits,
            MAX_DIGIT_BITS,
        );
        if !layout.has_all {
            let runs = self.items.chunk_by_mut(|&a, &b| layout.are_alike(a, b));
            for run in runs.filter(|run| run.len() > 1) {
                run.sort_unstable_by_key(|&item| (self.codes[layout.index_of(item)], item));
            }
        }
    }
}

/// Bit layout of a number that holds a code above its index.
#[derive(Debug, Clone, Copy)]
struct ItemLayout {
    /// Upper bits of a code that do not differ, which an item does not have.
    skipped: u32,
    /// The bits of the index, which the lowest bits of a code give place to.
    index: u64,
    /// True if the bits displaced by the index are none in which codes differ.
    has_all: bool,
}

impl ItemLayout {
    /// For this many 63-bit codes that differ in some of these bits.
    fn new(differing: u64, count: usize) -> Self {
        let skipped = differing.leading_zeros().min(u64::BITS - 1);
        let index_bits = count.next_power_of_two().ilog2();
        Self {
            skipped,
            index: (1 << index_bits) - 1,
            has_all: index_bits <= skipped,
        }
    }

    fn differing_bits(self) -> u32 {
        u64::BITS - self.skipped
    }

    #[inline(always)]
    fn item(self, code: u64, index: u64) -> u64 {
        code << self.skipped & !self.index | index
    }

    #[inline(always)]
    fn index_of(self, item: u64) -> usize {
        (item & self.index) as usize
    }

    /// The code of an item that has all but the bits shared with `alike`.
    #[inline(always)]
    fn code(self, item: u64, alike: u64) -> u64 {
        let differing = u64::MAX >> self.skipped;
        (item & !self.index) >> self.skipped | alike & !differing
    }

    /// Returns true if two items have the same bits of their codes.
    #[inline(always)]
    fn are_alike(self, a: u64, b: u64) -> bool {
        a ^ b <= self.index
    }
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
        assert!(order_in_buckets(codes) == expected, "{} codes in buckets", codes.len());
    }

    /// A fixed sequence of well-mixed 64-bit numbers (splitmix64).
    fn mixed(seed: u64) -> u64 {
        let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    #[test]
    fn empty_single_and_equal_codes_are_sorted() {
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

    /// Many in one bucket, which differ in more bits than an item keeps, some in those that it does not keep alone.
    #[test]
    fn codes_too_long_for_an_item_are_sorted() {
        let codes: Vec<u64> = (0..20_000).map(|i| (mixed(i) % 8) << 48 | mixed(i + 7) & 7).collect();
        assert_sorted_like_std(&codes);
    }

    /// Few enough in one bucket that items keep all, but most alike in the bits that passes are made over.
    #[test]
    fn codes_that_radix_passes_leave_unsorted_are_sorted() {
        let mut codes: Vec<u64> = (0..1000).map(|i| mixed(i) & 0xf_ffff).collect();
        codes[500] |= 1 << 50;
        assert_sorted_like_std(&codes);
    }

    /// Several chunks: evenly, and where all but one are in one bucket, the first or the last.
    #[test]
    fn chunks_by_any_number_of_threads() {
        let even: Vec<u64> = (0..140_000).map(|i| mixed(i) >> 1).collect();
        let mut low: Vec<u64> = even.iter().map(|code| code >> 12).collect();
        low[139_999] = (1 << 63) - 1;
        let mut high: Vec<u64> = even.iter().map(|code| code >> 12 | 0x7ff << 52).collect();
        high[139_999] = 0;
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap().install(|| {
                for codes in [&even, &low, &high] {
                    assert_sorted_like_std(codes);
                }
            });
        }
    }

    /// As many as are sorted without buckets, and one more.
    #[test]
    fn few_and_many_codes() {
        for count in [few_codes::MAX, few_codes::MAX + 1] {
            let codes: Vec<u64> = (0..count as u64).map(|i| mixed(i) >> 1).collect();
            assert_sorted_like_std(&codes);
        }
    }

    #[test]
    fn items_return_their_codes_if_they_hold_all_bits() {
        for (codes, has_all) in [
            (vec![0x7fff_ffff_ffff_ffff, 1, 0], false),
            (vec![5 << 60 | 3 << 50 | 1, 5 << 60 | 7], true),
            (vec![9 << 40; 1 << 14], true),
            (vec![42], true),
        ] {
            let differing = codes.iter().fold(0, |bits, code| bits | code ^ codes[0]);
            let layout = ItemLayout::new(differing, codes.len());
            assert_eq!(layout.has_all, has_all);
            for (index, &code) in codes.iter().enumerate() {
                let item = layout.item(code, index as u64);
                assert_eq!(layout.index_of(item), index);
                assert!(!has_all || layout.code(item, codes[0]) == code);
            }
        }
    }

    /// Codes that differ in their lowest bits alone, which the index of an item takes the place of, in runs of every
    /// length.
    #[test]
    fn codes_whose_items_differ_in_the_index_alone() {
        let codes: Vec<u64> = (0..5000)
            .map(|i| mixed(i % 1000 * (i % 7)) << 16 >> 1 | mixed(i) & 0xffff)
            .collect();
        assert_sorted_like_std(&codes);
        let alike: Vec<u64> = (0..500).map(|i| 5 << 40 | mixed(i) & 0xff).collect();
        assert_sorted_like_std(&alike);
    }

    proptest! {
        #[test]
        fn sorts_any_codes(codes in prop::collection::vec(0u64..1 << 63, 0..600)) {
            assert_sorted_like_std(&codes);
        }
    }
}
