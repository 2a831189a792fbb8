//! A tree of spheres around the points of a cloud, of which each of the structures here is made.
//!
//! How it works: the points are divided (`split.rs`), their summaries are made from the leaves up (`summary.rs`), and
//! spheres and cones are rounded from the root down: a sphere to a code against the *rounded* sphere of its parent, so
//! that errors do not add up (Rusinkiewicz and Levoy 2000, §3.1). Rounded spheres and cones are what all structures
//! decide by, so that all draw the same nodes.

use super::bounds::Bounds;
use super::cone::cosine_of_sum;
use super::ellipses::ellipses_of;
use super::node_code::{NodeCode, cone_code};
use super::sphere_code;
use super::split::{Division, NODES_PER_TASK};
use super::summary::{Summary, summaries};
use crate::cloud::{PointRecord, ShapeRecord, oct_encode};
use crate::math::{Cube, Sphere};
use glam::Vec3;
use rayon::prelude::*;

/// Rounding of normals to octahedral coordinates and of cosines, as a cosine.
const CONE_SLACK: f32 = 1e-5;

/// A node that is no leaf, as rounded.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    /// What is drawn for it: holds the disks of all points below.
    pub(super) sphere: Sphere,
    pub(super) bounds: Bounds,
    /// All but the number of children.
    pub(super) code: NodeCode,
    /// Mean normal and colour, not rounded.
    pub(super) normal: [i16; 2],
    pub(super) color: [u8; 4],
    /// Packed, of its plane; 0 where points are disks.
    pub(super) ellipse: u32,
}

/// A tree of spheres; of no points, without nodes.
#[derive(Debug)]
pub(super) struct SphereTree {
    pub(super) division: Division,
    /// As the nodes of the division.
    pub(super) nodes: Vec<Node>,
}

impl SphereTree {
    /// The tree of these points.
    ///
    /// # Panics
    /// Preconditions: points in Morton order of the cube around them, as many of both.
    pub(super) fn build(points: &[PointRecord], shapes: &[ShapeRecord]) -> Self {
        assert_eq!(points.len(), shapes.len(), "one shape a point");
        let positions: Vec<Vec3> = points.iter().map(|point| Vec3::from_array(point.position)).collect();
        let codes = Cube::around(&positions).map_or_else(Vec::new, |cube| cube.codes(&positions));
        let division = Division::of(&codes);
        let summaries = summaries(&division, points, shapes);
        let mut nodes = rounded(&division, &summaries);
        if let Some(ellipses) = ellipses_of(&division, (points, shapes), |index| nodes[index].normal) {
            for (node, ellipse) in nodes.iter_mut().zip(ellipses) {
                node.ellipse = ellipse;
            }
        }
        Self { division, nodes }
    }
}

/// All nodes, each rounded against its parent.
fn rounded(division: &Division, summaries: &[Summary]) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::with_capacity(summaries.len());
    for level in division.levels() {
        let of_level: Vec<Node> = level
            .into_par_iter()
            .with_min_len(NODES_PER_TASK)
            .map(|index| {
                let parent = division.inners[index].parent as usize;
                Node::rounded(nodes.get(parent), &summaries[index])
            })
            .collect();
        nodes.extend(of_level);
    }
    nodes
}

impl Node {
    /// The root has no parent.
    fn rounded(parent: Option<&Self>, summary: &Summary) -> Self {
        let around = parent.map_or(&summary.sphere, |parent| &parent.sphere);
        let sphere_code = sphere_code::encoded(around, &summary.sphere);
        let sphere = sphere_code::decoded(around, sphere_code);
        let normal = oct_encode(summary.normal);
        let color = summary.color.round().to_array().map(|channel| channel as u8);
        let code = NodeCode::new(sphere_code, normal, color);
        let off_axis = code.cone().axis.dot(summary.normal);
        let cone = cone_code(cosine_of_sum(off_axis, summary.cone_cosine) - CONE_SLACK);
        let code = code.with_cone(cone);
        let bounds = match parent {
            Some(parent) => parent.bounds.nested(sphere, code.cone()),
            None => Bounds::of_root(sphere, code.cone()),
        };
        Self {
            sphere,
            bounds,
            code,
            normal,
            color,
            ellipse: 0,
        }
    }
}
