//! Sorting numbers that have a Morton code above an index.
//!
//! How it works: one number is moved, not a pair. A radix sort, from the lowest digit up, goes over only as many of the
//! upper bits as separate most points of a surface. It leaves a few neighbours in the wrong order, for an insertion
//! sort.

/// Sorts `items` in passes over their upper `telling_bits`, each of at most this many bits, and by comparison.
/// `scratch` is as long as `items`; it and `next` are undefined afterwards.
pub(super) fn sort(
    items: &mut Vec<u64>,
    scratch: &mut Vec<u64>,
    next: &mut Vec<u32>,
    telling_bits: u32,
    max_digit_bits: u32,
) {
    let digits = telling_bits.div_ceil(max_digit_bits);
    let bits = telling_bits.div_ceil(digits.max(1));
    next.resize(1 << bits, 0);
    for from_top in (1..=digits).rev() {
        scatter_items(items, scratch, u64::BITS - from_top * bits, next);
        std::mem::swap(items, scratch);
    }
    sort_nearly_sorted(items);
}

/// One pass of a radix sort by the digit from `first_bit` on; `next` has a counter for each.
// A separate function, so that its loops can use all registers.
#[inline(never)]
fn scatter_items(from: &[u64], to: &mut [u64], first_bit: u32, next: &mut [u32]) {
    let mask = next.len() - 1;
    let digit = |item: u64| (item >> first_bit) as usize & mask;
    scatter(from, next, digit, |_, item, place| to[place] = item);
}

/// Passes to `put` the index of each number, the number and its place: first those of small digits, equal ones in the
/// order given. `next` has a counter for each digit, and at last where it ends.
#[inline(always)]
pub(super) fn scatter(
    from: &[u64],
    next: &mut [u32],
    digit: impl Fn(u64) -> usize,
    mut put: impl FnMut(usize, u64, usize),
) {
    next.fill(0);
    for &item in from {
        next[digit(item)] += 1;
    }
    let mut start = 0;
    for count in &mut *next {
        start += std::mem::replace(count, start);
    }
    for (index, &item) in from.iter().enumerate() {
        let next = &mut next[digit(item)];
        let place = *next as usize;
        // Written before `put` writes anything, so that it need not be read again.
        *next += 1;
        put(index, item, place);
    }
}

/// Sorts numbers of which most are in place and the others near.
fn sort_nearly_sorted(items: &mut [u64]) {
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
