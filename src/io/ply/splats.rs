//! Gaussian splats as the authors of "3D Gaussian Splatting" store them in PLY, and flat ones of "2D Gaussian
//! Splatting": each point is an ellipsoid with three sizes, a rotation, an opacity, and a colour as spherical
//! harmonics.
//!
//! What is seen of an ellipsoid from most sides is its two large axes, so the splat lies across the smallest one: an
//! ellipse with these half axes, and their geometric mean for its radius. They are shown as disks of that radius, which
//! keeps the area. The harmonics' constant term is the colour seen on average from all sides; those that change with
//! direction (`f_rest_*`) are left out.

use super::super::column::Column;
use crate::cloud::{Ellipse, RawCloud};
use glam::{Mat3, Quat, Vec3};

/// Constant term of spherical harmonics: 1 / (2 √π).
const HARMONIC: f32 = 0.282_094_79;

const COLORS: [&str; 3] = ["f_dc_0", "f_dc_1", "f_dc_2"];
const OPACITY: &str = "opacity";
/// The last is left out where splats are flat.
const SCALES: [&str; 3] = ["scale_0", "scale_1", "scale_2"];
/// Real part first.
const ROTATION: [&str; 4] = ["rot_0", "rot_1", "rot_2", "rot_3"];

/// True for the columns that [`apply`] looks at.
pub(super) fn is_used(name: &str) -> bool {
    COLORS.contains(&name) || name == OPACITY || SCALES.contains(&name) || ROTATION.contains(&name)
}

/// Gives `cloud` the colours, normals, radii and ellipses of the splats in `columns`, if there are any: the normals
/// that such files have are zeros.
pub(super) fn apply(columns: &[Column<'_>], cloud: &mut RawCloud) {
    let count = cloud.positions.len();
    let find = |name: &str| {
        let column = columns.iter().find(|column| column.name == name)?;
        Some(column.to_f32(count))
    };
    let is_there = |name: &str| columns.iter().any(|column| column.name == name);
    let needed = COLORS.iter().chain(&SCALES[..2]).chain(&ROTATION);
    if !needed.chain([&OPACITY]).all(|name| is_there(name)) {
        return;
    }
    let [Some(red), Some(green), Some(blue)] = COLORS.map(find) else {
        return;
    };
    let [Some(real), Some(i), Some(j), Some(k)] = ROTATION.map(find) else {
        return;
    };
    let (Some(scale_x), Some(scale_y), Some(opacity)) = (find(SCALES[0]), find(SCALES[1]), find(OPACITY)) else {
        return;
    };
    let scale_z = find(SCALES[2]);

    let channel = |harmonic: f32| byte(0.5 + HARMONIC * harmonic);
    let color = |index: usize| {
        let alpha = byte(1.0 / (1.0 + (-opacity[index]).exp()));
        [channel(red[index]), channel(green[index]), channel(blue[index]), alpha]
    };
    let log_scales = |index: usize| {
        let z = scale_z.as_ref().map_or(f32::NEG_INFINITY, |z| z[index]);
        [scale_x[index], scale_y[index], z]
    };
    let rotation = |index: usize| {
        let quaternion = Quat::from_xyzw(i[index], j[index], k[index], real[index]);
        let length = quaternion.length();
        if length > 0.0 && length.is_finite() {
            Mat3::from_quat(quaternion / length)
        } else {
            Mat3::IDENTITY
        }
    };
    let splat = |index: usize| {
        let Splat {
            normal,
            radius,
            ellipse,
        } = Splat::of(log_scales(index), rotation(index));
        (normal.to_array(), (radius, ellipse))
    };
    let (normals, (radii, ellipses)) = (0..count).map(splat).unzip();
    let attributes = &mut cloud.attributes;
    attributes.colors = Some((0..count).map(color).collect());
    attributes.normals = Some(normals);
    attributes.radii = Some(radii);
    attributes.ellipses = Some(ellipses);
}

/// A fraction as 8 bits; 0 for what is not a number.
fn byte(fraction: f32) -> u8 {
    (fraction.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// What is seen of an ellipsoid.
struct Splat {
    normal: Vec3,
    radius: f32,
    ellipse: Ellipse,
}

impl Splat {
    /// Of sizes, of which the file has the logarithms, along the columns of `axes`.
    fn of(log_scales: [f32; 3], axes: Mat3) -> Self {
        let [x, y, z] = log_scales;
        let smallest = if z <= x && z <= y { 2 } else { usize::from(y <= x) };
        let [a, b] = [(smallest + 1) % 3, (smallest + 2) % 3];
        let [longer, shorter] = if log_scales[a] >= log_scales[b] { [a, b] } else { [b, a] };
        Self {
            normal: axes.col(smallest),
            radius: f32::midpoint(log_scales[longer], log_scales[shorter]).exp(),
            ellipse: Ellipse {
                axis: axes.col(longer),
                ratio: (log_scales[shorter] - log_scales[longer]).exp(),
            },
        }
    }
}
