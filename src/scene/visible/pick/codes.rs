//! Picking of byte-code surfels that a ray may hit: splats drawn as masks are picked as disks.
//!
//! How it works: the tree is traversed from the root. A node whose cell, with the splats below it, is farther from the
//! ray than the radius is skipped; one whose cell is small enough on the image, or on the deepest level, is a disk.
//! Whole blocks of nodes are drawn on one level, so that a node next to the border of two may be drawn one level finer
//! than it is picked.

use super::ray::Ray;
use crate::cloud::{PointRecord, ShapeRecord, coarser_normal, oct_encode, quantised_normals};
use crate::levels::octree::coded::{NodeAttributes, offset_of_code};
use crate::scene::{CodeStyle, CodedCells, DrawSettings, Surfels};
use glam::Vec3;
use std::sync::Arc;

/// A node and where its cell is.
struct Node {
    number: usize,
    level: u32,
    cell: [u32; 3],
}

/// The surfels of `coded` that may come nearer to the ray than a radius.
pub(super) fn surfels_near(ray: &Ray, coded: &CodedCells, style: &DrawSettings, radius_px: f64) -> Surfels {
    let (mut points, mut shapes) = (Vec::new(), Vec::new());
    let (cloud, surfels) = (&coded.cloud, &style.surfels);
    let cube = cloud.cube();
    let deepest = coded.deepest_level.min(cloud.depth());
    let [visibility, _] = surfels.splatting.scales(surfels.enlargement);
    let reaches = cloud.reaches(surfels.splat_scale * visibility);
    let root = Node {
        number: 0,
        level: 0,
        cell: [0; 3],
    };
    let mut waiting = Vec::new();
    waiting.extend((!cloud.attributes().is_empty()).then_some(root));
    while let Some(node) = waiting.pop() {
        let (level, edge) = (node.level, cube.cell_edge(node.level));
        let center = cube.cell_center(level, node.cell);
        let half = Vec3::splat(0.5 * edge);
        let reach = f64::from(reaches[level as usize]);
        if !ray.may_meet(center - half, center + half, reach, radius_px) {
            continue;
        }
        if level >= deepest || ray.size_px(center, edge) < f64::from(coded.lod_px) {
            let attributes = cloud.attributes()[node.number];
            let (point, shape) = surfel(attributes, center, edge, style.codes);
            points.push(point);
            shapes.push(shape);
            continue;
        }
        let mask = cloud.masks()[node.number];
        let children = (0..8).filter(|octant| mask >> octant & 1 != 0);
        let numbered = children.zip(cloud.first_child(node.number)..);
        waiting.extend(numbered.map(|(octant, number)| Node {
            number,
            level: level + 1,
            cell: [0, 1, 2].map(|axis| 2 * node.cell[axis] + (octant >> axis & 1)),
        }));
    }
    Surfels {
        points: Arc::new(points),
        shapes: Arc::new(shapes),
    }
}

/// The surfel of a node in a cell, with the drawn number of bits.
fn surfel(attributes: NodeAttributes, center: Vec3, edge: f32, style: CodeStyle) -> (PointRecord, ShapeRecord) {
    let bits = style.normal_bits.bits();
    let normal = quantised_normals(bits)[coarser_normal(attributes.normal(), bits) as usize];
    let offset = offset_of_code(attributes.offset_code(), style.offset_bits.bits()) * edge;
    let [red, green, blue] = attributes.color;
    let point = PointRecord {
        position: (center + offset * normal).to_array(),
        color: [red, green, blue, 255],
    };
    let shape = ShapeRecord {
        normal: oct_encode(normal),
        radius: attributes.radius_edges() * edge,
        ellipse: 0,
        scalar: 0.0,
    };
    (point, shape)
}
