//! Picking of byte-code surfels that a ray may hit: splats drawn as masks are picked as disks.
//!
//! How it works: the tree is traversed from the root. A node whose cell, with the splats below it, is farther from the
//! ray than the radius is skipped; one whose cell is small enough on the image, or on the deepest level, is a disk.
//! Whole blocks of nodes are drawn on one level, so that a node next to the border of two may be drawn one level finer
//! than it is picked.

use super::ray::Ray;
use crate::levels::octree::coded::CodeNode;
use crate::scene::{CodedCells, DrawSettings, Surfels};
use glam::Vec3;
use std::sync::Arc;

/// The surfels of `coded` that may come nearer to the ray than a radius.
pub(super) fn surfels_near(ray: &Ray, coded: &CodedCells, style: &DrawSettings, radius_px: f64) -> Surfels {
    let (mut points, mut shapes) = (Vec::new(), Vec::new());
    let (cloud, surfels) = (&coded.cloud, &style.surfels);
    let cube = cloud.cube();
    let deepest = coded.deepest_level.min(cloud.depth());
    let [visibility, _] = surfels.splatting.scales(surfels.enlargement);
    let reaches = cloud.reaches(surfels.splat_scale * visibility);
    let root = CodeNode::ROOT;
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
            let (point, shape) = cloud.surfel(node, style.codes.normal_bits.bits(), style.codes.offset_bits.bits());
            points.push(point);
            shapes.push(shape);
            continue;
        }
        waiting.extend(cloud.children(node));
    }
    Surfels {
        points: Arc::new(points),
        shapes: Arc::new(shapes),
    }
}
