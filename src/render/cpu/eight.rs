//! Eight records at a time: computed for each, one record per lane of the CPU's registers.

use super::view::{PixelRect, PixelView};
use bytemuck::Pod;
use fearless_simd::{Simd, SimdBase, SimdFloat, f32x8, mask32x8};
use glam::Vec3;

/// Eight vectors.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct Vectors<S: Simd> {
    pub(in crate::render) x: f32x8<S>,
    pub(in crate::render) y: f32x8<S>,
    pub(in crate::render) z: f32x8<S>,
}

impl<S: Simd> Vectors<S> {
    #[inline(always)]
    pub(in crate::render) fn splat(simd: S, vector: Vec3) -> Self {
        Self {
            x: f32x8::splat(simd, vector.x),
            y: f32x8::splat(simd, vector.y),
            z: f32x8::splat(simd, vector.z),
        }
    }

    #[inline(always)]
    pub(in crate::render) fn plus(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }

    #[inline(always)]
    pub(in crate::render) fn minus(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }

    #[inline(always)]
    pub(in crate::render) fn times(self, factor: f32x8<S>) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }

    #[inline(always)]
    pub(in crate::render) fn dot(self, other: Self) -> f32x8<S> {
        let xy = self.x.mul_add(other.x, self.y * other.y);
        self.z.mul_add(other.z, xy)
    }

    #[inline(always)]
    pub(super) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y.mul_sub(other.z, self.z * other.y),
            y: self.z.mul_sub(other.x, self.x * other.z),
            z: self.x.mul_sub(other.y, self.y * other.x),
        }
    }

    /// The largest of its components without their signs.
    #[inline(always)]
    pub(super) fn largest(self) -> f32x8<S> {
        self.x.abs().max(self.y.abs()).max(self.z.abs())
    }

    /// The vector of a lane.
    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }
}

/// The four words of each of eight records of 16 bytes; where there are fewer records, zeros.
#[inline(always)]
pub(super) fn words<S: Simd, R: Pod>(simd: S, records: &[R]) -> [f32x8<S>; 4] {
    const { assert!(size_of::<R>() == 16) }
    // All bits pass through registers unchanged, whether they are those of an f32 or not.
    let words: &[f32] = bytemuck::cast_slice(records);
    let mut padded = [[0.0; 16]; 2];
    let halves = words.as_chunks().0.first_chunk();
    let [first, second] = halves.unwrap_or_else(|| {
        padded.as_flattened_mut()[..words.len()].copy_from_slice(words);
        &padded
    });
    let (xy, zw) = simd.split_f32x16(simd.load_interleaved_128_f32x16(first));
    let (xy_after, zw_after) = simd.split_f32x16(simd.load_interleaved_128_f32x16(second));
    let ((x, y), (z, w)) = (simd.split_f32x8(xy), simd.split_f32x8(zw));
    let (x_after, y_after) = simd.split_f32x8(xy_after);
    let (z_after, w_after) = simd.split_f32x8(zw_after);
    [
        simd.combine_f32x4(x, x_after),
        simd.combine_f32x4(y, y_after),
        simd.combine_f32x4(z, z_after),
        simd.combine_f32x4(w, w_after),
    ]
}

/// A mask of the lanes below a number.
#[inline(always)]
pub(super) fn lanes_below<S: Simd>(simd: S, count: usize) -> mask32x8<S> {
    lane_numbers(simd).simd_lt(f32x8::splat(simd, count as f32))
}

/// 0 to 7.
#[inline(always)]
pub(in crate::render) fn lane_numbers<S: Simd>(simd: S) -> f32x8<S> {
    f32x8::from_slice(simd, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
}

impl PixelView {
    /// As [`PixelView::offset_from_eye`].
    #[inline(always)]
    pub(super) fn offsets_from_eye<S: Simd>(&self, simd: S, [x, y, z]: [f32x8<S>; 3]) -> Vectors<S> {
        let [high, low] = self.eye();
        Vectors { x, y, z }
            .minus(Vectors::splat(simd, high))
            .minus(Vectors::splat(simd, low))
    }

    /// As [`PixelView::rotate`].
    #[inline(always)]
    pub(super) fn rotate_each<S: Simd>(&self, simd: S, vectors: Vectors<S>) -> Vectors<S> {
        let rows = self.rotation().transpose();
        Vectors {
            x: vectors.dot(Vectors::splat(simd, rows.x_axis)),
            y: vectors.dot(Vectors::splat(simd, rows.y_axis)),
            z: vectors.dot(Vectors::splat(simd, rows.z_axis)),
        }
    }
}

/// View pyramid of a rectangle of pixels: the space in front of the near plane and between four planes through the eye.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pyramid {
    /// Unit vectors inwards.
    sides: [Vec3; 4],
    near: f32,
}

