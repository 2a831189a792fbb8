//! A tree of spheres around the points of a cloud, from which each of the structures here is built.
//!
//! How it works: the points are divided (`split.rs`), their summaries are made from the leaves up (`summary.rs`), and
//! spheres and cones are nested from the root down.
//!
//! A *coded* tree is rounded on the way: a sphere to a code relative to the *rounded* sphere of its parent, so that
//! errors do not add up (Rusinkiewicz and Levoy 2000, §3.1). All structures draw the same nodes of it, as they decide
//! by rounded spheres and cones. Spheres of 13 bits are a quarter wider, though, so half as many nodes again are drawn
//! at a threshold. So only QSplat, which has no space for more, is built from a coded tree.

use super::bounds::Bounds;
use super::cone::{Cone, cosine_of_sum};
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

/// Rounding precision of spheres and cones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Precision {
    /// Single floats.
    Exact,
    /// The codes of QSplat.
    Coded,
}

/// A node that is not a leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    /// Bounding sphere drawn for it: holds the disks of all points below.
    pub(super) sphere: Sphere,
    pub(super) bounds: Bounds,
    /// Mean normal and colour, not coded.
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
    /// Their codes without the number of children, of a coded tree.
    pub(super) codes: Vec<NodeCode>,
}

impl SphereTree {
    /// The tree of these points.
    ///
    /// # Panics
    /// Preconditions: points in Morton order of a cube around them, the same number of both.
    pub(super) fn build(cube: &Cube, points: &[PointRecord], shapes: &[ShapeRecord], precision: Precision) -> Self {
        assert_eq!(points.len(), shapes.len(), "one shape a point");
        let positions: Vec<Vec3> = points.iter().map(|point| Vec3::from_array(point.position)).collect();
        let division = Division::of(&cube.codes(&positions));
        let summaries = summaries(&division, points, shapes);
        let (mut nodes, codes) = match precision {
            Precision::Exact => (nested(&division, &summaries, Node::nested), Vec::new()),
            Precision::Coded => nested(&division, &summaries, Node::coded).into_iter().unzip(),
        };
        if let Some(ellipses) = ellipses_of(&division, points, shapes, |index| nodes[index].normal) {
            for (node, ellipse) in nodes.iter_mut().zip(ellipses) {
                node.ellipse = ellipse;
            }
        }
        Self { division, nodes, codes }
    }
}

/// All nodes, each built from its parent, if it has one, and its summary.
fn nested<T: Send + Sync>(
    division: &Division,
    summaries: &[Summary],
    make: impl Fn(Option<&T>, &Summary) -> T + Sync,
) -> Vec<T> {
    let mut nodes: Vec<T> = Vec::with_capacity(summaries.len());
    for level in division.levels() {
        let of_level: Vec<T> = level
            .into_par_iter()
            .with_min_len(NODES_PER_TASK)
            .map(|index| {
                // The root is its own parent, and not stored yet.
                let parent = division.inners[index].parent as usize;
                make(nodes.get(parent), &summaries[index])
            })
            .collect();
        nodes.extend(of_level);
    }
    nodes
}

impl Node {
    fn nested(parent: Option<&Self>, summary: &Summary) -> Self {
        // The sphere of a subset may be slightly wider, as neither is minimal.
        let (sphere, radius) = match parent {
            Some(parent) if parent.sphere.radius < summary.sphere.radius => (parent.sphere, parent.bounds.radius),
            // The spread without disks, as the edge of an octree's cell does not include them either: a torus of a
            // million points is drawn with 0.4 to 0.7 times the nodes that the sphere's radius gives, with an image as
            // close (52.5 dB; octree 52.9).
            _ => (summary.sphere, summary.spread),
        };
        let cosine = summary.cone_cosine - CONE_SLACK;
        let cone = Cone {
            axis: summary.normal,
            cosine: if cosine > 0.0 { cosine } else { -1.0 },
        };
        Self::with_bounds(parent, Bounds { sphere, cone, radius }, summary)
    }

    fn coded(parent: Option<&(Self, NodeCode)>, summary: &Summary) -> (Self, NodeCode) {
        let parent = parent.map(|(parent, _)| parent);
        let around = parent.map_or(&summary.sphere, |parent| &parent.sphere);
        let sphere_code = sphere_code::encoded(around, &summary.sphere);
        let sphere = sphere_code::decoded(around, sphere_code);
        let code = NodeCode::new(sphere_code, oct_encode(summary.normal), summary.color());
        let off_axis = code.cone().axis.dot(summary.normal);
        let cone = cone_code(cosine_of_sum(off_axis, summary.cone_cosine) - CONE_SLACK);
        let code = code.with_cone(cone);
        let bounds = Bounds {
            sphere,
            cone: code.cone(),
            // There is no space for another radius. This makes QSplat draw 1.5 to 3.3 times the nodes of the others at
            // the same threshold.
            radius: sphere.radius,
        };
        (Self::with_bounds(parent, bounds, summary), code)
    }

    /// A node with these bounds, which are nested here.
    fn with_bounds(parent: Option<&Self>, bounds: Bounds, summary: &Summary) -> Self {
        let Bounds { sphere, cone, radius } = bounds;
        Self {
            sphere,
            bounds: parent.map_or(bounds, |parent| parent.bounds.nested(sphere, cone, radius)),
            normal: oct_encode(summary.normal),
            color: summary.color(),
            ellipse: 0,
        }
    }
}
