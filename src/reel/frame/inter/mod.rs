//! Frames that are encoded relative to the previous one: its nodes, moved and changed.
//!
//! How it works: where the points of a file keep their order from frame to frame, the points of a cell of the key frame
//! stay together, and the node that stands for them moves as their mean does. The displacement is one more attribute of
//! the nodes of the key frame's octree, coded level by level: a node moves as its parent does, corrected by the
//! surrounding motion ([`slope`]). Colours and single numbers are changes, by the transform of colours in independent
//! frames; normals turn as those around them.
//!
//! When it wins: models that are animated, surfaces that are tracked. An attribute coded once need not be coded again:
//! for a textured body hardly anything is left but its motion, and points keep their identity, so nothing flickers. If
//! every frame is resampled, no two points correspond, and frames are independent.
//!
//! What it costs: a frame is decoded after those before it, back to the key frame. Coarse levels are decoded from
//! coarse levels alone.

mod changes;
mod code;
mod followed;
mod motion;
mod run;
mod slope;

pub(in crate::reel) use code::{decode, encode};
pub(in crate::reel) use followed::{Followed, cloud_of_followed};
pub(in crate::reel) use run::{Run, follows};

use super::grid::Grid;
use super::schema::{Retained, Schema, Values};

/// Maximum coded motion of a node in parts of a cell: within it, quotients are exact ([`crate::reel::coder::divided`]).
const MAX_CHANGE: i32 = 1 << 13;

/// Maximum bits of a position, so that it may leave the cube.
const MAX_POSITION_BITS: u32 = 28;

/// Precision of node motion.
#[derive(Debug, Clone, Copy)]
struct MotionScale {
    /// Bits of the parts of a deepest cell.
    part_bits: u32,
    /// The steps in which points or the finest nodes move, an odd number of parts, and the least of any level.
    steps: [i32; 2],
    /// An encoder leaves a node alone that is off by at most this many parts along an axis: earlier errors would
    /// otherwise be coded as motion, again and again.
    tolerance: f64,
}

impl MotionScale {
    /// The step of a level by how many levels of nodes are below it.
    fn step(self, below: u32) -> i32 {
        let [finest, min] = self.steps;
        ((finest >> below.min(16)) | 1).max(min)
    }
}

/// Returns the precision of the motion of a frame's nodes.
fn motion_scale(schema: &Schema) -> MotionScale {
    match schema.retained {
        // Individually stored points are off by at most half a cell: a tolerance, half a step, and rounding.
        Retained::Bits(bits) => MotionScale {
            part_bits: u32::from(bits) + 3,
            steps: [3, 3],
            tolerance: 1.9,
        },
        // At most half a cell.
        _ => MotionScale {
            part_bits: 8,
            steps: [129, 17],
            // A quarter of a cell. If every frame encoded the error of the previous one, that noise would be mistaken
            // for motion and used for prediction: 6 bits per point for the walking man with steps of a quarter of a
            // cell, instead of 1.2.
            tolerance: 64.0,
        },
    }
}

/// Bits of the parts of the deepest cells that positions of moved frames are in; `None` for frames that always stand
/// alone, as they keep numbers to the last bit.
pub(in crate::reel) fn part_bits(schema: &Schema, grid: &Grid) -> Option<u32> {
    let is_exact =
        schema.has_exact_normals || schema.has_exact_scalars || schema.has_ellipses || schema.radii == Values::Exact;
    let bits = motion_scale(schema).part_bits;
    let is_coded = !is_exact && schema.retained != Retained::Exact;
    (is_coded && grid.depth + bits <= MAX_POSITION_BITS).then_some(bits)
}
