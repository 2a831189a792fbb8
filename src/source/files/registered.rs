//! Registration check: detects clouds that are already in one coordinate system, so that poses next to them must not
//! transform them again.
//!
//! **How it works.** SLAM programs write scans in the coordinates of the sensor or of the map, with poses next to both.
//! For two frames whose poses are well apart, the fraction of points that meet in the same cells is counted with the
//! poses and without: poses that bring the clouds together are applied, poses that take them apart are not.

use crate::cloud::{RawCloud, even_places};
use crate::io;
use crate::source::FrameEntry;
use glam::{DAffine3, DVec3, I64Vec3};
use std::collections::HashSet;
use std::fs;
use std::time::Duration;

/// Points that are compared of each frame.
const POINTS: usize = 4096;

/// Fewer points meet by chance, or do not.
const MIN_POINTS: usize = 64;

/// Larger files are not read for this, unless some of their points can be read alone.
const MAX_BYTES: u64 = 64 << 20;

/// The displacement between two compared frames, as a share of the median distance of points from their centre.
const MIN_WAY: f64 = 0.1;

/// Poses are wrong if this many more points meet without them.
const MARGIN: f64 = 0.1;

/// Returns true if the frames are already registered: they overlap better without their `poses` than with them.
pub(super) fn are_registered(entries: &[FrameEntry], poses: &[Option<DAffine3>]) -> bool {
    let compared = || {
        let first = points_of(entries.first()?)?;
        let first_pose = poses.first().copied().flatten()?;
        let way = MIN_WAY * extent(&first)?;
        let far =
            |pose: &Option<DAffine3>| pose.is_some_and(|pose| pose.translation.distance(first_pose.translation) >= way);
        let other = poses.iter().position(far)?;
        let other_pose = poses[other]?;
        let apart = other_pose.translation.distance(first_pose.translation);
        let other = points_of(&entries[other])?;
        if first.len().min(other.len()) < MIN_POINTS {
            return None;
        }
        let cell = apart / 3.0;
        let without = share_that_meets(&first, &other, cell);
        let placed = |points: &[DVec3], pose: &DAffine3| -> Vec<DVec3> {
            points.iter().map(|point| pose.transform_point3(*point)).collect()
        };
        let with = share_that_meets(&placed(&first, &first_pose), &placed(&other, &other_pose), cell);
        Some(with + MARGIN < without)
    };
    compared().unwrap_or(false)
}

fn points_of(entry: &FrameEntry) -> Option<Vec<DVec3>> {
    let sample = io::read_sample(&entry.path, POINTS, 1, Duration::from_secs(1))
        .ok()
        .flatten();
    let cloud = match sample {
        Some((cloud, _)) => cloud,
        None if fs::metadata(&entry.path).is_ok_and(|file| file.len() <= MAX_BYTES) => io::read(&entry.path).ok()?,
        None => return None,
    };
    let RawCloud { positions, .. } = cloud;
    let places = even_places(positions.len(), POINTS).into_iter();
    let points = places.map(|place| positions.get(place));
    Some(points.filter(|point| point.is_finite()).collect())
}

/// The median distance from the median point; `None` for points at one place.
fn extent(points: &[DVec3]) -> Option<f64> {
    let median = |mut values: Vec<f64>| -> Option<f64> {
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    };
    let axis = |axis: usize| median(points.iter().map(|point| point[axis]).collect());
    let centre = DVec3::new(axis(0)?, axis(1)?, axis(2)?);
    median(points.iter().map(|point| point.distance(centre)).collect()).filter(|extent| *extent > 0.0)
}

fn share_that_meets(first: &[DVec3], other: &[DVec3], cell: f64) -> f64 {
    let cell_of = |point: &DVec3| (*point / cell).floor().as_i64vec3();
    let occupied: HashSet<I64Vec3> = first.iter().map(cell_of).collect();
    let met = other.iter().filter(|point| occupied.contains(&cell_of(point))).count();
    met as f64 / other.len().max(1) as f64
}
