//! Axis-aligned bounding boxes in the f32 space of one frame.

use glam::Vec3;

/// An axis-aligned box; empty when any `min` exceeds its `max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box of nothing: growing it by a point gives that point.
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The smallest box around finite `points`; [`Aabb::EMPTY`] for none.
    pub fn from_points(points: &[Vec3]) -> Self {
        points.iter().fold(Self::EMPTY, |aabb, &point| Self {
            min: aabb.min.min(point),
            max: aabb.max.max(point),
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

    /// The middle; the origin for an empty box.
    pub fn center(&self) -> Vec3 {
        if self.is_empty() {
            Vec3::ZERO
        } else {
            // Halved before it is added, so that boxes near f32::MAX do not overflow.
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

    /// Half the diagonal: the radius of the bounding sphere around [`Aabb::center`].
    pub fn radius(&self) -> f32 {
        0.5 * self.extent().length()
    }
}
