//! Files that a stranger has made: bytes changed at will, and every checksum right again.

use super::clouds::{PATH, file_of, patchwork, surface};
use super::parent_colors::chosen;
use crate::analysis::test_shapes::Random;
use crate::cloud::RawCloud;
use crate::progress::Progress;
use crate::reel::file::{CHUNK_HEADER_BYTES, ChunkHeader, ChunkKind, Directory, MAGIC_AND_VERSION_BYTES};
use crate::reel::parent_level::ParentValue;
use crate::reel::{Coding, ReelDecoder, ReelFile, ReelOptions};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Memory limit of a frame while it is decoded: mutations that claim more are refused.
const MEMORY: u64 = 1 << 25;

/// Chunks of a file: their headers, and the positions of their contents.
fn chunks(bytes: &[u8]) -> Vec<(ChunkHeader, Range<usize>)> {
    let mut found = Vec::new();
    let mut offset = MAGIC_AND_VERSION_BYTES;
    while let Some(header) = bytes.get(offset..offset + CHUNK_HEADER_BYTES) {
        let Ok(header) = ChunkHeader::read(header.try_into().unwrap()) else {
            break;
        };
        let start = offset + CHUNK_HEADER_BYTES;
        let end = start.saturating_add(header.len as usize).min(bytes.len());
        found.push((header, start..end));
        offset = end;
    }
    found
}

/// Recomputes the checksums of the bytes: of the chunks as they were before `bytes` were changed.
fn repair(bytes: &mut [u8], chunks: &[(ChunkHeader, Range<usize>)]) {
    for (header, contents) in chunks {
        let checked = contents.start..(contents.start + header.checked_len as usize).min(contents.end);
        if header.kind == ChunkKind::Group
            && let Ok(mut directory) = Directory::read(&bytes[checked.clone()], header.unchecked_len())
        {
            let data = &bytes[checked.end..contents.end];
            for section in directory.frames.iter_mut().flat_map(|frame| &mut frame.sections) {
                let start = section.offset as usize;
                section.crc = crc32fast::hash(&data[start..start + section.bytes() as usize]);
            }
            let repaired = directory.to_bytes();
            // A number can be written in more than one way.
            if repaired.len() == checked.len() {
                bytes[checked.clone()].copy_from_slice(&repaired);
            }
        }
        let repaired = ChunkHeader {
            crc: crc32fast::hash(&bytes[checked]),
            ..*header
        };
        let start = contents.start - CHUNK_HEADER_BYTES;
        bytes[start..contents.start].copy_from_slice(&repaired.to_bytes());
    }
}

/// Opens a file and decodes every frame of it, coarse and whole. Returns how many came out whole.
fn decode_all(bytes: Vec<u8>) -> usize {
    let Ok(file) = ReelFile::open(Arc::new(bytes), Path::new(PATH)) else {
        return 0;
    };
    let mut decoder = ReelDecoder::new(Arc::new(file), MEMORY);
    let mut count = 0;
    for index in 0..decoder.file().frame_count().min(100) {
        let run = decoder.file().run_of(index);
        assert!(run.contains(&index));
        for max_points in [300, usize::MAX] {
            let Ok(frame) = decoder.decode(index, max_points, &Progress::default()) else {
                continue;
            };
            let points = frame.cloud.positions.len();
            assert_eq!(frame.cloud.attributes.other_length(points), None);
            count += usize::from(frame.is_whole && max_points == usize::MAX);
        }
    }
    count
}

#[test]
fn mutated_files_with_valid_checksums_are_rejected_or_drawn() {
    let frames = |cloud: &dyn Fn(f32) -> RawCloud| [0.0, 0.05, 0.1].map(cloud);
    let of_surface = |options: ReelOptions| {
        let frames = frames(&|time| surface(400, time));
        (frames, options, 150, ParentValue::Mean)
    };
    let fast = ReelOptions {
        coding: Coding::Fast,
        ..ReelOptions::default()
    };
    let fast_patchwork = fast.clone();
    let mut random = Random(7);
    let mut decoded = 0;
    for (frames, options, mutations, expected_colors) in [
        of_surface(ReelOptions::default()),
        of_surface(ReelOptions::merged()),
        of_surface(ReelOptions::lossless()),
        of_surface(fast),
        // Large enough for colours of first children.
        (
            frames(&|time| patchwork(10_000, time)),
            ReelOptions::default(),
            30,
            ParentValue::FirstChild,
        ),
        (
            frames(&|time| patchwork(10_000, time)),
            fast_patchwork,
            30,
            ParentValue::FirstChild,
        ),
    ] {
        let whole = file_of(&frames, &options);
        assert_eq!(chosen(&frames, &options), expected_colors);
        let chunks = chunks(&whole);
        assert_eq!(decode_all(whole.clone()), 3);
        for _ in 0..mutations {
            let mut bytes = whole.clone();
            // Mostly in the metadata: that determines allocations.
            let (header, contents) = &chunks[random.next_bits() as usize % chunks.len()];
            let range = match random.next_bits() % 4 {
                0 => contents.clone(),
                _ => contents.start..(contents.start + header.checked_len as usize).min(contents.end),
            };
            for _ in 0..=random.next_bits() % 3 {
                let place = range.start + random.next_bits() as usize % range.len().max(1);
                let Some(byte) = bytes.get_mut(place) else { continue };
                *byte = match random.next_bits() % 4 {
                    0 => 0,
                    1 => 0xff,
                    2 => byte.wrapping_add(1),
                    _ => random.next_bits() as u8,
                };
            }
            repair(&mut bytes, &chunks);
            decoded += decode_all(bytes);
        }
    }
    assert!(decoded > 100, "{decoded} frames: mutations get nowhere");
}
