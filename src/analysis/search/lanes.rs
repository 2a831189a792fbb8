//! Points of memory into the lanes of registers: a coordinate of several points in each.

use fearless_simd::{Simd, SimdBase, f32x4, f32x8};
use glam::Vec4;

/// The coordinates of eight points, each in a register of its own.
#[inline(always)]
pub(in crate::analysis) fn axes<S: Simd>(simd: S, point: impl Fn(usize) -> Vec4) -> [f32x8<S>; 3] {
    let [low_x, low_y, low_z] = axes_of_four(simd, &point);
    let [high_x, high_y, high_z] = axes_of_four(simd, |lane| point(4 + lane));
    [
        simd.combine_f32x4(low_x, high_x),
        simd.combine_f32x4(low_y, high_y),
        simd.combine_f32x4(low_z, high_z),
    ]
}

/// The four numbers of each of four points, each in a register of its own.
#[inline(always)]
pub(in crate::analysis) fn registers_of_four<S: Simd>(simd: S, point: impl Fn(usize) -> Vec4) -> [f32x4<S>; 4] {
    let a = f32x4::from_slice(simd, point(0).as_ref());
    let b = f32x4::from_slice(simd, point(1).as_ref());
    let c = f32x4::from_slice(simd, point(2).as_ref());
    let d = f32x4::from_slice(simd, point(3).as_ref());
    let (xy_even, xy_odd) = (simd.zip_low_f32x4(a, c), simd.zip_low_f32x4(b, d));
    let (zw_even, zw_odd) = (simd.zip_high_f32x4(a, c), simd.zip_high_f32x4(b, d));
    [
        simd.zip_low_f32x4(xy_even, xy_odd),
        simd.zip_high_f32x4(xy_even, xy_odd),
        simd.zip_low_f32x4(zw_even, zw_odd),
        simd.zip_high_f32x4(zw_even, zw_odd),
    ]
}

/// The coordinates of four points, each in a register of its own.
#[inline(always)]
pub(in crate::analysis) fn axes_of_four<S: Simd>(simd: S, point: impl Fn(usize) -> Vec4) -> [f32x4<S>; 3] {
    let a = f32x4::from_slice(simd, point(0).as_ref());
    let b = f32x4::from_slice(simd, point(1).as_ref());
    let c = f32x4::from_slice(simd, point(2).as_ref());
    let d = f32x4::from_slice(simd, point(3).as_ref());
    let (xy_even, xy_odd) = (simd.zip_low_f32x4(a, c), simd.zip_low_f32x4(b, d));
    let (z_even, z_odd) = (simd.zip_high_f32x4(a, c), simd.zip_high_f32x4(b, d));
    [
        simd.zip_low_f32x4(xy_even, xy_odd),
        simd.zip_high_f32x4(xy_even, xy_odd),
        simd.zip_low_f32x4(z_even, z_odd),
    ]
}
