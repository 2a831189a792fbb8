//! Ellipses of nodes, where points are ellipses: from the leaves up.
//!
//! How it works: a node has the covariance of all points below, each ellipse counted as evenly filled. It follows from
//! the covariances of its children and the distances between them, so no point is visited twice. The node is drawn as
//! the equivalent ellipse in the plane of the node, as large as its sphere; the octree's nodes are the same
//! (`octree/node_surfel.rs`).

use super::split::{Child, Division, Inner, MAX_CHILDREN, NODES_PER_TASK};
use crate::cloud::{PointRecord, ShapeRecord, oct_decode};
use crate::levels::moments::{OF_HALF_AXIS, PlaneMoments, half_axes};
use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

/// Mean and covariance of points, in f64: offsets from zero may be large.
#[derive(Debug, Clone, Copy)]
struct Moments {
    point_count: f64,
    mean: DVec3,
    /// About the mean, for each point.
    spread: DMat3,
}

/// The matrix of the products of the numbers of a vector.
fn products(vector: DVec3) -> DMat3 {
    DMat3::from_cols(vector * vector.x, vector * vector.y, vector * vector.z)
}

impl Moments {
    const NONE: Self = Self {
        point_count: 0.0,
        mean: DVec3::ZERO,
        spread: DMat3::ZERO,
    };

    fn of_point(point: &PointRecord, shape: &ShapeRecord) -> Self {
        let [a, b] = half_axes(shape).map(|axis| products(axis.as_dvec3()) * OF_HALF_AXIS);
        Self {
            point_count: 1.0,
            mean: Vec3::from_array(point.position).as_dvec3(),
            spread: a + b,
        }
    }

    /// Computes the covariance of a node with these children. Precondition: there is one.
    fn of(children: &[Self]) -> Self {
        let point_count: f64 = children.iter().map(|child| child.point_count).sum();
        let share = |child: &Self| child.point_count / point_count;
        let mean: DVec3 = children.iter().map(|child| child.mean * share(child)).sum();
        let spread = children
            .iter()
            .map(|child| (child.spread + products(child.mean - mean)) * share(child))
            .fold(DMat3::ZERO, |sum, spread| sum + spread);
        Self {
            point_count,
            mean,
            spread,
        }
    }

    /// In the plane across a packed normal.
    fn packed_ellipse(&self, normal: [i16; 2]) -> u32 {
        let mut in_plane = PlaneMoments::across(oct_decode(normal));
        let [x, y] = in_plane.axes().map(Vec3::as_dvec3);
        let (of_x, of_y) = (self.spread * x, self.spread * y);
        in_plane.add_products(DVec3::new(x.dot(of_x), y.dot(of_x), y.dot(of_y)));
        in_plane.packed_ellipse()
    }
}

/// The packed ellipses of all nodes, whose packed normals are looked up by index; `None` where all points are
/// disks.
pub(super) fn ellipses_of(
    division: &Division,
    points: &[PointRecord],
    shapes: &[ShapeRecord],
    normal: impl Fn(usize) -> [i16; 2] + Sync,
) -> Option<Vec<u32>> {
    if shapes.par_iter().all(|shape| shape.ellipse == 0) {
        return None;
    }
    let mut moments = vec![Moments::NONE; division.inners.len()];
    for level in division.levels().rev() {
        let (done, below) = moments.split_at_mut(level.end);
        let of_child = |child| match child {
            Child::Leaf(point) => Moments::of_point(&points[point as usize], &shapes[point as usize]),
            Child::Inner(index) => below[index as usize - level.end],
        };
        let of_node = |node: &Inner| {
            let mut children = [Moments::NONE; MAX_CHILDREN];
            for (moments, child) in children.iter_mut().zip(node.children()) {
                *moments = of_child(child);
            }
            Moments::of(&children[..node.child_count()])
        };
        done[level.clone()]
            .par_iter_mut()
            .zip(&division.inners[level.clone()])
            .with_min_len(NODES_PER_TASK)
            .for_each(|(moments, node)| *moments = of_node(node));
    }
    let of_node = |(index, moments): (usize, &Moments)| moments.packed_ellipse(normal(index));
    Some(
        moments
            .par_iter()
            .enumerate()
            .with_min_len(NODES_PER_TASK)
            .map(of_node)
            .collect(),
    )
}
