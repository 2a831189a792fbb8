//! Depth maps of all photographs as disks of one surface, each place once.
//!
//! How it works: a depth that was measured is believed. One that was filled in is left out where another photograph
//! has measured something behind it: that one looks through it. What an earlier photograph shows as well, and not much
//! coarser, is left to that one. A disk is as large as its pixel is there, and lies in the plane of the depths around.

use super::Map;
use crate::cloud::{PointRecord, ShapeRecord, oct_encode};
use crate::photos::PhotoSurface;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::sync::Arc;

/// Depths are of one place if they differ by less, as a part.
const SAME: f64 = 0.01;

/// What is so much nearer than what was measured, as a part, is looked through.
const BEFORE: f64 = 0.02;

/// By how much coarser pixels of an earlier photograph may be.
const COARSER: f64 = 1.3;

/// Radius of a disk in pixels, and the least cosine it is stretched by.
const RADIUS_PX: f64 = 0.9;
const LEAST_COSINE: f64 = 0.3;

/// Neighbours of one surface differ by less, as a part of the depth, for each pixel.
const SLOPE: f64 = 0.03;

/// The disks of all maps, relative to `origin`.
pub(super) fn fuse(maps: &[Map<'_>], origin: DVec3) -> PhotoSurface {
    let of_map = |index: usize| -> Vec<(PointRecord, ShapeRecord)> {
        let pixels = 0..maps[index].depths.len();
        pixels.filter_map(|at| disk(maps, index, at, origin)).collect()
    };
    let disks: Vec<Vec<(PointRecord, ShapeRecord)>> = (0..maps.len()).into_par_iter().map(of_map).collect();
    let (points, shapes) = disks.into_iter().flatten().unzip();
    PhotoSurface {
        points: Arc::new(points),
        shapes: Arc::new(shapes),
    }
}

/// The disk of a pixel, unless another photograph has it or looks through it.
fn disk(maps: &[Map<'_>], index: usize, at: usize, origin: DVec3) -> Option<(PointRecord, ShapeRecord)> {
    let map = &maps[index];
    let place = map.place(at)?;
    let depth = f64::from(map.depths[at]);
    let is_measured = map.is_measured[at];
    let per_px = depth / map.focal();
    let (mut for_it, mut against) = (0, 0);
    for (other_index, other) in maps.iter().enumerate().filter(|(other, _)| *other != index) {
        let Some((there, distance)) = other.at_place(place) else {
            continue;
        };
        let seen = f64::from(other.depths[there]);
        if seen == 0.0 {
            continue;
        }
        let is_same = (distance - seen).abs() <= SAME * seen;
        // What is at a step has the other side of it in the next pixel.
        let is_before = distance < seen * (1.0 - BEFORE);
        if is_same {
            for_it += 1;
            let is_as_good = other.is_measured[there] || !is_measured;
            if other_index < index && is_as_good && distance / other.focal() <= COARSER * per_px {
                return None;
            }
        } else if is_before {
            if other.is_measured[there] && !is_measured {
                return None;
            }
            against += 1;
        }
    }
    if !is_measured && against > for_it {
        return None;
    }
    let normal = map.normal(at);
    let to_eye = (map.center() - place).normalize_or_zero();
    let normal = normal.map_or(to_eye, |normal| normal * normal.dot(to_eye).signum());
    let cosine = normal.dot(to_eye).max(LEAST_COSINE);
    let [red, green, blue] = map.view.image.pixels()[at];
    let point = PointRecord {
        position: (place - origin).as_vec3().to_array(),
        color: [red, green, blue, u8::MAX],
    };
    let shape = ShapeRecord {
        normal: oct_encode(normal.as_vec3()),
        radius: (RADIUS_PX * per_px / cosine) as f32,
        ellipse: 0,
        scalar: 0.0,
    };
    Some((point, shape))
}

impl Map<'_> {
    fn width(&self) -> usize {
        self.view.image.size_px()[0] as usize
    }

    fn focal(&self) -> f64 {
        self.view.camera.focal_px().x
    }

    fn center(&self) -> DVec3 {
        self.view.camera_from_world.inverse().translation
    }

    /// Where a pixel with a depth is in the world.
    fn place(&self, at: usize) -> Option<DVec3> {
        let depth = f64::from(self.depths[at]);
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

    /// Of the depths around a pixel, of length 1; `None` at steps.
    fn normal(&self, at: usize) -> Option<DVec3> {
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
