//! The surfels of a byte code that a ray may meet: what is drawn as masks is picked as disks.
//!
//! How it works: the tree is gone through from the root. A node whose cell, with the splats below it, is farther from
//! the ray than the radius is left out; one whose cell is small enough on the picture, or on the deepest level, is a
//! disk. Whole blocks of nodes are drawn on one level, so that a node beside the border of two may be drawn one level
//! finer than it is picked.

use super::ray::Ray;
use crate::cloud::{PointRecord, ShapeRecord, oct_encode, quantised_normals};
use crate::levels::octree::coded::offset_of_code;
use crate::scene::{CodedCells, Style, Surfels};
use glam::Vec3;
use std::sync::Arc;

/// A node and where its cell is.
struct Node {
    number: usize,
    level: u32,
    cell: [u32; 3],
}

/// The surfels of `coded` that may come nearer to the ray than a radius.
pub(super) fn surfels_near(
    ray: &Ray,
    coded: &CodedCells,
    style: &Style,
    radius_px: f64,
) -> Surfels {
    let (mut points, mut shapes) = (Vec::new(), Vec::new());
    let cloud = &coded.cloud;
    let cube = cloud.cube();
    let deepest = coded.deepest_level.min(cloud.depth());
    let splat_scale =
        style.surfels.splat_scale * style.surfels.splatting.scales(style.surfels.enlargement)[0];
    let root = Node {
        number: 0,
        level: 0,
        cell: [0; 3],
    };
    let mut waiting = if cloud.attributes().is_empty() {
        Vec::new()
    } else {
        vec![root]
    };
    while let Some(Node {
        number,
        level,
        cell,
    }) = waiting.pop()
    {
        let edge = cube.cell_edge(level);
        let center = cube.cell_center(level, cell);
        let attributes = &cloud.attributes()[number];
        let largest = |level| cloud.largest_radius(level);
        let largest_below = (level..=deepest).map(largest).fold(0.0, f32::max);
        // Surfels stand beside the middles of their cells by half a diagonal at most.
        let reach = splat_scale * largest_below + edge;
        let half = Vec3::splat(0.5 * edge);
        if !ray.may_meet(center - half, center + half, f64::from(reach), radius_px) {
            continue;
        }
        if level >= deepest || ray.size_px(center, edge) < f64::from(coded.lod_px) {
            let normal = quantised_normals(style.codes.normal_bits.bits());
            let index =
                crate::cloud::coarser_normal(attributes.normal(), style.codes.normal_bits.bits());
            let normal = normal[index as usize];
            let offset =
                offset_of_code(attributes.offset_code(), style.codes.offset_bits.bits()) * edge;
            let [red, green, blue] = attributes.color;
            points.push(PointRecord {
                position: (center + offset * normal).to_array(),
                color: [red, green, blue, 255],
            });
            shapes.push(ShapeRecord {
                normal: oct_encode(normal),
                radius: attributes.radius_edges() * edge,
                ellipse: 0,
                scalar: 0.0,
            });
            continue;
        }
        let mask = cloud.masks()[number];
        let children = (0..8).filter(|octant| mask >> octant & 1 != 0);
        let numbered = children.zip(cloud.first_child(number)..);
        waiting.extend(numbered.map(|(octant, number)| Node {
            number,
            level: level + 1,
            cell: [0, 1, 2].map(|axis| 2 * cell[axis] + (octant >> axis & 1)),
        }));
    }
    Surfels {
        points: Arc::new(points),
        shapes: Arc::new(shapes),
    }
}
