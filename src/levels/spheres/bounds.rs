//! Spheres and cones that are nested, whatever was rounded.
//!
//! A sphere or a cone that was rounded outwards may reach beyond that of its parent. The parent's, which holds all
//! points below as well, then takes its place. So bounds are nested exactly, and whoever decodes them from the root
//! down finds the same ones.

use super::cone::Cone;
use crate::math::Sphere;

/// Where the points below a node are, and where they face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    /// Inside that of the parent.
    pub(super) sphere: Sphere,
    /// Inside that of the parent.
    pub(super) cone: Cone,
    /// How far from the middle of what is drawn for the node the points below are, at most; not larger than that of the
    /// parent.
    pub(super) radius: f32,
}

impl Bounds {
    /// Of a child with this sphere, which is no larger, this cone, and points as far from its middle.
    #[inline(always)]
    pub(super) fn nested(&self, sphere: Sphere, cone: Cone, radius: f32) -> Self {
        Self {
            sphere: if self.sphere.holds(&sphere) {
                sphere
            } else {
                self.sphere
            },
            cone: if cone.is_within(&self.cone) { cone } else { self.cone },
            radius: radius.min(self.radius),
        }
    }
}
