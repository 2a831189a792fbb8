//! Depth scale estimation: the number of units per metre, estimated from the depth values when no file states it.
//!
//! *Evidence.* Depth cameras measure rooms: half of their pixels are 0.3 to 6 m away, and next to none farther than 12
//! m. Values that are millimetres times five are all multiples of five, which measurements never are by chance (TUM and
//! those that follow it write 5000 units per metre out of millimetres). Depths of more than that (0 and 65535 are not
//! measurements) decide between millimetres and 5000; the other units in use are named, as they cannot be
//! distinguished.

use crate::assumption::{Assumption, Evidence, Subject};
use crate::rgbd::is_measured;

/// Plausible range of the median depth in a room, in metres.
const MEDIAN_M: std::ops::RangeInclusive<f64> = 0.3..=6.0;

/// Depth in metres that 99 % of the values are below.
const FAR_M: f64 = 12.0;

/// Units per metre that are chosen from, the more common first.
const CHOSEN: [f64; 2] = [MILLIMETRES, FIFTHS];
const MILLIMETRES: f64 = 1000.0;
const FIFTHS: f64 = 5000.0;

/// Units in use, which are named as alternatives.
const KNOWN: [f64; 6] = [1000.0, 256.0, 4000.0, 5000.0, 6553.5, 10_000.0];

/// Share of multiples above which numbers are multiples.
const ALL: f64 = 0.98;

/// Distinct numbers below which their multiples are inconclusive.
const MIN_DISTINCT: usize = 64;

/// Origin of a recording's depth units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Units {
    /// The format states it, or its code has no others.
    Certain,
    /// Recordings of this kind have them, unless the numbers speak against it.
    Usual(&'static str),
    /// Nothing states it.
    Unknown,
}

/// Units per metre, and why.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DepthScale {
    pub(super) units_per_metre: f64,
    evidence: Evidence,
    why: String,
}

impl DepthScale {
    /// As an assumption.
    pub(super) fn assumption(&self) -> Assumption {
        let value = format!("{} units per metre", self.units_per_metre);
        Assumption::new(Subject::DepthScale, value, self.why.clone(), self.evidence)
    }

    /// Estimates the scale of integer depths, by default `usual` units per metre; `None` if nothing was measured.
    pub(super) fn of_numbers(numbers: &[u16], usual: f64, units: Units) -> Option<Self> {
        let mut numbers: Vec<u16> = numbers.iter().copied().filter(|&number| is_measured(number)).collect();
        numbers.sort_unstable();
        let depths = Depths::of(&numbers)?;
        let said = |units_per_metre: f64, evidence: Evidence, reason: &str| {
            let near = depths.quantiles[0] / units_per_metre;
            let far = depths.quantiles[2] / units_per_metre;
            let others = depths.alternatives(units_per_metre);
            Self {
                units_per_metre,
                evidence,
                why: format!("{reason}: most depths are {near:.2} to {far:.2} m; {others}"),
            }
        };
        if let Units::Usual(kind) = units
            && (depths.is_room(usual) || !CHOSEN.iter().any(|&other| depths.is_room(other)))
        {
            return Some(Self {
                units_per_metre: usual,
                evidence: Evidence::Convention,
                why: format!("recordings of {kind} have it"),
            });
        }
        if are_fifths(&numbers) && depths.is_room(FIFTHS) {
            return Some(said(FIFTHS, Evidence::Statistics, "all depths are multiples of 5"));
        }
        let rooms: Vec<f64> = CHOSEN.into_iter().filter(|&other| depths.is_room(other)).collect();
        Some(match rooms.as_slice() {
            [] => said(usual, Evidence::Fallback, "the depths are those of no room"),
            // Rarer units in use may make a room as well: the numbers do not decide.
            [only] => said(*only, Evidence::Fallback, "of 1000 and 5000 it alone makes a room"),
            [first, ..] => said(
                *first,
                Evidence::Fallback,
                "no file says it, and millimetres are the most common",
            ),
        })
    }

    /// Estimates the scale of float depths, which are metres unless those would be farther than any depth camera sees:
    /// then millimetres.
    pub(super) fn of_floats(floats: &[f32]) -> Option<Self> {
        let mut depths: Vec<f32> = floats
            .iter()
            .copied()
            .filter(|depth| depth.is_finite() && *depth > 0.0)
            .collect();
        depths.sort_unstable_by(f32::total_cmp);
        let median = f64::from(*depths.get(depths.len() / 2)?);
        let are_millimetres = median > 100.0 && MEDIAN_M.contains(&(median / MILLIMETRES));
        let (units_per_metre, evidence, why) = if are_millimetres {
            let why = format!("half of the depths are below {median:.0}, too far for a room if in metres");
            (MILLIMETRES, Evidence::Statistics, why)
        } else if median > FAR_M {
            let why = format!(
                "depths in floats are metres, and half of these are nearer than {median:.1}: 100 a metre would make \
                 that {:.2} m, 1000 a metre {:.3} m",
                median / 100.0,
                median / MILLIMETRES
            );
            (1.0, Evidence::Fallback, why)
        } else {
            (1.0, Evidence::Convention, "depths in floats are metres".to_owned())
        };
        Some(Self {
            units_per_metre,
            evidence,
            why,
        })
    }
}

/// Quantiles of depths, in their units.
struct Depths {
    /// 5 %, half, 95 % and 99 %.
    quantiles: [f64; 4],
}

