//! Sequence files: checksums of sections, chunks, their headers, and of the trailer (`docs/reel.md`).

use super::{put, u32_at, u64_at};

const SYNC: &[u8] = b"\xf1rlc";
const HEADER_BYTES: usize = 28;
const TRAILER_BYTES: usize = 20;

/// Flags of a frame.
const SENSOR: u8 = 1 << 1;
const IMAGE: u8 = 1 << 2;

fn find_chunk(bytes: &[u8], from: usize) -> Option<usize> {
    let rest = bytes.get(from..)?;
    let place = rest.windows(SYNC.len()).position(|window| window == SYNC)?;
    Some(from + place)
}

/// Removes the index and its position from the end: groups are then found one by one.
pub(super) fn drop_index(bytes: &mut Vec<u8>) {
    let mut from = 0;
    while let Some(start) = find_chunk(bytes, from) {
        if bytes[start..].get(4..8) == Some(b"INDX") {
            bytes.truncate(start);
            return;
        }
        from = start + SYNC.len();
    }
}

pub(super) fn repair(bytes: &mut [u8]) {
    let mut from = 12;
    while let Some(start) = find_chunk(bytes, from) {
        let contents = start + HEADER_BYTES;
        let (Some(count), Some(checked)) = (u64_at(bytes, start + 8), u32_at(bytes, start + 16)) else {
            break;
        };
        if contents > bytes.len() {
            break;
        }
        let end = contents.saturating_add(count).min(bytes.len());
        let checked_end = (contents + checked as usize).min(end);
        if bytes[start + 4..start + 8] == *b"GRUP" {
            repair_sections(&mut bytes[contents..end], checked_end - contents);
        }
        let crc = crc32fast::hash(&bytes[contents..checked_end]);
        put(bytes, start + 20, &crc.to_le_bytes());
        let crc = crc32fast::hash(&bytes[start..start + HEADER_BYTES - 4]);
        put(bytes, start + HEADER_BYTES - 4, &crc.to_le_bytes());
        let is_chunk_behind = bytes[end..].starts_with(SYNC);
        from = if is_chunk_behind { end } else { contents };
    }
    let trailer = bytes.len().saturating_sub(TRAILER_BYTES);
    if bytes.ends_with(b"reel-end") && bytes.len() >= TRAILER_BYTES {
        let crc = crc32fast::hash(&bytes[trailer..trailer + 8]);
        put(bytes, trailer + 8, &crc.to_le_bytes());
    }
}

/// Walks over a directory; `None` where it ends.
struct Cursor<'a> {
    bytes: &'a [u8],
    place: usize,
}

impl Cursor<'_> {
    fn skip(&mut self, count: usize) -> Option<()> {
        self.place = self
            .place
            .checked_add(count)
            .filter(|&place| place <= self.bytes.len())?;
        Some(())
    }

    fn byte(&mut self) -> Option<u8> {
        self.skip(1)?;
        Some(self.bytes[self.place - 1])
    }

    fn number(&mut self) -> Option<usize> {
        let mut number = 0;
        for shift in (0..63).step_by(7) {
            let byte = self.byte()?;
            number |= usize::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(number);
            }
        }
        None
    }

    fn text(&mut self) -> Option<()> {
        let count = self.number()?;
        self.skip(count)
    }
}

/// Position of the checksum of a section, and its data.
struct Section {
    crc_place: usize,
    offset: usize,
    byte_count: usize,
}

/// `contents` of a group: a directory of this many bytes, and the data of its sections.
fn repair_sections(contents: &mut [u8], directory_bytes: usize) {
    let mut sections = Vec::new();
    // Everything before an unreadable position is repaired.
    let _ = find_sections(&contents[..directory_bytes], &mut sections);
    for section in sections {
        let start = directory_bytes.saturating_add(section.offset).min(contents.len());
        let end = start.saturating_add(section.byte_count).min(contents.len());
        let crc = crc32fast::hash(&contents[start..end]);
        put(contents, section.crc_place, &crc.to_le_bytes());
    }
}

fn find_sections(directory: &[u8], sections: &mut Vec<Section>) -> Option<()> {
    let mut cursor = Cursor {
        bytes: directory,
        place: 0,
    };
    // The cube: a corner, the edge of a cell, the depth.
    cursor.skip(33)?;
    let mut scalar_counts = Vec::new();
    for _ in 0..cursor.number()? {
        scalar_counts.push(skip_schema(&mut cursor)?);
    }
    for _ in 0..cursor.number()? {
        skip_frame(&mut cursor, &scalar_counts)?;
        for _ in 0..cursor.number()? {
            cursor.number()?;
            let offset = cursor.number()?;
            let crc_place = cursor.place;
            cursor.skip(4)?;
            let mut byte_count = 0usize;
            for _ in 0..cursor.byte()? {
                cursor.byte()?;
                byte_count = byte_count.saturating_add(cursor.number()?);
            }
            sections.push(Section {
                crc_place,
                offset,
                byte_count,
            });
        }
    }
    Some(())
}

/// Its number of scalars.
fn skip_schema(cursor: &mut Cursor<'_>) -> Option<usize> {
    let bits = cursor.number()?;
    cursor.skip(4)?;
    if bits >> 10 & 1 != 0 {
        cursor.number()?;
        if cursor.byte()? != 0 {
            cursor.skip(24)?;
        }
    }
    let count = cursor.number()?;
    for _ in 0..count {
        cursor.text()?;
        cursor.skip(9)?;
    }
    Some(count)
}

/// A frame as far as its sections.
fn skip_frame(cursor: &mut Cursor<'_>, scalar_counts: &[usize]) -> Option<()> {
    cursor.text()?;
    cursor.number()?;
    let flags = cursor.byte()?;
    let scalars = scalar_counts.get(cursor.number()?)?;
    // Points that were written, in cells, outside.
    for _ in 0..3 {
        cursor.number()?;
    }
    for _ in 0..cursor.number()? {
        cursor.number()?;
    }
    cursor.skip(scalars.checked_mul(8)?)?;
    if flags & SENSOR != 0 {
        cursor.skip(24)?;
    }
    cursor.skip(2)?;
    if flags & IMAGE != 0 {
        cursor.number()?;
        cursor.number()?;
    }
    Some(())
}
