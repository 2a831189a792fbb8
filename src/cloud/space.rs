//! The space that the frames of a sequence have in common.

use crate::math::Lattice;
use glam::DVec3;

/// Origin and cells of the frames of a sequence. A cloud by itself has an origin only.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Space {
    /// Subtracted from file coordinates, in f64, before they become f32.
    pub origin: DVec3,
    /// Cells of all octrees, relative to the origin; `None` where the cube of a cloud is fitted to it.
    pub lattice: Option<Lattice>,
}

impl From<DVec3> for Space {
    fn from(origin: DVec3) -> Self {
        Self { origin, lattice: None }
    }
}
