//! Splats drawn for nodes of sequences: the points themselves, or the disk or ellipse of a node's sphere.

use super::tree::Node;
use crate::cloud::{PointRecord, ShapeRecord};
use crate::levels::structure::{RecordBuffers, Records};
use crate::math::Sphere;
use rayon::prelude::*;

/// The disk or ellipse of a node that is not a leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Splat {
    center: [f32; 3],
    radius: f32,
    normal: [i16; 2],
    color: [u8; 4],
    ellipse: u32,
}

impl Splat {
    /// As large as the sphere, and perpendicular to the mean normal (Sainz and Pajarola 2004 §4.1, sprites).
    pub(super) fn new(sphere: &Sphere, normal: [i16; 2], color: [u8; 4]) -> Self {
        Self {
            center: sphere.center.to_array(),
            radius: sphere.radius,
            normal,
            color,
            ellipse: 0,
        }
    }

    /// With the unrounded normal and colour.
    pub(super) fn of(node: &Node) -> Self {
        Self {
            ellipse: node.ellipse,
            ..Self::new(&node.sphere, node.normal, node.color)
        }
    }

    pub(super) fn records(&self) -> (PointRecord, ShapeRecord) {
        let point = PointRecord {
            position: self.center,
            color: self.color,
        };
        let shape = ShapeRecord {
            normal: self.normal,
            radius: self.radius,
            ellipse: self.ellipse,
            scalar: 0.0,
        };
        (point, shape)
    }
}

/// The records of all nodes, this many.
pub(super) fn all(
    node_count: usize,
    records: impl Fn(u32) -> (PointRecord, ShapeRecord) + Send + Sync,
) -> (Vec<PointRecord>, Vec<ShapeRecord>) {
    let nodes = (0..node_count as u32).into_par_iter();
    nodes.with_min_len(super::split::NODES_PER_TASK).map(records).unzip()
}

/// The records of nodes, in their order.
pub(super) fn write(
    drawn: &[u32],
    buffers: RecordBuffers,
    records: impl Fn(u32) -> (PointRecord, ShapeRecord) + Sync,
) -> Records {
    let RecordBuffers {
        mut points, mut shapes, ..
    } = buffers;
    let nodes = drawn.par_iter().with_min_len(super::split::NODES_PER_TASK);
    nodes
        .map(|&node| records(node))
        .unzip_into_vecs(&mut points, &mut shapes);
    Records::Surfels { points, shapes }
}
