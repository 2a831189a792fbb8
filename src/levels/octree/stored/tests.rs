//! What is written is read; what is damaged is refused, and never worse.

use super::*;
use crate::analysis::test_shapes::{self, Random};
use crate::levels::SelectView;
use crate::levels::octree::{OctreeError, StopCriterion};
use glam::Vec3;
use proptest::prelude::*;

fn bytes_of(tree: &Octree, shapes: Option<&[ShapeRecord]>) -> Vec<u8> {
    let mut bytes = Vec::new();
    tree.write_to(shapes, &mut bytes).unwrap();
    bytes
}

fn random_colors(count: usize, random: &mut Random) -> Vec<[u8; 4]> {
    let mut color = || (random.next_bits() as u32).to_le_bytes();
    (0..count).map(|_| color()).collect()
}

fn random_shapes(count: usize, random: &mut Random) -> Vec<ShapeRecord> {
    let mut shape = || ShapeRecord {
        normal: [random.next_bits() as i16, random.next_bits() as i16],
        radius: random.unit(),
        ellipse: 7,
        scalar: random.unit() - 0.5,
    };
    (0..count).map(|_| shape()).collect()
}

/// The checksum at the end made that of the bytes before it.
fn with_right_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.truncate(bytes.len().saturating_sub(4));
    let checksum = crc32fast::hash(&bytes);
    bytes.extend(checksum.to_le_bytes());
    bytes
}

/// Where the parts before the masks begin.
const VERSION_AT: usize = 8;
const EDGE_AT: usize = 24;
const POINTS_AT: usize = 28;
const DEPTH_AT: usize = 32;
const FLAGS_AT: usize = 33;
const MASK_COUNT_AT: usize = 34;
const MASKS_AT: usize = 38;

const STOPS: [StopCriterion; 10] = [
    StopCriterion::Spacing,
    StopCriterion::Loss(0.0),
    StopCriterion::Loss(0.02),
    StopCriterion::Loss(0.5),
    StopCriterion::Depth(0),
    StopCriterion::Depth(6),
    StopCriterion::Depth(21),
    StopCriterion::PointsPerOctant(0),
    StopCriterion::PointsPerOctant(8),
    StopCriterion::PointsPerOctant(1 << 30),
];

/// Written and read, for every stop criterion: equal, and everything that is asked of both.
fn check_cloud(positions: &[Vec3]) {
    let mut random = Random(positions.len() as u64);
    let colors = random_colors(positions.len(), &mut random);
    let shapes = random_shapes(positions.len(), &mut random);
    for stop in STOPS {
        let tree = Octree::build(positions, &colors, stop);
        let bare = StoredOctree::read_from(&bytes_of(&tree, None)).unwrap();
        assert!(bare.octree == tree, "{stop:?}");
        assert_eq!(bare.shapes, None);
        let whole = StoredOctree::read_from(&bytes_of(&tree, Some(&shapes))).unwrap();
        assert!(whole.octree == tree, "{stop:?}");
        assert_eq!(whole.shapes.as_deref(), Some(&*shapes));
        for level in 0..=tree.depth() {
            assert_eq!(bare.octree.level_voxels(level), tree.level_voxels(level));
        }
        for other in STOPS {
            assert!(bare.octree.with_stop(other) == tree.with_stop(other));
        }
    }
}

#[test]
fn clouds_of_all_kinds_are_read_as_they_were_written() {
    let mut random = Random(3);
    let torus = test_shapes::torus(2000, 0.4, &mut random).moved(Vec3::new(1e3, -7.0, 0.5));
    check_cloud(&torus.positions);
    check_cloud(&[]);
    check_cloud(&[Vec3::new(4.0, -2.0, 9.0)]);
    check_cloud(&[Vec3::splat(-1.0); 70]);
    let doubled = [&torus.positions[..300], &torus.positions[..300]].concat();
    check_cloud(&doubled);
    // Two pairs in neighbouring finest cells of opposite corners: 21 levels are needed, and leaves of two points.
    let cell = 2f32.powi(-21);
    let corners = [0.0, cell, 1.0 - cell, 1.0].map(Vec3::splat);
    check_cloud(&corners);
    let tree = Octree::build(&corners, &[[0; 4]; 4], StopCriterion::Loss(0.0));
    assert_eq!(tree.depth(), 21);
}

