//! What stands for the points below each node, and where they are: from the leaves up.

use super::cone::cosine_of_sum;
use super::split::{Child, Division, Inner, NODES_PER_TASK};
use crate::cloud::{PointRecord, ShapeRecord, oct_decode};
use crate::math::Sphere;
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// The points below a node in a few numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Summary {
    /// Holds their disks.
    pub(super) sphere: Sphere,
    /// Mean unit normal; that of the first child where there is no mean.
    pub(super) normal: Vec3,
    /// Cosine of an angle from the mean normal that none of theirs exceeds; −1 where nothing is known.
    pub(super) cone_cosine: f32,
    /// Mean colour, 8-bit red, green, blue and alpha.
    pub(super) color: Vec4,
    pub(super) point_count: u32,
}

impl Summary {
    const NONE: Self = Self {
        sphere: Sphere {
            center: Vec3::ZERO,
            radius: 0.0,
        },
        normal: Vec3::Z,
        cone_cosine: -1.0,
        color: Vec4::ZERO,
        point_count: 0,
    };

    /// Of one point.
    pub(super) fn of_point(point: &PointRecord, shape: &ShapeRecord) -> Self {
        Self {
            sphere: Sphere {
                center: Vec3::from_array(point.position),
                radius: shape.radius,
            },
            normal: oct_decode(shape.normal),
            cone_cosine: 1.0,
            color: Vec4::from_array(point.color.map(f32::from)),
            point_count: 1,
        }
    }

    /// Of a node with these children. Precondition: there is one.
    fn of(children: &[Self]) -> Self {
        let point_count = children.iter().map(|child| child.point_count).sum();
        let (mut normal, mut color) = (Vec3::ZERO, Vec4::ZERO);
        for child in children {
            let share = child.point_count as f32 / point_count as f32;
            normal += child.normal * share;
            color += child.color * share;
        }
        let normal = normal.try_normalize().unwrap_or(children[0].normal);
        let cosines = children
            .iter()
            .map(|child| cosine_of_sum(normal.dot(child.normal), child.cone_cosine));
        Self {
            sphere: Sphere::around(children.iter().map(|child| child.sphere)),
            normal,
            cone_cosine: cosines.fold(1.0, f32::min),
            color,
            point_count,
        }
    }
}

/// The summaries of all nodes that are no leaves.
pub(super) fn summaries(division: &Division, points: &[PointRecord], shapes: &[ShapeRecord]) -> Vec<Summary> {
    let mut summaries = vec![Summary::NONE; division.inners.len()];
    for level in division.levels().rev() {
        let (done, below) = summaries.split_at_mut(level.end);
        let of_child = |child| match child {
            Child::Leaf(point) => Summary::of_point(&points[point as usize], &shapes[point as usize]),
            Child::Inner(index) => below[index as usize - level.end],
        };
        let of_node = |node: &Inner| {
            let mut children = [Summary::NONE; super::split::MOST_CHILDREN];
            for (summary, child) in children.iter_mut().zip(node.children()) {
                *summary = of_child(child);
            }
            Summary::of(&children[..node.child_count()])
        };
        done[level.clone()]
            .par_iter_mut()
            .zip(&division.inners[level.clone()])
            .with_min_len(NODES_PER_TASK)
            .for_each(|(summary, node)| *summary = of_node(node));
    }
    summaries
}
