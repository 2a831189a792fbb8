//! Points that stand for no measurement: constants such as 0 0 0 or −9999, and coordinates absurdly far away.
//!
//! **How it works.** Programs write a constant where there is no return, and overflow to the smallest integer. One such
//! point in a survey in UTM coordinates moves the origin by thousands of kilometres and makes single precision coarser
//! than the points are apart. So the *bulk* of a cloud is measured first: the box between quantiles of a sample that
//! has no candidate in it. A point is missing if
//!
//! - it is at 0 0 0, away from the bulk, or again and again in a void of its own,
//! - a coordinate is a constant that programs are known to write, away from the bulk along that axis,
//! - it is more than [`FAR_DIAGONALS`] diagonals away: no picture shows it together with the rest.
//!
//! Where the box around all points is as large as the bulk suggests, nothing is looked for: one pass over the points.
//! The same points give the same answer whatever the number of threads.

use super::{Positions, even_places};
use crate::assumption::{Assumption, Evidence, Subject};
use glam::DVec3;
use rayon::prelude::*;
use std::fmt;
use std::str::FromStr;

/// Handling of points that stand for no measurement.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum NoData {
    /// Found by statistics.
    #[default]
    Auto,
    /// Every finite point is a measurement.
    None,
    /// Points with this coordinate are missing; for 0, those at 0 0 0.
    Value(f64),
}

impl FromStr for NoData {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            "none" => Ok(Self::None),
            number => match number.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(Self::Value(value)),
                _ => Err("expected auto, none or the number that stands for a missing coordinate".to_owned()),
            },
        }
    }
}

impl fmt::Display for NoData {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => formatter.write_str("auto"),
            Self::None => formatter.write_str("none"),
            Self::Value(value) => write!(formatter, "{value}"),
        }
    }
}

/// Magnitudes that programs write for a missing coordinate: elevation models, grids of simulations, depth cameras (16
/// bits of millimetres), smallest and largest integers (also of millimetres), largest floats.
const CONSTANTS: [f64; 16] = [
    999.0,
    999.9,
    9_999.0,
    9_999.9,
    99_999.0,
    999_999.0,
    32_767.0,
    32_768.0,
    65.535,
    65_535.0,
    2_147_483.648,
    2_147_483.647,
    2_147_483_648.0,
    2_147_483_647.0,
    1e20,
    1e30,
];
/// From here on a number is no coordinate in any unit: 1e30, the largest float and their kin.
const ABSURD: f64 = 1e18;
/// A constant is away from the bulk from this share of the bulk's diagonal on.
const AWAY_DIAGONALS: f64 = 0.5;
/// Points so many diagonals away from the bulk are missing whatever they are.
const FAR_DIAGONALS: f64 = 1000.0;
/// Points that the bulk is measured by.
const SAMPLE_POINTS: usize = 1 << 13;
/// Fewer points have no bulk.
const MIN_POINTS: usize = 16;
/// Share of the sample outside the bulk at each end of an axis.
const TAIL: f64 = 0.02;
/// Zeros are repeated from this count and this share of the points on.
const MIN_ZEROS: usize = 10;
const MIN_ZERO_SHARE: f64 = 1e-3;
/// A void has no other point within so many times the distance between points of a surface.
const VOID_SPACINGS: f64 = 3.0;
/// More of the points than this are not missing: what is taken for the bulk is not.
const MAX_SHARE: f64 = 0.98;
/// Distinct values that are told apart: more are not constants.
const MAX_DISTINCT: usize = 64;
/// Relative rounding of single precision.
const ROUNDING: f64 = 1e-6;

/// Missing points of one value.
#[derive(Debug, Clone, PartialEq)]
pub struct MissingValue {
    /// The position, or the coordinate that is missing: `0 0 0`, `z = -9999`.
    pub value: String,
    /// Number of points.
    pub count: usize,
}

/// The missing points of a cloud.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MissingPoints {
    /// Indices in the file, ascending.
    pub indices: Vec<u32>,
    /// The same by value, the most frequent first; at most [`MissingPoints::MAX_VALUES`].
    pub values: Vec<MissingValue>,
    /// Finite points that are not missing.
    pub present_count: usize,
    /// The box around them in file coordinates.
    pub bounds: Option<(DVec3, DVec3)>,
}

impl MissingPoints {
    /// Values beyond these are counted together.
    pub const MAX_VALUES: usize = 4;

