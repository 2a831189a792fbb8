//! Clipping, or cropping: draws only the records within a box, or on one side of a plane; or all but those.
//!
//! How it works. Records are excluded when a packet is made, by the positions of their centres, so every renderer and
//! every primitive draws the same, and undrawn records cannot be picked. Each record is tested by itself: a test costs
//! as much as finding the box around its neighbours would. Whole points are retained or clipped: a splat or a voxel
//! whose centre is inside reaches beyond the border by its radius.

use crate::cloud::{PointRecord, VoxelRecord};
use crate::math::Aabb;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Records that are worth handing to another thread.
const RECORDS_PER_TASK: usize = 1 << 14;

/// A part of space, borders included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClipShape {
    /// Between two corners; empty if a coordinate of `min` exceeds that of `max`.
    Box {
        /// Smallest corner, scene units.
        min: DVec3,
        /// Largest corner, scene units.
        max: DVec3,
    },
    /// All places `p` with `normal · p ≥ offset`.
    Plane {
        /// Towards the inside; of any length but 0.
        normal: DVec3,
        /// Plane offset along the normal, scene units if that has a length of 1.
        offset: f64,
    },
}

impl ClipShape {
    /// The box around `bounds`, which are relative to `origin`.
    pub fn around(bounds: &Aabb, origin: DVec3) -> Self {
        Self::Box {
            min: origin + bounds.min.as_dvec3(),
            max: origin + bounds.max.as_dvec3(),
        }
    }

    /// The plane through three places; `None` if they are on a line.
    pub fn through([a, b, c]: [DVec3; 3]) -> Option<Self> {
        let [u, v] = [b - a, c - a].map(DVec3::try_normalize);
        let normal = u?.cross(v?);
        // Three picked points are never exactly collinear.
        let normal = (normal.length() > 1e-6).then(|| normal.normalize())?;
        let offset = normal.dot(a);
        Some(Self::Plane { normal, offset })
    }

    /// Returns true if the shape contains a position.
    pub fn contains(&self, place: DVec3) -> bool {
        match self {
            Self::Box { min, max } => place.cmpge(*min).all() && place.cmple(*max).all(),
            Self::Plane { normal, offset } => normal.dot(place) >= *offset,
        }
    }

    fn relative_to(&self, origin: DVec3) -> Self {
        match *self {
            Self::Box { min, max } => Self::Box {
                min: min - origin,
                max: max - origin,
            },
            Self::Plane { normal, offset } => Self::Plane {
                normal,
                offset: offset - normal.dot(origin),
            },
        }
    }
}

/// Clipping of the cloud to the part that is drawn, in the coordinates of the file; in a packet relative to the origin
/// of the sequence, like everything in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clip {
    /// True if clipping is enabled.
    pub is_on: bool,
    /// Clip shape.
    pub shape: ClipShape,
    /// Draws everything outside the shape instead.
    pub keeps_outside: bool,
}

impl Clip {
    /// Draws everything inside `shape`.
    pub fn to(shape: ClipShape) -> Self {
        Self {
            is_on: true,
            shape,
            keeps_outside: false,
        }
    }

    /// Returns true if a position is not clipped, so that records there are drawn.
    pub fn keeps(&self, place: DVec3) -> bool {
        !self.is_on || self.shape.contains(place) != self.keeps_outside
    }

    /// Returns the clip for positions relative to `origin`.
    #[must_use]
    pub fn relative_to(&self, origin: DVec3) -> Self {
        Self {
            shape: self.shape.relative_to(origin),
            ..*self
        }
    }

    /// The indices of the records that are drawn, ascending.
    pub(in crate::scene) fn retained<T: HasPosition>(&self, records: &[T]) -> Vec<u32> {
        self.retained_places(records.len(), |index| records[index].place())
    }

    /// Returns the ascending indices of the records that are drawn, of `count` records whose centres are at these
    /// positions.
    pub(in crate::scene) fn retained_places(&self, count: usize, place: impl Fn(usize) -> Vec3 + Sync) -> Vec<u32> {
        let indices = (0..count as u32).into_par_iter().with_min_len(RECORDS_PER_TASK);
        indices
            .filter(|&index| self.keeps(place(index as usize).as_dvec3()))
            .collect()
    }
}

/// A record that is somewhere.
pub(in crate::scene) trait HasPosition: Sync {
    /// Returns the centre of the record, relative to the origin of the sequence.
    fn place(&self) -> Vec3;
}

impl HasPosition for PointRecord {
    fn place(&self) -> Vec3 {
        Vec3::from_array(self.position)
    }
}

impl HasPosition for VoxelRecord {
    fn place(&self) -> Vec3 {
        Vec3::from_array(self.center)
    }
}

/// The records at `indices`.
pub(in crate::scene) fn at<T: Copy + Send + Sync>(records: &[T], indices: &[u32]) -> Vec<T> {
    let indices = indices.par_iter().with_min_len(RECORDS_PER_TASK);
    indices.map(|&index| records[index as usize]).collect()
}

#[cfg(test)]
#[path = "clip_tests.rs"]
mod tests;
