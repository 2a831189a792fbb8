//! Bytes that say at which levels points part from those before them, eight at a time.
//!
//! How it works: a cell of a level begins with each point whose parting level is that level or less. Parting levels are
//! below 32, so eight of them, in one word, are compared by one addition: the addend lifts just those above the level
//! into the highest bit of their byte, and no carry leaves a byte.

use fearless_simd::{Level, dispatch};

/// Partings compared at a time.
pub(super) const WORD: usize = 8;
const HIGHEST_BITS: u64 = 0x8080_8080_8080_8080;
const LOWEST_BITS: u64 = 0x0101_0101_0101_0101;

/// The highest bit of every byte of `partings` that is at most `level`.
#[inline(always)]
pub(super) fn beginnings(partings: [u8; WORD], level: u32) -> u64 {
    let lift = LOWEST_BITS * u64::from(127 - level);
    !(u64::from_le_bytes(partings) + lift) & HIGHEST_BITS
}

/// Counts the values in `partings` that are at most `level`.
pub(super) fn count_at_most(partings: &[u8], level: u32) -> usize {
    dispatch!(Level::new(), _simd => count_in_lanes(partings, level as u8))
}

#[inline(always)]
pub(super) fn count_in_lanes(partings: &[u8], level: u8) -> usize {
    // As many as fit into a byte counter. Counting in rows of 128 took 0.03 instead of 0.7 ns each.
    let (rows, rest) = partings.as_chunks::<128>();
    let count_in_row = |row: &[u8]| -> u8 { row.iter().map(|&parting| u8::from(parting <= level)).sum() };
    let in_rows: usize = rows.iter().map(|row| usize::from(count_in_row(row))).sum();
    in_rows + usize::from(count_in_row(rest))
}

/// Writes the first points of the cells of `level` among the points from `first` on, whose partings are given, to the
/// beginning of `out`, and returns their number. Precondition: space for one word more than there are partings.
#[inline(always)]
pub(super) fn write_beginnings(partings: &[u8], level: u32, first: u32, out: &mut [u32]) -> usize {
    let mut count = 0;
    let mut point = first;
    let (words, rest) = partings.as_chunks::<WORD>();
    for &word in words {
        count += write_beginnings_of_word(word, level, point, &mut out[count..]);
        point += WORD as u32;
    }
    if !rest.is_empty() {
        let mut word = [u8::MAX >> 1; WORD];
        word[..rest.len()].copy_from_slice(rest);
        count += write_beginnings_of_word(word, level, point, &mut out[count..]);
    }
    count
}

/// Not a closure, which is called twice and so would not be inlined.
#[inline(always)]
fn write_beginnings_of_word(word: [u8; WORD], level: u32, first: u32, out: &mut [u32]) -> usize {
    let set = beginning_set(word, level) as usize;
    let out: &mut [u32; WORD] = out.first_chunk_mut().expect("room for a word");
    // All are written, and those after the ones that begin a cell are overwritten. A table of 256 entries instead of
    // eight conditional stores: one of the changes that made writing voxels twice as fast.
    for (out, place) in out.iter_mut().zip(PLACES_IN_WORD[set]) {
        *out = first + u32::from(place);
    }
    set.count_ones() as usize
}

/// One bit for every byte of `partings` that is at most `level`.
#[inline(always)]
fn beginning_set(partings: [u8; WORD], level: u32) -> u8 {
    // Every bit is moved into the highest byte, no two to the same place.
    const TO_HIGHEST_BYTE: u64 = 0x0102_0408_1020_4080;
    ((beginnings(partings, level) >> 7).wrapping_mul(TO_HIGHEST_BYTE) >> 56) as u8
}

/// The positions of the bits of every byte, ascending; the entries after them do not matter.
static PLACES_IN_WORD: [[u8; WORD]; 256] = {
    let mut places = [[0; WORD]; 256];
    let mut set = 0;
    while set < 256 {
        let (mut count, mut place) = (0, 0);
        while place < WORD {
            if set >> place & 1 == 1 {
                places[set][count] = place as u8;
                count += 1;
            }
            place += 1;
        }
        set += 1;
    }
    places
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::morton::LEVELS;

    #[test]
    fn word_comparisons_match_byte_comparisons() {
        for level in 0..=LEVELS {
            for parting in 0..=LEVELS as u8 + 1 {
                let partings = [parting, 0, 22, 1, parting, 21, 7, parting];
                let expected = (0..8)
                    .filter(|&i| u32::from(partings[i as usize]) <= level)
                    .fold(0, |bits, i| bits | 0x80u64 << (8 * i));
                assert_eq!(beginnings(partings, level), expected);
            }
        }
    }

    #[test]
    fn beginnings_and_their_count_match_a_scan() {
        for count in [0, 1, 7, 8, 31, 32, 33, 100, 32 * 255, 32 * 255 + 9] {
            let partings: Vec<u8> = (0..count as u64)
                .map(|i| (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as u8 % 23)
                .collect();
            for level in [0, 3, 12, LEVELS] {
                let expected: Vec<u32> = (0..count)
                    .filter(|&i| u32::from(partings[i as usize]) <= level)
                    .map(|i| i + 1000)
                    .collect();
                assert_eq!(count_at_most(&partings, level), expected.len());
                let mut out = vec![0; count as usize + WORD];
                let written = write_beginnings(&partings, level, 1000, &mut out);
                assert_eq!(out[..written], expected);
            }
        }
    }
}
