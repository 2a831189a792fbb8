//! Files that lie, end early or were changed: an answer, never a panic, in no time.

use super::*;
use laz::{LazVlrBuilder, ParLasZipCompressor};
use std::time::{Duration, Instant};

/// Writes the cloud in the older compression, with one stream of bytes for all fields.
fn older(chunk_points: u32) -> Vec<u8> {
    const POINT_BYTES: u16 = 28;
    let compression = LazVlrBuilder::default().with_point_format(1, 0).unwrap();
    let compression = compression.with_fixed_chunk_size(chunk_points).build();
    let mut described = Vec::new();
    compression.write_to(&mut described).unwrap();
    let described = record(b"laszip encoded", 22204, &described);
    let mut file = header(0x81, POINT_BYTES, 20, 1, 375 + described.len());
    file.extend(described);
    let mut file = Cursor::new(file);
    file.set_position(file.get_ref().len() as u64);
    let mut packer = ParLasZipCompressor::new(&mut file, compression).unwrap();
    let mut rows = Vec::new();
    for index in 0..20i32 {
        rows.extend((index * index).to_le_bytes());
        rows.extend([index as u8; 24]);
    }
    packer.compress_many(&rows).unwrap();
    packer.done().unwrap();
    file.into_inner()
}

/// Files of each kind, with the bytes that no point can do without.
fn files() -> [(&'static str, Vec<u8>); 4] {
    [
        ("plain", written(&sample(8), false)),
        ("compressed", written(&sample(8), true)),
        ("older compression", older(8)),
        ("octree", octrees::octree()),
    ]
}

/// Reads a possibly damaged file. Precondition: the limit of memory is far above the needs of the whole file.
fn try_read(what: &str, bytes: &[u8]) -> Option<RawCloud> {
    const LONGEST: Duration = Duration::from_secs(5);
    let start = Instant::now();
    let cloud = decode(bytes, &options().with_max_memory(4 << 20), &Progress::default()).ok();
    assert!(start.elapsed() < LONGEST, "{what} takes too long");
    if let Some(cloud) = &cloud {
        let count = cloud.positions.len();
        assert!(
            cloud
                .attributes
                .colors
                .as_ref()
                .is_none_or(|colors| colors.len() == count)
        );
        assert!(cloud.attributes.scalars.iter().all(|field| field.values.len() == count));
    }
    cloud
}

#[test]
fn truncated_files_are_rejected_or_complete() {
    for (what, file) in files() {
        let whole = read(&file).positions;
        for length in 0..file.len() {
            let Some(cloud) = try_read(what, &file[..length]) else {
                continue;
            };
            // Data after the points may be missing: tables are reconstructed from the chunks.
            assert_ne!(what, "plain", "{length} of {}", file.len());
            let mut found: Vec<_> = (0..whole.len()).map(|i| cloud.positions.get(i).x).collect();
            let mut expected: Vec<_> = (0..whole.len()).map(|i| whole.get(i).x).collect();
            found.sort_by(f64::total_cmp);
            expected.sort_by(f64::total_cmp);
            assert_eq!(found, expected, "{what}: {length} of {}", file.len());
        }
    }
}

#[test]
fn changed_bytes_never_panic() {
    for (what, file) in files() {
        // Small changes matter in numbers that describe the following data.
        let points_start = u32::from_le_bytes(take(&file, POINTS_AT)) as usize;
        for at in 0..file.len() {
            let changes: &[u8] = if at < points_start { &[0x01, 0xff] } else { &[0xff] };
            for change in changes {
                let mut file = file.clone();
                file[at] ^= change;
                try_read(what, &file);
            }
        }
    }
}

#[test]
fn chunks_are_found_without_their_table() {
    for (what, mut file) in files() {
        if !["compressed", "older compression"].contains(&what) {
            continue;
        }
        let expected = read(&file);
        let start = u32::from_le_bytes(take(&file, POINTS_AT)) as usize;
        for offset in [0, -1, i64::MAX, i64::MIN, start as i64 + 9] {
            file[start..start + 8].copy_from_slice(&offset.to_le_bytes());
            assert_eq!(read(&file), expected, "{what}, table at {offset}");
        }
    }
}

#[test]
fn the_oldest_files_are_a_single_unchunked_stream() {
    let mut file = older(100);
    let expected = read(&file);
    let start = u32::from_le_bytes(take(&file, POINTS_AT)) as usize;
    file.drain(start..start + 8);
    // The compression record begins with how points are divided.
    file[375 + 54] = 1;
    assert_eq!(read(&file), expected);
    assert_eq!(expected.positions.get(3).x, 9.0 * 0.5 + 100.0);
}

#[test]
fn declared_counts_are_checked_against_file_size_and_memory() {
    let refused = |file: &[u8], expected: &str| {
        let problem = decode(file, &options(), &Progress::default()).unwrap_err().problem;
        assert!(problem.contains(expected), "{problem}");
    };
    for (what, file) in files() {
        let mut more = file.clone();
        more[COUNT_AT..COUNT_AT + 8].copy_from_slice(&(1u64 << 60).to_le_bytes());
        let expected = match what {
            "plain" => "claims 1152921504606846976 points",
            _ => "raise --max-memory",
        };
        refused(&more, expected);
        more[COUNT_AT..COUNT_AT + 8].copy_from_slice(&1_000_000u64.to_le_bytes());
        assert!(try_read(what, &more).is_none(), "{what}");
    }
    let mut file = written(&sample(3), true);
    // An impossible count of records, and then no record for the compression.
    file[RECORDS_AT..RECORDS_AT + 4].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(read(&file).positions.len(), 3);
    file[RECORDS_AT..RECORDS_AT + 4].copy_from_slice(&0u32.to_le_bytes());
    refused(&file, "no record says how");
    refused(&file[..300], "the file ends at 300");
    refused(&file[..200], "it is truncated, or no LAS file");
    let limit = options().with_max_memory(1000);
    let problem = decode(&written(&sample(50), false), &limit, &Progress::default())
        .unwrap_err()
        .problem;
    assert!(problem.contains("raise --max-memory"), "{problem}");
}

/// The crate would allocate 9,600 bytes for each of them on each thread, whatever the file has.
#[test]
fn extra_bytes_are_checked_against_the_memory_limit() {
    let problem = |extra_bytes: u16| {
        let compression = LazVlrBuilder::default().with_point_format(6, extra_bytes);
        let mut described = Vec::new();
        let compression = compression.unwrap().build();
        compression.write_to(&mut described).unwrap();
        let described = record(b"laszip encoded", 22204, &described);
        let start = 375 + described.len();
        let mut file = header(0x80 | 6, 30 + extra_bytes, 1, 1, start);
        file.extend(described);
        file.extend([0; 100]);
        decode(&file, &options(), &Progress::default()).unwrap_err().problem
    };
    let refusal = problem(60_000);
    assert!(refusal.contains("60000 extra bytes each"), "{refusal}");
    assert!(refusal.contains("raise --max-memory"), "{refusal}");
    let damage = problem(10);
    assert!(!damage.contains("extra bytes"), "{damage}");
}

#[test]
fn unfinished_headers_are_reported() {
    let cloud = RawCloud::from_positions(Positions::F64(
        (0..50).map(|index| [f64::from(index), 2.0, 3.0]).collect(),
    ));
    let mut file = written(&cloud, false);
    // The counts of the old and the new header.
    file[107..111].fill(0);
    file[COUNT_AT..COUNT_AT + 8].fill(0);
    let found = read(&file);
    assert_eq!(found.positions.len(), 50);
    assert!(found.warnings[0].contains("counts no points"), "{:?}", found.warnings);
    let mut packed = written(&cloud, true);
    packed[107..111].fill(0);
    packed[COUNT_AT..COUNT_AT + 8].fill(0);
    assert_eq!(read(&packed).positions.len(), 0);
    let empty = RawCloud::from_positions(Positions::F64(Vec::new()));
    assert!(read(&written(&empty, false)).warnings.is_empty());
    assert!(read(&written(&empty, true)).warnings.is_empty());
    // A scale of zero puts all points at one position.
    let mut flat = written(&cloud, false);
    flat[139..147].fill(0);
    let fault = decode(&flat, &options(), &Progress::default()).unwrap_err();
    assert!(fault.problem.contains("scale along y is 0"), "{}", fault.problem);
}
