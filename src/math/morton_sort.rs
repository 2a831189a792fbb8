//! Sorting by Morton codes: points are put in the order in which an octree visits them.
//!
//! How it works: codes, each with what goes with it, are first parted into 512 buckets by their highest nine bits (the cells
//! of octree level 3), chunk by chunk. Then each bucket is gathered from all chunks and sorted.
//!
//! ```text
//! codes ── chunks of 32,768 ──► each chunk parted ── bucket after bucket, from all chunks ──► sorted
//!          a task each          into buckets         a task each
//! ```
//!
//! A bucket is sorted by a radix sort, from the lowest digit up, of numbers that have the code's bits above an index; but only
//! by as many of the bits in which its codes differ as tell most points of a surface apart, which makes two passes. What they
//! leave is a few neighbours in the wrong order, for an insertion sort. Clouds that are no surfaces, or that an outlier
//! squeezes into few cells, leave more, which is then sorted by comparison.
//!
//! When it wins: each point is moved once through memory, to its bucket, and all else happens in the second cache, while a radix
//! sort of the whole moves it once for each digit and then fetches what goes with each code from anywhere. Tasks share nothing.
//!
//! Codes that are in order already are left alone, which one look over them tells.
//!
//! Of up to 2¹⁷ codes the caches hold all, and [`super::few_codes`] sorts them without buckets.
//!
//! The sort is stable: equal codes stay in the order in which they were given. Nothing depends on timing or threads.

use super::few_codes;
use rayon::prelude::*;

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
    if codes.len() <= few_codes::MOST {
        let mut items = codes.to_vec();
        few_codes::make_items(&mut items);
        few_codes::sort(&mut items, &mut vec![0; codes.len()], |index| codes[index]);
        return items
            .into_iter()
            .map(|item| few_codes::index_of(item) as u32)
            .collect();
    }
    order_in_buckets(codes)
}

fn order_in_buckets(codes: &[u64]) -> Vec<u32> {
    let buckets = Buckets::new(codes, |index| index as u32);
    let mut order = vec![0; codes.len()];
    buckets.sort_each(buckets.places(&mut order), |_, indices, order| {
        order.copy_from_slice(indices);
    });
    order
}

const CODE_BITS: u32 = 63;
const BUCKET_BITS: u32 = 9;
const BUCKETS: usize = 1 << BUCKET_BITS;

/// Codes that are parted together: what they are read from and written to stays in the second cache.
const CHUNK: usize = 1 << 15;

/// Codes, and what goes with each, parted by the highest bits of the codes.
pub(crate) struct Buckets<T> {
    /// Chunk after chunk, within each by bucket, within that in the order given.
    codes: Vec<u64>,
    carried: Vec<T>,
    /// Where each bucket ends in each chunk.
    ends: Vec<[u32; BUCKETS]>,
    /// Codes of each bucket in all chunks.
    lens: [usize; BUCKETS],
}

impl<T: Copy + Default + Send + Sync> Buckets<T> {
    /// Parts 63-bit `codes`, each with what `carried` says goes with its index.
    pub(crate) fn new(codes: &[u64], carried: impl Fn(usize) -> T + Sync) -> Self {
        let mut parted_codes = vec![0; codes.len()];
        let mut parted_carried = vec![T::default(); codes.len()];
        let ends: Vec<[u32; BUCKETS]> = codes
            .par_chunks(CHUNK)
            .zip(parted_codes.par_chunks_mut(CHUNK))
            .zip(parted_carried.par_chunks_mut(CHUNK))
            .enumerate()
            .map(|(chunk, ((codes, parted_codes), parted_carried))| {
                let first = CHUNK * chunk;
                let mut next = [0; 2 * BUCKETS];
                let ends = scatter(codes, &mut next, bucket_of, |index, code, place| {
                    parted_codes[place] = code;
                    parted_carried[place] = carried(first + index);
                });
                ends.try_into().expect("an end for each bucket")
            })
            .collect();
        let mut lens = [0; BUCKETS];
        for ends in &ends {
            let mut start = 0;
            for (len, &end) in lens.iter_mut().zip(ends) {
                *len += (end - start) as usize;
                start = end;
            }
        }
        Self {
            codes: parted_codes,
            carried: parted_carried,
            ends,
            lens,
        }
    }

    /// The part of `out` that belongs to each bucket. Precondition: as many as there are codes.
    pub(crate) fn places<'o, O>(&self, mut out: &'o mut [O]) -> Vec<&'o mut [O]> {
        let place = |&len: &usize| out.split_off_mut(..len);
        self.lens.iter().filter_map(place).collect()
    }

    /// Hands the codes of each bucket to `write`, in order, with what goes with each, and the place of the bucket. Those without
    /// codes are left out.
    pub(crate) fn sort_each<P: Send>(
        &self,
        places: Vec<P>,
        write: impl Fn(&[u64], &[T], P) + Sync,
    ) {
        places
            .into_par_iter()
            .enumerate()
            .filter(|&(bucket, _)| self.lens[bucket] > 0)
            .for_each_init(Sorter::default, |sorter, (bucket, place)| {
                sorter.gather(self, bucket);
                let (codes, carried) = sorter.sort();
                write(codes, carried, place);
            });
    }
}

