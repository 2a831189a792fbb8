//! Axis-aligned bounding boxes in the f32 space of one frame.

use fearless_simd::{Level, dispatch};
use glam::Vec3;
use rayon::prelude::*;

/// An axis-aligned box; empty when any `min` exceeds its `max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

/// Points that are worth handing to another thread.
const POINTS_PER_TASK: usize = 1 << 14;

impl Aabb {
    /// The box of nothing: growing it by a point gives that point.
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The smallest box around finite `points`; [`Aabb::EMPTY`] for none.
    pub fn from_points(points: &[Vec3]) -> Self {
        let parts = points.par_chunks(POINTS_PER_TASK).map(Self::of_some);
        parts.reduce(|| Self::EMPTY, |a, b| a.union(&b))
    }

    fn of_some(points: &[Vec3]) -> Self {
        dispatch!(Level::new(), _simd => Self::of_some_in_lanes(points))
    }

    /// Eight boxes, each around every eighth point, and their union: coordinates are compared as they are in memory.
    #[inline(always)]
    fn of_some_in_lanes(points: &[Vec3]) -> Self {
        const LANES: usize = 24;
        let (rows, rest) = bytemuck::cast_slice::<_, f32>(points).as_chunks::<LANES>();
        let mut min = [f32::INFINITY; LANES];
        let mut max = [f32::NEG_INFINITY; LANES];
        for row in rows {
            // Comparisons that compile to one instruction: no coordinate is NaN.
            for (least, &new) in min.iter_mut().zip(row) {
                *least = if new < *least { new } else { *least };
            }
            for (most, &new) in max.iter_mut().zip(row) {
                *most = if new > *most { new } else { *most };
            }
        }
        for (lane, &new) in rest.iter().enumerate() {
            min[lane] = min[lane].min(new);
            max[lane] = max[lane].max(new);
        }
        let boxes = min.as_chunks::<3>().0.iter().zip(max.as_chunks::<3>().0);
        boxes.fold(Self::EMPTY, |aabb, (&min, &max)| {
            let (min, max) = (Vec3::from_array(min), Vec3::from_array(max));
            aabb.union(&Self { min, max })
        })
    }

    /// True when no point is inside.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Returns the centre; the origin for an empty box.
    pub fn center(&self) -> Vec3 {
        if self.is_empty() {
            Vec3::ZERO
        } else {
            // Halved before adding, so that boxes near f32::MAX do not overflow.
            self.min * 0.5 + self.max * 0.5
        }
    }

    /// Edge lengths; zero for an empty box.
    pub fn extent(&self) -> Vec3 {
        if self.is_empty() {
            Vec3::ZERO
        } else {
            self.max - self.min
        }
    }

    /// Returns true if the bounding box is much wider than high along Z, as for a street, a room or a survey.
    pub fn is_flat_along_z(&self) -> bool {
        const FLAT: f32 = 3.0;
        let extent = self.extent();
        extent.z * FLAT < extent.x.min(extent.y)
    }

    /// Half the diagonal: the radius of the bounding sphere around [`Aabb::center`].
    pub fn radius(&self) -> f32 {
        0.5 * self.extent().length()
    }
}
