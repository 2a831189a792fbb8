//! Bytes that are missing, changed, moved or made up: a clear sentence, never a panic, and no more lost than has to be.

use super::clouds::{MEMORY, PATH, decoder, file_of, open, surface};
use crate::cloud::RawCloud;
use crate::progress::Progress;
use crate::reel::{Coding, NewFrame, ReelDecoder, ReelError, ReelFile, ReelOptions, ReelWriter};
use proptest::prelude::*;
use std::path::Path;
use std::sync::Arc;

fn three_groups() -> (Vec<u8>, ReelOptions) {
    let clouds: Vec<RawCloud> = (0..6).map(|frame| surface(2000, 0.05 * frame as f32)).collect();
    let options = ReelOptions {
        keyframes: 2,
        ..ReelOptions::default()
    };
    (file_of(&clouds, &options), options)
}

/// All frames that can be decoded; the others are errors.
fn readable(file: ReelFile) -> Vec<usize> {
    let mut decoder = ReelDecoder::new(Arc::new(file), MEMORY);
    let frames = 0..decoder.file().frame_count();
    frames
        .filter(|&frame| decoder.decode(frame, usize::MAX, &Progress::default()).is_ok())
        .collect()
}

#[test]
fn other_files_and_later_versions_are_rejected() {
    let (bytes, _) = three_groups();
    let message = |bytes: &[u8]| open(bytes).unwrap_err().to_string();
    assert!(message(b"ply\nformat ascii 1.0\n").contains("not a sequence file"));
    assert!(message(b"").contains("not a sequence file"));
    assert!(message(&bytes[..9]).contains("ends before"));
    let mut later = bytes.clone();
    for (version, word) in [(bytes[8] + 1, "later"), (bytes[8] - 1, "earlier")] {
        later[8] = version;
        let message = message(&later);
        assert!(
            message.contains(PATH) && message.contains(&format!("{word} version")),
            "{message}"
        );
    }
    // A higher minor version adds things that may be skipped.
    let mut newer = bytes;
    newer[10] = 9;
    assert_eq!(readable(open(&newer).unwrap()).len(), 6);
}

#[test]
fn every_prefix_has_the_frames_started_in_it() {
    let (bytes, options) = three_groups();
    let mut max = 0;
    for end in (12..bytes.len()).step_by(101).chain([bytes.len() - 1]) {
        let file = open(&bytes[..end]).unwrap();
        let count = file.frame_count();
        assert!(count >= max && !file.damage().is_empty());
        let whole = open(&bytes[..end]).unwrap().whole_groups().frame_count();
        assert!(whole <= count && whole.is_multiple_of(2));
        max = count;
        assert_eq!(readable(file), (0..count).collect::<Vec<_>>());
    }
    assert_eq!(max, 6);
    // And writing can be resumed.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.reel");
    std::fs::write(&path, &bytes[..bytes.len() * 2 / 3]).unwrap();
    let cloud = surface(1000, 0.0);
    let frame = NewFrame {
        cloud: &cloud,
        name: "later",
        time: None,
    };
    for _ in 0..2 {
        let mut writer = ReelWriter::append_to(&path, options.clone()).unwrap();
        writer.write_group(&[frame]).unwrap();
        writer.finish().unwrap();
    }
    let file = ReelFile::open(Arc::new(std::fs::File::open(&path).unwrap()), &path).unwrap();
    let count = file.frame_count();
    assert_eq!(file.frame(count - 1).unwrap().name, "later");
    assert_eq!(readable(file), (0..count).collect::<Vec<_>>());
}