#[test]
fn a_view_selects_the_same_voxels() {
    let torus = test_shapes::torus(3000, 0.4, &mut Random(5));
    let colors = random_colors(3000, &mut Random(6));
    for stop in [StopCriterion::Loss(0.02), StopCriterion::PointsPerOctant(5)] {
        let tree = Octree::build(&torus.positions, &colors, stop);
        let read = StoredOctree::read_from(&bytes_of(&tree, None)).unwrap();
        for lod_px in [0.0, 2.0, 20.0] {
            let view = SelectView {
                lod_px,
                ..crate::levels::octree::tests::view_from(Vec3::new(0.0, 2.0, 1.5), Vec3::X, 0.0)
            };
            let (mut written, mut found) = (Vec::new(), Vec::new());
            let stats = tree.select(&view, &mut written);
            // Leaves that are known to be on one level are not looked for one by one.
            let stats_of_read = read.octree.select(&view, &mut found);
            assert_eq!(stats_of_read.emitted, stats.emitted);
            assert!(stats_of_read.visited_nodes <= stats.visited_nodes);
            assert_eq!(found, written);
            assert!(!found.is_empty());
        }
    }
}

#[test]
fn points_come_back_to_a_finest_cell() {
    let torus = test_shapes::torus(1000, 0.4, &mut Random(7)).moved(Vec3::splat(30.0));
    let colors = random_colors(1000, &mut Random(8));
    let cube = crate::math::Cube::around(&torus.positions).unwrap();
    let order = crate::math::order_of_codes(&cube.codes(&torus.positions));
    let tree = Octree::build(&torus.positions, &colors, StopCriterion::default());
    let points = StoredOctree::read_from(&bytes_of(&tree, None)).unwrap().points();
    assert_eq!(points.len(), 1000);
    let half_cell = 0.5 * cube.cell_edge(LEVELS);
    let rounding = 32.0 * f32::EPSILON;
    for (point, &index) in points.iter().zip(&order) {
        let [red, green, blue, _] = colors[index as usize];
        assert_eq!(point.color, [red, green, blue, 255]);
        let off = (Vec3::from(point.position) - torus.positions[index as usize]).abs();
        assert!(off.max_element() <= half_cell + rounding, "{off} of {half_cell}");
    }
}

#[test]
fn equal_columns_are_written_once() {
    let tree = Octree::build(&[Vec3::ZERO, Vec3::ONE], &[[1, 2, 3, 4]; 2], StopCriterion::default());
    let shape = ShapeRecord {
        normal: [1, -2],
        radius: 0.5,
        ellipse: 0,
        scalar: -3.0,
    };
    let alone = bytes_of(&tree, None).len();
    assert_eq!(bytes_of(&tree, Some(&[shape; 2])).len() - alone, 4 * 5);
    let other = ShapeRecord { radius: 0.75, ..shape };
    assert_eq!(bytes_of(&tree, Some(&[shape, other])).len() - alone, 4 * 5 + 4);
}

/// By hand: two points in opposite octants, one level.
#[test]
fn the_bytes_of_a_small_tree() {
    let colors = [[10, 20, 30, 0], [40, 50, 60, 0]];
    let tree = Octree::build(&[Vec3::ZERO, Vec3::ONE], &colors, StopCriterion::Depth(1));
    let bytes = bytes_of(&tree, None);
    let (head, rest) = bytes.split_at(MASKS_AT);
    let mut expected = b"reeltree\x01\0\0\0".to_vec();
    expected.extend([[0; 4], [0; 4], [0; 4], 1f32.to_le_bytes()].as_flattened());
    expected.extend([2, 0, 0, 0, 1, 0, 1, 0, 0, 0]);
    assert_eq!(head, expected);
    // 1 and 60 zeros; 1 and 60 ones; 6 zeros that fill up.
    let points = 1u128 | 1 << 61 | ((1 << 60) - 1) << 62;
    let mut expected = vec![0b1000_0001];
    expected.extend(points.to_le_bytes());
    expected.extend([10, 20, 30, 40, 50, 60]);
    let (content, checksum) = rest.split_at(expected.len());
    assert_eq!(content, expected);
    let crc = crc32fast::hash(&bytes[..bytes.len() - 4]);
    assert_eq!(checksum, crc.to_le_bytes());
}

fn small_tree(stop: StopCriterion) -> Vec<u8> {
    let sphere = test_shapes::sphere(24, &mut Random(11));
    let colors = random_colors(24, &mut Random(12));
    let tree = Octree::build(&sphere.positions, &colors, stop);
    bytes_of(&tree, Some(&random_shapes(24, &mut Random(13))))
}

const SMALL_STOPS: [StopCriterion; 3] = [
    StopCriterion::Loss(0.3),
    StopCriterion::Depth(5),
    StopCriterion::PointsPerOctant(3),
];

#[test]
fn every_flipped_bit_is_noticed() {
    for stop in SMALL_STOPS {
        let bytes = small_tree(stop);
        for bit in 0..8 * bytes.len() {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let error = StoredOctree::read_from(&damaged).unwrap_err();
            let expected = match bit / 8 {
                0..VERSION_AT => matches!(error, StoredOctreeError::Magic { .. }),
                VERSION_AT..12 => matches!(error, StoredOctreeError::Version { .. }),
                _ => matches!(error, StoredOctreeError::Checksum { .. }),
            };
            assert!(expected, "bit {bit}: {error}");
        }
    }
}

