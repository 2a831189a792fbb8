//! The order of Morton codes, and so of the points they belong to.
//!
//! How it works: a radix sort from the lowest digit up (LSD), but only over the highest 33 bits of the code, the first
//! 11 octree levels. An item is one `u64`: those 33 bits above the 31-bit index of the point, so that code and index
//! travel in 8 bytes and three passes of 11 bits sort them.
//!
//! ```text
//! 63 ........ 53 52 ........ 42 41 ........ 31 30 ......... 0
//!   third digit   second digit   first digit    point index
//! ```
//!
//! Points that share all 11 levels now stand in runs, which are sorted by the 30 bits left: short runs by comparison,
//! long ones (an outlier far away squeezes the whole cloud into few cells) by a second radix sort.
//!
//! When it wins: at 11 levels the cells of a scanned surface hold one point or two, so half of the passes that a sort of
//! all 63 bits makes would move nothing. A digit in which all items agree costs no pass either.
//!
//! Codes that are in order already are left alone, which one look over them tells.
//!
//! Halves of many codes, parted by the highest digit, are sorted by two threads.
//!
//! The sort is stable: equal codes stay in the order of their indices. Nothing depends on timing or threads.

const INDEX_BITS: u32 = 31;
const INDEX_MASK: u64 = (1 << INDEX_BITS) - 1;
/// Bits of a 63-bit code that find no room beside the index.
const LOW_BITS: u32 = 30;

const DIGIT_BITS: u32 = 11;
const DIGIT_VALUES: usize = 1 << DIGIT_BITS;
const DIGITS: usize = 3;

/// Below this a comparison sort is done before the digit counters of a radix sort are cleared.
const SHORT_RUN: usize = 1024;

/// The indices of 63-bit `codes` in the order of the codes; of equal codes by ascending index.
///
/// # Panics
/// Preconditions: at most 2³¹ codes, each below 2⁶³.
pub fn order_of_codes(codes: &[u64]) -> Vec<u32> {
    assert!(
        codes.len() as u64 <= 1 << INDEX_BITS,
        "indices of {} points do not fit 31 bits",
        codes.len()
    );
    if codes.is_sorted() {
        return (0..codes.len() as u32).collect();
    }
    let mut scratch = vec![0; codes.len()];
    if codes.len() < 2 * PARALLEL_CODES || rayon::current_num_threads() == 1 {
        let items = codes.iter().zip(0..);
        let mut items: Vec<u64> = items.map(|(&code, index)| item_of(code, index)).collect();
        sort_part(codes, &mut items, &mut scratch);
        return items
            .into_iter()
            .map(|item| index_of(item) as u32)
            .collect();
    }
    let mut items = vec![0; codes.len()];
    let mut order = vec![0; codes.len()];
    let middle = partition_near_half(codes, &mut items);
    let (low, high) = items.split_at_mut(middle);
    let (low_scratch, high_scratch) = scratch.split_at_mut(middle);
    let (low_order, high_order) = order.split_at_mut(middle);
    let sort = |items: &mut [u64], scratch: &mut [u64], order: &mut [u32]| {
        sort_part(codes, items, scratch);
        for (index, &item) in order.iter_mut().zip(&*items) {
            *index = index_of(item) as u32;
        }
    };
    rayon::join(
        || sort(low, low_scratch, low_order),
        || sort(high, high_scratch, high_order),
    );
    order
}

/// Below this, codes are not shared out among threads.
const PARALLEL_CODES: usize = 1 << 14;

/// The item of a code.
fn item_of(code: u64, index: u64) -> u64 {
    code >> LOW_BITS << INDEX_BITS | index
}

/// Writes the items of `codes`, first those with a small highest digit, then the others, both in their order; how many
/// come first: about half, as far as whole digits allow. On two threads, a half of the codes each.
fn partition_near_half(codes: &[u64], items: &mut [u64]) -> usize {
    let (front, back) = codes.split_at(codes.len() / 2);
    let highest_digit = |code: u64| digit_of(item_of(code, 0), DIGITS - 1);
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
    while front_low + back_low < codes.len() / 2 {
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
                    *item = item_of(code, index);
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

/// Sorts `items` by the whole codes that their indices name, stably; leaves only indices right.
fn sort_part(codes: &[u64], items: &mut [u64], scratch: &mut [u64]) {
    sort_items(items, scratch);
    for run in items.chunk_by_mut(|a, b| a >> INDEX_BITS == b >> INDEX_BITS) {
        match run {
            [_] => {}
            // Most runs: two selections instead of branches that are taken as often as not.
            &mut [ref mut a, ref mut b] => {
                let ascends = codes[index_of(*a)] <= codes[index_of(*b)];
                (*a, *b) = if ascends { (*a, *b) } else { (*b, *a) };
            }
            run => sort_run(run, codes, scratch),
        }
    }
}

fn index_of(item: u64) -> usize {
    (item & INDEX_MASK) as usize
}

/// Sorts a run of items that agree in their upper bits by the low bits of their codes; leaves only indices right.
fn sort_run(run: &mut [u64], codes: &[u64], scratch: &mut [u64]) {
    if run.len() <= SHORT_RUN {
        run.sort_unstable_by_key(|&item| (codes[index_of(item)], item));
        return;
    }
    for item in &mut *run {
        let low = codes[index_of(*item)] & ((1 << LOW_BITS) - 1);
        *item = low << INDEX_BITS | *item & INDEX_MASK;
    }
    let scratch = &mut scratch[..run.len()];
    sort_items(run, scratch);
}

/// Sorts `items` by the 33 bits above the index, stably. `scratch` is as long as `items`.
fn sort_items(items: &mut [u64], scratch: &mut [u64]) {
    let mut counts = vec![[0u32; DIGIT_VALUES]; DIGITS];
    for &item in &*items {
        for (digit, counts) in counts.iter_mut().enumerate() {
            counts[digit_of(item, digit)] += 1;
        }
    }
    let mut in_scratch = false;
    for (digit, counts) in counts.iter_mut().enumerate() {
        if counts.iter().any(|&count| count as usize == items.len()) {
            continue;
        }
        let mut next = 0;
        for count in counts.iter_mut() {
            next += std::mem::replace(count, next);
        }
        let (from, to) = if in_scratch {
            (&*scratch, &mut *items)
        } else {
            (&*items, &mut *scratch)
        };
        for &item in from {
            let place = &mut counts[digit_of(item, digit)];
            to[*place as usize] = item;
            *place += 1;
        }
        in_scratch = !in_scratch;
    }
    if in_scratch {
        items.copy_from_slice(scratch);
    }
}

fn digit_of(item: u64, digit: usize) -> usize {
    (item >> (INDEX_BITS + DIGIT_BITS * digit as u32)) as usize & (DIGIT_VALUES - 1)
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