/// Points of each frame of a file, and whether all of the frame is there.
fn points_of(bytes: &[u8]) -> Vec<(usize, bool)> {
    let mut decoder = decoder(bytes);
    let file = Arc::clone(decoder.file());
    let frames = 0..file.frame_count();
    frames
        .map(|index| {
            let frame = decoder.decode(index, usize::MAX, &Progress::default()).unwrap();
            let points = frame.cloud.positions.len();
            let info = file.frame(index).unwrap();
            assert_eq!(points, info.points);
            assert_eq!(frame.cloud.attributes.other_length(points), None);
            // Missing data is reported for the frame and for the file.
            assert_eq!(
                frame.is_whole,
                frame.cloud.warnings.is_empty(),
                "{:?}",
                frame.cloud.warnings
            );
            assert!(
                frame.is_whole || file.damage()[0].contains("ends early"),
                "{:?}",
                file.damage()
            );
            assert!(!frame.is_whole || points == frame.points_in_frame);
            (points, frame.is_whole)
        })
        .collect()
}

#[test]
fn every_prefix_of_a_frame_draws_the_tree_so_far() {
    let frames: Vec<RawCloud> = (0..3).map(|frame| surface(2500, 0.05 * frame as f32)).collect();
    for (count, options) in [
        (1, ReelOptions::default()),
        (1, ReelOptions::merged()),
        (1, ReelOptions::lossless()),
        (
            1,
            ReelOptions {
                coding: Coding::Fast,
                ..ReelOptions::default()
            },
        ),
        (3, ReelOptions::default()),
        (3, ReelOptions::merged()),
        (3, ReelOptions::lossless()),
    ] {
        let bytes = file_of(&frames[..count], &options);
        let all = points_of(&bytes);
        assert!(all.len() == count && all.iter().all(|(_, is_whole)| *is_whole));
        assert!(open(&bytes).unwrap().damage().is_empty());
        let (directory, ..) = open(&bytes).unwrap().directory(0).unwrap();
        let sections = directory.frames[0].sections.len();
        let mut before: Vec<(usize, bool)> = Vec::new();
        let mut steps = 0;
        for end in (12..bytes.len())
            .step_by(1 + bytes.len() / 150)
            .chain([bytes.len() - 1])
        {
            let file = open(&bytes[..end]).unwrap();
            assert!(
                !file.damage().is_empty(),
                "{end} of {} bytes are no whole file",
                bytes.len()
            );
            let now = points_of(&bytes[..end]);
            assert!(now.len() >= before.len());
            for (&(points, is_whole), &(max, _)) in now.iter().zip(&all) {
                assert!(points > 0 && points <= max && (!is_whole || points == max));
            }
            assert!(
                before
                    .iter()
                    .zip(&now)
                    .all(|(before, now)| before.0 <= now.0 && before.1 <= now.1)
            );
            steps += usize::from(now != before);
            before = now;
        }
        assert_eq!(before, all, "the index is no part of a frame");
        // Coarse levels, finer ones, and the points if these are stored individually.
        assert!(sections >= if options.keeps_points() { 3 } else { 2 }, "{sections}");
        if count == 1 {
            assert_eq!(steps, sections, "each section is a step");
        } else {
            assert!(steps >= 3, "{steps}");
        }
        let nearly = &bytes[..bytes.len() * 95 / 100];
        assert!(!points_of(nearly).is_empty());
    }
}

