//! Formats of chunks, pages or messages, each with a length or a checksum.

use super::{put, u32_at, u64_at};

/// Messages of a live stream: kind, bytes, checksum, payload.
pub(super) fn repair_stream(bytes: &mut [u8]) {
    let Some(head) = u32_at(bytes, 12) else { return };
    let mut place = 16usize.saturating_add(head as usize);
    while let Some(count) = u32_at(bytes, place.saturating_add(4)) {
        let payload = place + 12;
        let end = payload.saturating_add(count as usize).min(bytes.len());
        if payload > end {
            return;
        }
        let crc = crc32fast::hash(&bytes[payload..end]);
        put(bytes, place + 8, &crc.to_le_bytes());
        place = end;
    }
}

/// CRC-32C, bit by bit.
fn crc32c(bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0x82f6_3b78;
    let crc = bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            let is_odd = crc & 1;
            (crc >> 1) ^ (POLYNOMIAL * is_odd)
        })
    });
    !crc
}

/// Pages, each with its checksum at the end, highest byte first; and the length of the file in its head.
pub(super) fn repair_e57(bytes: &mut [u8]) {
    let count = bytes.len() as u64;
    let page_bytes = u64_at(bytes, 40).filter(|count| (128..=1 << 16).contains(count));
    let page_bytes = page_bytes.unwrap_or(1024);
    if bytes.len() > page_bytes {
        put(bytes, 16, &count.to_le_bytes());
    }
    for page in bytes.chunks_exact_mut(page_bytes) {
        let (data, crc) = page.split_at_mut(page_bytes - 4);
        crc.copy_from_slice(&crc32c(data).to_be_bytes());
    }
}

/// Chunks: bytes, kind, data, checksum of kind and data; highest byte first.
pub(super) fn repair_png(bytes: &mut [u8]) {
    let mut place = 8;
    while let Some(count) = u32_at(bytes, place) {
        let start = place + 4;
        let end = start.saturating_add(4).saturating_add(count.swap_bytes() as usize);
        let Some(data) = bytes.get(start..end) else { return };
        let crc = crc32fast::hash(data);
        put(bytes, end, &crc.to_be_bytes());
        place = end + 4;
    }
}

/// The length of the file; and where two chunks do not fill it, the length of the last one.
pub(super) fn repair_glb(bytes: &mut [u8]) {
    if !bytes.starts_with(b"glTF") {
        return;
    }
    let count = bytes.len() as u32;
    put(bytes, 8, &count.to_le_bytes());
    let Some(first) = u32_at(bytes, 12) else { return };
    let second = 20usize.saturating_add(first as usize);
    if let Some(rest) = bytes.len().checked_sub(second.saturating_add(8)) {
        put(bytes, second, &(rest as u32).to_le_bytes());
    }
}

/// Checksums of chunks that are not packed; others are removed (0 is none).
pub(super) fn repair_mcap(bytes: &mut [u8]) {
    const CHUNK: u8 = 6;
    let mut place = 8;
    while let Some(count) = u64_at(bytes, place + 1) {
        let contents = place + 9;
        if bytes[place] == CHUNK {
            let packing_bytes = u32_at(bytes, contents + 28).unwrap_or(0) as usize;
            let records = contents.saturating_add(32 + 8).saturating_add(packing_bytes);
            let end = contents.saturating_add(count);
            let crc = match bytes.get(records..end) {
                Some(records) if packing_bytes == 0 => crc32fast::hash(records),
                _ => 0,
            };
            if u32_at(bytes, contents + 24) != Some(0) {
                put(bytes, contents + 24, &crc.to_le_bytes());
            }
        }
        place = contents.saturating_add(count).min(bytes.len());
    }
}

/// The length at the end of each block is that at its beginning.
pub(super) fn repair_pcapng(bytes: &mut [u8]) {
    if !bytes.starts_with(&[0x0a, 0x0d, 0x0d, 0x0a]) {
        return;
    }
    let mut place = 0usize;
    while let Some(count) = u32_at(bytes, place.saturating_add(4)) {
        if count < 12 {
            return;
        }
        let end = place.saturating_add(count as usize);
        put(bytes, end.saturating_sub(4), &count.to_le_bytes());
        place = end;
    }
}
