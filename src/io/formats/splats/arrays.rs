//! Splats as arrays of numpy, by the names that trainers of splats save them under (gsplat, Dynamic 3D Gaussians,
//! `SplaTAM` and others): half axes, rotations, opacities, and colours as harmonics.

use super::{SplatShape, alpha_of_logit, byte, channel_of_harmonic, colors_of_harmonics, put_shapes, warn_of_colors};
use crate::cloud::RawCloud;
use crate::io::columns::column::Column;
use glam::Quat;

const SCALES: [&str; 5] = ["log_scales", "scales", "scale", "scaling", "scalings"];
/// Real part first.
const ROTATIONS: [&str; 8] = [
    "unnorm_rotations",
    "rotations",
    "rotation",
    "quats",
    "quat",
    "quaternions",
    "rots",
    "rot",
];
const OPACITIES: [&str; 5] = ["logit_opacities", "opacities", "opacity", "alphas", "alpha"];
const HARMONICS: [&str; 4] = ["features_dc", "f_dc", "sh0", "shs_dc"];

/// An array with a row for each splat.
pub(in crate::io) struct SplatArray<'a> {
    /// In lower case.
    pub(in crate::io) name: &'a str,
    pub(in crate::io) columns: Vec<Column<'a>>,
}

/// Returns true if an array of this name, in lower case, is a splat attribute.
pub(in crate::io) fn is_used(name: &str) -> bool {
    [&SCALES[..], &ROTATIONS, &OPACITIES, &HARMONICS]
        .iter()
        .any(|names| names.contains(&name))
}

/// Adds the splat attributes in `arrays` to `cloud`: the shapes where there are half axes, one, two or three, and
/// rotations; opacities; the colours of harmonics where the cloud has no colours. Returns the names of the used arrays.
pub(in crate::io) fn apply<'a>(arrays: &[SplatArray<'a>], cloud: &mut RawCloud) -> Vec<&'a str> {
    let mut used = Vec::new();
    let mut broken_colors = 0;
    let count = cloud.positions.len();
    let find = |names: &[&str], widths: std::ops::RangeInclusive<usize>| {
        let mut named = names
            .iter()
            .filter_map(|name| arrays.iter().find(|array| array.name == *name));
        let array = named.find(|array| widths.contains(&array.columns.len()))?;
        let columns = array.columns.iter().map(|column| column.to_f32(count));
        Some((array.name, columns.collect::<Vec<Vec<f32>>>()))
    };
    let logits = find(&OPACITIES, 1..=1).map_or_else(Vec::new, |(_, mut opacities)| opacities.swap_remove(0));
    if let Some((name, mut scales)) = find(&SCALES, 1..=3) {
        // Lengths are not negative, but logarithms of lengths below 1 are.
        let are_logarithms = name == "log_scales" || scales.iter().flatten().any(|&scale| scale <= 0.0);
        if !are_logarithms {
            scales.iter_mut().flatten().for_each(|scale| *scale = scale.ln());
        }
        match (&scales[..], find(&ROTATIONS, 4..=4)) {
            // A ball has no orientation: its normal is estimated.
            ([radius], rotations) => {
                used.push(name);
                used.extend(rotations.map(|(name, _)| name));
                cloud.attributes.radii = Some(radius.iter().map(|radius| radius.exp()).collect());
            }
            ([x, y, others @ ..], Some((rotations, parts))) => {
                used.extend([name, rotations]);
                put_shapes(cloud, &logits, |index| SplatShape {
                    log_scales: [
                        x[index],
                        y[index],
                        others.first().map_or(f32::NEG_INFINITY, |z| z[index]),
                    ],
                    rotation: Quat::from_xyzw(parts[1][index], parts[2][index], parts[3][index], parts[0][index]),
                });
            }
            _ => {}
        }
    }
    if let Some((name, harmonics)) = find(&HARMONICS, 3..=3).filter(|_| cloud.attributes.colors.is_none()) {
        used.push(name);
        let channels = [0, 1, 2].map(|channel| harmonics[channel].as_slice());
        let (colors, broken) = colors_of_harmonics(channels, channel_of_harmonic);
        cloud.attributes.colors = Some(colors);
        broken_colors = broken;
    }
    if let (Some((name, opacities)), Some(colors)) = (find(&OPACITIES, 1..=1), &mut cloud.attributes.colors) {
        used.push(name);
        let opacities = &opacities[0];
        let are_shares = name != "logit_opacities" && opacities.iter().all(|share| (0.0..=1.0).contains(share));
        for (color, &opacity) in colors.iter_mut().zip(opacities) {
            color[3] = if are_shares {
                byte(opacity)
            } else {
                alpha_of_logit(opacity)
            };
        }
    }
    if !used.is_empty() {
        warn_of_colors(cloud, broken_colors);
    }
    used
}