impl Pyramid {
    pub(super) fn of(view: &PixelView, rect: PixelRect) -> Self {
        // Pixel centres, where things are drawn, are half a pixel inside: more than the rounding error.
        let slope = |axis: usize, px: i32| (px as f32 - view.center_px[axis]) / view.px_per_slope[axis];
        let [left, right] = [rect.start, rect.end].map(|corner| slope(0, corner[0]));
        let [top, bottom] = [rect.start, rect.end].map(|corner| slope(1, corner[1]));
        Self {
            sides: [
                Vec3::new(1.0, 0.0, left),
                Vec3::new(-1.0, 0.0, -right),
                Vec3::new(0.0, -1.0, -top),
                Vec3::new(0.0, 1.0, bottom),
            ]
            .map(Vec3::normalize),
            near: view.near,
        }
    }

    /// Returns a mask of the points in view space around which something within these distances may be visible. Of the
    /// records of a block, which is drawn by every tile that the block may touch, most touch one.
    #[inline(always)]
    pub(super) fn may_touch<S: Simd>(&self, simd: S, centers: Vectors<S>, distances: f32x8<S>) -> mask32x8<S> {
        let [left, right, top, bottom] = self.sides;
        let (x, y, z) = (centers.x, centers.y, centers.z);
        let neighbor = |side: Vec3| x.mul_add(side.x, z * side.z);
        let above = |side: Vec3| y.mul_add(side.y, z * side.z);
        let across = neighbor(left).min(neighbor(right));
        let along = above(top).min(above(bottom));
        let beyond_near = -z - f32x8::splat(simd, self.near);
        (across.min(along).min(beyond_near) + distances).simd_ge(f32x8::splat(simd, 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::view_of;
    use super::super::tile::LANES;
    use super::*;
    use crate::cloud::PointRecord;
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    #[test]
    fn loads_match_records_and_are_zero_beyond_them() {
        let record = |index: u8| PointRecord {
            position: [0.0, 100.0, 200.0].map(|word| word + f32::from(index)),
            color: [index, 0xff, 0xff, 0xff],
        };
        let records: Vec<PointRecord> = (0..9).map(record).collect();
        for count in [1, 5, 8, 9] {
            let [x, y, z, w] = dispatch!(Level::new(), simd => {
                let [x, y, z, w] = words(simd, &records[..count]);
                [*x, *y, *z, *w]
            });
            for lane in 0..LANES {
                let color = w[lane].to_bits().to_ne_bytes();
                let expected = if lane < count {
                    record(lane as u8)
                } else {
                    bytemuck::Zeroable::zeroed()
                };
                assert_eq!([x[lane], y[lane], z[lane]], expected.position);
                assert_eq!(color, expected.color);
            }
        }
    }

    proptest! {
        /// A ball around a point on the ray through a pixel.
        #[test]
        fn bounding_spheres_touch_the_pixels_they_are_visible_in(
            px in prop::array::uniform2(0i32..64),
            distance in 0.1f32..1e4,
            aside in prop::array::uniform3(-1.0f32..1.0),
            radius in 0.0f32..2.0,
        ) {
            let view = view_of([64, 64]);
            let slope = |axis: usize| {
                (px[axis] as f32 + 0.5 - view.center_px[axis]) / view.px_per_slope[axis]
            };
            let seen = distance * Vec3::new(slope(0), slope(1), -1.0);
            let radius = radius * distance;
            let center = seen + 0.999 * radius * Vec3::from_array(aside).normalize_or_zero();
            let rect = PixelRect { start: px, end: [px[0] + 1, px[1] + 1] };
            prop_assert!(may_touch(&view, rect, center, radius));
        }

        /// The ray through a column's edge is as far from a point as the sine of the angle between them says.
        #[test]
        fn bounding_spheres_do_not_touch_pixels_next_to_them(
            column in 0i32..64,
            angle in -1.0f32..1.0,
            distance in 0.1f32..1e4,
        ) {
            let view = view_of([64, 64]);
            let edge = ((column as f32 - view.center_px[0]) / view.px_per_slope[0]).atan();
            prop_assume!((edge - angle).abs() > 1e-2);
            let center = distance * Vec3::new(angle.sin(), 0.0, -angle.cos());
            let neighbor = distance * (edge - angle).sin();
            let left = PixelRect { start: [-1 << 20, -1 << 20], end: [column, 1 << 20] };
            let right = PixelRect { start: [column, -1 << 20], end: [1 << 20, 1 << 20] };
            for (rect, neighbor) in [(left, -neighbor), (right, neighbor)] {
                prop_assert!(!may_touch(&view, rect, center, 0.999 * neighbor) || neighbor < 0.0);
                prop_assert!(may_touch(&view, rect, center, 1.001 * neighbor.max(0.0)));
            }
        }
    }

    fn may_touch(view: &PixelView, rect: PixelRect, center: Vec3, radius: f32) -> bool {
        let pyramid = Pyramid::of(view, rect);
        dispatch!(Level::new(), simd => {
            let radius = f32x8::splat(simd, radius);
            let mask = pyramid.may_touch(simd, Vectors::splat(simd, center), radius);
            simd.any_true_mask32x8(mask)
        })
    }
}
