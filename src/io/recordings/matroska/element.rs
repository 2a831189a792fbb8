//! Elements of EBML (RFC 8794): an id, the length of the body, the body.
//!
//! The length of both numbers is in their first byte: the number of leading zeros is the number of following bytes. A
//! length of ones alone is unknown, as written by programs that cannot seek back.

use super::super::recording::walk::Walk;

/// The first bytes of a file of elements: the id of its header.
pub(super) const MAGIC: [u8; 4] = [0x1a, 0x45, 0xdf, 0xa3];

/// Returns true if a file that begins with these bytes consists of EBML elements.
pub(crate) fn is_one(start: &[u8]) -> bool {
    start.starts_with(&MAGIC)
}

/// Header of an element, before its body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Head {
    /// With the bits that tell its length, as specifications print it.
    pub(super) id: u32,
    /// Bytes of the body; `None` where that is not known.
    pub(super) byte_count: Option<u64>,
}

/// Bytes that an id and a length have at most.
const MAX_ID_BYTES: usize = 4;
const MAX_LENGTH_BYTES: usize = 8;

/// Bytes of a number by its first byte.
fn length_of(first: u8) -> usize {
    first.leading_zeros() as usize + 1
}

/// The number of these bytes, whose first one determines their count: with that bit, or without.
fn number(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0, |sum, &byte| (sum << 8) | u64::from(byte))
}

/// A number without the bit that tells its length, and whether all its bits are ones.
fn value(bytes: &[u8]) -> (u64, bool) {
    let ones = (1_u64 << (7 * bytes.len())) - 1;
    let value = number(bytes) & ones;
    (value, value == ones)
}

/// The head that `walk` is at; `None` where there is none, or no whole one.
pub(super) fn head(walk: &mut Walk) -> Option<Head> {
    let mut bytes = |max: usize| {
        let mut bytes = walk.take(1)?;
        let length = length_of(bytes[0]);
        if length > max {
            return None;
        }
        bytes.extend(walk.take(length as u64 - 1)?);
        Some(bytes)
    };
    let id = number(&bytes(MAX_ID_BYTES)?) as u32;
    let (byte_count, is_unknown) = value(&bytes(MAX_LENGTH_BYTES)?);
    Some(Head {
        id,
        byte_count: (!is_unknown).then_some(byte_count),
    })
}

/// The number that `bytes` begin with, and the rest; `None` where it is incomplete.
pub(super) fn leading_number(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let length = length_of(*bytes.first()?);
    if length > MAX_LENGTH_BYTES {
        return None;
    }
    let (number, rest) = bytes.split_at_checked(length)?;
    Some((value(number).0, rest))
}

/// The elements within a body, with their ids; up to the first that is not whole.
pub(super) fn children(mut body: &[u8]) -> impl Iterator<Item = (u32, &[u8])> {
    std::iter::from_fn(move || {
        let length = length_of(*body.first()?);
        let (id, rest) = body.split_at_checked(length.min(MAX_ID_BYTES))?;
        let (byte_count, rest) = leading_number(rest)?;
        let (child, rest) = rest.split_at_checked(usize::try_from(byte_count).ok()?)?;
        body = rest;
        (length <= MAX_ID_BYTES).then(|| (number(id) as u32, child))
    })
}

/// A big-endian integer; the lowest eight bytes of a longer one.
pub(super) fn unsigned(body: &[u8]) -> u64 {
    number(body)
}

/// A text, which may end with zeros.
pub(super) fn text(body: &[u8]) -> String {
    let end = body.iter().position(|&byte| byte == 0).unwrap_or(body.len());
    String::from_utf8_lossy(&body[..end]).into_owned()
}
