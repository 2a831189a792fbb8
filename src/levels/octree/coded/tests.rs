//! Byte codes with attributes against the octree, against all points, and against recomputed normals.

use super::*;
use crate::cloud::{oct_decode, oct_encode, quantised_normals};
use crate::math::order_of_codes;
use glam::Vec3;
use proptest::prelude::*;

type SharedRecords = (Arc<Vec<PointRecord>>, Arc<Vec<ShapeRecord>>);

/// Records in Morton order, of positions with normals and radii.
pub(crate) fn records(surfels: &[(Vec3, Vec3, f32)]) -> SharedRecords {
    let positions: Vec<Vec3> = surfels.iter().map(|surfel| surfel.0).collect();
    let Some(cube) = Cube::around(&positions) else {
        return SharedRecords::default();
    };
    let order = order_of_codes(&cube.codes(&positions));
    let in_order = order.iter().map(|&index| &surfels[index as usize]);
    let points = in_order.clone().enumerate().map(|(index, surfel)| {
        let [red, green, blue, _] = (index as u32).wrapping_mul(0x9e37_79b9).to_le_bytes();
        PointRecord {
            position: surfel.0.to_array(),
            color: [red, green, blue, 255],
        }
    });
    let shapes = in_order.map(|surfel| ShapeRecord {
        normal: oct_encode(surfel.1),
        radius: surfel.2,
        ellipse: 0,
        scalar: 0.0,
    });
    (Arc::new(points.collect()), Arc::new(shapes.collect()))
}

pub(crate) fn tree_of(records: &SharedRecords, stop: StopCriterion) -> Arc<Octree> {
    let positions: Vec<Vec3> = records.0.iter().map(|point| point.position.into()).collect();
    let colors: Vec<[u8; 4]> = records.0.iter().map(|point| point.color).collect();
    Arc::new(Octree::build(&positions, &colors, stop))
}

/// A sphere of radius 1, as a spiral.
fn sphere(count: u32, radius: f32) -> Vec<(Vec3, Vec3, f32)> {
    let golden_angle = std::f32::consts::PI * (3.0 - 5f32.sqrt());
    let on_sphere = |i: u32| {
        let z = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (golden_angle * i as f32).sin_cos();
        let ring = (1.0 - z * z).sqrt();
        Vec3::new(ring * cos, ring * sin, z)
    };
    (0..count).map(on_sphere).map(|p| (p, p, radius)).collect()
}

/// The nodes of a cloud with their levels, cells and children, derived from first children and masks alone.
fn all_nodes(cloud: &CodedCloud) -> Vec<(usize, u32, [u32; 3], Range<usize>)> {
    let mut nodes = vec![(0, 0, [0; 3])];
    let mut found = Vec::new();
    while let Some((node, level, cell)) = nodes.pop() {
        let mut children = 0..0;
        if level < cloud.depth() {
            let first = cloud.first_child(node);
            let mask = cloud.masks()[node];
            children = first..first + mask.count_ones() as usize;
            let octants = (0..8).filter(|octant| mask >> octant & 1 != 0);
            for (child, octant) in children.clone().zip(octants) {
                let bit = |axis: usize| octant >> axis & 1;
                let cell = [0, 1, 2].map(|axis| 2 * cell[axis] + bit(axis));
                nodes.push((child, level + 1, cell));
            }
        }
        found.push((node, level, cell, children));
    }
    found
}

#[test]
fn an_empty_cloud_has_an_empty_code() {
    let records = records(&[]);
    let cloud = CodedCloud::new(&tree_of(&records, StopCriterion::default()), &records.0, &records.1);
    assert!(cloud.masks().is_empty());
    assert!(cloud.attributes().is_empty());
    assert_eq!(cloud.depth(), 0);
    assert_eq!(cloud.bits_per_leaf(), None);
}

#[test]
fn a_single_point_is_a_node_at_its_position() {
    let normal = Vec3::new(2.0, -1.0, 2.0) / 3.0;
    let records = records(&[(Vec3::new(1.0, 2.0, 3.0), normal, 0.5)]);
    let octree = tree_of(&records, StopCriterion::Depth(3));
    let cloud = CodedCloud::new(&octree, &records.0, &records.1);
    assert!(cloud.is_of(&octree, &records.0, &records.1));
    assert!(!cloud.is_of(&tree_of(&records, StopCriterion::Depth(3)), &records.0, &records.1));
    assert_eq!(cloud.attributes().len(), 4);
    for node in cloud.attributes() {
        let decoded = quantised_normals(17)[node.normal() as usize];
        assert!(decoded.dot(normal) > 0.9999);
        assert_eq!(node.color, records.0[0].color[..3]);
    }
}

