//! No-data points: constants such as 0 0 0 or −9999, and coordinates absurdly far away.
//!
//! **How it works.** Programs write a constant where there is no return, and overflow to the smallest integer. One such
//! point in a survey in UTM coordinates moves the origin by thousands of kilometres and makes single precision coarser
//! than the points are apart. So the *bulk* of a cloud is measured first ([`bulk`]), by a sample from which candidates
//! are removed. A point is missing if
//!
//! - it is at 0 0 0, away from the bulk, or repeatedly, alone in a void,
//! - it is at exactly the same place, or distance from 0 0 0, as many other points ([`repeats`]),
//! - a coordinate is a constant that programs are known to write, away from the bulk along that axis,
//! - a coordinate is exactly 0, as in many other points, while the bulk is elsewhere along that axis,
//! - it is more than a thousand diagonals away: no image shows it together with the rest.
//!
//! Where the box around all points is as large as the bulk suggests, nothing is searched: one pass over the points.
//! Results do not depend on the number of threads. Vertices of meshes are shared by many faces, so repetition means
//! nothing there.

mod bulk;
mod known;
mod naming;
mod repeats;
#[cfg(test)]
mod tests;

use super::{Positions, RawCloud};
use crate::assumption::{Assumption, Evidence, Subject};
use bulk::{Bulk, Extent};
use glam::DVec3;
use known::{Known, is_at, is_near};
pub use naming::MissingValue;
use naming::{MAX_VALUES, Naming};
use rayon::prelude::*;
use repeats::Repeats;
use std::fmt;
use std::str::FromStr;

/// Handling of no-data points.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum NoData {
    /// Found by statistics.
    #[default]
    Auto,
    /// Every finite point is a measurement.
    None,
    /// Points with this coordinate are missing; for 0, those at 0 0 0, and those with a 0 along an axis along which all
    /// others are elsewhere.
    Value(f64),
    /// Points at this place are missing.
    Place([f64; 3]),
}

impl FromStr for NoData {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const EXPECTED: &str = "expected auto, none, the number that stands for a missing coordinate, or the place \
                                of missing points as three numbers, such as -1,-1,-1";
        match text {
            "auto" => return Ok(Self::Auto),
            "none" => return Ok(Self::None),
            _ => {}
        }
        let words = text.split([',', ';', ' ']).filter(|word| !word.is_empty());
        let numbers: Option<Vec<f64>> = words
            .map(|word| word.parse().ok().filter(|number: &f64| number.is_finite()))
            .collect();
        match numbers.as_deref() {
            Some(&[value]) => Ok(Self::Value(value)),
            Some(&[x, y, z]) => Ok(Self::Place([x, y, z])),
            _ => Err(EXPECTED.to_owned()),
        }
    }
}

impl fmt::Display for NoData {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => formatter.write_str("auto"),
            Self::None => formatter.write_str("none"),
            Self::Value(value) => write!(formatter, "{value}"),
            Self::Place([x, y, z]) => write!(formatter, "{x},{y},{z}"),
        }
    }
}

/// More of the points than this are not missing: the supposed bulk is wrong then.
const MAX_SHARE: f64 = 0.98;
/// The missing points of a cloud.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MissingPoints {
    /// Indices in the file, ascending.
    pub indices: Vec<u32>,
    /// Missing values with their counts, the most frequent first; at most [`MissingPoints::MAX_VALUES`].
    pub values: Vec<MissingValue>,
    /// Finite points that are not missing.
    pub present_count: usize,
    /// The box around them in file coordinates.
    pub bounds: Option<(DVec3, DVec3)>,
}

impl MissingPoints {
    /// Values beyond these are counted together.
    pub const MAX_VALUES: usize = MAX_VALUES;

    /// The missing points of `cloud` by `rule`.
    pub fn of(cloud: &RawCloud, rule: NoData) -> Self {
        let known = Known {
            limits: cloud.integer_limits,
            has_faces: !cloud.faces.is_empty() || cloud.skipped_faces > 0,
        };
        Self::find(&cloud.positions, rule, known)
    }

