//! Attributes of all nodes, from the leaves up.
//!
//! How it works: a leaf takes the means of its points (as [`NodeSurfel`] has them), and a node above the means of its
//! children, weighted by points, so that the points are read once and each level costs a third of the one below. The
//! surface in a cell is taken for the plane through the mean position across the mean normal: the offset is where the
//! line through the centre of the cell along the normal meets it (Botsch et al. 2002 §5.1). The radius is the smallest
//! that covers all disks below from there. Normals are used as they will be decoded, so that a cone holds the drawn
//! normals.

use super::attributes::NodeAttributes;
use crate::cloud::{FINEST_NORMAL_BITS, PointRecord, ShapeRecord, oct_decode, quantise_normal, quantised_normals};
use crate::levels::octree::Octree;
use crate::levels::octree::node_surfel::NodeSurfel;
use crate::math::morton;
use bytemuck::Zeroable;
use glam::Vec3;
use rayon::prelude::*;

/// Intermediate summary of a node while it is aggregated.
#[derive(Debug, Clone, Copy)]
struct Summary {
    mean: Vec3,
    normal: Vec3,
    color: Vec3,
    point_count: f32,
    cell: [u32; 3],
    /// Bounding radius of all disks below, from `drawn_at`.
    radius: f32,
    /// Half angle of the cone of normals, in radians.
    cone: f32,
    /// Position of its splat.
    drawn_at: Vec3,
    /// The normal as it is decoded, and its index.
    drawn_normal: Vec3,
    normal_index: u32,
    offset_edges: f32,
}

/// For rounding of cosines near 1, in radians.
const ANGLE_SLACK: f32 = 1e-3;

/// Nodes that are worth handing to another thread.
const NODES_PER_TASK: usize = 1 << 10;

/// The attributes of all nodes, breadth-first. Precondition: all leaves of the tree are on one level.
pub(super) fn attributes(
    tree: &Octree,
    masks: &[u8],
    points: &[PointRecord],
    shapes: &[ShapeRecord],
) -> Vec<NodeAttributes> {
    if points.is_empty() {
        return Vec::new();
    }
    let mut attributes = vec![NodeAttributes::zeroed(); tree.node_count()];
    let mut end = attributes.len();
    let mut below = leaves(tree, points, shapes);
    let mut masks = masks;
    for level in (0..=tree.depth()).rev() {
        let start = end - below.len();
        let edge = tree.cube().cell_edge(level);
        attributes[start..end]
            .par_iter_mut()
            .with_min_len(NODES_PER_TASK)
            .zip(&below)
            .for_each(|(attributes, node)| *attributes = node.attributes(edge));
        end = start;
        if level > 0 {
            let above = tree.level_counts()[level as usize - 1];
            let (rest, of_level) = masks.split_at(masks.len() - above);
            masks = rest;
            below = parents(tree, level - 1, of_level, &below);
        }
    }
    attributes
}

fn leaves(tree: &Octree, points: &[PointRecord], shapes: &[ShapeRecord]) -> Vec<Summary> {
    let depth = tree.depth();
    let partings = tree.points.partings.iter().enumerate();
    let begin = |&(point, &parting): &(usize, &u8)| point == 0 || u32::from(parting) <= depth;
    let mut starts: Vec<usize> = partings.filter(begin).map(|(point, _)| point).collect();
    starts.push(points.len());
    starts
        .par_windows(2)
        .with_min_len(NODES_PER_TASK)
        .map(|ends| {
            let range = ends[0]..ends[1];
            let finest = tree.points.cells[range.start];
            let cell = [0, 1, 2].map(|axis| finest.coordinate(axis, depth));
            let surfel = NodeSurfel::of(&points[range.clone()], &shapes[range], false);
            let [red, green, blue, _] = surfel.point.color;
            let mut leaf = Summary::placed(
                tree,
                depth,
                cell,
                Vec3::from_array(surfel.point.position),
                oct_decode(surfel.shape.normal),
            );
            leaf.color = Vec3::from_array([red, green, blue].map(f32::from));
            leaf.point_count = surfel.point_count as f32;
            leaf.radius = leaf.distance_in_plane(leaf.mean) + surfel.shape.radius;
            leaf
        })
        .collect()
}

/// The nodes of a level with these masks, from the nodes of the level below.
fn parents(tree: &Octree, level: u32, masks: &[u8], below: &[Summary]) -> Vec<Summary> {
    let mut next = 0;
    let firsts: Vec<(usize, usize)> = masks
        .iter()
        .map(|mask| {
            let first = next;
            next += mask.count_ones() as usize;
            (first, next)
        })
        .collect();
    firsts
        .par_iter()
        .with_min_len(NODES_PER_TASK)
        .map(|&(first, end)| parent(tree, level, &below[first..end]))
        .collect()
}

fn parent(tree: &Octree, level: u32, children: &[Summary]) -> Summary {
    let cell = children[0].cell.map(|coordinate| coordinate / 2);
    let (mut mean, mut normal, mut color) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    let point_count = children.iter().map(|child| child.point_count).sum::<f32>();
    for child in children {
        let share = child.point_count / point_count;
        mean += child.mean * share;
        normal += child.normal * share;
        color += child.color * share;
    }
    let normal = normal.try_normalize().unwrap_or(children[0].normal);
    let mut parent = Summary::placed(tree, level, cell, mean, normal);
    parent.color = color;
    parent.point_count = point_count;
    for child in children {
        let reach = parent.distance_in_plane(child.drawn_at) + child.radius;
        parent.radius = parent.radius.max(reach);
        let cosine = parent.drawn_normal.dot(child.drawn_normal).clamp(-1.0, 1.0);
        parent.cone = parent.cone.max(child.cone + cosine.acos() + ANGLE_SLACK);
    }
    parent
}

impl Summary {
    /// A node with this mean position and normal, whose disks are still to be added.
    fn placed(tree: &Octree, level: u32, cell: [u32; 3], mean: Vec3, normal: Vec3) -> Self {
        debug_assert!(level <= morton::LEVELS);
        let center = tree.cube().cell_center(level, cell);
        let edge = tree.cube().cell_edge(level);
        let normal_index = quantise_normal(normal);
        let drawn_normal = quantised_normals(FINEST_NORMAL_BITS)[normal_index as usize];
        let offset_edges = drawn_normal.dot(mean - center) / edge;
        Self {
            mean,
            normal,
            color: Vec3::ZERO,
            point_count: 0.0,
            cell,
            radius: 0.0,
            cone: 0.0,
            drawn_at: center + drawn_normal * (offset_edges * edge),
            drawn_normal,
            normal_index,
            offset_edges,
        }
    }

    /// Returns the distance of a point from the centre of the splat, perpendicular to the normal.
    fn distance_in_plane(&self, point: Vec3) -> f32 {
        let offset = point - self.drawn_at;
        (offset - self.drawn_normal * offset.dot(self.drawn_normal)).length()
    }

    fn attributes(&self, edge: f32) -> NodeAttributes {
        let color = self.color.round().to_array().map(|channel| channel as u8);
        let radius_edges = self.radius / edge;
        NodeAttributes::new(self.normal_index, self.offset_edges, radius_edges, color, self.cone)
    }
}
