//! Footprints of splats as precomputed masks of weights (Botsch et al. 2002 §5.2).
//!
//! How it works: on the screen a disk is an ellipse, and as an ellipse it could be a disk seen from straight ahead with
//! another normal. So there are masks for normals (quantised, half of an octahedron, half of which again gives the same
//! ellipses), for sizes (quarters of an octave) and for the position of the centre in its pixel (quarters of pixels
//! near by, halves further out: the paper rounds to integer pixels and names that as the cause of its remaining
//! aliasing). A weight is that of the exact disks, `exp(−3·d²)` inside of the ellipse `d ≤ 1`; the box filter of a
//! pixel, whose variance is 1/12, widens the ellipse by half a pixel squared, as the covariance of `exp(−3·d²)` is a
//! sixth of the ellipse's matrix. So nothing is narrower than a pixel, and splats seen edge on do not fall between
//! pixels.
//!
//! Masks do not depend on the camera: [`super::footprints`] determines the ellipse of a normal, by position.
//!
//! Rows have eight zeros between them, so that eight weights can be read from any position, for pixels that begin at a
//! multiple of eight.

use crate::cloud::{quantise_direction, quantised_directions};
use crate::render::constants::MASK_FALLOFF;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::LazyLock;

/// Refinements of the octahedron for shapes of masks.
const SHAPE_LEVEL: u32 = 4;

/// Ellipses: of normals with x and z not negative.
const SHAPES: usize = 2 << (2 * SHAPE_LEVEL);

/// Sizes in an octave, distinguished by the highest bits of a float's mantissa.
const SIZE_BITS: u32 = 2;

/// The largest radius that belongs to the first size.
const SMALLEST_PX: f32 = 0.5;

/// Radii from here on have no mask.
// Larger splats are exact disks, which are not slower: with masks, 100,000 surfels took 82 ms instead of 63 ms (full
// view, one thread), as the table only partly fits into the caches.
pub(super) const LARGEST_PX: f32 = 16.0;

const SIZES: usize = 5 << SIZE_BITS;

/// Zero padding at the sides of each row.
const MARGIN: usize = 8;

/// Weight of a pixel at the centre of a splat.
pub(super) const FULL_WEIGHT: f32 = 255.0;

/// All masks.
pub(super) static MASKS: LazyLock<Masks> = LazyLock::new(Masks::new);

/// Mask of one footprint: rows of weights around the pixel that contains the centre of the splat.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mask {
    /// Index of the first weight of its first row among all weights.
    pub(super) start: u32,
    /// From one row to the next.
    pub(super) stride: u16,
    /// The first column and row, relative to the pixel.
    pub(super) left: i8,
    pub(super) top: i8,
    pub(super) width: u8,
    pub(super) height: u8,
}

/// All footprints.
#[derive(Debug)]
pub(super) struct Masks {
    weights: Vec<u8>,
    /// Masks by size, shape and place.
    footprints: Vec<Mask>,
    /// The first mask of each size.
    size_starts: [usize; SIZES],
}

/// The size of a radius in pixels; `None` beyond all masks.
#[inline(always)]
pub(super) fn size_of(radius_px: f32) -> Option<usize> {
    const SHIFT: u32 = f32::MANTISSA_DIGITS - 1 - SIZE_BITS;
    if radius_px >= LARGEST_PX || radius_px.is_nan() {
        return None;
    }
    let above = radius_px.max(SMALLEST_PX).to_bits() - SMALLEST_PX.to_bits();
    Some((above >> SHIFT) as usize)
}

/// Returns the radius that the masks of a size are made for: the midpoint of those that it stands for.
fn radius_of_size(size: usize) -> f32 {
    let edge = |size: usize| {
        let octave = (size >> SIZE_BITS) as i32;
        let part = (size % (1 << SIZE_BITS)) as f32 / (1 << SIZE_BITS) as f32;
        SMALLEST_PX * 2f32.powi(octave) * (1.0 + part)
    };
    0.5 * (edge(size) + edge(size + 1))
}

/// Places within a pixel along each axis that masks of a size are made for.
fn places_of_size(size: usize) -> usize {
    match radius_of_size(size) {
        radius if radius < 3.0 => 4,
        radius if radius < 8.0 => 2,
        _ => 1,
    }
}

/// The shape of the mask for the ellipse that a unit disk with this normal is, seen from straight ahead: x to the
/// right, y downwards, any sign.
pub(super) fn shape_of(normal: Vec3) -> u16 {
    let upright = if normal.x < 0.0 { -normal } else { normal };
    let upright = Vec3::new(upright.x, upright.y, upright.z.abs());
    let index = quantise_direction(upright, SHAPE_LEVEL);
    let (octant, path) = (index >> (2 * SHAPE_LEVEL), index % (1 << (2 * SHAPE_LEVEL)));
    ((octant >> 1 & 1) << (2 * SHAPE_LEVEL) | path) as u16
}

/// The normal of a shape.
fn normal_of_shape(shape: usize) -> Vec3 {
    let (half, path) = (shape >> (2 * SHAPE_LEVEL), shape % (1 << (2 * SHAPE_LEVEL)));
    let octant = half << 1;
    quantised_directions(SHAPE_LEVEL)[octant << (2 * SHAPE_LEVEL) | path]
}