    fn find(positions: &Positions, rule: NoData, known: Known) -> Self {
        let all = Extent::of(positions, |_| true);
        match rule {
            NoData::None => Self::none(&all),
            NoData::Value(value) => {
                let zero_axes = if value == 0.0 {
                    bulk::axes_without_zero(positions)
                } else {
                    [false; 3]
                };
                let is_missing = |position: DVec3| has_value(position, value, zero_axes);
                Self::where_missing(positions, is_missing, &Naming::of_rule(known))
            }
            NoData::Place(place) => {
                let is_missing = |position: DVec3| is_at(position, place);
                Self::where_missing(positions, is_missing, &Naming::of_place(place, known))
            }
            NoData::Auto => match Bulk::of(positions, &all, known) {
                // Otherwise a single pass suffices: no zeros, no repetition, nothing far outside the bulk.
                Some(bulk) if bulk.may_miss(&all) => {
                    let repeats = Repeats::find(positions, &bulk, &all);
                    let is_missing = |position: DVec3| bulk.misses(position) || repeats.contain(position, &bulk);
                    let found = Self::where_missing(positions, is_missing, &Naming::of_repeats(&repeats, known));
                    if found.indices.len() as f64 > MAX_SHARE * all.count as f64 {
                        Self::none(&all)
                    } else {
                        found
                    }
                }
                _ => Self::none(&all),
            },
        }
    }

    /// The finite points for which `is_missing` is true.
    fn where_missing(positions: &Positions, is_missing: impl Fn(DVec3) -> bool + Sync, naming: &Naming<'_>) -> Self {
        let indices: Vec<u32> = (0..positions.len() as u32)
            .into_par_iter()
            .filter(|&index| {
                let position = positions.get(index as usize);
                position.is_finite() && is_missing(position)
            })
            .collect();
        let present = Extent::of(positions, |position| !is_missing(position));
        Self {
            values: naming.values(positions, &indices, &present),
            indices,
            present_count: present.count,
            bounds: present.bounds(),
        }
    }

    fn none(all: &Extent) -> Self {
        Self {
            present_count: all.count,
            bounds: all.bounds(),
            ..Self::default()
        }
    }

    /// True without missing points.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// For people: `120 points at 0 0 0, 1 point at y = -2147483.648`; nothing where none is missing.
    pub fn in_words(&self) -> String {
        let mut parts: Vec<String> = self
            .values
            .iter()
            .map(|MissingValue { value, count }| format!("{} at {value}", points(*count)))
            .collect();
        let named: usize = self.values.iter().map(|value| value.count).sum();
        let others = self.indices.len() - named;
        if others > 0 {
            parts.push(format!("{} far from the rest", points(others)));
        }
        parts.join(", ")
    }

    /// The assumption that these points are missing; `None` where none is, or the user said so.
    pub fn assumption(&self, rule: NoData, found_in: FoundIn) -> Option<Assumption> {
        (!self.is_empty() && rule == NoData::Auto).then(|| {
            let values: Vec<&str> = self.values.iter().map(|value| value.value.as_str()).collect();
            let value = match values.as_slice() {
                [] => "points far from the rest".to_owned(),
                values => values.join(", "),
            };
            let count = match found_in.whole_count {
                Some(whole) => {
                    let share = self.indices.len() as f64 / found_in.point_count.max(1) as f64;
                    format!("about {}", points((share * whole as f64).round() as usize))
                }
                None => points(self.indices.len()),
            };
            let of_frame = if found_in.is_only_frame {
                ""
            } else {
                " in a frame at most,"
            };
            let why =
                format!("{count}{of_frame} away from the rest of the cloud: such points are neither drawn nor framed");
            Assumption::new(Subject::NoData, value, why, Evidence::Statistics)
        })
    }
}

/// Search scope for missing points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FoundIn {
    /// Number of examined points.
    pub point_count: usize,
    /// Points of the frame, where these are a sample of it.
    pub whole_count: Option<usize>,
    /// True if there is no other frame.
    pub is_only_frame: bool,
}

fn points(count: usize) -> String {
    format!("{count} {}", if count == 1 { "point" } else { "points" })
}

/// Makes these points holes. Precondition: each index is below the number of points.
pub(crate) fn make_holes(positions: &mut Positions, indices: &[u32]) {
    match positions {
        Positions::F32(positions) => indices
            .iter()
            .for_each(|&index| positions[index as usize] = [f32::NAN; 3]),
        Positions::F64(positions) => indices
            .iter()
            .for_each(|&index| positions[index as usize] = [f64::NAN; 3]),
    }
}

fn has_value(position: DVec3, value: f64, zero_axes: [bool; 3]) -> bool {
    if value == 0.0 {
        return position == DVec3::ZERO || (0..3).any(|axis| zero_axes[axis] && position[axis] == 0.0);
    }
    position.to_array().iter().any(|&coordinate| is_near(coordinate, value))
}
