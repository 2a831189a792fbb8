//! Planes in depth images, through pixels that are next to each other in the image.
//!
//! **How it works.** On a plane the inverse of the depth is linear in the ray: `1/z = a·x + b·y + c` for a point at
//! `z·(x, y, 1)`, and its normal is along `(a, b, c)`. So a plane is fitted to a window of pixels by least squares of
//! inverse depths, whose error is the same at all depths where depths come of disparities (Khoshelham and Oude Elberink
//! 2012). Sums over windows of any size are four corners of a summed-area table (Crow 1984).
//!
//! Depths of such sensors are steps that are many pixels wide. A window that is narrower sees a step or sees none, so
//! planes of the nearest neighbours are terraces. Each pixel therefore has the widest window in which depths are on one
//! plane but for noise. It need not be at its centre: of nine windows that it is in, those that cross an edge do not
//! fit (Fusiello et al. 1997 do so for stereo). So planes end at edges, and corners stay sharp.
//!
//! The noise level is estimated from the image itself (`noise.rs`). A point within that distance of a plane is put on
//! it.

mod noise;
mod pixels;
mod windows;

use super::images::DepthImage;
use glam::Vec3;
use noise::Noise;
use pixels::Pixels;
use rayon::prelude::*;
use std::ops::Range;
use windows::{Plane, PlanesOfWindows, Windows};

/// Half widths of the windows: pixels between the centre and the border, widest first.
// A wall at two metres consists of steps of a centimetre that are tens of pixels wide: the planes of the twelve nearest
// neighbours form terraces, and a wall of Redwood looked like wood grain when lit.
const HALF_WIDTHS_PX: [usize; 4] = [16, 8, 4, 2];

/// Lines whose windows are summed together. More make fewer sums twice, fewer take less memory.
const BAND_LINES: usize = 128;

/// Inverse depths that are on a plane are off it by at most this many times the noise of the image, in the root of
/// their mean square.
const FITS: f32 = 2.0;

/// Moves points that are the pixels of one image, line by line, along their rays onto the planes that they are on but
/// for noise, and returns the normals of these planes. In the frame of a camera that looks along +z; holes are not
/// finite, or not before the camera.
///
/// Normals are of unit length, towards the camera; zero in holes. Points without a plane from any window (single ones,
/// those in one line) face the camera, and stay. The same for any number of threads, each of which takes 160 bytes per
/// pixel of 192 lines.
///
/// # Panics
/// Precondition: one point per pixel.
pub fn put_on_planes([width, height]: [u32; 2], points: &mut [Vec3]) -> Vec<Vec3> {
    let pixels = Pixels::of([width, height].map(|edge| edge as usize), points);
    let noise = Noise::of(&pixels);
    let mut normals = vec![Vec3::ZERO; points.len()];
    let per_band = (BAND_LINES * pixels.width).max(1);
    let bands = points.par_chunks_mut(per_band).zip(normals.par_chunks_mut(per_band));
    bands.enumerate().for_each(|(band, (points, normals))| {
        let first = BAND_LINES * band;
        let lines = first..(first + BAND_LINES).min(pixels.height);
        put_band_on_planes(&pixels, &noise, lines, points, normals);
    });
    normals
}

/// [`put_on_planes`] for depths alone, for any camera without a lens: points on a plane for one pinhole are on one for
/// all.
pub fn on_planes(depth: &DepthImage) -> DepthImage {
    let per_px = (depth.width().max(depth.height()) as f32).recip();
    let metres = depth.metres().iter().enumerate();
    let mut points: Vec<Vec3> = metres
        .map(|(at, &z)| {
            let [x, y] = [at % depth.width(), at / depth.width()].map(|pixels| pixels as f32 * per_px);
            let ray = Vec3::new(x, y, 1.0);
            if z > 0.0 { z * ray } else { Vec3::NAN }
        })
        .collect();
    put_on_planes(depth.size_px(), &mut points);
    let moved = points
        .into_iter()
        .map(|point| if point.z > 0.0 { point.z } else { 0.0 });
    depth.with_metres(moved.collect())
}

/// [`put_on_planes`] for the pixels of `lines`.
fn put_band_on_planes(pixels: &Pixels, noise: &Noise, lines: Range<usize>, points: &mut [Vec3], normals: &mut [Vec3]) {
    let sums = Windows::of(pixels, pixels.around(&lines, 2 * HALF_WIDTHS_PX[0]));
    let levels = HALF_WIDTHS_PX.map(|half| sums.planes(half, pixels.around(&lines, half)));
    let rays = &pixels.rays[pixels.width * lines.start..];
    for (at, (point, normal)) in points.iter_mut().zip(normals).enumerate() {
        let ray @ &[x, y, inverse] = &rays[at];
        if inverse > 0.0 {
            let limit = FITS * noise.at(inverse);
            let pixel = [at % pixels.width, lines.start + at / pixels.width];
            let plane = plane_of(&levels, limit, ray, pixel);
            *normal = plane.normal_towards_camera(ray);
            let on_plane = plane.inverse_depth(ray);
            let is_within_limits = inverse == point.z.recip();
            if is_within_limits && plane.fits(limit, ray) && on_plane > 0.0 {
                *point = Vec3::new(x, y, 1.0) / on_plane;
            }
        }
    }
}

/// Returns the plane that a pixel is on.
///
/// If the window around it does not fit, one of half the width around it is better, for curved surfaces, than one of
/// the same width next to it: those are tried only afterwards.
fn plane_of(levels: &[PlanesOfWindows; 4], limit: f32, ray: &[f32; 3], pixel: [usize; 2]) -> Plane {
    let min = |first: &Plane, second: &Plane| first.error.total_cmp(&second.error);
    let fits = |plane: &Plane| plane.fits(limit, ray);
    let around = |planes: &PlanesOfWindows| planes.at(pixel, [0, 0]).filter(fits);
    let neighbor = |planes: &PlanesOfWindows| planes.neighbor(pixel).filter(fits).min_by(min);
    let [widest, .., narrowest] = levels;
    let mut steps = levels.windows(2);
    around(widest)
        // In this order, as off-centre planes are tilted on curved surfaces: with off-centre windows of the full width
        // first, 40 % of a sphere was off by more than 5°; now 15 % are, along its outline.
        .or_else(|| steps.find_map(|step| around(&step[1]).or_else(|| neighbor(&step[0]))))
        .or_else(|| neighbor(narrowest))
        .or_else(|| narrowest.neighbor(pixel).min_by(min))
        .unwrap_or(Plane::NONE)
}

#[cfg(test)]
mod tests;
