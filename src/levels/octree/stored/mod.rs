//! An octree as bytes, and back: the breadth-first byte code (paper 000 §VI-A) with what it leaves out, the points.
//!
//! The byte code is the shape of the tree down to its leaves in one byte an internal node. A leaf is then the number of
//! its points, and a point no more than the bits of its Morton code below its leaf: what is above, the byte code says.
//! So the tree that is read equals the one written, and can be divided anew ([`Octree::with_stop`]) like it.
//!
//! Use: what takes long to prepare (normals, radii, the sorted points) is kept beside a scan, or handed to another
//! program.
//!
//! # Layout
//! Integers and floats are little-endian; bits are taken from the lowest of each byte up.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | [`MAGIC`] |
//! | 4 | [`VERSION`] |
//! | 16 | the cube: smallest corner x, y, z and edge, f32, scene units relative to the sequence origin |
//! | 4 | number of points n, at most 2³¹ |
//! | 1 | level of the deepest leaves, at most 21 |
//! | 1 | flags: bit 0, leaves may be on several levels; bit 1, there are shapes |
//! | 4 | number of mask bytes m |
//! | m | the masks of [`Octree::masks`] |
//! | … | bits: for each leaf in Morton order the number of its points, as an Elias gamma code (zeros, as many as the number has bits beyond its highest; a one; those bits), then for each of its points in ascending order the 3 · (21 − level) lowest bits of its Morton code; filled up to a byte with zeros |
//! | 3n | red, green, blue of each point |
//! | … | if there are shapes, four columns: normals (two octahedral i16), radii (f32, scene units), ellipses (u32), scalars (f32). A column is a byte, 1, and four bytes a point; or 0, and the four bytes that all points have |
//! | 4 | CRC-32 (IEEE 802.3) of all bytes before |
//!
//! # Example
//! ```
//! use glam::Vec3;
//! use pointreel::levels::octree::{Octree, StopCriterion, StoredOctree};
//!
//! let positions = [Vec3::ZERO, Vec3::X, Vec3::ONE];
//! let tree = Octree::build(&positions, &[[200, 100, 50, 255]; 3], StopCriterion::default());
//! let mut bytes = Vec::new(); // or a file: `scan.reeltree`
//! tree.write_to(None, &mut bytes)?;
//! let read = StoredOctree::read_from(&bytes)?;
//! assert_eq!(read.octree, tree);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Errors
//! Coordinates are kept to a 2²¹st of the cube's edge, all else bit by bit; alpha, which trees do not have, is lost.
//! Any flipped bit is noticed by the checksum. Bytes made to pass it are read as a valid tree or refused: every number
//! that claims something is checked before memory is reserved for it, so that no more than some thirty times the bytes
//! are (27 measured for the densest tree, `benches/stored.rs`).

mod bits;
mod columns;
mod error;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use error::StoredOctreeError;

use super::Octree;
use super::color_sums::color_of_sum;
use crate::cloud::{PointRecord, ShapeRecord};
use crate::math::morton::LEVELS;

/// How every stored octree begins.
pub const MAGIC: [u8; 8] = *b"reeltree";

/// The version of the layout.
pub const VERSION: u32 = 1;

/// Set when leaves may be on several levels.
const SEVERAL_LEVELS: u8 = 1;
/// Set when there are shapes.
const SHAPES: u8 = 2;

/// What was stored of a prepared cloud.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredOctree {
    /// Equal to the one that was written.
    pub octree: Octree,
    /// The shape of every point in the order of [`StoredOctree::points`], if shapes were written.
    pub shapes: Option<Vec<ShapeRecord>>,
}

impl StoredOctree {
    /// The points in Morton order, opaque, each in the middle of its finest cell.
    ///
    /// Error: at most a 2²²nd of the cube's edge along each axis, beside the rounding of f32.
    pub fn points(&self) -> Vec<PointRecord> {
        let cube = self.octree.cube;
        let points = &self.octree.points;
        let cells = points.cells.iter().enumerate();
        cells
            .map(|(point, cell)| {
                let [red, green, blue] = self.octree.point_color(point);
                PointRecord {
                    position: cube.cell_center(LEVELS, cell.coordinates()).to_array(),
                    color: [red, green, blue, 255],
                }
            })
            .collect()
    }
}

impl Octree {
    /// Red, green and blue of one point, by its place in Morton order.
    fn point_color(&self, point: usize) -> [u8; 3] {
        let sums = &self.points.colors_before;
        color_of_sum(sums[point + 1].wrapping_sub(sums[point]))
    }
}