fn bucket_of(code: u64) -> usize {
    (code >> (CODE_BITS - BUCKET_BITS)) as usize % BUCKETS
}

/// Sorts one bucket after another in the same memory.
#[derive(Default)]
struct Sorter<T> {
    codes: Vec<u64>,
    carried: Vec<T>,
    items: Vec<u64>,
    scratch: Vec<u64>,
    carried_in_order: Vec<T>,
    next: Vec<u32>,
}

impl<T: Copy + Default> Sorter<T> {
    /// Takes a bucket from all chunks.
    fn gather(&mut self, buckets: &Buckets<T>, bucket: usize) {
        self.codes.clear();
        self.carried.clear();
        let chunks = buckets.codes.chunks(CHUNK);
        let chunks = chunks.zip(buckets.carried.chunks(CHUNK));
        for (ends, (codes, carried)) in buckets.ends.iter().zip(chunks) {
            let start = bucket.checked_sub(1).map_or(0, |before| ends[before]);
            let piece = start as usize..ends[bucket] as usize;
            self.codes.extend_from_slice(&codes[piece.clone()]);
            self.carried.extend_from_slice(&carried[piece]);
        }
    }

    /// The codes in order, and what goes with each.
    fn sort(&mut self) -> (&[u64], &[T]) {
        let count = self.codes.len();
        if self.items.len() < count {
            self.items.resize(count, 0);
            self.scratch.resize(count, 0);
            self.carried_in_order.resize(count, T::default());
        }
        let (items, scratch) = (&mut self.items[..count], &mut self.scratch[..count]);
        let layout = ItemLayout::of(&self.codes);
        let (items, codes) = sort(&self.codes, layout, items, scratch, &mut self.next);
        let carried = &mut self.carried_in_order[..count];
        for ((code, carried), &mut item) in codes.iter_mut().zip(&mut *carried).zip(items) {
            let index = layout.index_of(item);
            *code = self.codes[index];
            *carried = self.carried[index];
        }
        (codes, carried)
    }
}

/// How one number holds some bits of a code above the index of the code: the upper ones of the bits in which codes differ, as many
/// as there is room for.
#[derive(Debug, Clone, Copy)]
struct ItemLayout {
    /// Bits of the index.
    index: u32,
    /// Bits of the code that are kept.
    kept: u32,
    /// The lowest bits of a code, which are not kept.
    left_out: u32,
}

impl ItemLayout {
    fn of(codes: &[u64]) -> Self {
        let index = usize::BITS - codes.len().leading_zeros();
        let differing = codes.iter().fold(0, |bits, code| bits | code ^ codes[0]);
        let differing_bits = u64::BITS - differing.leading_zeros();
        let kept = differing_bits.min(u64::BITS - index);
        Self {
            index,
            kept,
            left_out: differing_bits - kept,
        }
    }

    #[inline(always)]
    fn item(self, code: u64, index: usize) -> u64 {
        let kept = code >> self.left_out & ((1 << self.kept) - 1);
        kept << self.index | index as u64
    }

    #[inline(always)]
    fn index_of(self, item: u64) -> usize {
        (item & ((1 << self.index) - 1)) as usize
    }

    /// Digits, from the lowest up, of the upper ones of the bits kept, that tell most of `count` points of a surface apart.
    fn digits(self, count: usize) -> impl Iterator<Item = Digit> {
        /// Up to so many points are sorted by comparison before the counters of a radix sort are cleared.
        const FEW: usize = 64;
        const MOST_BITS: u32 = 11;
        // Three bits divide a surface by four. One level more, so that few cells have two points.
        let telling_bits = if count > FEW {
            count.ilog2() * 3 / 2 + 4
        } else {
            0
        };
        let bits = telling_bits.min(self.kept);
        let digits = bits.div_ceil(MOST_BITS);
        let bits_each = bits.div_ceil(digits.max(1));
        let end = self.index + self.kept;
        (1..=digits).rev().map(move |from_top| Digit {
            first_bit: end.saturating_sub(from_top * bits_each).max(self.index),
            bits: bits_each,
        })
    }
}

/// Some bits of a number.
#[derive(Debug, Clone, Copy)]
struct Digit {
    first_bit: u32,
    bits: u32,
}

impl Digit {
    #[inline(always)]
    fn of(self, item: u64) -> usize {
        (item >> self.first_bit) as usize & ((1 << self.bits) - 1)
    }
}

