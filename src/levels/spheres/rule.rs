//! Selection rule by screen-space error for the nodes that represent the points below them: the metric of Sainz and
//! Pajarola 2004 §4.1.
//!
//! A node covers `ε = f·A/d²` on the screen, where `A = πr²`, r is the maximum distance of the points below from its
//! centre, `d` is the distance from the eye to the nearest point of its sphere, and `f = cos max(γ − θ − β, 0)` is the
//! visible fraction of the disk: γ is the angle between its normal and the direction to the eye, θ the half angle of
//! its normal cone, and `sin β` is the radius of the sphere over the distance, which allows for the points away from
//! its centre. A node is *small* if ε is at most the square of the LOD threshold, so that a threshold means a length in
//! pixels whatever the metric. With edges instead ([`LodMetric::Edge`]), f is 1 and the square of the edge of the cube
//! in a sphere with the radius r replaces A.
//!
//! As bounds are nested (`bounds.rs`), nothing grows from parent to child: below a small node all are small, below one
//! that is outside the frustum or faces away all are, too. So the result of a traversal from the root can be decided
//! per node, from itself and its parent alone: the nodes that are drawn are those that are small, or leaves, while
//! their parents are not.

use super::bounds::Bounds;
use crate::levels::cut::{CutHints, LodMetric, SelectView};
use glam::{DVec3, DVec4, Vec4};

/// Result for a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NodeClass {
    /// Nothing of it can be seen.
    Dropped,
    /// It is drawn, if its parent is divided.
    Small,
    /// Its children are tested.
    Divided,
}

/// Selection rule, in f64: for f32 inputs, rounding then changes nothing that bounds distinguish.
#[derive(Debug)]
pub(super) struct Rule {
    eye: DVec3,
    planes: [DVec4; crate::math::Frustum::PLANES],
    /// A of a disk with a radius of 1 at a distance of 1, px².
    area_px2: f64,
    is_oriented: bool,
    culls_back_faces: bool,
    threshold_px2: f64,
    /// Fraction of the threshold within which the previous view decides.
    band: f64,
    deepest_level: u32,
}

/// All that decides in a view. A single float there is one here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RuleNumbers {
    /// Eye position that distances are measured from.
    pub eye: [f32; 3],
    /// Planes of the frustum.
    pub planes: [[f32; 4]; crate::math::Frustum::PLANES],
    /// A of a disk with a radius of 1 at a distance of 1, px².
    pub area_px2: f64,
    /// The largest ε of a small node, px².
    pub small_px2: f64,
    /// True if normals determine the visible fraction of a disk.
    pub is_oriented: bool,
    /// True if back-facing nodes are culled.
    pub culls_back_faces: bool,
    /// Nodes of this level are not divided.
    pub deepest_level: u32,
}

/// Hysteresis: relative amount by which a node must be larger or smaller than the threshold to change sides.
pub(super) const HYSTERESIS: f64 = 0.1;

impl Rule {
    pub(super) fn new(view: &SelectView, hints: &CutHints<'_>) -> Self {
        Self {
            eye: view.eye.as_dvec3(),
            planes: view.frustum.planes().map(Vec4::as_dvec4),
            area_px2: std::f64::consts::PI * f64::from(view.pixels_per_unit_at_1).powi(2),
            is_oriented: view.metric == LodMetric::Area,
            culls_back_faces: hints.culls_back_faces,
            threshold_px2: f64::from(view.metric.root_area_px(view.lod_px).max(0.0)).powi(2),
            band: if hints.before.is_some() { HYSTERESIS } else { 0.0 },
            deepest_level: view.deepest_level,
        }
    }

    /// Returns the parameters that decide without a previous view, for evaluation elsewhere.
    pub(super) fn numbers(&self) -> RuleNumbers {
        RuleNumbers {
            eye: self.eye.as_vec3().to_array(),
            planes: self.planes.map(|plane| plane.as_vec4().to_array()),
            area_px2: self.area_px2,
            small_px2: self.threshold_px2,
            is_oriented: self.is_oriented,
            culls_back_faces: self.culls_back_faces,
            deepest_level: if self.deepest_level < SelectView::ALL_LEVELS {
                self.deepest_level
            } else {
                u32::MAX
            },
        }
    }