    /// The missing points among `positions` by `rule`.
    pub fn find(positions: &Positions, rule: NoData) -> Self {
        let all = Extent::of(positions, |_| true);
        let is_missing: Box<dyn Fn(DVec3) -> bool + Sync> = match rule {
            NoData::None => return Self::none(&all),
            NoData::Value(value) => Box::new(move |position| has_value(position, value)),
            NoData::Auto => match Bulk::of(positions, &all) {
                Some(bulk) if bulk.may_miss(&all) => {
                    let has_void = bulk.zeros_are_apart(positions, &all);
                    Box::new(move |position| bulk.misses(position, has_void))
                }
                _ => return Self::none(&all),
            },
        };
        let indices: Vec<u32> = (0..positions.len() as u32)
            .into_par_iter()
            .filter(|&index| {
                let position = positions.get(index as usize);
                position.is_finite() && is_missing(position)
            })
            .collect();
        if indices.is_empty() || (rule == NoData::Auto && indices.len() as f64 > MAX_SHARE * all.count as f64) {
            return Self::none(&all);
        }
        let present = Extent::of(positions, |position| !is_missing(position));
        Self {
            values: values(positions, &indices, &present),
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
        let points = |count: usize| if count == 1 { "point" } else { "points" };
        let mut parts: Vec<String> = self
            .values
            .iter()
            .map(|MissingValue { value, count }| format!("{count} {} at {value}", points(*count)))
            .collect();
        let named: usize = self.values.iter().map(|value| value.count).sum();
        let others = self.indices.len() - named;
        if others > 0 {
            parts.push(format!("{others} {} far from the rest", points(others)));
        }
        parts.join(", ")
    }

    /// The assumption that these points are missing; `None` where none is, or the user said so.
    pub fn assumption(&self, rule: NoData) -> Option<Assumption> {
        (!self.is_empty() && rule == NoData::Auto).then(|| {
            // Without counts, so that frames with the same constant have the same assumption.
            let values: Vec<&str> = self.values.iter().map(|value| value.value.as_str()).collect();
            let value = match values.as_slice() {
                [] => "points far from the rest".to_owned(),
                values => values.join(", "),
            };
            let why = "away from the rest of the cloud: such points are neither drawn nor framed";
            Assumption::new(Subject::NoData, value, why, Evidence::Statistics)
        })
    }
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

fn has_value(position: DVec3, value: f64) -> bool {
    if value == 0.0 {
        return position == DVec3::ZERO;
    }
    position.to_array().iter().any(|&coordinate| is_near(coordinate, value))
}

fn is_near(coordinate: f64, value: f64) -> bool {
    (coordinate - value).abs() <= ROUNDING * value.abs()
}

fn is_constant(coordinate: f64) -> bool {
    let magnitude = coordinate.abs();
    magnitude >= ABSURD || CONSTANTS.iter().any(|&constant| is_near(magnitude, constant))
}

fn is_candidate(position: DVec3) -> bool {
    position == DVec3::ZERO || position.to_array().into_iter().any(is_constant)
}

/// The missing points by value, the most frequent first. A value is shared, or a constant.
fn values(positions: &Positions, indices: &[u32], present: &Extent) -> Vec<MissingValue> {
    let mut values: Vec<MissingValue> = Vec::new();
    for &index in indices {
        let value = value_of(positions.get(index as usize), present);
        if let Some(known) = values.iter_mut().find(|known| known.value == value) {
            known.count += 1;
        } else if values.len() < MAX_DISTINCT {
            values.push(MissingValue { value, count: 1 });
        }
    }
    values.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| a.value.cmp(&b.value)));
    values.truncate(MissingPoints::MAX_VALUES);
    values
}

/// The coordinate that is farthest outside of the present points.
fn value_of(position: DVec3, present: &Extent) -> String {
    if position == DVec3::ZERO {
        return "0 0 0".to_owned();
    }
    let outside = (present.min - position).max(position - present.max);
    let axis = outside.max_position();
    let coordinate = position[axis];
    let name = ["x", "y", "z"][axis];
    if coordinate.abs() >= 1e9 {
        format!("{name} = {coordinate:e}")
    } else {
        format!("{name} = {coordinate}")
    }
}

/// Finite points and the box around them.
#[derive(Debug, Clone, Copy)]
struct Extent {
    count: usize,
    zero_count: usize,
    min: DVec3,
    max: DVec3,
}

impl Extent {
    const EMPTY: Self = Self {
        count: 0,
        zero_count: 0,
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };
    const POINTS_PER_TASK: usize = 1 << 16;

    fn of(positions: &Positions, is_taken: impl Fn(DVec3) -> bool + Sync) -> Self {
        let count = positions.len();
        let starts = (0..count).into_par_iter().step_by(Self::POINTS_PER_TASK);
        let of_part = |start: usize| {
            let end = (start + Self::POINTS_PER_TASK).min(count);
            let taken = (start..end).map(|index| positions.get(index));
            let taken = taken.filter(|position| position.is_finite() && is_taken(*position));
            taken.fold(Self::EMPTY, Self::with)
        };
        starts.map(of_part).reduce(|| Self::EMPTY, Self::union)
    }

