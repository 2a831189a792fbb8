//! Dynamic splats: "Spacetime Gaussian Feature Splatting" (Li et al. 2024, §3.1 and §3.2) gives each splat a time at
//! which it is most visible, a width in time, a polynomial for its path and a rotation that changes. One time step is
//! shown.
//!
//! Their colours are light from 0 to 1, not harmonics.

use super::splat_columns::{take, take_all};
use crate::cloud::{Positions, RawCloud};
use crate::io::columns::column::Column;
use glam::{DVec3, Quat};

const CENTER: &str = "trbf_center";
/// The natural logarithm of the width.
const WIDTH: &str = "trbf_scale";
/// Prefix of the path columns: three numbers for each power of the time since the centre, from the first on.
const MOTION: &str = "motion_";
/// Columns of the change of rotation per unit of time.
const TURN: [&str; 4] = ["omega_0", "omega_1", "omega_2", "omega_3"];

/// Columns by which other methods make splats move ("4D Gaussian Splatting", "4D-Rotor", "`FreeTimeGS`", splats with
/// velocities); nothing is made of them.
const OF_OTHERS: [&str; 18] = [
    "scale_t",
    "t_scale",
    "rot_r_0",
    "trbf_center",
    "scale_3",
    "rot_4",
    "motion_0",
    "omega_0",
    "velocity_0",
    "velocity_x",
    "vx",
    "t_start",
    "t_end",
    "duration",
    "t",
    "time",
    "timestamp",
    "time_center",
];

/// The columns that say how splats move.
pub(super) struct MovingSplats<'a> {
    center: Column<'a>,
    width: Option<Column<'a>>,
    /// In the order of the powers and axes.
    motion: Vec<Column<'a>>,
    turn: Option<[Column<'a>; 4]>,
}

impl<'a> MovingSplats<'a> {
    /// Removes their columns from `columns`, if splats move.
    pub(super) fn take(columns: &mut Vec<Column<'a>>) -> Option<Self> {
        let first = format!("{MOTION}0");
        if !columns.iter().any(|column| column.name == first) {
            return None;
        }
        let center = take(columns, CENTER)?;
        let numbered = (0..).map(|place| format!("{MOTION}{place}"));
        let motion = numbered.map_while(|name| take(columns, &name)).collect();
        Some(Self {
            center,
            width: take(columns, WIDTH),
            motion,
            turn: take_all(columns, TURN),
        })
    }

    /// Moves the points of `cloud` and `rotations` to one time, the median of their centres, and puts the visible
    /// fraction of each splat at that time into `shares`.
    pub(super) fn put_into(self, cloud: &mut RawCloud, rotations: &mut [Quat], shares: &mut [f32]) {
        let count = cloud.positions.len();
        let centers = self.center.to_f32(count);
        let instant = median(&centers);
        let widths = self.width.map(|width| width.to_f32(count));
        let motion: Vec<Vec<f32>> = self.motion.iter().map(|column| column.to_f32(count)).collect();
        let turn = self.turn.map(|turn| turn.each_ref().map(|column| column.to_f32(count)));
        let since = |index: usize| instant - centers[index];
        for (index, share) in shares.iter_mut().enumerate() {
            let width = widths.as_ref().map_or(f32::INFINITY, |widths| widths[index].exp());
            *share = (-(since(index) / width).powi(2)).exp();
            if !share.is_finite() {
                *share = 1.0;
            }
        }
        if let Some([real, i, j, k]) = turn {
            for (index, rotation) in rotations.iter_mut().enumerate() {
                *rotation += Quat::from_xyzw(i[index], j[index], k[index], real[index]) * since(index);
            }
        }
        let path = |index: usize| {
            let mut power = 1.0;
            let mut moved = DVec3::ZERO;
            for axes in motion.chunks_exact(3) {
                power *= f64::from(since(index));
                moved += DVec3::from_array([0, 1, 2].map(|axis: usize| f64::from(axes[axis][index]))) * power;
            }
            moved
        };
        match &mut cloud.positions {
            Positions::F32(positions) => {
                for (index, position) in positions.iter_mut().enumerate() {
                    *position = (glam::Vec3::from_array(*position).as_dvec3() + path(index))
                        .as_vec3()
                        .to_array();
                }
            }
            Positions::F64(positions) => {
                for (index, position) in positions.iter_mut().enumerate() {
                    *position = (DVec3::from_array(*position) + path(index)).to_array();
                }
            }
        }
        cloud.warnings.push(format!(
            "header: these are moving splats (Spacetime Gaussians): their time is not read, they are shown as they \
             are at t = {instant}"
        ));
    }
}

/// Warns if fields of `cloud` belong to splats with an unsupported motion model.
pub(super) fn warn_of_unknown(cloud: &mut RawCloud) {
    /// Max number of names in the message.
    const MAX_NAMED: usize = 3;
    let is_moving = |name: &&&str| cloud.attributes.scalars.iter().any(|field| field.name == ***name);
    let names = OF_OTHERS.iter().filter(is_moving).take(MAX_NAMED);
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    let (property, says) = match names.len() {
        0 => return,
        1 => ("property", "says"),
        _ => ("properties", "say"),
    };
    cloud.warnings.push(format!(
        "header: the {property} {} {says} that these are moving splats: their time is not read, splats of all time \
         steps are shown together",
        names.join(", ")
    ));
}

/// 0 where no value is finite.
fn median(values: &[f32]) -> f32 {
    let mut finite: Vec<f32> = values.iter().copied().filter(|value| value.is_finite()).collect();
    if finite.is_empty() {
        return 0.0;
    }
    let midpoint = finite.len() / 2;
    *finite.select_nth_unstable_by(midpoint, f32::total_cmp).1
}
