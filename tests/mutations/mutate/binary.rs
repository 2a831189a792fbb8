//! Changes of bytes.

use crate::random::Random;

/// Number of leading bytes that mostly decide on the rest.
const HEAD_BYTES: usize = 256;

/// Whole numbers that tend to be wrong: edges of types, signs, sizes that nothing has.
const INTEGERS: [u64; 24] = [
    0,
    1,
    2,
    3,
    7,
    0x7f,
    0x80,
    0xff,
    0x100,
    0x7fff,
    0x8000,
    0xffff,
    0x1_0000,
    0x00ff_ffff,
    0x1000_0000,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x1_0000_0000,
    0x100_0000_0000,
    0x7fff_ffff_ffff_ffff,
    0x8000_0000_0000_0000,
    0xffff_ffff_ffff_fffe,
    0xffff_ffff_ffff_ffff,
];

const FLOATS: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    -0.0,
    1e-300,
    1e-40,
    1e19,
    -1e19,
    1e38,
    -3.5e38,
    1e300,
    0.5,
];

/// An offset in `bytes`: often at the beginning or the end, where heads and directories are.
fn place(bytes: &[u8], random: &mut Random) -> usize {
    let count = bytes.len();
    match random.below(6) {
        0 | 1 => random.below(count.min(HEAD_BYTES)),
        2..=4 => random.below(count),
        _ => count - 1 - random.below(count.min(HEAD_BYTES)).min(count - 1),
    }
}

/// A part of `bytes`, mostly short.
fn range(bytes: &[u8], random: &mut Random) -> std::ops::Range<usize> {
    let start = place(bytes, random);
    let max = [4, 16, 64, 1024][random.below(4)];
    start..(start + 1 + random.below(max)).min(bytes.len())
}

/// Changes `bytes` once.
pub(super) fn mutate(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    if bytes.is_empty() {
        bytes.extend(other.iter().take(HEAD_BYTES));
        return;
    }
    match random.below(20) {
        0..=2 => {
            let place = place(bytes, random);
            bytes[place] ^= 1 << random.below(8);
        }
        3 => {
            let place = place(bytes, random);
            bytes[place] = random.next() as u8;
        }
        4..=9 => put_integer(bytes, random),
        10 => put_float(bytes, random),
        11 => add_a_little(bytes, random),
        12 => {
            let range = range(bytes, random);
            let value = *random.pick(&[0, 0xff, 0x20, 0x80]);
            bytes[range].fill(value);
        }
        13 => {
            let range = range(bytes, random);
            let repeated = bytes[range.clone()].repeat(1 + random.below(3));
            bytes.splice(range.end..range.end, repeated);
        }
        14 => {
            let range = range(bytes, random);
            bytes.drain(range);
        }
        15 => {
            let range = range(bytes, random);
            let to = random.below(bytes.len() - range.len() + 1);
            bytes.copy_within(range, to);
        }
        16 => {
            let place = place(bytes, random);
            bytes.truncate(place);
        }
        17 => {
            let count = 1 + random.below(64);
            let value = random.next() as u8;
            bytes.resize(bytes.len() + count, value);
        }
        _ => splice(bytes, other, random),
    }
}

/// The end of another file behind the beginning of this one, or a part of it within.
fn splice(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    if other.is_empty() {
        return;
    }
    if random.one_in(2) {
        let place = place(bytes, random);
        bytes.truncate(place);
        bytes.extend(&other[random.below(other.len())..]);
    } else {
        let (from, to) = (range(other, random), place(bytes, random));
        let count = from.len().min(bytes.len() - to);
        bytes[to..to + count].copy_from_slice(&other[from][..count]);
    }
}

fn put_integer(bytes: &mut [u8], random: &mut Random) {
    let place = place(bytes, random);
    let width = [1, 2, 4, 8][random.below(4)].min(bytes.len() - place);
    // Most fields are aligned to their width.
    let place = if random.one_in(3) { place } else { place - place % width };
    let count = bytes.len() as u64;
    let value = match random.below(6) {
        0 => count,
        1 => count.wrapping_add(random.below(5) as u64).wrapping_sub(2),
        2 => random.next() >> random.below(64),
        _ => *random.pick(&INTEGERS),
    };
    let field = &mut bytes[place..place + width];
    if random.one_in(4) {
        field.copy_from_slice(&value.to_be_bytes()[8 - width..]);
    } else {
        field.copy_from_slice(&value.to_le_bytes()[..width]);
    }
}

fn put_float(bytes: &mut [u8], random: &mut Random) {
    let value = *random.pick(&FLOATS);
    let place = place(bytes, random) / 4 * 4;
    let written = if random.one_in(2) {
        value.to_le_bytes().to_vec()
    } else {
        (value as f32).to_le_bytes().to_vec()
    };
    if let Some(field) = bytes.get_mut(place..place + written.len()) {
        field.copy_from_slice(&written);
    }
}

/// One more or less than there is: where bounds are checked wrongly.
fn add_a_little(bytes: &mut [u8], random: &mut Random) {
    let place = place(bytes, random);
    let step = 1 + random.below(8) as u8;
    bytes[place] = if random.one_in(2) {
        bytes[place].wrapping_add(step)
    } else {
        bytes[place].wrapping_sub(step)
    };
}
