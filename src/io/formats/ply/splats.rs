//! Gaussian splats as the authors of "3D Gaussian Splatting" store them in PLY, flat ones of "2D Gaussian Splatting",
//! round ones of one scale, those with 8-bit colours of `nerfstudio`, and moving ones of "Spacetime Gaussian Feature
//! Splatting" (`io/formats/splats`). The harmonics that change with direction (`f_rest_*`) are skipped.
//!
//! Of the four groups of columns (colours, opacity, scales, rotation) one may be absent.

use super::super::splats::{
    SplatShape, alpha_of_logit, byte, channel_of_harmonic, colors_of_harmonics, put_shapes, warn_of_colors,
};
use super::moving_splats::{self, MovingSplats};
use super::splat_columns::{take, take_all};
use crate::cloud::{AxisConvention, RawCloud};
use crate::io::columns::column::Column;
use glam::Quat;

const COLORS: [&str; 3] = ["f_dc_0", "f_dc_1", "f_dc_2"];
const OPACITY: &str = "opacity";
/// The last is absent where splats are flat, the last two where they are round.
const SCALES: [&str; 3] = ["scale_0", "scale_1", "scale_2"];
/// Real part first.
const ROTATION: [&str; 4] = ["rot_0", "rot_1", "rot_2", "rot_3"];
/// Column that marks a rotation in space and time: further rotation components exist only there.
const ROTATION_IN_TIME: &str = "rot_4";

/// Beginnings of names of columns that nothing is made of: harmonics that change with direction, features that a
/// network makes colours of.
const UNREAD: [&str; 3] = ["f_rest_", "f_dc_", "f_t_"];

/// Prefixes of column names of anchors that a network turns into splats ("Scaffold-GS", Lu et al. 2024), and of their
/// other columns.
const ANCHOR: &str = "f_anchor_feat_";
const OF_ANCHORS: [&str; 5] = ["f_offset_", ANCHOR, "opacity", "scale_", "rot_"];

/// Returns true if rows with the columns that `is_there` knows are splats.
pub(super) fn are_splats(is_there: &dyn Fn(&str) -> bool) -> bool {
    let has_colors = COLORS.iter().all(|name| is_there(name));
    let has_rotation = ROTATION.iter().all(|name| is_there(name));
    let groups = [has_colors, is_there(OPACITY), is_there(SCALES[0]), has_rotation];
    let is_anchor = is_there(&format!("{ANCHOR}0"));
    is_there(SCALES[0]) && groups.iter().filter(|&&is_there| is_there).count() >= 3 && !is_anchor
}

/// Returns true if a column of splats of this name contains nothing that is shown.
pub(super) fn is_unread(name: &str) -> bool {
    !COLORS.contains(&name) && UNREAD.iter().any(|prefix| name.starts_with(prefix))
}

/// Returns true if a column of this name is one of anchors from which a network generates splats.
pub(super) fn is_anchor(name: &str) -> bool {
    name.starts_with(ANCHOR)
}

/// Reduces the anchors of a network to positions. Returns a warning.
pub(super) fn drop_anchors(columns: &mut Vec<Column<'_>>) -> Option<String> {
    if !columns.iter().any(|column| is_anchor(&column.name)) {
        return None;
    }
    columns.retain(|column| !OF_ANCHORS.iter().any(|prefix| column.name.starts_with(prefix)));
    Some(format!(
        "header: the properties `{ANCHOR}*` say that these are anchors of Scaffold-GS, of which a network makes \
         splats: without it they are shown as points where the anchors are; export splats from the trained model"
    ))
}

