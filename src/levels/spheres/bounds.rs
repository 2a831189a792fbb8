//! Spheres and cones that are nested, whatever was rounded.
//!
//! A sphere or a cone that was rounded outwards may reach beyond its parent. The parent's, which holds all
//! points below as well, then replaces it. So bounds are nested exactly, and decoding from the root down gives the same
//! ones.

use super::cone::Cone;
use crate::math::Sphere;

/// Bounds of the positions and of the normals of the points below a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    /// Inside the parent's.
    pub(super) sphere: Sphere,
    /// Inside the parent's.
    pub(super) cone: Cone,
    /// Maximum distance of the points below from the centre of the splat drawn for the node; not larger than the
    /// parent's.
    pub(super) radius: f32,
}

impl Bounds {
    /// Returns the nested bounds of a child with this sphere, which is no larger, this cone, and points at this
    /// distance from its centre.
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