#[test]
fn every_lost_or_added_byte_is_noticed_with_a_right_checksum_too() {
    for stop in SMALL_STOPS {
        let bytes = small_tree(stop);
        for kept in 0..bytes.len() {
            assert!(StoredOctree::read_from(&bytes[..kept]).is_err());
            let shorter = with_right_checksum(bytes[..kept].to_vec());
            assert!(StoredOctree::read_from(&shorter).is_err(), "{kept} bytes");
        }
        let longer = with_right_checksum([&*bytes, &[0]].concat());
        assert!(StoredOctree::read_from(&longer).is_err());
    }
}

/// Each kind of damage has its own message.
#[test]
fn damage_with_a_right_checksum_is_named() {
    use StoredOctreeError as Error;
    let whole = small_tree(StopCriterion::Depth(5));
    let set = |at: usize, with: &[u8]| {
        let mut bytes = whole.clone();
        bytes[at..at + with.len()].copy_from_slice(with);
        StoredOctree::read_from(&with_right_checksum(bytes)).unwrap_err()
    };
    let most = u32::MAX.to_le_bytes();
    assert_eq!(set(VERSION_AT, &[2]), Error::Version { found: 2 });
    assert!(matches!(set(EDGE_AT, &f32::NAN.to_le_bytes()), Error::Cube { .. }));
    assert!(matches!(
        set(EDGE_AT, &0f32.to_le_bytes()),
        Error::Cube { edge: 0.0, .. }
    ));
    assert_eq!(set(POINTS_AT, &most), Error::TooManyPoints { found: u32::MAX });
    let claimed = set(POINTS_AT, &(1u32 << 31).to_le_bytes());
    assert!(matches!(claimed, Error::Truncated { part: "colours", .. }), "{claimed}");
    let claimed = set(POINTS_AT, &25u32.to_le_bytes());
    let few = Error::TooFewInLeaves {
        expected: 25,
        found: 24,
    };
    assert_eq!(claimed, few);
    let none = set(POINTS_AT, &[0]);
    assert!(matches!(none, Error::NodesWithoutPoints { depth: 5, .. }), "{none}");
    let few = set(POINTS_AT, &[3]);
    let cells = matches!(few, Error::Shape(OctreeError::TooManyCells { most: 3, .. }));
    assert!(cells, "{few}");
    assert_eq!(set(DEPTH_AT, &[22]), OctreeError::TooDeep { depth: 22 }.into());
    let deeper = set(DEPTH_AT, &[6]);
    let missing = matches!(deeper, Error::Shape(OctreeError::Truncated { level: 5, .. }));
    assert!(missing, "{deeper}");
    let trailing = set(DEPTH_AT, &[4]);
    let trails = matches!(trailing, Error::Shape(OctreeError::TrailingBytes { .. }));
    assert!(trails, "{trailing}");
    assert_eq!(set(FLAGS_AT, &[6]), Error::Flags { found: 6 });
    assert!(matches!(set(FLAGS_AT, &[0]), Error::TrailingBytes { .. }));
    let masks = set(MASK_COUNT_AT, &most);
    assert!(matches!(masks, Error::Truncated { part: "masks", .. }), "{masks}");
    let empty = OctreeError::EmptyNode { index: 0, level: 0 };
    assert_eq!(set(MASKS_AT, &[0]), empty.into());

    // From the end: checksum, 97 bytes of scalars, 5 of ellipses, 97 of radii.
    let scalars_at = whole.len() - 4 - 97;
    let radii_at = scalars_at - 5 - 97;
    let kind = set(scalars_at, &[2]);
    assert_eq!(
        kind,
        Error::ColumnKind {
            part: "scalars",
            found: 2
        }
    );
    let invalid = |part, point| Error::InvalidNumber { part, point };
    let infinite = f32::INFINITY.to_le_bytes();
    assert_eq!(set(scalars_at + 1, &infinite), invalid("scalars", 0));
    assert_eq!(set(radii_at + 1 + 8, &(-1f32).to_le_bytes()), invalid("radii", 2));
}