    /// Returns the result for a node that is not a leaf. `was_divided` returns whether the previous view divided it.
    pub(super) fn node_class(&self, bounds: &Bounds, level: u32, was_divided: impl FnOnce() -> bool) -> NodeClass {
        let seen_share = self.seen_share(bounds);
        if self.is_dropped(bounds, seen_share) {
            return NodeClass::Dropped;
        }
        let size_px2 = self.size_px2(bounds, seen_share);
        if self.is_small(size_px2, was_divided) || self.ends_at(level) {
            NodeClass::Small
        } else {
            NodeClass::Divided
        }
    }

    /// Returns true if a node is culled because nothing of it can be visible: frustum culling and back-face culling.
    pub(super) fn drops(&self, bounds: &Bounds) -> bool {
        self.is_dropped(bounds, self.seen_share(bounds))
    }

    fn is_dropped(&self, bounds: &Bounds, seen_share: f64) -> bool {
        self.culls_back_faces && seen_share <= 0.0 || self.is_outside(bounds)
    }

    /// Nodes below this one are small if their radius is at most so much; negative where none needs to be.
    ///
    /// Nested bounds are not nearer and not more of them is seen, so nothing but their radius can make them larger.
    pub(super) fn small_radius_below(&self, bounds: &Bounds) -> f64 {
        let size_px2 = self.size_px2(bounds, self.seen_share(bounds));
        let small_px2 = self.threshold_px2 * (1.0 - self.band).powi(2);
        if small_px2 == 0.0 || size_px2.is_infinite() {
            return -1.0;
        }
        f64::from(bounds.radius) * (small_px2 / size_px2).sqrt() * (1.0 - ROUNDING)
    }

    /// Returns true if nodes of this level are not divided, however large.
    pub(super) fn ends_at(&self, level: u32) -> bool {
        self.deepest_level < SelectView::ALL_LEVELS && level >= self.deepest_level
    }

    fn is_small(&self, size_px2: f64, was_divided: impl FnOnce() -> bool) -> bool {
        let share = |share: f64| share * share * self.threshold_px2;
        if self.threshold_px2 == 0.0 || size_px2 > share(1.0 + self.band) {
            return false;
        }
        size_px2 <= share(1.0 - self.band) || !was_divided()
    }

    fn is_outside(&self, bounds: &Bounds) -> bool {
        let center = bounds.sphere.center.as_dvec3();
        let mut planes = self.planes.iter();
        planes.any(|plane| plane.truncate().dot(center) + plane.w < -f64::from(bounds.sphere.radius))
    }

    /// Returns the visible fraction of its disk: f. Negative if all of it faces away, if that is dropped; otherwise the
    /// back counts the same as the front.
    fn seen_share(&self, bounds: &Bounds) -> f64 {
        if bounds.cone.is_everything() || !(self.is_oriented || self.culls_back_faces) {
            return 1.0;
        }
        let to_eye = self.eye - bounds.sphere.center.as_dvec3();
        let (distance, radius) = (to_eye.length(), f64::from(bounds.sphere.radius));
        if distance <= radius {
            return 1.0;
        }
        let cosine = bounds.cone.axis.as_dvec3().dot(to_eye) / distance;
        let gamma = if self.culls_back_faces { cosine } else { cosine.abs() };
        let theta = f64::from(bounds.cone.cosine);
        let sine_of_beta = radius / distance;
        let beta = (1.0 - sine_of_beta * sine_of_beta).sqrt();
        // Cosine and sine of θ + β, which is below 180°.
        let sine_of_theta = (1.0 - theta * theta).sqrt();
        let (allowed, sine_of_allowed) = (
            theta * beta - sine_of_theta * sine_of_beta,
            sine_of_theta * beta + theta * sine_of_beta,
        );
        if gamma >= allowed {
            return 1.0;
        }
        gamma * allowed + (1.0 - gamma * gamma).max(0.0).sqrt() * sine_of_allowed
    }

    /// ε of a node, px²; infinite where the eye is in its sphere.
    fn size_px2(&self, bounds: &Bounds, seen_share: f64) -> f64 {
        let distance = self.eye.distance(bounds.sphere.center.as_dvec3()) - f64::from(bounds.sphere.radius);
        if distance <= 0.0 {
            return f64::INFINITY;
        }
        let seen_share = if self.is_oriented { seen_share.max(0.0) } else { 1.0 };
        // The radius of the points, not of the sphere: the error of one disk drawn instead of many depends on where
        // their centres are.
        let ratio = f64::from(bounds.radius) / distance;
        seen_share * self.area_px2 * (ratio * ratio)
    }
}

/// A fraction larger than rounding errors of f64, and small enough to change nothing else.
const ROUNDING: f64 = 1e-6;
