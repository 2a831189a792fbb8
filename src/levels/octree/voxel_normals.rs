//! The normals of voxels (future work of the 4D media paper): shading uses them instead of the faces of cubes.
//!
//! How it works: the mean of the normals of a node's points, which are a range; each is turned to the side of those
//! before it, so that the normals of a file without a sensor, whose signs mean nothing, do not cancel each other. As
//! the light is two-sided, the sign of the mean means nothing either. Levels that are drawn repeatedly are cached, as
//! voxels are (`cached_levels.rs`).

use super::cached_levels::Cached;
use super::gap::Gap;
use super::gaps::add_gaps;
use super::surfels::LodSurfels;
use super::write::{NodeWriter, Nodes};
use crate::cloud::{ShapeRecord, oct_decode, oct_encode};
use crate::levels::cut::Cut;
use glam::Vec3;

impl LodSurfels {
    /// Replaces the contents of `out` by records with the normals of the voxels of a cut of the octree, in the order of
    /// [`super::Octree::write_voxels`]. All else in them is 0.
    pub fn write_voxel_normals(&self, cut: &Cut, out: &mut Vec<ShapeRecord>) {
        let sorted = &self.octree.points;
        let writer = NormalWriter { shapes: &self.shapes };
        let coarse = sorted.coarse_levels().len() as u32;
        let may_be_cached = cut.ranges.iter().filter(|range| range.level < coarse);
        let cached: Cached<'_, ShapeRecord> = self.normals.cached(may_be_cached, sorted, &writer);
        sorted.write_nodes(&cut.ranges, &writer, &cached, out);
    }
}

impl LodSurfels {
    /// Adds records with the normals of gaps, in the order of [`super::Octree::add_gap_voxels`].
    pub fn add_gap_normals(&self, gaps: &[Gap], out: &mut Vec<ShapeRecord>) {
        let shapes = &self.shapes;
        add_gaps(gaps, &NormalWriter { shapes }, out);
    }
}

struct NormalWriter<'a> {
    /// One a point.
    shapes: &'a [ShapeRecord],
}

impl NodeWriter for NormalWriter<'_> {
    type Record = ShapeRecord;

    #[inline(always)]
    fn write(&self, nodes: &Nodes<'_>, out: &mut [ShapeRecord]) {
        let ends = nodes.ends.iter();
        for (record, (&first, &end)) in out.iter_mut().zip(nodes.firsts.iter().zip(ends)) {
            *record = ShapeRecord {
                normal: mean_normal(&self.shapes[first as usize..end as usize]),
                radius: 0.0,
                ellipse: 0,
                scalar: 0.0,
            };
        }
    }
}

/// Octahedral, as in the points. Precondition: there is one.
#[inline(always)]
fn mean_normal(shapes: &[ShapeRecord]) -> [i16; 2] {
    let [only] = shapes else {
        let mut sum = Vec3::ZERO;
        for shape in shapes {
            let normal = oct_decode(shape.normal);
            sum += if normal.dot(sum) < 0.0 { -normal } else { normal };
        }
        // Flipping each towards the sum makes the sum longer, so it is not 0.
        return oct_encode(sum.normalize_or(Vec3::Z));
    };
    only.normal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_shapes::{self, Random};
    use crate::cloud::PointRecord;
    use crate::levels::CutHints;
    use crate::levels::Levels as _;
    use crate::levels::octree::tests::view_from;
    use crate::levels::octree::{Octree, StopCriterion};
    use std::sync::Arc;

    /// A sphere whose normals point outwards or, half of them, inwards; in Morton order.
    fn sphere(count: usize) -> (Vec<PointRecord>, Vec<ShapeRecord>) {
        let mut random = Random(17);
        let positions = test_shapes::sphere(count, &mut random).positions;
        let cube = crate::math::Cube::around(&positions).unwrap();
        let order = crate::math::order_of_codes(&cube.codes(&positions));
        let sorted = order.iter().map(|&index| positions[index as usize]);
        sorted
            .map(|position| {
                let side = if random.unit() < 0.5 { 1.0 } else { -1.0 };
                let point = PointRecord {
                    position: position.to_array(),
                    color: [200; 4],
                };
                let shape = ShapeRecord {
                    normal: oct_encode(side * position.normalize()),
                    radius: 0.01,
                    ellipse: 0,
                    scalar: 3.0,
                };
                (point, shape)
            })
            .unzip()
    }

    #[test]
    fn cell_normals_match_the_surface_whatever_the_signs_of_point_normals() {
        let (points, shapes) = sphere(30_000);
        let positions: Vec<Vec3> = points.iter().map(|point| point.position.into()).collect();
        let colors = vec![[200; 4]; points.len()];
        let octree = Arc::new(Octree::build(&positions, &colors, StopCriterion::Spacing));
        let surfels = LodSurfels::new(Arc::clone(&octree), Arc::new(points), Arc::new(shapes));
        let (mut voxels, mut normals) = (Vec::new(), Vec::new());
        // At the second and third time levels are cached.
        for lod_px in [0.0, 12.0, 0.0, 12.0, 0.0] {
            let view = view_from(Vec3::new(2.0, 3.0, 4.0), Vec3::ZERO, lod_px);
            let cut = octree.cut(&view, CutHints::default());
            octree.write_voxels(&cut, &mut voxels);
            surfels.write_voxel_normals(&cut, &mut normals);
            assert_eq!(voxels.len(), normals.len());
            let cosine = |(voxel, shape): (&crate::cloud::VoxelRecord, &ShapeRecord)| {
                let outwards = Vec3::from_array(voxel.center).normalize();
                oct_decode(shape.normal).dot(outwards).abs()
            };
            let min = voxels.iter().zip(&normals).map(cosine).fold(1.0, f32::min);
            let mean = voxels.iter().zip(&normals).map(cosine).sum::<f32>() / voxels.len() as f32;
            assert!(min > 0.9 && mean > 0.998, "{lod_px} px: {min}, {mean}");
        }
    }

    #[test]
    fn the_mean_matches_one_computed_by_hand() {
        let mean = |normals: &[Vec3]| {
            let shapes: Vec<ShapeRecord> = normals
                .iter()
                .map(|&normal| ShapeRecord {
                    normal: oct_encode(normal),
                    radius: 1.0,
                    ellipse: 0,
                    scalar: 0.0,
                })
                .collect();
            oct_decode(mean_normal(&shapes))
        };
        assert_eq!(mean(&[Vec3::NEG_Z]), Vec3::NEG_Z);
        // Both sides of a thin sheet count as one direction.
        assert_eq!(mean(&[Vec3::Y, Vec3::NEG_Y, Vec3::Y]), Vec3::Y);
        let between = mean(&[Vec3::X, Vec3::Y]);
        assert!(between.abs_diff_eq(Vec3::new(0.5, 0.5, 0.0).normalize(), 1e-4));
    }
}
