//! A depth image as a point cloud.

use super::images::DepthImage;
use super::rays::RayTable;
use crate::cloud::{AxisConvention, ImageGrid, LengthUnit, Positions, RawCloud};
use glam::DVec3;
use rayon::prelude::*;

/// The points of `depth`, one per pixel, in the frame of its camera; holes are NaN. `colors` has the same number of
/// entries.
///
/// Precondition: `rays` are of an image of the same size.
pub fn cloud(depth: &DepthImage, rays: &RayTable, colors: Option<Vec<[u8; 4]>>) -> RawCloud {
    debug_assert_eq!(depth.size_px(), rays.size_px());
    let point = |(&z, &[x, y]): (&f32, &[f32; 2])| {
        if z > 0.0 && x.is_finite() {
            [x * z, y * z, z]
        } else {
            [f32::NAN; 3]
        }
    };
    let positions: Vec<[f32; 3]> = depth.metres().par_iter().zip(rays.rays()).map(point).collect();
    let [width, height] = depth.size_px();
    let mut raw = RawCloud::from_positions(Positions::F32(positions));
    raw.grid = ImageGrid::of(width, height, raw.positions.len());
    raw.attributes.colors = colors;
    raw.sensor = Some(DVec3::ZERO);
    raw.convention = Some(AxisConvention::Camera);
    raw.unit = Some(LengthUnit::Metre);
    raw
}
