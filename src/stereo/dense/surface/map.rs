//! Depth map of one image, measured and filled in.

use super::complete::complete;
use crate::stereo::View;
use glam::{DVec2, DVec3};

/// Neighbours of one surface differ by less, as a part of the depth, for each pixel.
const SLOPE: f64 = 0.03;

/// Depths of a view.
pub(super) struct Map<'a> {
    pub(super) view: View<'a>,
    /// Index of its image in the set.
    pub(super) number: usize,
    /// 0 where there is none.
    pub(super) depths: Vec<f32>,
    pub(super) is_measured: Vec<bool>,
}

impl Map<'_> {
    /// Fills in pixels without depth, except those that show nothing of the scene.
    pub(super) fn complete(&mut self, is_scene: &[bool]) {
        let inverse = |&depth: &f32| if depth > 0.0 { depth.recip() } else { 0.0 };
        let mut inverse: Vec<f32> = self.depths.iter().map(inverse).collect();
        complete(
            &mut inverse,
            self.view.image.pixels(),
            self.view.image.size_px()[0] as usize,
        );
        for ((depth, inverse), &is_scene) in self.depths.iter_mut().zip(inverse).zip(is_scene) {
            *depth = if inverse > 0.0 && is_scene {
                inverse.recip()
            } else {
                0.0
            };
        }
    }

    fn width(&self) -> usize {
        self.view.image.size_px()[0] as usize
    }

    pub(super) fn focal(&self) -> f64 {
        self.view.camera.focal_px().x
    }

    pub(super) fn center(&self) -> DVec3 {
        self.view.camera_from_world.inverse().translation
    }

    /// Returns the world position of a pixel with a depth.
    pub(super) fn place(&self, at: usize) -> Option<DVec3> {
        self.place_at(at, f64::from(self.depths[at]))
    }

    /// Returns the world position of a pixel at the given depth.
    pub(super) fn place_at(&self, at: usize, depth: f64) -> Option<DVec3> {
        let pixel = DVec2::new((at % self.width()) as f64, (at / self.width()) as f64);
        let ray = self.view.camera.ray(pixel).filter(|_| depth > 0.0)?;
        Some(self.view.camera_from_world.inverse().transform_point3(ray * depth))
    }

    /// The pixel that a place is in, and how far away it is.
    pub(super) fn at_place(&self, place: DVec3) -> Option<(usize, f64)> {
        let in_camera = self.view.camera_from_world.transform_point3(place);
        let pixel = self.view.camera.pixel(in_camera)?;
        let is_inside = self.view.camera.contains(pixel);
        let [column, row] = pixel.round().max(DVec2::ZERO).to_array().map(|at| at as usize);
        let at = (self.width() * row + column).min(self.depths.len().saturating_sub(1));
        is_inside.then_some((at, in_camera.z))
    }

    /// Returns the depth of a position and the depth measured in its pixel.
    pub(super) fn measured_at(&self, place: DVec3) -> Option<(f64, f64)> {
        let (at, distance) = self.at_place(place).filter(|&(at, _)| self.is_measured[at])?;
        Some((distance, f64::from(self.depths[at])))
    }

    /// Returns the unit normal estimated from the depths around a pixel; `None` at depth discontinuities.
    pub(super) fn normal(&self, at: usize) -> Option<DVec3> {
        const STEP: usize = 2;
        let (width, height) = (self.width(), self.depths.len() / self.width());
        let (row, column) = (at / width, at % width);
        let depth = f64::from(self.depths[at]);
        let is_near = |other: usize| {
            (f64::from(self.depths[other]) - depth).abs() <= SLOPE * depth * STEP as f64 && self.depths[other] > 0.0
        };
        let or_own = |other: Option<usize>| other.filter(|&other| is_near(other)).unwrap_or(at);
        let left = or_own((column >= STEP).then(|| at - STEP));
        let right = or_own((column + STEP < width).then_some(at + STEP));
        let up = or_own((row >= STEP).then(|| at - STEP * width));
        let down = or_own((row + STEP < height).then_some(at + STEP * width));
        let across = self.place(right)? - self.place(left)?;
        let along = self.place(down)? - self.place(up)?;
        Some(across.cross(along).normalize_or_zero()).filter(|normal| *normal != DVec3::ZERO)
    }
}
