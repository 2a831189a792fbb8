//! Fusion of the depth maps of all images into splats of one surface, each point once.
//!
//! How it works: a measured depth is trusted. A filled-in depth is skipped if another image has measured something
//! behind it: that one looks through it. A point that an earlier image shows as well, and not much coarser, is taken
//! from that one. A splat is as large as its pixel is there, and lies in the plane of the surrounding depths.

use super::map::Map;
use super::others::{BEFORE, SAME};
use crate::cloud::{PointRecord, ShapeRecord, oct_encode};
use crate::photos::PhotoSurface;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;

/// Maximum factor by which the pixels of an earlier image may be coarser.
const COARSER: f64 = 1.3;

/// Radius of a disk in pixels, and the least cosine it is stretched by.
// 0.9, 1.0, 1.1, 1.3 px: 19.05, 19.26, 19.41, 19.66 dB over the whole image, as cracks close, and 23.63, 23.59, 23.47,
// 23.21 dB over the drawn part, as outlines grow thicker (room).
const RADIUS_PX: f64 = 1.0;
const MIN_COSINE: f64 = 0.3;

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

/// Returns the splat of a pixel, unless another image has it or looks through it.
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
        // Next to a depth discontinuity, the adjacent pixel shows its other side.
        let is_before = distance < seen * (1.0 - BEFORE);
        if is_same {
            for_it += 1;
            let is_as_good = other.is_measured[there] || !is_measured;
            if other_index < index && is_as_good && distance / other.focal() <= COARSER * per_px {
                return None;
            }
        } else if is_before {
            // Moving it back along its ray instead costs 0.7 dB (room, 22.97) and 2.4 dB (temple, 19.39).
            if other.is_measured[there] && !is_measured {
                return None;
            }
            against += 1;
        }
    }
    // Requiring one other image that agrees: 23.07 dB, 0.82 drawn instead of 23.09, 0.90 (room), 20.37, 0.33 instead of
    // 21.26, 0.42 (temple); two: 22.82, 0.75 and 20.18, 0.28.
    if !is_measured && against > for_it {
        return None;
    }
    let normal = map.normal(at);
    let to_eye = (map.center() - place).normalize_or_zero();
    let normal = normal.map_or(to_eye, |normal| normal * normal.dot(to_eye).signum());
    let cosine = normal.dot(to_eye).max(MIN_COSINE);
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
