//! A tree into bytes.

use super::bits::BitWriter;
use super::{MAGIC, Octree, SEVERAL_LEVELS, SHAPES, VERSION, columns};
use crate::cloud::ShapeRecord;
use crate::math::morton::LEVELS;
use std::io;
use std::ops::Range;

impl Octree {
    /// Writes the tree, and if given the shape of every point in Morton order (that of [`crate::cloud::Frame`]): bytes that
    /// [`super::StoredOctree::read_from`] reads, in the layout that is described there.
    ///
    /// Size: 42 bytes, a byte an internal node, and for each point 4 to 6 bytes of coordinates, 3 of colour and 16 of shape,
    /// less 4 for each of normal, radius, ellipse and scalar that is the same for all.
    ///
    /// # Panics
    /// Preconditions: one shape a point, with finite scalar and radius, the radius not below zero.
    pub fn write_to(
        &self,
        shapes: Option<&[ShapeRecord]>,
        out: &mut impl io::Write,
    ) -> io::Result<()> {
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
        let several_levels = if self.is_even { 0 } else { SEVERAL_LEVELS };
        let shapes = if has_shapes { SHAPES } else { 0 };
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(
            self.cube
                .min
                .to_array()
                .map(f32::to_le_bytes)
                .as_flattened(),
        );
        bytes.extend(self.cube.edge.to_le_bytes());
        bytes.extend((self.point_count() as u32).to_le_bytes());
        bytes.extend([self.depth() as u8, several_levels | shapes]);
        bytes
    }

    /// How many points each leaf has, and what its place in the tree does not say of their codes.
    fn point_bits(&self) -> Vec<u8> {
        let mut bits = BitWriter::default();
        for (points, level) in self.leaf_points() {
            let below = 3 * (LEVELS - level);
            bits.put_gamma(points.len() as u32);
            for &code in &self.points.codes[points] {
                bits.put(code & ((1 << below) - 1), below);
            }
        }
        bits.into_bytes()
    }

    /// The points and the level of each leaf, in Morton order.
    fn leaf_points(&self) -> Vec<(Range<usize>, u32)> {
        let mut leaves = Vec::with_capacity(self.leaf_count);
        for (level, nodes) in self.levels.iter().enumerate() {
            for node in 0..nodes.node_count() {
                if nodes.mask(node) == 0 {
                    let end = match &nodes.point_end {
                        Some(ends) => ends[node],
                        None => nodes.first_point[node + 1],
                    };
                    let points = nodes.first_point[node] as usize..end as usize;
                    leaves.push((points, level as u32));
                }
            }
        }
        // Those of one level are in order.
        leaves.sort_by_key(|(points, _)| points.start);
        leaves
    }
}