impl Depths {
    /// Precondition: `numbers` ascend.
    fn of(numbers: &[u16]) -> Option<Self> {
        let last = numbers.len().checked_sub(1)?;
        let at = |share: f64| f64::from(numbers[(share * last as f64) as usize]);
        Some(Self {
            quantiles: [0.05, 0.5, 0.95, 0.99].map(at),
        })
    }

    /// Returns true if the depths are plausible for a room in these units.
    fn is_room(&self, units_per_metre: f64) -> bool {
        MEDIAN_M.contains(&(self.quantiles[1] / units_per_metre)) && self.quantiles[3] / units_per_metre <= FAR_M
    }

    /// Other units in which they would be a room.
    fn alternatives(&self, chosen: f64) -> String {
        let others = KNOWN
            .into_iter()
            .filter(|&other| other != chosen && self.is_room(other));
        let others: Vec<String> = others
            .map(|other| {
                format!(
                    "{other} would make half of them nearer than {:.2} m",
                    self.quantiles[1] / other
                )
            })
            .collect();
        if others.is_empty() {
            "no other unit in use makes a room".to_owned()
        } else {
            others.join(", ")
        }
    }
}

/// Returns true if the values are multiples of five, and not of coarser steps. Precondition: `numbers` ascend.
fn are_fifths(numbers: &[u16]) -> bool {
    let distinct = numbers.chunk_by(|one, other| one == other).count();
    let share = |step: u16| {
        let multiples = numbers.iter().filter(|number| number.is_multiple_of(step)).count();
        multiples as f64 / numbers.len().max(1) as f64
    };
    distinct >= MIN_DISTINCT && share(5) >= ALL && share(10) < ALL
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wall that leaves the camera, in units.
    fn wall(near_m: f64, far_m: f64, units_per_metre: f64) -> Vec<u16> {
        let depth = |at: u32| near_m + (far_m - near_m) * f64::from(at) / 9999.0;
        let mut numbers: Vec<u16> = (0..10_000)
            .map(|at| (depth(at) * units_per_metre).round() as u16)
            .collect();
        numbers.extend([0; 500]);
        numbers.extend([u16::MAX; 500]);
        numbers
    }

    fn found(numbers: &[u16]) -> (f64, Evidence) {
        let found = DepthScale::of_numbers(numbers, 1000.0, Units::Unknown).unwrap();
        (found.units_per_metre, found.evidence)
    }

    #[test]
    fn millimetres_and_fifths_of_millimetres_are_distinguished() {
        for (near_m, far_m) in [(0.5, 1.2), (0.8, 4.0), (1.0, 3.0), (2.0, 5.0), (0.4, 8.0)] {
            assert_eq!(found(&wall(near_m, far_m, 1000.0)).0, 1000.0, "{near_m} to {far_m} m");
            let fifths: Vec<u16> = wall(near_m, far_m, 1000.0)
                .into_iter()
                .map(|mm| if is_measured(mm) { 5 * mm } else { mm })
                .collect();
            assert_eq!(found(&fifths), (5000.0, Evidence::Statistics), "{near_m} to {far_m} m");
        }
        // Rendered depths are not multiples, but larger than a room in millimetres would be.
        assert_eq!(found(&wall(1.0, 4.0, 5000.0)), (5000.0, Evidence::Fallback));
    }

    #[test]
    fn a_guess_names_the_alternatives() {
        let scale = DepthScale::of_numbers(&wall(1.0, 3.0, 1000.0), 1000.0, Units::Unknown).unwrap();
        assert_eq!(scale.evidence, Evidence::Fallback);
        let line = scale.assumption().to_string();
        assert!(
            line.contains("5000 would make half of them nearer than 0.40 m"),
            "{line}"
        );
        assert!(line.contains("--depth-scale"), "{line}");
        let kitti = DepthScale::of_numbers(&wall(1.4, 3.2, 256.0), 1000.0, Units::Unknown).unwrap();
        let line = kitti.assumption().to_string();
        assert!(line.contains("256 would make") && line.contains("fallback"), "{line}");
    }

    #[test]
    fn a_format_convention_applies_unless_the_depths_are_implausible() {
        let usual = Units::Usual("TUM");
        let tum = DepthScale::of_numbers(&wall(0.8, 4.0, 5000.0), 5000.0, usual).unwrap();
        assert_eq!((tum.units_per_metre, tum.evidence), (5000.0, Evidence::Convention));
        let millimetres = DepthScale::of_numbers(&wall(0.5, 2.0, 1000.0), 5000.0, usual).unwrap();
        assert_eq!(
            (millimetres.units_per_metre, millimetres.evidence),
            (1000.0, Evidence::Fallback)
        );
        let street = DepthScale::of_numbers(&wall(5.0, 60.0, 1000.0), 1000.0, usual).unwrap();
        assert_eq!(
            (street.units_per_metre, street.evidence),
            (1000.0, Evidence::Convention)
        );
        assert_eq!(DepthScale::of_numbers(&[0, 65535], 1000.0, Units::Unknown), None);
    }

    #[test]
    fn floats_are_metres_or_millimetres() {
        let of = |median: f32| DepthScale::of_floats(&[f32::NAN, 0.0, 0.5 * median, median, 2.0 * median]).unwrap();
        for (median, expected) in [(1.5, 1.0), (40.0, 1.0), (1500.0, 1000.0), (50_000.0, 1.0)] {
            assert_eq!(of(median).units_per_metre, expected, "{median}");
        }
        assert_eq!(
            (of(1.5).evidence, of(200.0).evidence),
            (Evidence::Convention, Evidence::Fallback)
        );
        assert!(
            of(200.0).why.contains("100 a metre would make that 2.00 m"),
            "centimetres"
        );
    }
}
