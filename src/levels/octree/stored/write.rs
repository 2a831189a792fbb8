//! A tree into bytes.

use super::bits::BitWriter;
use super::{MAGIC, Octree, SEVERAL_LEVELS, SHAPES, VERSION, columns};
use crate::cloud::ShapeRecord;
use crate::levels::cut::NodeRange;
use crate::levels::octree::stop::Leaves;
use crate::math::morton::LEVELS;
use std::io;

impl Octree {
    /// Writes the tree, and if given the shape of every point in Morton order (that of [`crate::cloud::Frame`]): bytes
    /// that [`super::StoredOctree::read_from`] reads, in the layout that is described there.
    ///
    /// Size: 42 bytes, a byte an internal node, and for each point 4 to 6 bytes of coordinates, 3 of colour and 16 of
    /// shape, less 4 for each of normal, radius, ellipse and scalar that is the same for all.
    ///
    /// # Panics
    /// Preconditions: one shape a point, with finite scalar and radius, the radius not below zero.
    pub fn write_to(&self, shapes: Option<&[ShapeRecord]>, out: &mut impl io::Write) -> io::Result<()> {
        let mut bytes = self.header(shapes.is_some());
        let masks = self.masks();
        bytes.extend((masks.len() as u32).to_le_bytes());
        bytes.extend(masks);
        bytes.extend(self.point_bits());
        bytes.extend((0..self.point_count()).flat_map(|point| self.point_color(point)));
        if let Some(shapes) = shapes {
            assert_eq!(shapes.len(), self.point_count(), "one shape for each point");
            columns::write(shapes, &mut bytes);
        }
        out.write_all(&bytes)?;
        out.write_all(&crc32fast::hash(&bytes).to_le_bytes())
    }

    /// All up to the masks.
    fn header(&self, has_shapes: bool) -> Vec<u8> {
        let several_levels = match self.leaves {
            Leaves::InRuns(_) | Leaves::OfPoints(_) if self.point_count() > 0 => SEVERAL_LEVELS,
            Leaves::OnLevel(_) | Leaves::InRuns(_) | Leaves::OfPoints(_) => 0,
        };
        let shapes = if has_shapes { SHAPES } else { 0 };
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(self.cube.min.to_array().map(f32::to_le_bytes).as_flattened());
        bytes.extend(self.cube.edge.to_le_bytes());
        bytes.extend((self.point_count() as u32).to_le_bytes());
        bytes.extend([self.depth() as u8, several_levels | shapes]);
        bytes
    }

    /// How many points each leaf has, and what its place in the tree does not say of their codes.
    fn point_bits(&self) -> Vec<u8> {
        let mut bits = BitWriter::default();
        let root = self.root();
        match &self.leaves {
            Leaves::OnLevel(level) => {
                let level = *level;
                self.put_leaves(&NodeRange { level, ..root }, &mut bits);
            }
            Leaves::InRuns(runs) => {
                let mut start = 0;
                for run in runs.iter() {
                    let points = start..run.end as usize;
                    start = points.end;
                    let level = run.level;
                    self.put_leaves(&NodeRange { level, points }, &mut bits);
                }
            }
            Leaves::OfPoints(_) if root.points.is_empty() => {}
            Leaves::OfPoints(_) => {
                self.put_leaves_below(&root, &mut bits);
            }
        }
        bits.into_bytes()
    }

    /// Recursion is bounded by the 21 levels.
    fn put_leaves_below(&self, node: &NodeRange, bits: &mut BitWriter) {
        if self.is_leaf(node.level, &node.points) {
            self.put_leaves(node, bits);
            return;
        }
        for (_, child) in self.points.children(node) {
            self.put_leaves_below(&child, bits);
        }
    }

    /// Consecutive leaves of one level.
    fn put_leaves(&self, leaves: &NodeRange, bits: &mut BitWriter) {
        let below = 3 * (LEVELS - leaves.level);
        let mut first = leaves.points.start;
        while first < leaves.points.end {
            let end = self.points.next_beginning(leaves.level, first + 1, leaves.points.end);
            bits.put_gamma((end - first) as u32);
            for cell in &self.points.cells[first..end] {
                bits.put(cell.code() & ((1 << below) - 1), below);
            }
            first = end;
        }
    }
}
