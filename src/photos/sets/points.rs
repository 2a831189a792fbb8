//! Sparse points of a reconstruction, and the pixels at which images observed them.
//!
//! Tracks are one flat array with a start index for each point: a million points with six observations each are two
//! allocations and not a million.

use glam::{DVec3, Vec2, Vec3};

/// Observation of a point at a pixel of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Index of the image.
    pub photo: u32,
    /// Pixel position of the observation; centres of pixels are at integers.
    pub pixel: Vec2,
}

/// Points with colours, and with the observations that they were made of where a format has them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SparsePoints {
    positions: Vec<DVec3>,
    colors: Vec<[u8; 3]>,
    normals: Vec<Vec3>,
    observations: Vec<Observation>,
    /// End index of the observations of each point.
    track_ends: Vec<usize>,
    /// Points that were nowhere.
    skipped: usize,
}

impl SparsePoints {
    /// Adds a point. One that is nowhere, with a coordinate that is not finite, is skipped and counted.
    pub fn push(&mut self, position: DVec3, color: [u8; 3], track: impl IntoIterator<Item = Observation>) {
        if !position.is_finite() {
            self.skipped += 1;
            return;
        }
        self.positions.push(position);
        self.colors.push(color);
        self.observations.extend(track);
        self.track_ends.push(self.observations.len());
    }

    /// Gives each point a normal of length 1 in the world. Refused, by `false`, if their number differs from that of
    /// the points.
    #[must_use]
    pub fn set_normals(&mut self, normals: Vec<Vec3>) -> bool {
        let is_one_each = normals.len() == self.len();
        if is_one_each {
            self.normals = normals;
        }
        is_one_each
    }

    /// Number of points that were skipped, as they were nowhere.
    pub fn skipped(&self) -> usize {
        self.skipped
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Returns true if there are no points.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Positions in the world.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Red, green and blue, one per point.
    pub fn colors(&self) -> &[[u8; 3]] {
        &self.colors
    }

    /// Normals of length 1 in the world, one per point, where they are known.
    pub fn normals(&self) -> Option<&[Vec3]> {
        (!self.normals.is_empty()).then_some(&self.normals)
    }

    /// The pixels that show the point; none for a point that does not exist.
    pub fn track(&self, point: usize) -> &[Observation] {
        let Some(&end) = self.track_ends.get(point) else {
            return &[];
        };
        let start = point.checked_sub(1).map_or(0, |before| self.track_ends[before]);
        &self.observations[start..end]
    }

    /// All observations, in the order of their points.
    pub fn observations(&self) -> &[Observation] {
        &self.observations
    }

    /// At most `max` of the points, evenly taken, without their tracks and normals.
    #[must_use]
    pub(in crate::photos) fn some(&self, max: usize) -> Self {
        let every = self.len().div_ceil(max.max(1)).max(1);
        let mut some = Self::default();
        for (&position, &color) in self.positions.iter().zip(&self.colors).step_by(every) {
            some.push(position, color, []);
        }
        some
    }

    /// Returns the points with each observation mapped by `change`; `None` removes it from its track.
    #[must_use]
    pub(in crate::photos) fn with_observations(mut self, change: impl Fn(Observation) -> Option<Observation>) -> Self {
        let mut observations = Vec::with_capacity(self.observations.len());
        let mut start = 0;
        for end in &mut self.track_ends {
            observations.extend(self.observations[start..*end].iter().copied().filter_map(&change));
            start = std::mem::replace(end, observations.len());
        }
        self.observations = observations;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(photo: u32) -> Observation {
        Observation {
            photo,
            pixel: Vec2::splat(photo as f32),
        }
    }

    #[test]
    fn each_point_has_a_separate_track() {
        let mut points = SparsePoints::default();
        points.push(DVec3::X, [1; 3], [seen(0), seen(2)]);
        points.push(DVec3::Y, [2; 3], []);
        points.push(DVec3::Z, [3; 3], [seen(1)]);
        assert_eq!(points.track(0), [seen(0), seen(2)]);
        assert_eq!(points.track(1), []);
        assert_eq!(points.track(2), [seen(1)]);
        assert_eq!(points.track(3), []);
        assert!(!points.set_normals(vec![Vec3::Z]) && points.normals().is_none());
        assert!(points.set_normals(vec![Vec3::Z; 3]) && points.normals().is_some());
    }

    #[test]
    fn points_are_sampled_evenly_without_tracks() {
        let mut points = SparsePoints::default();
        for at in 0..10 {
            points.push(f64::from(at) * DVec3::X, [at as u8; 3], [seen(0)]);
        }
        let some = points.some(4);
        let places: Vec<f64> = some.positions().iter().map(|place| place.x).collect();
        assert_eq!(places, [0.0, 3.0, 6.0, 9.0]);
        assert_eq!(some.colors()[1], [3; 3]);
        assert!(some.observations().is_empty());
        assert_eq!(points.some(100).len(), 10);
        assert_eq!(points.some(0).len(), 1);
    }

    #[test]
    fn excluded_photos_are_removed_from_tracks() {
        let mut points = SparsePoints::default();
        points.push(DVec3::X, [1; 3], [seen(0), seen(2), seen(9)]);
        points.push(DVec3::Y, [2; 3], [seen(1)]);
        let positions = points.positions().to_vec();
        let retained = points.with_observations(|seen| {
            let photo = (*[Some(1), None, Some(0)].get(seen.photo as usize)?)?;
            Some(Observation { photo, ..seen })
        });
        let photos = |point| retained.track(point).iter().map(|seen| seen.photo).collect::<Vec<_>>();
        assert_eq!((photos(0), photos(1)), (vec![1, 0], vec![]));
        assert_eq!(retained.positions(), positions);
    }
}