/// The columns that splats are made of.
pub(super) struct Splats<'a> {
    colors: Option<[Column<'a>; 3]>,
    opacity: Option<Column<'a>>,
    scales: Vec<Column<'a>>,
    rotation: Option<[Column<'a>; 4]>,
    moving: Option<MovingSplats<'a>>,
    /// True if the columns have a rotation in space and time, which is not read.
    turns_in_time: bool,
}

impl<'a> Splats<'a> {
    /// The splats, and the other columns; all columns where there are no splats.
    pub(super) fn take(mut columns: Vec<Column<'a>>) -> Result<(Self, Vec<Column<'a>>), Vec<Column<'a>>> {
        let is_there = |name: &str| columns.iter().any(|column| column.name == name);
        if !are_splats(&is_there) {
            return Err(columns);
        }
        let turns_in_time = is_there(ROTATION_IN_TIME);
        columns.retain(|column| !is_unread(&column.name));
        let moving = MovingSplats::take(&mut columns);
        let splats = Self {
            colors: take_all(&mut columns, COLORS),
            opacity: take(&mut columns, OPACITY),
            scales: SCALES.iter().filter_map(|name| take(&mut columns, name)).collect(),
            rotation: take_all(&mut columns, ROTATION).filter(|_| !turns_in_time),
            moving,
            turns_in_time,
        };
        Ok((splats, columns))
    }

    /// Gives `cloud` their colours, normals, radii and ellipses: the normals that such files have are zeros.
    pub(super) fn put_into(self, cloud: &mut RawCloud) {
        let count = cloud.positions.len();
        let values = |column: &Column<'_>| column.to_f32(count);
        let opacity = self.opacity.as_ref().map(values);
        let scales: Vec<Vec<f32>> = self.scales.iter().map(values).collect();
        let rotations = self.rotation.as_ref().map(|rotation| {
            let [real, i, j, k] = rotation.each_ref().map(values);
            let turn = |index: usize| Quat::from_xyzw(i[index], j[index], k[index], real[index]);
            (0..count).map(turn).collect::<Vec<Quat>>()
        });
        let missing = self.missing();
        let mut shares: Vec<f32> = vec![1.0; count];
        // Colours of moving splats are light, not spherical harmonics.
        let channel = if self.moving.is_some() {
            byte
        } else {
            channel_of_harmonic
        };
        let mut rotations = rotations;
        if let Some(moving) = self.moving {
            moving.put_into(cloud, rotations.as_deref_mut().unwrap_or_default(), &mut shares);
        }
        let mut broken = 0;
        if let Some(channels) = &self.colors {
            let channels = channels.each_ref().map(values);
            let (colors, count) = colors_of_harmonics(channels.each_ref().map(Vec::as_slice), channel);
            cloud.attributes.colors = Some(colors);
            broken = count;
        }
        // Splats without any colour are white.
        let colors = cloud.attributes.colors.get_or_insert_with(|| vec![[255; 4]; count]);
        for (index, (color, share)) in colors.iter_mut().zip(shares).enumerate() {
            let alpha = opacity.as_ref().map_or(u8::MAX, |logits| alpha_of_logit(logits[index]));
            color[3] = (f32::from(alpha) * share).round() as u8;
        }
        match rotations {
            Some(rotations) if scales.len() > 1 => {
                put_shapes(cloud, opacity.as_deref().unwrap_or_default(), |index| SplatShape {
                    log_scales: [0, 1, 2].map(|axis| scales.get(axis).map_or(f32::NEG_INFINITY, |scale| scale[index])),
                    rotation: rotations[index],
                });
            }
            _ => put_balls(cloud, &scales),
        }
        cloud.warnings.extend(missing);
        warn_of_colors(cloud, broken);
        moving_splats::warn_of_unknown(cloud);
    }

    /// Returns the message about groups of columns that are missing.
    fn missing(&self) -> Option<String> {
        let mut parts = Vec::new();
        if self.opacity.is_none() {
            parts.push("no `opacity`: they are taken for opaque");
        }
        if self.turns_in_time {
            parts.push("rotations in space and time (`rot_0` to `rot_7`), which are not read: they are shown round");
        } else if self.rotation.is_none() {
            parts.push("no rotation (`rot_0` to `rot_3`): they are shown round");
        }
        if self.scales.len() == 1 && self.rotation.is_some() {
            parts.push("one scale (`scale_0`): they are round");
        }
        (!parts.is_empty()).then(|| format!("header: the splats have {}", parts.join("; they have ")))
    }
}

/// Gives `cloud` radii, the geometric means of the half axes. The direction of a ball is undefined: its normal is
/// estimated.
fn put_balls(cloud: &mut RawCloud, scales: &[Vec<f32>]) {
    let radius = |index: usize| {
        let mean = scales.iter().map(|scale| scale[index]).sum::<f32>() / scales.len().max(1) as f32;
        let radius = mean.exp();
        if radius.is_finite() { radius } else { 0.0 }
    };
    cloud.attributes.radii = Some((0..cloud.positions.len()).map(radius).collect());
    cloud.attributes.normals = None;
    cloud.convention = Some(AxisConvention::UsuallyYDown);
}