    fn with(self, position: DVec3) -> Self {
        Self {
            count: self.count + 1,
            zero_count: self.zero_count + usize::from(position == DVec3::ZERO),
            min: self.min.min(position),
            max: self.max.max(position),
        }
    }

    fn union(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            zero_count: self.zero_count + other.zero_count,
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    fn bounds(&self) -> Option<(DVec3, DVec3)> {
        (self.count > 0).then_some((self.min, self.max))
    }
}

/// The box that most points are in.
#[derive(Debug, Clone, Copy)]
struct Bulk {
    min: DVec3,
    max: DVec3,
    diagonal: f64,
}

impl Bulk {
    /// Measured by a sample without candidates; `None` where too few points are left.
    fn of(positions: &Positions, all: &Extent) -> Option<Self> {
        if all.count < MIN_POINTS {
            return None;
        }
        let places = even_places(positions.len(), SAMPLE_POINTS).into_iter();
        let sample: Vec<DVec3> = places
            .map(|place| positions.get(place))
            .filter(|position| position.is_finite() && !is_candidate(*position))
            .collect();
        if sample.len() < MIN_POINTS / 2 {
            return None;
        }
        let mut bulk = Self {
            min: DVec3::ZERO,
            max: DVec3::ZERO,
            diagonal: 0.0,
        };
        for axis in 0..3 {
            let mut values: Vec<f64> = sample.iter().map(|position| position[axis]).collect();
            values.sort_unstable_by(f64::total_cmp);
            let last = values.len() - 1;
            let tail = (TAIL * last as f64).ceil() as usize;
            (bulk.min[axis], bulk.max[axis]) = (values[tail.min(last)], values[last - tail.min(last)]);
        }
        bulk.diagonal = (bulk.max * 0.5 - bulk.min * 0.5).length() * 2.0;
        (bulk.diagonal > 0.0 && bulk.diagonal.is_finite()).then_some(bulk)
    }

    /// False where no point can be missing: zeros are not there, and none is far away along any axis.
    fn may_miss(&self, all: &Extent) -> bool {
        let is_far = |axis: usize| self.outside(all.min, axis).max(self.outside(all.max, axis)) > self.far(axis);
        all.zero_count > 0 || (0..3).any(is_far)
    }

    /// Distance from the box along an axis; negative inside.
    fn outside(&self, position: DVec3, axis: usize) -> f64 {
        (self.min[axis] - position[axis]).max(position[axis] - self.max[axis])
    }

    /// Constants are missing from this distance along an axis on. Along a flat axis the least step away is far.
    fn far(&self, axis: usize) -> f64 {
        (self.max[axis] - self.min[axis]).max(1e-3 * self.diagonal)
    }

    /// Distance from the box.
    fn distance(&self, position: DVec3) -> f64 {
        (self.min - position).max(position - self.max).max(DVec3::ZERO).length()
    }

    fn misses(&self, position: DVec3, zeros_are_apart: bool) -> bool {
        let distance = self.distance(position);
        if position == DVec3::ZERO {
            return zeros_are_apart || distance > AWAY_DIAGONALS * self.diagonal;
        }
        if distance > FAR_DIAGONALS * self.diagonal {
            return true;
        }
        (0..3).any(|axis| is_constant(position[axis]) && self.outside(position, axis) > self.far(axis))
    }