proptest! {
    #[test]
    fn any_prefix_decodes_to_the_tree_of_its_level(
        points in prop::collection::vec(prop::array::uniform3(-1f32..1.0), 1..400),
        depth in 0u32..8,
    ) {
        let surfels: Vec<_> = points.iter().map(|&p| (p.into(), Vec3::Z, 0.01)).collect();
        let records = records(&surfels);
        let octree = tree_of(&records, StopCriterion::Depth(depth));
        let cloud = CodedCloud::new(&octree, &records.0, &records.1);
        prop_assert_eq!(cloud.depth(), octree.depth());
        prop_assert_eq!(cloud.masks(), octree.masks());
        let positions: Vec<Vec3> = records.0.iter().map(|point| point.position.into()).collect();
        let finest = cloud.cube().cells(&positions);
        let nodes = all_nodes(&cloud);
        prop_assert_eq!(nodes.len(), cloud.attributes().len());
        for level in 0..=cloud.depth() {
            // Of all points, one at a time.
            let mut expected: Vec<[u32; 3]> = finest
                .iter()
                .map(|cell| [0, 1, 2].map(|axis| cell.coordinate(axis, level)))
                .collect();
            expected.dedup();
            prop_assert_eq!(&cloud.cells(level), &expected);
            prop_assert_eq!(cloud.level(level).len(), expected.len());
            let coarser = octree.with_stop(StopCriterion::Depth(level));
            prop_assert_eq!(&cloud.cells(level), &Octree::cells_from_masks(&coarser.masks(), level).unwrap());
            for (node, _, cell, _) in nodes.iter().filter(|node| node.1 == level) {
                prop_assert_eq!(*cell, expected[node - cloud.level(level).start]);
            }
        }
        for (node, level, _, _) in &nodes {
            let below = cloud.depth() - level;
            let leaves = cloud.descendants(*node..node + 1, below);
            prop_assert!(leaves.start < leaves.end && leaves.end <= cloud.attributes().len());
        }
    }

    /// For points with one normal, the disk of a node, where it is drawn, covers the disks of all points below it.
    #[test]
    fn radii_cover_all_descendants(
        points in prop::collection::vec((prop::array::uniform3(-1f32..1.0), 0.001f32..0.3), 1..200),
        normal in prop::array::uniform3(-1f32..1.0),
        depth in 0u32..6,
    ) {
        let normal = Vec3::from_array(normal).normalize_or(Vec3::Z);
        let surfels: Vec<_> = points.iter().map(|&(p, r)| (Vec3::from_array(p), normal, r)).collect();
        let records = records(&surfels);
        let octree = tree_of(&records, StopCriterion::Depth(depth));
        let cloud = CodedCloud::new(&octree, &records.0, &records.1);
        let positions: Vec<Vec3> = records.0.iter().map(|point| point.position.into()).collect();
        let cells = cloud.cube().cells(&positions);
        for (node, level, cell, _) in all_nodes(&cloud) {
            let edge = cloud.cube().cell_edge(level);
            let node = &cloud.attributes()[node];
            let normal = quantised_normals(17)[node.normal() as usize];
            let center = cloud.cube().cell_center(level, cell);
            for ((position, shape), finest) in positions.iter().zip(&*records.1).zip(&cells) {
                if [0, 1, 2].map(|axis| finest.coordinate(axis, level)) == cell {
                    let offset = position - center;
                    let in_plane = (offset - normal * offset.dot(normal)).length();
                    // The normal of the points differs by up to 0.6° from the decoded one.
                    prop_assert!(node.radius_edges() * edge >= 0.98 * (in_plane + shape.radius));
                }
            }
            prop_assert!(node.radius_edges() * edge <= cloud.largest_radius(level));
        }
    }

    #[test]
    fn cones_contain_the_normals_of_all_descendants(
        points in prop::collection::vec(
            (prop::array::uniform3(-1f32..1.0), prop::array::uniform3(-1f32..1.0)), 1..200),
        depth in 0u32..6,
    ) {
        let surfels: Vec<_> = points
            .iter()
            .map(|&(p, n)| (Vec3::from_array(p), (Vec3::from_array(n) + Vec3::Z).normalize_or(Vec3::Z), 0.1))
            .collect();
        let records = records(&surfels);
        let octree = tree_of(&records, StopCriterion::Depth(depth));
        let cloud = CodedCloud::new(&octree, &records.0, &records.1);
        let normal_of = |node: usize| quantised_normals(17)[cloud.attributes()[node].normal() as usize];
        for (node, level, _, _) in all_nodes(&cloud) {
            let cone = cloud.attributes()[node].cone();
            for below in level..=cloud.depth() {
                for inside in cloud.descendants(node..node + 1, below - level) {
                    let angle = normal_of(node).dot(normal_of(inside)).min(1.0).acos();
                    prop_assert!(cone >= angle.min(std::f32::consts::PI) - 1e-3, "{} {}", cone, angle);
                }
            }
        }
    }
}

