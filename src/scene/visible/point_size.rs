//! Point size: how large points are drawn.
//!
//! **How it works.** A point is a square, or a disk in it, that faces the screen. Its edge is a length in the scene
//! divided by the distance, or the given number of pixels where that would be less: no point vanishes. The length is
//! the same for all points (*projected*), or follows the radius of each (*adaptive*), as the modes of Potree
//! (`attenuated`, `adaptive`) do; with the scale 1 points close a surface that faces the eye, and are as large as the
//! disks of surfels would be.

use crate::scene::ScenePacket;
use crate::scene::style::{Lighting, PointShape, PointSizing, Primitive};
use std::f32::consts::SQRT_2;

/// Returns the minimum width in pixels of points that are not plain ones of a fixed number of pixels: they then cover
/// the centre of a pixel wherever they are. A little more than squares and disks need for that, as rasterisers round
/// corners to 1/256 pixel.
fn min_px(shape: PointShape) -> f32 {
    match shape {
        PointShape::Square => 1.01,
        PointShape::Disk | PointShape::Gaussian => 1.43,
    }
}

/// The edges of the points of a packet: the sum of two lengths in the scene, or this many pixels if that is less.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSize {
    /// Minimum edge in pixels.
    pub min_px: f32,
    /// Edge length of every point, scene units.
    pub edge: f32,
    /// For each unit of the radius of a point.
    pub edge_per_radius: f32,
}

impl PointSize {
    /// Returns the point size of a packet. Where the radii of points are unknown, they are the typical point spacing.
    pub fn of(packet: &ScenePacket) -> Self {
        let points = packet.style.drawn_points();
        let min_px = min_px(points.shape);
        let is_lit = packet.style.primitive == Primitive::Point && packet.lighting() != Lighting::Unlit;
        let is_plain = points.shape != PointShape::Gaussian && !is_lit;
        match points.sizing {
            PointSizing::Pixels => Self {
                min_px: if is_plain {
                    points.size_px.max(1.0)
                } else {
                    points.size_px.max(min_px)
                },
                edge: 0.0,
                edge_per_radius: 0.0,
            },
            PointSizing::Adaptive if packet.content.shapes().is_some() => Self {
                min_px,
                edge: 0.0,
                edge_per_radius: 2.0 * points.scale,
            },
            PointSizing::Projected | PointSizing::Adaptive => Self {
                min_px,
                // Disks close a square grid of points if they are as wide as the diagonal of its squares.
                edge: SQRT_2 * points.scale * packet.params.point_spacing,
                edge_per_radius: 0.0,
            },
        }
    }

    /// Returns true if every point is a pixel.
    pub fn is_pixel(&self) -> bool {
        self.edge == 0.0 && self.edge_per_radius == 0.0 && self.min_px <= 1.0
    }
}
