//! Bytes into a tree, every claim checked before it is believed.

use super::bits::BitReader;
use super::{MAGIC, SEVERAL_LEVELS, SHAPES, StoredOctree, StoredOctreeError, VERSION, columns};
use crate::levels::octree::Octree;
use crate::levels::octree::byte_code::{LeafLevels, leaves_of_masks};
use crate::levels::octree::sorted_points::SortedPoints;
use crate::levels::octree::stop::{LeafRun, Leaves};
use crate::math::{Cube, morton::LEVELS};
use glam::Vec3;
use std::sync::Arc;

/// Most points of a tree.
const MOST_POINTS: u32 = 1 << 31;

/// Bytes of the checksum.
const CHECKSUM_BYTES: usize = 4;

impl StoredOctree {
    /// Reads what [`Octree::write_to`] wrote: all of `bytes`, no more and no less.
    ///
    /// The tree is [equal](PartialEq) to the written one. Bytes that are damaged are an error, and so are those of
    /// another kind or a later version. Memory reserved is at most some thirty times the bytes, whatever they claim.
    pub fn read_from(bytes: &[u8]) -> Result<Self, StoredOctreeError> {
        let content = checked_content(bytes)?;
        let (header, rest) = OctreeHeader::read(content)?;
        let (masks, rest) = split(rest, header.mask_bytes, "masks")?;
        // What a number of points may claim is bounded by their colours.
        let color_bytes = header.point_count.saturating_mul(3);
        if rest.len() < color_bytes {
            return Err(truncated("colours", color_bytes, rest.len()));
        }
        let leaves = header.leaves(masks)?;
        let mut bits = BitReader::new(rest);
        let points = read_points(&mut bits, rest.len(), &leaves, header.point_count)?;
        let rest = bits.into_rest().ok_or(StoredOctreeError::Padding)?;
        let (colors, rest) = split(rest, color_bytes, "colours")?;
        let (shapes, rest) = if header.has_shapes {
            let (shapes, rest) = columns::read(rest, header.point_count)?;
            (Some(shapes), rest)
        } else {
            (None, rest)
        };
        if !rest.is_empty() {
            let trailing = rest.len();
            return Err(StoredOctreeError::TrailingBytes { trailing });
        }
        let octree = header.octree(points, colors.as_chunks().0);
        Ok(Self { octree, shapes })
    }
}

/// What is between the version and the checksum, once both are right.
fn checked_content(bytes: &[u8]) -> Result<&[u8], StoredOctreeError> {
    let Some(rest) = bytes.strip_prefix(&MAGIC) else {
        let found = bytes[..bytes.len().min(MAGIC.len())].to_vec();
        return Err(StoredOctreeError::Magic { found });
    };
    let (found, rest) = take_u32(rest, "version")?;
    if found != VERSION {
        return Err(StoredOctreeError::Version { found });
    }
    let Some((content, checksum)) = rest.split_last_chunk::<CHECKSUM_BYTES>() else {
        return Err(truncated("checksum", CHECKSUM_BYTES, rest.len()));
    };
    let found = u32::from_le_bytes(*checksum);
    let expected = crc32fast::hash(&bytes[..bytes.len() - CHECKSUM_BYTES]);
    if found != expected {
        return Err(StoredOctreeError::Checksum { expected, found });
    }
    Ok(content)
}

/// What stands before the masks.
#[derive(Debug)]
struct OctreeHeader {
    cube: Cube,
    point_count: usize,
    depth: u32,
    has_several_levels: bool,
    has_shapes: bool,
    mask_bytes: usize,
}

impl OctreeHeader {
    fn read(bytes: &[u8]) -> Result<(Self, &[u8]), StoredOctreeError> {
        let (cube, rest) = split(bytes, 16, "cube")?;
        let cube = read_cube(cube)?;
        let (point_count, rest) = take_u32(rest, "number of points")?;
        if point_count > MOST_POINTS {
            let found = point_count;
            return Err(StoredOctreeError::TooManyPoints { found });
        }
        let (depth_and_flags, rest) = split(rest, 2, "depth and flags")?;
        let [depth, flags] = [depth_and_flags[0], depth_and_flags[1]];
        if flags & !(SEVERAL_LEVELS | SHAPES) != 0 {
            return Err(StoredOctreeError::Flags { found: flags });
        }
        let (mask_bytes, rest) = take_u32(rest, "number of masks")?;
        let header = Self {
            cube,
            point_count: point_count as usize,
            depth: u32::from(depth),
            has_several_levels: flags & SEVERAL_LEVELS != 0,
            has_shapes: flags & SHAPES != 0,
            mask_bytes: mask_bytes as usize,
        };
        Ok((header, rest))
    }