/// On a sphere that is sampled as densely as its cells are large, the offsets move the centres of cells to the surface.
#[test]
fn offsets_move_points_onto_the_surface() {
    let records = records(&sphere(300_000, 0.01));
    let octree = tree_of(&records, StopCriterion::Depth(6));
    let cloud = CodedCloud::new(&octree, &records.0, &records.1);
    let depth = cloud.depth();
    let edge = cloud.cube().cell_edge(depth);
    let (mut without, mut with) = (0f32, 0f32);
    for (cell, node) in cloud
        .cells(depth)
        .into_iter()
        .zip(&cloud.attributes()[cloud.level(depth)])
    {
        let center = cloud.cube().cell_center(depth, cell);
        let normal = quantised_normals(17)[node.normal() as usize];
        without = without.max((center.length() - 1.0).abs() / edge);
        let moved = center + normal * (node.offset_edges() * edge);
        with = with.max((moved.length() - 1.0).abs() / edge);
    }
    // Half a step is 0.108; curvature adds a little.
    assert!(without > 0.75 && with < 0.16, "{without} to {with} edges");
}

/// On a surface whose cells are as large as its sample spacing, positions take 8/3 bits at most (Botsch et al.
/// 2002 §3).
#[test]
fn positions_take_fewer_bits_than_the_bound_of_the_paper() {
    let records = records(&sphere(400_000, 0.01));
    let octree = tree_of(&records, StopCriterion::Depth(5));
    let cloud = CodedCloud::new(&octree, &records.0, &records.1);
    let bits = cloud.bits_per_leaf().unwrap();
    assert!(bits.masks <= 8.0 / 3.0, "{bits:?}");
    assert!(bits.masks_entropy < bits.masks, "{bits:?}");
    let leaves = cloud.level(5).len() as f64;
    assert_eq!(bits.masks, 8.0 * cloud.masks().len() as f64 / leaves);
}

#[test]
fn leaves_on_several_levels_are_moved_to_one() {
    let records = records(&sphere(2000, 0.05));
    let octree = tree_of(&records, StopCriterion::PointsPerOctant(10));
    let cloud = CodedCloud::new(&octree, &records.0, &records.1);
    let on_one = octree.with_stop(StopCriterion::PAPER);
    assert_eq!(cloud.masks(), on_one.masks());
    assert!(cloud.is_of(&octree, &records.0, &records.1));
}

#[test]
fn numbers_of_all_magnitudes_are_handled() {
    let extremes = [0.0, 1e-45, -1e-38, 1e-20, 1.0, 1e30, -3e38, f32::MAX];
    let surfels: Vec<_> = (0..100)
        .map(|index| {
            let pick = |factor: usize| extremes[index * factor % extremes.len()];
            (
                Vec3::new(pick(1), pick(3), pick(5)),
                oct_decode([index as i16 * 300, 7]),
                pick(7).abs(),
            )
        })
        .collect();
    let records = records(&surfels);
    for stop in [
        StopCriterion::Loss(0.0),
        StopCriterion::Depth(21),
        StopCriterion::Depth(0),
    ] {
        let octree = tree_of(&records, stop);
        let cloud = CodedCloud::new(&octree, &records.0, &records.1);
        assert_eq!(cloud.attributes().len(), octree.node_count());
    }
}
