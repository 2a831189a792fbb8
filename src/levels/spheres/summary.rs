//! Per-node summary of the points below and of their bounds, computed from the leaves up.
//!
//! A sphere around spheres is wider than one around their contents, by a tenth where nodes have few points. So the
//! spheres of nodes of few points enclose the disks of these.

use super::cone::cosine_of_sum;
use super::split::{Child, Division, Inner, NODES_PER_TASK};
use crate::cloud::{PointRecord, ShapeRecord, oct_decode};
use crate::math::Sphere;
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// The spheres of nodes of more points enclose those of their children.
// Spheres around spheres are wider than spheres around their contents, by a tenth.
const FEW_POINTS: usize = 64;

/// The points below a node in a few numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Summary {
    /// Holds their disks.
    pub(super) sphere: Sphere,
    /// Maximum distance of the points from the centre of the sphere.
    pub(super) spread: f32,
    /// Mean unit normal; the first child's where there is no mean.
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
        spread: 0.0,
        normal: Vec3::Z,
        cone_cosine: -1.0,
        color: Vec4::ZERO,
        point_count: 0,
    };

    /// Returns the summary of one point.
    pub(super) fn of_point(point: &PointRecord, shape: &ShapeRecord) -> Self {
        Self {
            sphere: disk(point, shape),
            spread: 0.0,
            normal: oct_decode(shape.normal),
            cone_cosine: 1.0,
            color: Vec4::from_array(point.color.map(f32::from)),
            point_count: 1,
        }
    }

    /// 8-bit red, green, blue and alpha.
    pub(super) fn color(&self) -> [u8; 4] {
        self.color.round().to_array().map(|channel| channel as u8)
    }

    /// Computes the summary of a node with these children, with a sphere around the disks of its points if these are
    /// few. Precondition: there is one.
    fn of(children: &[Self], points: &[PointRecord], shapes: &[ShapeRecord]) -> Self {
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
        let has_few = points.len() <= FEW_POINTS;
        let sphere = if has_few {
            Sphere::around(points.iter().zip(shapes).map(|(point, shape)| disk(point, shape)))
        } else {
            Sphere::around(children.iter().map(|child| child.sphere))
        };
        let spread = if has_few {
            let squares = points
                .iter()
                .map(|point| sphere.center.distance_squared(point.position.into()));
            squares.fold(0.0, f32::max).sqrt()
        } else {
            let reaches = children
                .iter()
                .map(|child| sphere.center.distance(child.sphere.center) + child.spread);
            reaches.fold(0.0, f32::max)
        };
        Self {
            sphere,
            // For points with disks of zero size, rounding could make it wider.
            spread: spread.min(sphere.radius),
            normal,
            cone_cosine: cosines.fold(1.0, f32::min),
            color,
            point_count,
        }
    }
}

/// Returns a bounding sphere of the disk that a point is drawn as.
#[inline(always)]
fn disk(point: &PointRecord, shape: &ShapeRecord) -> Sphere {
    Sphere {
        center: Vec3::from_array(point.position),
        radius: shape.radius,
    }
}

/// The summaries of all nodes that are not leaves.
pub(super) fn summaries(division: &Division, points: &[PointRecord], shapes: &[ShapeRecord]) -> Vec<Summary> {
    let mut summaries = vec![Summary::NONE; division.inners.len()];
    for level in division.levels().rev() {
        let (done, below) = summaries.split_at_mut(level.end);
        let of_child = |child| match child {
            Child::Leaf(point) => Summary::of_point(&points[point as usize], &shapes[point as usize]),
            Child::Inner(index) => below[index as usize - level.end],
        };
        let of_node = |node: &Inner| {
            let mut children = [Summary::NONE; super::split::MAX_CHILDREN];
            for (summary, child) in children.iter_mut().zip(node.children()) {
                *summary = of_child(child);
            }
            let below = node.points();
            Summary::of(&children[..node.child_count()], &points[below.clone()], &shapes[below])
        };
        done[level.clone()]
            .par_iter_mut()
            .zip(&division.inners[level.clone()])
            .with_min_len(NODES_PER_TASK)
            .for_each(|(summary, node)| *summary = of_node(node));
    }
    summaries
}
