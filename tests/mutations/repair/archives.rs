//! Archives: checksums of members.

use super::{put, u16_at, u32_at};
use std::io::Read as _;

/// No member is unpacked further than this for its checksum.
const MAX_BYTES: u64 = 1 << 24;

/// The sum of each header.
pub(super) fn repair_tar(bytes: &mut [u8]) {
    const SUM: std::ops::Range<usize> = 148..156;
    for header in bytes.chunks_exact_mut(512) {
        if header[257..262] != *b"ustar" {
            continue;
        }
        let is_own_style = header[SUM.end - 1] == b' ';
        header[SUM].fill(b' ');
        let sum: u32 = header.iter().map(|&byte| u32::from(byte)).sum();
        let end = if is_own_style { "\0 " } else { "\0" };
        let written = format!("{sum:0width$o}{end}", width = 8 - end.len());
        header[SUM].copy_from_slice(&written.as_bytes()[..8]);
    }
}

/// The checksum of `packed`, unpacked as far as possible, and the number of bytes.
fn unpacked(packed: &[u8]) -> (u32, u64) {
    let mut bytes = Vec::new();
    // A reader sees whatever is unpacked before the damage.
    let _ = flate2::read::DeflateDecoder::new(packed)
        .take(MAX_BYTES)
        .read_to_end(&mut bytes);
    (crc32fast::hash(&bytes), bytes.len() as u64)
}

/// Checksum and length at the end of the only member.
pub(super) fn repair_gzip(bytes: &mut [u8]) {
    const HEAD_BYTES: usize = 10;
    let Some(end) = bytes.len().checked_sub(8).filter(|&end| end >= HEAD_BYTES) else {
        return;
    };
    // Names and comments, which are zero-terminated.
    let flags = bytes[3];
    let mut start = HEAD_BYTES;
    for flag in [3, 4] {
        if flags >> flag & 1 != 0 {
            let rest = &bytes[start..end];
            start += rest
                .iter()
                .position(|&byte| byte == 0)
                .map_or(rest.len(), |place| place + 1);
        }
    }
    let (crc, count) = unpacked(&bytes[start..end]);
    put(bytes, end, &crc.to_le_bytes());
    put(bytes, end + 4, &(count as u32).to_le_bytes());
}

/// Checksums of members, in the directory and before each.
pub(super) fn repair_zip(bytes: &mut [u8]) {
    const ENTRY: &[u8] = b"PK\x01\x02";
    let places: Vec<usize> = bytes
        .windows(ENTRY.len())
        .enumerate()
        .filter_map(|(place, window)| (window == ENTRY).then_some(place))
        .collect();
    for entry in places {
        let Some(crc) = member_crc(bytes, entry) else {
            continue;
        };
        put(bytes, entry + 16, &crc.to_le_bytes());
        let local = u32_at(bytes, entry + 42).map_or(usize::MAX, |place| place as usize);
        // With this flag the sizes follow the data, and 0 is here.
        let comes_later = u16_at(bytes, local.saturating_add(6)).is_some_and(|flags| flags >> 3 & 1 != 0);
        if !comes_later && bytes.get(local..).is_some_and(|rest| rest.starts_with(b"PK\x03\x04")) {
            put(bytes, local + 14, &crc.to_le_bytes());
        }
    }
}

/// Checksum of the member of an entry of the directory; `None` for an unknown compression method.
fn member_crc(bytes: &[u8], entry: usize) -> Option<u32> {
    let method = u16_at(bytes, entry + 10)?;
    let count = u32_at(bytes, entry + 20)? as usize;
    let local = u32_at(bytes, entry + 42)? as usize;
    let data = local
        .checked_add(30)?
        .checked_add(u16_at(bytes, local.checked_add(26)?)?)?
        .checked_add(u16_at(bytes, local.checked_add(28)?)?)?;
    let data = bytes.get(data..data.checked_add(count)?)?;
    match method {
        0 => Some(crc32fast::hash(data)),
        8 => Some(unpacked(data).0),
        _ => None,
    }
}
