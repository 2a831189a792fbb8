//! Cloud-optimised files: coarse levels first, and less of them where memory is short.

use super::*;
use laz::{LazVlrBuilder, ParLasZipCompressor};

/// Points of the voxels by level: of the root, of two children, of one grandchild.
const VOXELS: [(i32, usize); 4] = [(0, 5), (2, 40), (1, 10), (1, 20)];

/// Position of the entries of the root page in [`octree`].
fn root_start(file: &[u8]) -> usize {
    u64::from_le_bytes(take(file, 375 + 54 + 40)) as usize
}

/// A file whose voxels are in another order than their levels, with another page for the last two.
pub(super) fn octree() -> Vec<u8> {
    const POINT_BYTES: u16 = 30;
    const ENTRY_BYTES: usize = 32;
    let count: usize = VOXELS.iter().map(|(_, points)| points).sum();
    let compression = LazVlrBuilder::default().with_point_format(6, 0).unwrap();
    let compression = compression.with_variable_chunk_size().build();
    let mut described = Vec::new();
    compression.write_to(&mut described).unwrap();
    let described = record(b"laszip encoded", 22204, &described);
    let points_start = 375 + 54 + 160 + described.len();

    let mut points = Cursor::new(vec![0; points_start]);
    points.set_position(points_start as u64);
    let mut packer = ParLasZipCompressor::new(&mut points, compression).unwrap();
    packer.reserve_offset_to_chunk_table().unwrap();
    let mut chunks = Vec::new();
    let mut first = 0;
    for (level, points) in VOXELS {
        let mut rows = Vec::new();
        for index in first..first + points {
            let mut row = vec![0; usize::from(POINT_BYTES)];
            row[..4].copy_from_slice(&(index as i32).to_le_bytes());
            // Classes that are all zero would be skipped.
            row[16] = level as u8 + 1;
            rows.extend(row);
        }
        first += points;
        let start = packer.get_mut().position();
        packer.compress_chunks([rows.as_slice()]).unwrap();
        chunks.push((level, start, packer.get_mut().position() - start, points));
    }
    packer.done().unwrap();
    let mut file = points.into_inner();

    let entry = |(level, start, bytes, points): (i32, u64, u64, i32)| {
        let mut entry = Vec::new();
        for number in [level, 0, 0, 0] {
            entry.extend(number.to_le_bytes());
        }
        entry.extend(start.to_le_bytes());
        entry.extend((bytes as i32).to_le_bytes());
        entry.extend(points.to_le_bytes());
        entry
    };
    let entries = chunks.map_entries(entry);
    let root = file.len();
    let page = root + 4 * ENTRY_BYTES;
    file.extend(entries[..2].concat());
    // A voxel without points has no chunk.
    file.extend(entry((1, 0, 0, 0)));
    file.extend(entry((1, page as u64, 2 * ENTRY_BYTES as u64, -1)));
    file.extend(entries[2..].concat());

    let mut info = vec![0; 160];
    info[40..48].copy_from_slice(&(root as u64).to_le_bytes());
    info[48..56].copy_from_slice(&(4 * ENTRY_BYTES as u64).to_le_bytes());
    let mut head = header(6 | 0x80, POINT_BYTES, count as u64, 2, points_start);
    head.extend(record(b"copc", 1, &info));
    head.extend(described);
    file[..points_start].copy_from_slice(&head);
    file
}

trait Entries {
    fn map_entries(self, entry: impl Fn((i32, u64, u64, i32)) -> Vec<u8>) -> Vec<Vec<u8>>;
}

impl Entries for Vec<(i32, u64, u64, usize)> {
    fn map_entries(self, entry: impl Fn((i32, u64, u64, i32)) -> Vec<u8>) -> Vec<Vec<u8>> {
        self.into_iter()
            .map(|(level, start, bytes, points)| entry((level, start, bytes, points as i32)))
            .collect()
    }
}

fn levels(cloud: &RawCloud) -> Vec<f64> {
    let classes = numbers(cloud, "classification").into_iter();
    classes.map(|class| class - 1.0).collect()
}

fn expected(levels: usize) -> Vec<f64> {
    let all = [vec![0.0; 5], vec![1.0; 30], vec![2.0; 40]];
    all[..levels].concat()
}

#[test]
fn points_are_read_level_by_level() {
    let cloud = read(&octree());
    assert_eq!(levels(&cloud), expected(3));
    // Raw numbers from 45 on are the voxels of level 1, after the five of the root.
    assert_eq!(cloud.positions.get(5).x, 45.0 * 0.5 + 100.0);
}

#[test]
fn levels_are_read_up_to_the_memory_limit() {
    let file = octree();
    let mut seen = Vec::new();
    for bytes in (0..10_000).step_by(97) {
        if let Ok(cloud) = decode(&file, &options().with_max_memory(bytes), &Progress::default()) {
            let count = cloud.positions.len();
            assert_eq!(
                levels(&cloud),
                expected([5, 35, 75].iter().position(|&n| n == count).unwrap() + 1)
            );
            if seen.last() != Some(&count) {
                seen.push(count);
            }
        } else {
            assert!(seen.is_empty(), "{bytes}");
        }
    }
    assert_eq!(seen, [5, 35, 75]);
}

#[test]
fn files_beyond_the_limit_are_read_level_by_level_through_windows() {
    const FILE_BYTES: u64 = 1 << 20;
    let file = tempfile::Builder::new().suffix(".laz").tempfile().unwrap();
    std::fs::write(file.path(), octree()).unwrap();
    let read = |max_bytes: u64| {
        let options = options().with_max_memory(max_bytes);
        super::super::windows::read_levels(file.path(), &options, &Progress::default())
    };
    assert!(read(FILE_BYTES).unwrap().is_none(), "all of it fits");
    file.as_file().set_len(FILE_BYTES).unwrap();
    let mut seen = Vec::new();
    for bytes in (100..20_000).step_by(97) {
        match read(bytes) {
            Ok(Some(cloud)) => {
                let count = cloud.positions.len();
                let found = [5, 35, 75].iter().position(|&n| n == count).unwrap();
                assert_eq!(levels(&cloud), expected(found + 1));
                if seen.last() != Some(&count) {
                    seen.push(count);
                }
            }
            Ok(None) => assert!(seen.is_empty(), "{bytes}"),
            Err(error) => {
                assert!(seen.is_empty(), "{bytes}");
                assert!(error.to_string().contains("--max-memory"), "{error}");
            }
        }
    }
    assert_eq!(seen, [5, 35, 75]);
}

#[test]
fn a_damaged_hierarchy_is_ignored() {
    let file = octree();
    let in_file_order = [vec![0.0; 5], vec![2.0; 40], vec![1.0; 30]].concat();
    let root = root_start(&file);
    let page = root + 4 * 32;
    for (what, at, bytes) in [
        ("root page outside", 375 + 54 + 40, u64::MAX.to_le_bytes()),
        ("root page of no whole entries", 375 + 54 + 48, 33u64.to_le_bytes()),
        ("a level below all", root, [0xff; 8]),
        ("a chunk outside", root + 16, (1u64 << 40).to_le_bytes()),
        ("a page that is itself", root + 3 * 32 + 16, (root as u64).to_le_bytes()),
        // Length of a chunk and count of its points.
        ("points that are too many", page + 24, [1, 0, 0, 0, 255, 255, 0, 0]),
    ] {
        let mut file = file.clone();
        file[at..at + 8].copy_from_slice(&bytes);
        assert_eq!(levels(&read(&file)), in_file_order, "{what}");
    }
}
