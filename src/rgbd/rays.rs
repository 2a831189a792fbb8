//! The direction of every pixel, computed once per camera.

use super::camera::Camera;
use glam::DVec2;
use rayon::prelude::*;

/// x and y of the ray of every pixel at a depth of 1, line by line; not a number where a lens shows nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct RayTable {
    size_px: [u32; 2],
    rays: Vec<[f32; 2]>,
}

impl RayTable {
    /// The rays of `camera`.
    pub fn of(camera: &Camera) -> Self {
        let [width, height] = camera.size_px();
        let ray = |column: u32, row: u32| {
            // Newton steps with halving: once per pixel and camera, not once per frame.
            let ray = camera.ray(DVec2::new(f64::from(column), f64::from(row)));
            ray.map_or([f32::NAN; 2], |ray| [ray.x as f32, ray.y as f32])
        };
        let lines = (0..height).into_par_iter();
        Self {
            size_px: [width, height],
            rays: lines
                .flat_map_iter(|row| (0..width).map(move |column| ray(column, row)))
                .collect(),
        }
    }

    /// Width and height of the image.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// x and y at a depth of 1, line by line.
    pub fn rays(&self) -> &[[f32; 2]] {
        &self.rays
    }
}
