//! Gaussian splats as the authors of "3D Gaussian Splatting" store them in PLY, and flat ones of "2D Gaussian
//! Splatting": each point is an ellipsoid with three sizes, a rotation, an opacity, and a colour as spherical
//! harmonics.
//!
//! They are shown as disks: what is seen of an ellipsoid from most sides is its two large axes, so the disk lies across
//! the smallest one and has the geometric mean of the others for its radius, which keeps the area. The harmonics'
//! constant term is the colour seen on average from all sides; those that change with direction (`f_rest_*`) are left
//! out.

use super::super::column::Column;
use crate::cloud::RawCloud;
use glam::{Mat3, Quat};

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

/// Gives `cloud` the colours, radii and normals of the splats in `columns`, if there are any: the normals that such
/// files have are zeros.
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
    cloud.colors = Some((0..count).map(color).collect());
    cloud.radii = Some((0..count).map(|index| radius(log_scales(index))).collect());
    cloud.normals = Some(
        (0..count)
            .map(|index| rotation(index).col(smallest(log_scales(index))).to_array())
            .collect(),
    );
}

/// A fraction as 8 bits; 0 for what is not a number.
fn byte(fraction: f32) -> u8 {
    (fraction.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// Index of the smallest axis.
fn smallest(log_scales: [f32; 3]) -> usize {
    let [x, y, z] = log_scales;
    if z <= x && z <= y { 2 } else { usize::from(y <= x) }
}

/// Geometric mean of the two larger sizes, of which the file has the logarithms.
fn radius(log_scales: [f32; 3]) -> f32 {
    let left_out = smallest(log_scales);
    let others = (0..3).filter(|&axis| axis != left_out);
    (others.map(|axis| log_scales[axis]).sum::<f32>() / 2.0).exp()
}
