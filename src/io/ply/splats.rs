//! Gaussian splats as the authors of "3D Gaussian Splatting" store them in PLY, flat ones of "2D Gaussian Splatting",
//! those with 8-bit colours of `nerfstudio`, and moving ones of "Spacetime Gaussian Feature Splatting"
//! (`io/splats`). The harmonics that change with direction (`f_rest_*`) are skipped.

use super::super::column::Column;
use super::super::splats::{SplatShape, alpha_of_logit, byte, channel_of_harmonic, put_shapes};
use super::moving_splats::{self, MovingSplats};
use super::splat_columns::{take, take_all};
use crate::cloud::RawCloud;
use glam::Quat;

const COLORS: [&str; 3] = ["f_dc_0", "f_dc_1", "f_dc_2"];
const OPACITY: &str = "opacity";
/// The last is absent where splats are flat.
const SCALES: [&str; 3] = ["scale_0", "scale_1", "scale_2"];
/// Real part first.
const ROTATION: [&str; 4] = ["rot_0", "rot_1", "rot_2", "rot_3"];

/// Beginnings of names of columns that nothing is made of: harmonics that change with direction, features that a
/// network makes colours of.
const UNREAD: [&str; 3] = ["f_rest_", "f_dc_", "f_t_"];

/// Whether rows with the columns that `is_there` knows are splats.
pub(super) fn are_splats(is_there: &dyn Fn(&str) -> bool) -> bool {
    let mut needed = SCALES[..2].iter().chain(&ROTATION).chain([&OPACITY]);
    needed.all(|name| is_there(name))
}

/// Whether a column of splats of this name has nothing that is shown.
pub(super) fn is_unread(name: &str) -> bool {
    !COLORS.contains(&name) && UNREAD.iter().any(|prefix| name.starts_with(prefix))
}

/// The columns that splats are made of.
pub(super) struct Splats<'a> {
    colors: Option<[Column<'a>; 3]>,
    opacity: Column<'a>,
    scales: Vec<Column<'a>>,
    rotation: [Column<'a>; 4],
    moving: Option<MovingSplats<'a>>,
}

impl<'a> Splats<'a> {
    /// The splats, and the columns that say something else; all columns where there are no splats.
    pub(super) fn take(mut columns: Vec<Column<'a>>) -> Result<(Self, Vec<Column<'a>>), Vec<Column<'a>>> {
        if !are_splats(&|name: &str| columns.iter().any(|column| column.name == name)) {
            return Err(columns);
        }
        columns.retain(|column| !is_unread(&column.name));
        let moving = MovingSplats::take(&mut columns);
        let colors = take_all(&mut columns, COLORS);
        let scales: Vec<Column<'a>> = SCALES.iter().filter_map(|name| take(&mut columns, name)).collect();
        let (Some(opacity), Some(rotation)) = (take(&mut columns, OPACITY), take_all(&mut columns, ROTATION)) else {
            return Err(columns);
        };
        let splats = Self {
            colors,
            opacity,
            scales,
            rotation,
            moving,
        };
        Ok((splats, columns))
    }

    /// Gives `cloud` their colours, normals, radii and ellipses: the normals that such files have are zeros.
    pub(super) fn put_into(self, cloud: &mut RawCloud) {
        let count = cloud.positions.len();
        let values = |column: &Column<'_>| column.to_f32(count);
        let opacity = values(&self.opacity);
        let scales: Vec<Vec<f32>> = self.scales.iter().map(values).collect();
        let [real, i, j, k] = self.rotation.each_ref().map(values);
        let mut rotations: Vec<Quat> = (0..count)
            .map(|index| Quat::from_xyzw(i[index], j[index], k[index], real[index]))
            .collect();
        let mut shares: Vec<f32> = vec![1.0; count];
        // Colours of moving splats are light, not harmonics.
        let channel = if self.moving.is_some() {
            byte
        } else {
            channel_of_harmonic
        };
        if let Some(moving) = self.moving {
            moving.put_into(cloud, &mut rotations, &mut shares);
        }
        if let Some(channels) = &self.colors {
            let [red, green, blue] = channels.each_ref().map(values);
            let color = |index: usize| [red[index], green[index], blue[index]].map(channel);
            cloud.attributes.colors = Some((0..count).map(|index| with_alpha(color(index), 255)).collect());
        }
        // Splats without any colour are white.
        let colors = cloud.attributes.colors.get_or_insert_with(|| vec![[255; 4]; count]);
        for ((color, &opacity), share) in colors.iter_mut().zip(&opacity).zip(shares) {
            color[3] = (f32::from(alpha_of_logit(opacity)) * share).round() as u8;
        }
        put_shapes(cloud, &opacity, |index| SplatShape {
            log_scales: [0, 1, 2].map(|axis| scales.get(axis).map_or(f32::NEG_INFINITY, |scale| scale[index])),
            rotation: rotations[index],
        });
        moving_splats::warn_of_unknown(cloud);
    }
}

fn with_alpha([red, green, blue]: [u8; 3], alpha: u8) -> [u8; 4] {
    [red, green, blue, alpha]
}