/// Damage in the bits of the points, in trees small enough to say what it must be.
#[test]
fn damaged_points_are_named() {
    use StoredOctreeError as Error;
    let colors = [[0; 4]; 2];
    let tree = Octree::build(&[Vec3::ZERO, Vec3::ONE], &colors, StopCriterion::Depth(1));
    let whole = bytes_of(&tree, None);
    let with_points = |points: u128| {
        let mut bytes = whole.clone();
        bytes[MASKS_AT + 1..MASKS_AT + 17].copy_from_slice(&points.to_le_bytes());
        StoredOctree::read_from(&with_right_checksum(bytes))
    };
    let right = 1 | 1 << 61;
    assert_eq!(with_points(right).unwrap().octree.level_counts(), [1, 2]);
    assert_eq!(with_points(right | 1 << 127), Err(Error::Padding));
    // Three points (0, 1, 1) in the first leaf; two in the second after one in the first.
    let found = |leaf, found, left| Err(Error::LeafTooLarge { leaf, found, left });
    assert_eq!(with_points(0b110), found(0, 3, 2));
    assert_eq!(with_points(1 | 0b010 << 61), found(1, 2, 1));
    assert!(matches!(with_points(0), Err(Error::Truncated { part: "points", .. })));

    // Both in the root, the first after the second.
    let root = bytes_of(&tree.with_stop(StopCriterion::Depth(0)), None);
    let mut bytes = root.clone();
    let points = 0b010u128 | 5 << 3 | 4 << 66;
    bytes[MASKS_AT..MASKS_AT + 16].copy_from_slice(&points.to_le_bytes());
    bytes[MASKS_AT + 16] = 0;
    let found = StoredOctree::read_from(&with_right_checksum(bytes));
    assert_eq!(found, Err(Error::OutOfOrder { point: 1 }));
}

#[test]
fn cells_divided_for_any_reason_are_read() {
    // Eight points in octant 0 of the root, and one in each of two others: by points, octant 0 alone is divided.
    let mut points: Vec<Vec3> = (0..8)
        .map(|corner| Vec3::from_array([0, 1, 2].map(|axis| 0.2 * (corner >> axis & 1) as f32)))
        .collect();
    points.extend([Vec3::X * 0.9, Vec3::X * 0.95, Vec3::Y * 0.9, Vec3::ONE]);
    let colors = vec![[0; 4]; points.len()];
    let even = Octree::build(&points, &colors, StopCriterion::Depth(3));
    let mut bytes = bytes_of(&even, None);
    bytes[FLAGS_AT] |= SEVERAL_LEVELS;
    // Two points share an octant, and others with as few are divided.
    let bytes = with_right_checksum(bytes);
    let read = StoredOctree::read_from(&bytes).unwrap();
    assert_eq!(read.octree, even);
    assert_eq!(bytes_of(&read.octree, None), bytes);
}

/// Whatever is read can be used and written again.
fn check_readable(bytes: &[u8]) {
    let Ok(read) = StoredOctree::read_from(bytes) else {
        return;
    };
    let tree = &read.octree;
    assert_eq!(read.points().len(), tree.point_count());
    let masks = tree.masks();
    assert_eq!(bytes[MASKS_AT..MASKS_AT + masks.len()], masks);
    assert_eq!(tree.level_voxels(tree.depth()).len(), tree.leaf_count());
    let again = bytes_of(tree, read.shapes.as_deref());
    assert_eq!(StoredOctree::read_from(&again), Ok(read));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Bytes set, lost, doubled and cut off anywhere, under a checksum made right again.
    #[test]
    fn damage_is_an_error_or_a_tree(
        stop in 0..SMALL_STOPS.len(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..8), 1..4),
    ) {
        let mut bytes = small_tree(SMALL_STOPS[stop]);
        for (at, byte, kind) in damage {
            let at = at.index(bytes.len());
            match kind {
                0 => drop(bytes.remove(at)),
                1 => bytes.insert(at, byte),
                2 => bytes.truncate(at.max(12)),
                3 => bytes[at] ^= 1 << (byte % 8),
                4 => bytes[at] = 0,
                5 => bytes[at] = u8::MAX,
                _ => bytes[at] = byte,
            }
        }
        check_readable(&with_right_checksum(bytes));
    }

    /// Anything behind a right beginning.
    #[test]
    fn noise_is_an_error_or_a_tree(
        depth in 0u8..23,
        flags in 0u8..4,
        points in 0u32..9,
        noise in prop::collection::vec(prop_oneof![Just(0u8), Just(1), Just(128), any::<u8>()], 0..60),
    ) {
        let mask_bytes = u32::from(depth).min(noise.len() as u32);
        let mut bytes = [&MAGIC[..], &VERSION.to_le_bytes()].concat();
        bytes.extend([[0; 4], [0; 4], [0; 4], 1f32.to_le_bytes()].as_flattened());
        bytes.extend(points.to_le_bytes());
        bytes.extend([depth, flags]);
        bytes.extend(mask_bytes.to_le_bytes());
        bytes.extend(noise);
        bytes.extend([0; 4]);
        check_readable(&with_right_checksum(bytes));
    }
}