    /// True where zeros are repeated and nothing else is near them.
    fn zeros_are_apart(&self, positions: &Positions, all: &Extent) -> bool {
        let is_repeated = all.zero_count >= MIN_ZEROS && all.zero_count as f64 >= MIN_ZERO_SHARE * all.count as f64;
        if !is_repeated {
            return false;
        }
        let others = (all.count - all.zero_count).max(1) as f64;
        let void = VOID_SPACINGS * self.diagonal / others.sqrt();
        (0..positions.len()).into_par_iter().all(|index| {
            let position = positions.get(index);
            !position.is_finite() || position == DVec3::ZERO || position.length() > void
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A wavy ground of 50 × 40 points a metre apart.
    fn ground(at: DVec3) -> Vec<DVec3> {
        let point = |index: u32| {
            let [x, y] = [index % 50, index / 50].map(f64::from);
            at + DVec3::new(x, y, 2.0 * (0.3 * x).sin())
        };
        (0..2000).map(point).collect()
    }

    fn found(points: &[DVec3]) -> MissingPoints {
        let positions = points.iter().map(glam::DVec3::to_array).collect();
        MissingPoints::find(&Positions::F64(positions), NoData::Auto)
    }

    const UTM: DVec3 = DVec3::new(431_000.0, 4_581_000.0, 120.0);

    #[test]
    fn one_zero_and_many_are_found_in_a_survey() {
        for count in [1, 20, 1500] {
            let mut points = ground(UTM);
            points.splice(7..7, vec![DVec3::ZERO; count]);
            let missing = found(&points);
            let expected: Vec<u32> = (7..7 + count as u32).collect();
            assert_eq!(missing.indices, expected);
            assert_eq!(missing.values[0].value, "0 0 0");
            assert_eq!(missing.values[0].count, count);
            assert!(missing.bounds.unwrap().0.x >= 431_000.0);
        }
    }

    #[test]
    fn constants_are_found_by_their_coordinate() {
        for constant in [-9999.0, 65_535.0, -2_147_483.648, 1e30, -3.4e38, -32_768.0] {
            let mut points = ground(DVec3::ZERO);
            points[100].z = constant;
            points[200].z = constant;
            let missing = found(&points);
            assert_eq!(missing.indices, [100, 200], "{constant}");
            assert!(missing.values[0].value.starts_with("z = "), "{:?}", missing.values);
            assert_eq!(missing.values[0].count, 2);
        }
    }

    #[test]
    fn what_is_absurdly_far_is_missing_and_what_is_far_is_not() {
        for (x, is_missing) in [(1e9, true), (-3e6, true), (400.0, false)] {
            let mut points = ground(DVec3::ZERO);
            points[3].x = x;
            assert_eq!(!found(&points).is_empty(), is_missing, "{x}");
        }
    }

    #[test]
    fn measurements_are_not_missing() {
        // A model at zero with a vertex there; a ground that has z = 0; one around zero; one of another size.
        assert!(found(&ground(DVec3::ZERO)).is_empty());
        assert!(found(&ground(DVec3::new(-25.0, -20.0, 0.0))).is_empty());
        let flat: Vec<DVec3> = ground(DVec3::ZERO).iter().map(|point| point.with_z(0.0)).collect();
        assert!(found(&flat).is_empty());
        // Elevations that pass 999.
        let high: Vec<DVec3> = ground(DVec3::ZERO)
            .iter()
            .map(|point| point + DVec3::Z * 999.0)
            .collect();
        assert!(found(&high).is_empty());
        let line: Vec<DVec3> = (0..500).map(|index| DVec3::X * f64::from(index)).collect();
        assert!(found(&line).is_empty());
        assert!(found(&[DVec3::ZERO; 100]).is_empty());
        assert!(found(&[]).is_empty());
    }

    #[test]
    fn zeros_in_a_void_are_missing_and_a_sweep_around_them_stays() {
        // A scanner in a room that writes 0 0 0 where nothing came back.
        let mut points: Vec<DVec3> = (0..4000)
            .map(|index| {
                let turn = f64::from(index) * 0.37;
                DVec3::new(5.0 * turn.cos(), 5.0 * turn.sin(), f64::from(index % 20) * 0.1 - 1.0)
            })
            .collect();
        points.extend([DVec3::ZERO; 50]);
        let missing = found(&points);
        assert_eq!(missing.indices.len(), 50);
        assert_eq!(missing.present_count, 4000);
    }

    #[test]
    fn a_user_says_what_is_missing() {
        let positions = ground(DVec3::ZERO).iter().map(glam::DVec3::to_array).collect();
        let positions = Positions::F64(positions);
        let find = |rule| MissingPoints::find(&positions, rule);
        assert_eq!(find(NoData::Value(0.0)).indices, [0]);
        assert_eq!(find(NoData::Value(7.0)).indices.len(), 40 + 50 - 1);
        assert!(find(NoData::None).is_empty());
        for (text, rule) in [
            ("auto", NoData::Auto),
            ("none", NoData::None),
            ("-9999", NoData::Value(-9999.0)),
        ] {
            assert_eq!(text.parse(), Ok(rule));
            assert_eq!(rule.to_string(), text);
        }
        assert!("nan".parse::<NoData>().is_err() && "zero".parse::<NoData>().is_err());
    }

    proptest! {
        /// The bounds are those of a cloud without the missing points, and the holes are these alone.
        #[test]
        fn bounds_are_those_of_what_is_there(
            x in -1e6f64..1e6, y in -1e7f64..1e7, count in 1usize..200, place in 0usize..2000,
        ) {
            let at = DVec3::new(x, y, 50.0);
            prop_assume!(at.truncate().length() > 200.0);
            let clean = ground(at);
            let expected = found(&clean);
            let mut points = clean.clone();
            points.splice(place..place, vec![DVec3::ZERO; count]);
            let missing = found(&points);
            prop_assert_eq!(missing.bounds, expected.bounds);
            prop_assert_eq!(missing.indices.len(), count);
            let mut positions = Positions::F64(points.iter().map(glam::DVec3::to_array).collect());
            make_holes(&mut positions, &missing.indices);
            prop_assert_eq!(positions.finite_bounds().1, expected.bounds);
        }
    }
}
