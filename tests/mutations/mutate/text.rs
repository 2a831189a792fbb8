//! Changes of text.

use super::binary;
use crate::random::Random;
use std::ops::Range;

/// Replacements of a number.
const NUMBERS: [&str; 24] = [
    "nan",
    "-nan",
    "inf",
    "-inf",
    "1e999",
    "-1e999",
    "-0",
    "0",
    "1",
    "-1",
    "1e-400",
    "1e38",
    "-1e19",
    "3.5e38",
    "255",
    "256",
    "65536",
    "2147483647",
    "2147483648",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "99999999999999999999999999999999999999",
    "0.000000000000000000000000000000000001",
];

/// Bytes of a file with a head of text that can be the head.
const HEAD_BYTES: usize = 512;

/// Words and the spaces between them are separated by these.
fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'-' | b'+' | b'_')
}

fn words(bytes: &[u8], is_wanted: fn(u8) -> bool) -> Vec<Range<usize>> {
    let mut words = Vec::new();
    let mut start = None;
    for (place, &byte) in bytes.iter().chain(b"\n").enumerate() {
        match (is_word(byte), start) {
            (true, None) => start = Some(place),
            (false, Some(begin)) => {
                if is_wanted(bytes[begin]) {
                    words.push(begin..place);
                }
                start = None;
            }
            _ => {}
        }
    }
    words
}

fn is_number(first: u8) -> bool {
    first.is_ascii_digit() || matches!(first, b'-' | b'+' | b'.')
}

fn lines(bytes: &[u8]) -> Vec<Range<usize>> {
    let mut start = 0;
    let lines = bytes.split_inclusive(|&byte| byte == b'\n').map(|line| {
        start += line.len();
        start - line.len()..start
    });
    lines.collect()
}

/// Changes `bytes` once.
pub(super) fn mutate(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let lines = lines(bytes);
    if lines.is_empty() {
        bytes.extend(other.iter().take(HEAD_BYTES));
        return;
    }
    let line = random.pick(&lines).clone();
    match random.below(12) {
        0..=3 => replace_number(bytes, random),
        4 => replace_word(bytes, other, random),
        5 => {
            bytes.drain(line);
        }
        6 => {
            let repeated = bytes[line.clone()].repeat(1 + random.below(20));
            bytes.splice(line.end..line.end, repeated);
        }
        7 => {
            let moved: Vec<u8> = bytes.drain(line).collect();
            let place = random.below(bytes.len() + 1);
            bytes.splice(place..place, moved);
        }
        8 => {
            let place = line.start + random.below(line.len());
            let inserted = *random.pick(&[" ", ",", ";", "\t", "\n", "\r", "\"", "#", "\0", "é", "\u{feff}", "//"]);
            bytes.splice(place..place, inserted.bytes());
        }
        9 => {
            // A long line.
            let words = bytes[line.clone()].repeat(50);
            let words = words.into_iter().filter(|&byte| byte != b'\n');
            bytes.splice(line.start..line.start, words);
        }
        _ => binary::mutate(bytes, other, random),
    }
}

/// Changes the head of `bytes` once.
pub(super) fn mutate_head(bytes: &mut Vec<u8>, random: &mut Random) {
    // The start of bytes that are not text.
    let is_text = |&byte: &u8| byte.is_ascii_graphic() || matches!(byte, b' ' | b'\n' | b'\r' | b'\t');
    let end = bytes.iter().position(|byte| !is_text(byte)).unwrap_or(bytes.len());
    let mut head: Vec<u8> = bytes[..end.min(HEAD_BYTES)].to_vec();
    let count = head.len();
    mutate(&mut head, &[], random);
    bytes.splice(..count, head);
}

fn replace_number(bytes: &mut Vec<u8>, random: &mut Random) {
    let numbers = words(bytes, is_number);
    if !numbers.is_empty() {
        let range = random.pick(&numbers).clone();
        let number = random.pick(&NUMBERS).bytes();
        bytes.splice(range, number);
    }
}

fn replace_word(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let of_other = words(other, |_| true);
    let own = words(bytes, |_| true);
    let word = match random.below(4) {
        0 if !of_other.is_empty() => other[random.pick(&of_other).clone()].to_vec(),
        1 => vec![b'x'; 1 << random.below(14)],
        _ if !own.is_empty() => bytes[random.pick(&own).clone()].to_vec(),
        _ => return,
    };
    if !own.is_empty() {
        bytes.splice(random.pick(&own).clone(), word);
    }
}
