//! Sorting the codes of a cloud that the caches hold whole.
//!
//! How it works: the lowest bits of each code give place to its index, and these *items* are sorted ([`super::items`]),
//! in two passes of up to 14 bits. Where codes differ in the bits that gave place alone, they are asked for.
//!
//! When it wins: over the buckets of [`super::morton_sort`] while all items fit the second and third cache, where the
//! many places that a pass writes to are near: 88,000 are sorted in two thirds to three quarters of the time. Two
//! passes of 14 bits were faster than three of 8 to 10 bits, four of 7, and two of 11 to 13, which leave more to the
//! insertion sort.
//!
//! The sort is stable, and single-threaded.

use super::items;

/// Maximum number of codes that are sorted like this. Of 2¹⁷ the items are 1 MiB.
pub(crate) const MAX: usize = 1 << INDEX_BITS;

const INDEX_BITS: u32 = 17;
const INDEX: u64 = (1 << INDEX_BITS) - 1;

/// The counters of a digit of this width are 64 KiB, an eighth of an L2 cache.
const MAX_DIGIT_BITS: u32 = 14;

/// Turns at most [`MAX`] 63-bit codes into their items.
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

/// Sorts `items` as their codes are, equal ones by index. `code` returns the code of an index; `scratch` is as long as
/// `items`, and undefined afterwards.
pub(crate) fn sort(items: &mut Vec<u64>, scratch: &mut Vec<u64>, code: impl Fn(usize) -> u64) {
    // Three bits divide a surface into four. Two more levels, so that few cells contain two points.
    let telling_bits = items.len().max(1).ilog2() * 3 / 2 + 4;
    items::sort(items, scratch, &mut Vec::new(), telling_bits, MAX_DIGIT_BITS);
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
