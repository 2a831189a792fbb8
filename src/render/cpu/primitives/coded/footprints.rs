//! Footprint lookup: the mask of a normal at each position in the image (Botsch et al. 2002 §5.2).
//!
//! How it works: in perspective the ellipse of a disk depends on its normal and on its position in the image. So
//! normals are divided into classes, once per frame for each entry of the table of normals, and the image into 4×4
//! sectors; for the ray through the centre of a sector and the direction of a class the ellipse is computed once per
//! camera: its longer half axis, as a factor on the radius, and the mask of its shape. A splat looks both up.

use super::masks;
use crate::cloud::{quantise_direction, quantised_directions};
use crate::render::cpu::view::PixelView;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Refinements of the octahedron for classes of normals.
const CLASS_LEVEL: u32 = 4;

/// Classes: without orientation, half of the octahedron.
const CLASSES: usize = 4 << (2 * CLASS_LEVEL);

/// Sectors of the image along each axis.
const SECTORS: usize = 4;

/// The class of a normal in view space, of any orientation.
pub(super) fn class_of(normal: Vec3) -> u32 {
    let towards_eye = if normal.z < 0.0 { -normal } else { normal };
    // NaN gets some class.
    quantise_direction(towards_eye, CLASS_LEVEL) % CLASSES as u32
}

/// The mask for a class in a sector.
#[derive(Debug, Clone, Copy)]
pub(super) struct Footprint {
    /// The longer half axis, for a radius of 1.
    pub(super) stretch: f32,
    pub(super) shape: u16,
}

/// Footprints of all classes in all sectors.
#[derive(Debug)]
pub(super) struct Footprints {
    of_sectors: Vec<Footprint>,
    sectors_per_px: [f32; 2],
}

impl Footprints {
    pub(super) fn new(view: &PixelView) -> Self {
        let sectors_per_px = view.size_px.map(|edge| SECTORS as f32 / edge as f32);
        let of_sectors = (0..SECTORS * SECTORS)
            .into_par_iter()
            .flat_map_iter(|sector| {
                let slope = |axis: usize, sector: usize| {
                    let center = (sector as f32 + 0.5) / sectors_per_px[axis];
                    (center - view.center_px[axis]) / view.px_per_slope[0]
                };
                let slopes = [slope(0, sector % SECTORS), slope(1, sector / SECTORS)];
                let classes = &quantised_directions(CLASS_LEVEL)[..CLASSES];
                classes.iter().map(move |&normal| footprint(normal, slopes))
            })
            .collect();
        Self {
            of_sectors,
            sectors_per_px,
        }
    }

    #[inline(always)]
    pub(super) fn at(&self, class: u32, x_px: f32, y_px: f32) -> &Footprint {
        // Positions outside the image are in a sector at its border.
        let sector = |px: f32, axis: usize| (px * self.sectors_per_px[axis]).clamp(0.0, SECTORS as f32 - 1.0) as usize;
        let sector = SECTORS * sector(y_px, 1) + sector(x_px, 0);
        &self.of_sectors[CLASSES * sector + class as usize]
    }
}

/// The footprint of a disk with a normal in view space, where a ray leads so far to the right and downwards for each
/// unit of distance.
fn footprint(normal: Vec3, [right, down]: [f32; 2]) -> Footprint {
    // A step on the disk moves its projection by these products, in radii on the screen.
    let to_right = Vec3::new(1.0, 0.0, right);
    let downwards = Vec3::new(0.0, -1.0, down);
    let [along_x, along_y] = [to_right, downwards].map(|axis| axis.dot(normal));
    // The ellipse's matrix: the sum of the squares of the images of two directions perpendicular to the normal.
    let xx = to_right.length_squared() - along_x * along_x;
    let xy = to_right.dot(downwards) - along_x * along_y;
    let yy = downwards.length_squared() - along_y * along_y;
    let (center, half_difference) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let spread = half_difference.hypot(xy);
    let (longer2, shorter2) = (center + spread, (center - spread).max(0.0));
    // The direction of the shorter axis: the eigenvector of the smaller eigenvalue, the longer of its two forms.
    let (a, b) = (Vec2::new(xy, shorter2 - xx), Vec2::new(shorter2 - yy, xy));
    let shorter = if a.length_squared() > b.length_squared() { a } else { b };
    let tilt2 = (1.0 - shorter2 / longer2).max(0.0);
    let tilt = shorter.normalize_or_zero() * tilt2.sqrt();
    Footprint {
        stretch: longer2.sqrt(),
        shape: masks::shape_of(tilt.extend((1.0 - tilt2).sqrt())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disks_straight_ahead_have_their_exact_radius() {
        for normal in &quantised_directions(CLASS_LEVEL)[..CLASSES] {
            let footprint = footprint(*normal, [0.0, 0.0]);
            assert!((footprint.stretch - 1.0).abs() < 1e-3);
            // Rows are counted downwards.
            let expected = masks::shape_of(Vec3::new(normal.x, -normal.y, normal.z));
            assert_eq!(footprint.shape, expected, "{normal}");
        }
    }

    /// Facing the eye in the corner of the image: a circle across the ray, which the image plane cuts as an ellipse
    /// that is longer outwards, by the ray's length.
    #[test]
    fn off_center_disks_are_stretched_outwards() {
        let ray = Vec3::new(0.4, -0.3, -1.0);
        let footprint = footprint(-ray.normalize(), [0.4, 0.3]);
        let length = ray.length();
        assert!((footprint.stretch - length).abs() < 1e-4);
        let ratio2: f32 = 1.0 / (length * length);
        let across = Vec2::new(-0.6, 0.8) * (1.0 - ratio2).sqrt();
        assert_eq!(footprint.shape, masks::shape_of(across.extend(ratio2.sqrt())));
    }
}
