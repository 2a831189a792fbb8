//! Distances between the points of two frames.

use crate::app::work::outcome::Message;
use crate::measure::Change;
use crate::sequence::PreparedFrame;
use glam::{DVec3, Vec3};

/// One-way distances of the points of one frame from another frame, scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneWay {
    /// Mean distance to the nearest point.
    pub mean: f64,
    /// Root of the mean of their squares.
    pub root_mean_squared: f64,
    /// The largest one.
    pub largest: f64,
}

impl Message for Option<FrameDistances> {}

/// Distances between two frames, scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameDistances {
    /// From each point of A to the nearest of B.
    pub from_a: OneWay,
    /// From each point of B to the nearest of A.
    pub from_b: OneWay,
    /// The frames, by [`PreparedFrame::id`].
    pub(super) ids: [u64; 2],
}

impl FrameDistances {
    /// The Hausdorff distance: the larger of both largest.
    pub fn hausdorff(&self) -> f64 {
        self.from_a.largest.max(self.from_b.largest)
    }
}

/// The distances of two frames; the origin of the second is `shift` away from the first one's. `None` if one has no
/// points, or if cancelled.
pub(super) fn between(
    a: &PreparedFrame,
    b: &PreparedFrame,
    shift: DVec3,
    is_wanted: impl Fn() -> bool + Sync,
) -> Option<FrameDistances> {
    let places_a = a.frame.positions();
    let moved: Vec<Vec3>;
    let places_b = if shift == DVec3::ZERO {
        b.frame.positions()
    } else {
        let move_one = |place: &Vec3| (place.as_dvec3() + shift).as_vec3();
        moved = b.frame.positions().iter().map(move_one).collect();
        &moved
    };
    let one_way = |from: &[Vec3], to: &[Vec3]| {
        let change = Change::between(from, to, &is_wanted).filter(|_| !from.is_empty())?;
        Some(OneWay {
            mean: change.mean,
            root_mean_squared: change.root_mean_squared(),
            largest: f64::from(change.largest()),
        })
    };
    Some(FrameDistances {
        from_a: one_way(places_a, places_b)?,
        from_b: one_way(places_b, places_a)?,
        ids: [a.id, b.id],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Frame, Positions, RawCloud};
    use crate::sequence::{Needs, PrepareCounters, prepare};
    use std::sync::Arc;

    /// A row of 100 points one unit apart, relative to `origin`.
    fn row(height: f64, origin: DVec3, outlier: Option<f64>) -> PreparedFrame {
        let place = |x: u32| [f64::from(x), height, 0.0];
        let mut places: Vec<[f64; 3]> = (0..100).map(place).collect();
        places.extend(outlier.map(|z| [0.0, height, z]));
        let raw = RawCloud::from_positions(Positions::F64(places));
        let frame = Arc::new(Frame::from_raw(raw, origin).unwrap());
        prepare(0, frame, 0.0, &Needs::default(), &PrepareCounters::default())
    }

    #[test]
    fn rows_with_a_known_shift_have_known_distances() {
        let a = row(0.0, DVec3::ZERO, None);
        for origin in [DVec3::ZERO, DVec3::new(64.0, -8.0, 16.0)] {
            let b = row(0.25, origin, None);
            let found = between(&a, &b, origin, || true).unwrap();
            let quarter = OneWay {
                mean: 0.25,
                root_mean_squared: 0.25,
                largest: 0.25,
            };
            assert_eq!((found.from_a, found.from_b), (quarter, quarter));
            assert_eq!(found.hausdorff(), 0.25);
        }
    }

    #[test]
    fn points_missing_from_one_sequence_are_far_in_one_direction_only() {
        let (a, b) = (row(0.0, DVec3::ZERO, None), row(0.0, DVec3::ZERO, Some(101.0)));
        let found = between(&a, &b, DVec3::ZERO, || true).unwrap();
        assert_eq!((found.from_a.mean, found.from_a.largest), (0.0, 0.0));
        assert_eq!(found.from_b.mean, 1.0, "one of 101 is 101 away");
        let expected = 101f64.sqrt();
        assert!((found.from_b.root_mean_squared - expected).abs() < 1e-12);
        assert_eq!(found.hausdorff(), 101.0);
        assert!(between(&a, &b, DVec3::ZERO, || false).is_none());
    }
}
