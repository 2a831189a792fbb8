//! Fusion of depth maps of posed images into one cloud of coloured points in the world.

use crate::cloud::{Positions, RawCloud};
use crate::rgbd::DepthImage;
use crate::stereo::StereoError;
use crate::stereo::View;
use glam::DVec2;
use rayon::prelude::*;

/// Creates a coloured point cloud with one point for each pixel that has a depth, in the frame and the unit of the
/// poses: view by view, line by line.
///
/// # Errors
/// [`StereoError::CountsDiffer`]; [`StereoError::OtherCamera`] if a map or an image differs in size from its camera;
/// [`StereoError::NoPose`], [`StereoError::NoPinhole`].
pub fn cloud(maps: &[DepthImage], views: &[View<'_>]) -> Result<RawCloud, StereoError> {
    if maps.len() != views.len() {
        return Err(StereoError::CountsDiffer {
            maps: maps.len(),
            views: views.len(),
        });
    }
    let mut positions = Vec::new();
    let mut colors = Vec::new();
    for (index, (map, view)) in maps.iter().zip(views).enumerate() {
        view.check(index)?;
        if map.size_px() != view.camera.size_px() {
            return Err(StereoError::OtherCamera {
                view: index,
                image: map.size_px(),
                camera: view.camera.size_px(),
            });
        }
        let world_from_camera = view.camera_from_world.inverse();
        let width = map.width();
        let pixels = map.metres().par_iter().zip(view.image.pixels()).enumerate();
        let points = pixels.filter_map(|(at, (&depth, &[red, green, blue]))| {
            let pixel = DVec2::new((at % width) as f64, (at / width) as f64);
            let ray = view.camera.ray(pixel).filter(|_| depth > 0.0)?;
            let point = world_from_camera.transform_point3(ray * f64::from(depth));
            Some((point.to_array(), [red, green, blue, u8::MAX]))
        });
        let (new_positions, new_colors): (Vec<[f64; 3]>, Vec<[u8; 4]>) = points.unzip();
        positions.extend(new_positions);
        colors.extend(new_colors);
    }
    let mut raw = RawCloud::from_positions(Positions::F64(positions));
    raw.attributes.colors = Some(colors);
    Ok(raw)
}