#[test]
fn a_damaged_group_only_loses_its_own_frames() {
    let (bytes, _) = three_groups();
    let groups: Vec<usize> = bytes
        .windows(8)
        .enumerate()
        .filter(|(_, at)| *at == b"\xf1rlcGRUP")
        .map(|(at, _)| at)
        .collect();
    assert_eq!(groups.len(), 3);
    for is_finished in [true, false] {
        let end = if is_finished { bytes.len() } else { bytes.len() - 1 };
        for (place, frames) in [(groups[1] + 10, vec![0, 1, 4, 5]), (groups[1] + 40, vec![0, 1, 4, 5])] {
            let mut damaged = bytes[..end].to_vec();
            damaged[place] ^= 4;
            let file = open(&damaged).unwrap();
            let said = file.damage().to_vec();
            let found = readable(file);
            if is_finished {
                assert_eq!(found, frames);
            } else {
                // Without an index it is unknown which frames are lost, but not that some are.
                assert_eq!(found.len(), 4);
                assert!(said[0].contains(PATH) && said[0].contains("damaged"), "{said:?}");
            }
        }
        let mut damaged = bytes[..end].to_vec();
        let last = groups[2] - 1;
        damaged[last] ^= 1;
        let mut decoder = decoder(&damaged);
        let error = decoder.decode(3, usize::MAX, &Progress::default()).unwrap_err();
        assert!(
            matches!(&error, ReelError::Damaged { byte, .. } if *byte as usize <= last),
            "{error}"
        );
        assert!(error.to_string().contains("checksum"), "{error}");
        // The coarse levels are stored elsewhere, and are intact.
        assert!(decoder.decode(3, 200, &Progress::default()).is_ok());
        assert!(decoder.decode(4, usize::MAX, &Progress::default()).is_ok());
    }
}

#[test]
fn memory_is_limited() {
    let (bytes, _) = three_groups();
    let mut decoder = ReelDecoder::new(Arc::new(open(&bytes).unwrap()), 1 << 19);
    let error = decoder.decode(0, usize::MAX, &Progress::default()).unwrap_err();
    assert!(matches!(error, ReelError::TooLarge { frame: 0, .. }), "{error}");
    assert!(decoder.decode(0, 20, &Progress::default()).is_ok());
    let error = decoder.decode(17, usize::MAX, &Progress::default()).unwrap_err();
    assert!(
        matches!(
            error,
            ReelError::NoFrame {
                index: 17,
                count: 6,
                ..
            }
        ),
        "{error}"
    );
    let cancelled = Progress::default();
    cancelled.cancel();
    assert!(matches!(
        decoder.decode(0, 20, &cancelled),
        Err(ReelError::Cancelled { .. })
    ));
}

/// Recomputes every checksum of a file, so that the code behind them is reached.
fn mended(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut at = 12;
    while at + 28 <= bytes.len() && bytes[at..at + 4] == *b"\xf1rlc" {
        let len = u64::from_le_bytes(bytes[at + 8..at + 16].try_into().unwrap()) as usize;
        let checked = u32::from_le_bytes(bytes[at + 16..at + 20].try_into().unwrap()) as usize;
        if len > bytes.len() || checked > len || at + 28 + checked > bytes.len() {
            break;
        }
        let crc = crc32fast::hash(&bytes[at + 28..at + 28 + checked]);
        bytes[at + 20..at + 24].copy_from_slice(&crc.to_le_bytes());
        let crc = crc32fast::hash(&bytes[at..at + 24]);
        bytes[at + 24..at + 28].copy_from_slice(&crc.to_le_bytes());
        at += 28 + len;
    }
    bytes
}

proptest! {
    #[test]
    fn changed_bytes_never_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        mend: bool, near_start: bool, lossless: bool, fast: bool) {
        let options = ReelOptions {
            coding: if fast { Coding::Fast } else { Coding::Compact },
            ..if lossless { ReelOptions::lossless() } else { ReelOptions::default() }
        };
        let mut bytes = file_of(&[surface(100, 0.0), surface(81, 0.1)], &options);
        let reach = if near_start { bytes.len().min(400) } else { bytes.len() };
        for (place, value) in changes {
            bytes[place.index(reach)] = value;
        }
        if mend {
            bytes = mended(bytes);
        }
        if let Ok(file) = ReelFile::open(Arc::new(bytes), Path::new(PATH)) {
            let mut decoder = ReelDecoder::new(Arc::new(file), 1 << 24);
            for frame in 0..decoder.file().frame_count().min(4) {
                for max in [50, usize::MAX] {
                    if let Ok(frame) = decoder.decode(frame, max, &Progress::default()) {
                        prop_assert_eq!(frame.cloud.attributes.other_length(frame.cloud.positions.len()), None);
                    }
                }
            }
        }
    }
}