/// The items of `codes` in their order, stably, in one of the two places; and the other one.
fn sort<'a>(
    codes: &[u64],
    layout: ItemLayout,
    mut items: &'a mut [u64],
    mut scratch: &'a mut [u64],
    next: &mut Vec<u32>,
) -> (&'a mut [u64], &'a mut [u64]) {
    for (index, (item, &code)) in items.iter_mut().zip(codes).enumerate() {
        *item = layout.item(code, index);
    }
    for digit in layout.digits(codes.len()) {
        scatter_items(items, scratch, digit, next);
        (items, scratch) = (scratch, items);
    }
    sort_nearly_sorted(items);
    if layout.left_out > 0 {
        let kept = |item: u64| item >> layout.index;
        for run in items.chunk_by_mut(|&a, &b| kept(a) == kept(b)) {
            if run.len() > 1 {
                run.sort_unstable_by_key(|&item| (codes[layout.index_of(item)], item));
            }
        }
    }
    (items, scratch)
}

/// One pass of a radix sort.
// A function of its own, so that its loops have all registers.
#[inline(never)]
fn scatter_items(from: &[u64], to: &mut [u64], digit: Digit, next: &mut Vec<u32>) {
    next.resize(2 << digit.bits, 0);
    scatter(
        from,
        next,
        |item| digit.of(item),
        |_, item, place| to[place] = item,
    );
}

/// Tells `put` the index of each number, the number and its place: first those of small digits, equal ones in the order given.
/// Returns where each digit ends. `next` has room for two counters a digit.
///
/// The front and the back half are gone through side by side, with counters of their own: neighbours often have the same
/// digit, and a counter that was just written is slow to read.
#[inline(always)]
fn scatter<'n>(
    from: &[u64],
    next: &'n mut [u32],
    digit: impl Fn(u64) -> usize,
    mut put: impl FnMut(usize, u64, usize),
) -> &'n [u32] {
    next.fill(0);
    let (next_of_front, next_of_back) = next.split_at_mut(next.len() / 2);
    let middle = from.len() / 2;
    let (front, back) = from.split_at(middle);
    let (back, odd) = back.split_at(middle);
    for (&a, &b) in front.iter().zip(back) {
        next_of_front[digit(a)] += 1;
        next_of_back[digit(b)] += 1;
    }
    for &item in odd {
        next_of_back[digit(item)] += 1;
    }
    let mut start = 0;
    for (front, back) in next_of_front.iter_mut().zip(&mut *next_of_back) {
        start += std::mem::replace(front, start);
        start += std::mem::replace(back, start);
    }
    let mut put_next = |index: usize, item: u64, next: &mut [u32]| {
        let next = &mut next[digit(item)];
        let place = *next as usize;
        // Written before `put` writes anything, so that it need not be read again.
        *next += 1;
        put(index, item, place);
    };
    for (index, (&a, &b)) in front.iter().zip(back).enumerate() {
        put_next(index, a, next_of_front);
        put_next(middle + index, b, next_of_back);
    }
    for &item in odd {
        put_next(from.len() - 1, item, next_of_back);
    }
    // Once all are in place, starts have become ends.
    next_of_back
}

/// Sorts numbers of which most are in place and the others near.
pub(super) fn sort_nearly_sorted(items: &mut [u64]) {
    /// An insertion sort has no business here if a number is further away.
    const FAR: usize = 32;
    for i in 1..items.len() {
        let item = items[i];
        let mut place = i;
        while place > 0 && items[place - 1] > item {
            if i - place == FAR {
                items[place] = item;
                items.sort_unstable();
                return;
            }
            items[place] = items[place - 1];
            place -= 1;
        }
        items[place] = item;
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
        assert!(
            order_in_buckets(codes) == expected,
            "{} codes in buckets",
            codes.len()
        );
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

    /// Many in one bucket, which differ in more bits than an item keeps, some in those that it does not keep alone.
    #[test]
    fn codes_that_an_item_has_no_room_for() {
        let codes: Vec<u64> = (0..9000)
            .map(|i| (mixed(i) % 64) << 48 | mixed(i + 7) & 7)
            .collect();
        assert_sorted_like_std(&codes);
    }

    /// Few enough in one bucket that items keep all, but most alike in the bits that passes are made over.
    #[test]
    fn codes_that_passes_leave_unsorted() {
        let mut codes: Vec<u64> = (0..1000).map(|i| mixed(i) & 0xf_ffff).collect();
        codes[500] |= 1 << 53;
        assert_sorted_like_std(&codes);
    }

    /// Several chunks: evenly, and where all but one are in one bucket, the first or the last.
    #[test]
    fn chunks_by_any_number_of_threads() {
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

    /// More than are sorted without buckets, and as many as that.
    #[test]
    fn few_and_many_codes() {
        for count in [few_codes::MOST, few_codes::MOST + 1] {
            let codes: Vec<u64> = (0..count as u64).map(|i| mixed(i) >> 1).collect();
            assert_sorted_like_std(&codes);
        }
    }

    /// Codes that differ in their lowest bits alone, which the index of an item takes the place of, in runs of every length.
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
