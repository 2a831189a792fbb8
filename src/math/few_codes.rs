//! Sorting the codes of a cloud that the caches hold whole.
//!
//! How it works: an *item* is a code whose lowest bits give place to its index, so that one number is moved, not a pair. Items
//! are sorted by a radix sort, from the lowest digit up, of only as many of their upper bits as tell most points of a surface
//! apart: two passes of up to 14 bits. What they leave is a few neighbours in the wrong order, for an insertion sort, and where
//! codes differ in the bits that gave place alone, they are asked for.
//!
//! When it wins: over the buckets of [`super::morton_sort`] while all items fit the second and third cache, where the many
//! places that a pass writes to are near: 88,000 are sorted in two thirds to three quarters of the time. Two passes of 14 bits
//! were faster than three of 8 to 10 bits, four of 7, and two of 11 to 13, which leave more to the insertion sort.
//!
//! The sort is stable, and nothing is done by several threads.

use super::morton_sort::sort_nearly_sorted;

/// Codes that are sorted in this way. Of 2¹⁷ the items are 1 MiB.
pub(crate) const MOST: usize = 1 << INDEX_BITS;

const INDEX_BITS: u32 = 17;
const INDEX: u64 = (1 << INDEX_BITS) - 1;

/// The counters of so wide a digit are 64 KiB, an eighth of a second cache.
const MOST_DIGIT_BITS: u32 = 14;

/// Turns at most [`MOST`] 63-bit codes into their items.
pub(crate) fn make_items(codes: &mut [u64]) {
    for (index, code) in (0..).zip(codes) {
        *code = *code << 1 & !INDEX | index;
    }
}

/// The index in an item.
#[inline(always)]
pub(crate) fn index_of(item: u64) -> usize {
    (item & INDEX) as usize
}

/// Sorts `items` as their codes are, equal ones by index. `code` tells the code of an index; `scratch` is as long as `items`, and
/// has nothing of meaning afterwards.
pub(crate) fn sort(items: &mut Vec<u64>, scratch: &mut Vec<u64>, code: impl Fn(usize) -> u64) {
    // Three bits divide a surface by four. Two levels more, so that few cells have two points.
    let telling_bits = items.len().max(1).ilog2() * 3 / 2 + 4;
    let digits = telling_bits.div_ceil(MOST_DIGIT_BITS);
    let bits = telling_bits.div_ceil(digits);
    let mut next = vec![0; 1 << bits];
    for from_top in (1..=digits).rev() {
        scatter(items, scratch, u64::BITS - from_top * bits, &mut next);
        std::mem::swap(items, scratch);
    }
    sort_nearly_sorted(items);
    let are_alike = |pair: &[u64]| pair[0] ^ pair[1] <= INDEX;
    let mut rest = items.as_mut_slice();
    while let Some(first) = rest.windows(2).position(are_alike) {
        let from_first = &mut rest[first..];
        let more = from_first.windows(2).take_while(|pair| are_alike(pair));
        let (run, after) = from_first.split_at_mut(1 + more.count());
        run.sort_unstable_by_key(|&item| (code(index_of(item)), item));
        rest = after;
    }
}

/// One pass of a radix sort by the digit from `first_bit` on; `next` has a counter for each.
// A function of its own, so that its loops have all registers.
#[inline(never)]
fn scatter(from: &[u64], to: &mut [u64], first_bit: u32, next: &mut [u32]) {
    let mask = next.len() - 1;
    let digit = |item: u64| (item >> first_bit) as usize & mask;
    next.fill(0);
    for &item in from {
        next[digit(item)] += 1;
    }
    let mut start = 0;
    for count in &mut *next {
        start += std::mem::replace(count, start);
    }
    for &item in from {
        let next = &mut next[digit(item)];
        let place = *next as usize;
        *next += 1;
        to[place] = item;
    }
}