impl Masks {
    fn new() -> Self {
        let mut size_starts = [0; SIZES];
        let mut count = 0;
        for (size, start) in size_starts.iter_mut().enumerate() {
            *start = count;
            count += SHAPES * places_of_size(size).pow(2);
        }
        let rows: Vec<(Mask, Vec<u8>)> = (0..SIZES * SHAPES)
            .into_par_iter()
            .flat_map_iter(|both| {
                let (size, shape) = (both / SHAPES, both % SHAPES);
                let places = places_of_size(size);
                let quadric = Quadric::new(normal_of_shape(shape), radius_of_size(size));
                (0..places * places).map(move |place| {
                    let center = |part: usize| (part as f32 + 0.5) / places as f32;
                    quadric.mask([center(place % places), center(place / places)])
                })
            })
            .collect();
        let mut weights = vec![0; MARGIN];
        let mut footprints = Vec::with_capacity(count);
        for (mask, rows) in rows {
            let start = weights.len() as u32;
            footprints.push(Mask { start, ..mask });
            weights.extend(rows);
        }
        Self {
            weights,
            footprints,
            size_starts,
        }
    }

    /// Returns the mask of a shape and a size for a centre at these fractions of its pixel, 0 to 1.
    #[inline(always)]
    pub(super) fn get(&self, shape: u16, size: usize, fraction: [f32; 2]) -> &Mask {
        let places = PLACES[size];
        let place = |fraction: f32| ((fraction * places as f32) as usize).min(places - 1);
        let place = places * place(fraction[1]) + place(fraction[0]);
        &self.footprints[self.size_starts[size] + places * places * shape as usize + place]
    }

    /// Eight weights of a row from a column on: 8 before its first one at the earliest, and at its last one at the
    /// latest.
    #[inline(always)]
    pub(super) fn eight(&self, mask: &Mask, row: usize, column: isize) -> &[u8; 8] {
        let start = mask.start as usize + row * mask.stride as usize;
        let first = start.wrapping_add_signed(column);
        let weights: Result<&[u8; 8], _> = self.weights[first..first + 8].try_into();
        weights.expect("eight weights")
    }

    /// Returns the weights of a row.
    #[cfg(test)]
    pub(super) fn row(&self, mask: &Mask, row: usize) -> &[u8] {
        let start = mask.start as usize + row * mask.stride as usize;
        &self.weights[start..start + mask.width as usize]
    }

    /// Bytes held in memory.
    #[cfg(test)]
    pub(super) fn byte_size(&self) -> usize {
        self.weights.len() + size_of_val(self.footprints.as_slice())
    }
}

/// [`places_of_size`] of all sizes.
static PLACES: LazyLock<[usize; SIZES]> = LazyLock::new(|| std::array::from_fn(places_of_size));

/// Quadratic form `d²` of the offset from the centre, in pixels: `xx·x² + 2·xy·x·y + yy·y²`.
#[derive(Debug, Clone, Copy)]
struct Quadric {
    xx: f32,
    xy: f32,
    yy: f32,
    /// Reach of the ellipse along both axes.
    reach: [f32; 2],
}

impl Quadric {
    /// Creates the quadratic form of a disk with a normal, seen from straight ahead, after the pixel's box filter.
    fn new(normal: Vec3, radius_px: f32) -> Self {
        // The matrix of an ellipse is the sum of the squares of its half axes.
        const BOX: f32 = 6.0 / 12.0;
        let area = radius_px * radius_px;
        let (x, y) = (normal.x, normal.y);
        let matrix = [area * (1.0 - x * x) + BOX, -area * x * y, area * (1.0 - y * y) + BOX];
        let per_determinant = 1.0 / (matrix[0] * matrix[2] - matrix[1] * matrix[1]);
        Self {
            xx: matrix[2] * per_determinant,
            xy: -matrix[1] * per_determinant,
            yy: matrix[0] * per_determinant,
            reach: [matrix[0].sqrt(), matrix[2].sqrt()],
        }
    }

    /// Rasterises its mask around the pixel in which `center` is the position of its centre, and the weights, each row
    /// with the zeros after it.
    fn mask(&self, center: [f32; 2]) -> (Mask, Vec<u8>) {
        let covered = |axis: usize| -> Range<i32> {
            // Pixels whose centres are inside.
            let low = (center[axis] - self.reach[axis] - 0.5).ceil() as i32;
            let high = (center[axis] + self.reach[axis] - 0.5).floor() as i32;
            low..high + 1
        };
        let (columns, rows) = (covered(0), covered(1));
        let stride = columns.len() + MARGIN;
        let mut weights = Vec::with_capacity(stride * rows.len());
        for row in rows.clone() {
            let y = row as f32 + 0.5 - center[1];
            weights.extend(columns.clone().map(|column| {
                let x = column as f32 + 0.5 - center[0];
                let d2 = self.xx * x * x + 2.0 * self.xy * x * y + self.yy * y * y;
                if d2 > 1.0 {
                    return 0;
                }
                ((FULL_WEIGHT * (-MASK_FALLOFF * d2).exp()) as u8).max(1)
            }));
            weights.extend([0; MARGIN]);
        }
        let mask = Mask {
            start: 0,
            stride: stride as u16,
            left: columns.start as i8,
            top: rows.start as i8,
            width: columns.len() as u8,
            height: rows.len() as u8,
        };
        (mask, weights)
    }
}