    /// The leaves as location codes in Morton order.
    fn leaves(&self, masks: &[u8]) -> Result<Vec<u64>, StoredOctreeError> {
        if self.point_count == 0 {
            return match (self.depth, masks, self.has_several_levels) {
                (0, [], false) => Ok(Vec::new()),
                (depth, masks, _) => Err(StoredOctreeError::NodesWithoutPoints {
                    depth,
                    mask_bytes: masks.len(),
                }),
            };
        }
        let leaves = if self.has_several_levels {
            LeafLevels::OnAnyLevel
        } else {
            LeafLevels::OnDeepestLevel
        };
        let mut leaves = leaves_of_masks(masks, self.depth, leaves, self.point_count)?;
        if self.has_several_levels {
            // Codes of all levels moved up to the same highest bit: Morton order.
            leaves.sort_unstable_by_key(|leaf| leaf << leaf.leading_zeros());
        }
        Ok(leaves)
    }

    /// The tree, whatever was asked for when it was built: leaves with points in each of them can only be where they
    /// were.
    fn octree(&self, points: ReadPoints, colors: &[[u8; 3]]) -> Octree {
        let sorted = SortedPoints::from_codes(&points.codes, colors).expect("codes ascend");
        let leaves = if self.has_several_levels {
            Leaves::InRuns(points.runs.into())
        } else {
            Leaves::OnLevel(self.depth)
        };
        Octree::with_leaves(self.cube, Arc::new(sorted), leaves)
    }
}

fn read_cube(bytes: &[u8]) -> Result<Cube, StoredOctreeError> {
    let (numbers, _) = bytes.as_chunks::<4>();
    let number = |index: usize| f32::from_le_bytes(numbers[index]);
    let cube = Cube {
        min: Vec3::new(number(0), number(1), number(2)),
        edge: number(3),
    };
    let is_valid = cube.min.is_finite() && cube.edge.is_finite() && cube.edge > 0.0;
    if is_valid {
        Ok(cube)
    } else {
        Err(StoredOctreeError::Cube {
            min: cube.min.to_array(),
            edge: cube.edge,
        })
    }
}

/// Points as they are stored.
#[derive(Debug)]
struct ReadPoints {
    /// Ascending.
    codes: Vec<u64>,
    /// The levels of their leaves.
    runs: Vec<LeafRun>,
}

/// The points of all leaves.
fn read_points(
    bits: &mut BitReader<'_>,
    byte_count: usize,
    leaves: &[u64],
    point_count: usize,
) -> Result<ReadPoints, StoredOctreeError> {
    let mut codes = Vec::with_capacity(point_count);
    let mut runs = Vec::new();
    let ended = || truncated("points", byte_count + 1, byte_count);
    for (leaf, &location) in leaves.iter().enumerate() {
        let below = location.leading_zeros();
        let left = point_count - codes.len();
        let found = bits.take_gamma().ok_or_else(ended)? as usize;
        if found > left {
            return Err(StoredOctreeError::LeafTooLarge { leaf, found, left });
        }
        let first_code = finest_code(location);
        let mut least = first_code;
        for _ in 0..found {
            let code = first_code | bits.take(below).ok_or_else(ended)?;
            if code < least {
                let point = codes.len();
                return Err(StoredOctreeError::OutOfOrder { point });
            }
            codes.push(code);
            least = code;
        }
        LeafRun::push(&mut runs, codes.len(), LEVELS - below / 3);
    }
    match codes.len() {
        found if found == point_count => Ok(ReadPoints { codes, runs }),
        found => Err(StoredOctreeError::TooFewInLeaves {
            expected: point_count,
            found,
        }),
    }
}

/// The first finest code in the cell of a location code.
fn finest_code(location: u64) -> u64 {
    (location << location.leading_zeros()) ^ 1 << (3 * LEVELS)
}

fn truncated(part: &'static str, expected: usize, found: usize) -> StoredOctreeError {
    StoredOctreeError::Truncated { part, expected, found }
}

/// The first `count` bytes, and the others.
fn split<'a>(bytes: &'a [u8], count: usize, part: &'static str) -> Result<(&'a [u8], &'a [u8]), StoredOctreeError> {
    bytes
        .split_at_checked(count)
        .ok_or_else(|| truncated(part, count, bytes.len()))
}

fn take_u32<'a>(bytes: &'a [u8], part: &'static str) -> Result<(u32, &'a [u8]), StoredOctreeError> {
    match bytes.split_first_chunk() {
        Some((number, rest)) => Ok((u32::from_le_bytes(*number), rest)),
        None => Err(truncated(part, 4, bytes.len())),
    }
}
