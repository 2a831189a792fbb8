//! Gaussian splats as the authors of "3D Gaussian Splatting" store them in PLY, and flat ones of "2D Gaussian
//! Splatting" (`io/splats`). The harmonics that change with direction (`f_rest_*`) are left out.

use super::super::column::Column;
use super::super::splats::{SplatShape, alpha_of_logit, channel_of_harmonic, put_shapes};
use crate::cloud::RawCloud;
use glam::Quat;

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
    let color = |index: usize| {
        let [r, g, b] = [&red, &green, &blue].map(|channel| channel_of_harmonic(channel[index]));
        [r, g, b, alpha_of_logit(opacity[index])]
    };
    cloud.attributes.colors = Some((0..count).map(color).collect());
    put_shapes(cloud, |index| {
        let z = scale_z.as_ref().map_or(f32::NEG_INFINITY, |z| z[index]);
        SplatShape {
            log_scales: [scale_x[index], scale_y[index], z],
            rotation: Quat::from_xyzw(i[index], j[index], k[index], real[index]),
        }
    });
}
