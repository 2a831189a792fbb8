//! Names of missing points: by their place, by the coordinate that is missing, or by their distance.

use super::bulk::{Extent, is_listed};
use super::known::{Known, is_at};
use super::repeats::Repeats;
use crate::cloud::Positions;
use glam::DVec3;

/// Maximum number of values that are distinguished: more are not constants.
const MAX_DISTINCT: usize = 64;
/// Values beyond these are counted together.
pub(super) const MAX_VALUES: usize = 4;
const AXES: [&str; 3] = ["x", "y", "z"];

/// Missing points of one value.
#[derive(Debug, Clone, PartialEq)]
pub struct MissingValue {
    /// The position, or the coordinate that is missing: `0 0 0`, `z = -9999`.
    pub value: String,
    /// Number of points.
    pub count: usize,
}

/// Context for naming missing values.
#[derive(Debug)]
pub(super) struct Naming<'a> {
    repeats: Option<&'a Repeats>,
    place: Option<[f64; 3]>,
    known: Known,
}

impl<'a> Naming<'a> {
    /// Creates a naming for coordinates that a user has named.
    pub(super) fn of_rule(known: Known) -> Self {
        Self {
            repeats: None,
            place: None,
            known,
        }
    }

    /// Creates a naming for a position that a user has named.
    pub(super) fn of_place(place: [f64; 3], known: Known) -> Self {
        Self {
            place: Some(place),
            ..Self::of_rule(known)
        }
    }

    /// Creates a naming for repeats that statistics have found.
    pub(super) fn of_repeats(repeats: &'a Repeats, known: Known) -> Self {
        Self {
            repeats: Some(repeats),
            ..Self::of_rule(known)
        }
    }

    /// The missing points by value, the most frequent first. A coordinate that a single point has, and that no program
    /// is known to write, is not a no-data value.
    pub(super) fn values(&self, positions: &Positions, indices: &[u32], present: &Extent) -> Vec<MissingValue> {
        let mut values: Vec<(MissingValue, bool)> = Vec::new();
        for &index in indices {
            let (value, is_known) = self.value(positions.get(index as usize), present);
            if let Some((known, _)) = values.iter_mut().find(|(known, _)| known.value == value) {
                known.count += 1;
            } else if values.len() < MAX_DISTINCT {
                values.push((MissingValue { value, count: 1 }, is_known));
            }
        }
        values.retain(|(value, is_known)| *is_known || value.count > 1 || indices.len() == 1);
        let mut values: Vec<MissingValue> = values.into_iter().map(|(value, _)| value).collect();
        values.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| a.value.cmp(&b.value)));
        values.truncate(MAX_VALUES);
        values
    }

    /// The name of a missing point, and true if its value is a known no-data constant.
    fn value(&self, position: DVec3, present: &Extent) -> (String, bool) {
        let DVec3 { x, y, z } = position;
        if let Some(name) = self.limit(position) {
            return (name, true);
        }
        let is_repeated = self.repeats.is_some_and(|repeats| repeats.is_place(position));
        if position == DVec3::ZERO || is_repeated || self.place.is_some_and(|place| is_at(position, place)) {
            return (
                format!("{} {} {}", number(x + 0.0), number(y + 0.0), number(z + 0.0)),
                true,
            );
        }
        let outside = (present.min - position).max(position - present.max);
        let axis = outside.max_position();
        let coordinate = position[axis];
        let is_known = coordinate == 0.0 || is_listed(coordinate) || coordinate.abs() == f64::from(f32::MAX);
        if let Some(range) = self.repeats.and_then(|repeats| repeats.range(position))
            && !is_known
        {
            return (format!("a distance of {} from 0 0 0", range as f32), true);
        }
        let is_same = |other: &usize| position[*other] == coordinate && (*other == axis || outside[*other] > 0.0);
        let axes: Vec<&str> = (0..3).filter(is_same).map(|other| AXES[other]).collect();
        (format!("{} = {}", axes.join(" = "), number(coordinate)), is_known)
    }

    /// `x = y = z = the smallest 32-bit integer`, for coordinates that the integers of the file end with.
    fn limit(&self, position: DVec3) -> Option<String> {
        let limits = self.known.limits?;
        let names = ["smallest", "largest"];
        names.iter().enumerate().find_map(|(end, name)| {
            let axes: Vec<&str> = (0..3)
                .filter(|&axis| limits[axis][end] == position[axis])
                .map(|axis| AXES[axis])
                .collect();
            (!axes.is_empty()).then(|| format!("{} = the {name} 32-bit integer", axes.join(" = ")))
        })
    }
}

fn number(coordinate: f64) -> String {
    let size = coordinate.abs();
    if size >= 1e9 || (size > 0.0 && size < 1e-4) {
        format!("{coordinate:e}")
    } else {
        format!("{coordinate}")
    }
}
