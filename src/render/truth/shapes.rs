//! Shapes with a formula, met by rays exactly.
//!
//! How it works: sphere, cube and saddle are solved in closed form. Along the torus a ray proceeds by its distance to
//! it, which never passes the surface (sphere tracing, Hart 1996), until the step is lost in rounding.

use super::rays::{Hit, SampleGrid, TruthView, Visible, unit_color};
use crate::sequence::Shape;
use glam::{DVec2, DVec3};

/// A shape to be met by rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RayTraced {
    /// Shape to trace.
    pub shape: Shape,
    /// True if back faces are culled; closed shapes are the same with and without.
    pub cull_back_faces: bool,
}

/// A shape with the tolerance of its depths.
pub(super) struct Traced {
    pub(super) shape: RayTraced,
    pub(super) tolerance: f64,
}

impl Visible for Traced {
    fn meet(&self, view: &TruthView, samples: &SampleGrid) -> Vec<Option<Hit>> {
        let [columns, rows] = samples.size();
        let frame_from_view = view.view_from_frame.transpose();
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        places
            .map(|(column, row)| {
                let ray = view.ray(samples.place_px(column, row));
                let direction = frame_from_view * ray;
                let depth = self.shape.depth(view.eye, direction)?;
                let position = view.eye + direction * depth;
                let normal = self.shape.shape.normal_at(position);
                let color = unit_color(Shape::color_at(position));
                Some(Hit {
                    depth,
                    color: view.lit(color, view.view_from_frame * normal, ray),
                    tolerance: self.tolerance,
                })
            })
            .collect()
    }
}

impl RayTraced {
    /// Returns the ray parameter of the visible intersection with the shape, as a multiple of `direction` from `eye`.
    pub(super) fn depth(self, eye: DVec3, direction: DVec3) -> Option<f64> {
        let is_seen = |depth: &f64| {
            let position = eye + direction * *depth;
            let faces_away = self.shape.normal_at(position).dot(direction) > 0.0;
            *depth > 0.0 && self.shape.is_within(position) && !(self.cull_back_faces && faces_away)
        };
        match self.shape {
            Shape::Sphere => {
                let [a, b] = [direction.length_squared(), eye.dot(direction)];
                roots([a, 2.0 * b, eye.length_squared() - 1.0]).find(is_seen)
            }
            Shape::Cube => {
                let planes = [-1.0, 1.0].map(|side| (DVec3::splat(side) - eye) / direction);
                let mut depths: [f64; 6] = std::array::from_fn(|face| planes[face / 3][face % 3]);
                depths.sort_by(f64::total_cmp);
                depths.into_iter().find(is_seen)
            }
            // x² − y² − z = 0.
            Shape::Saddle => roots([
                direction.x * direction.x - direction.y * direction.y,
                2.0 * (eye.x * direction.x - eye.y * direction.y) - direction.z,
                eye.x * eye.x - eye.y * eye.y - eye.z,
            ])
            .find(is_seen),
            Shape::Torus => trace(eye, direction, |position| {
                let across = DVec2::new(position.truncate().length() - 1.0, position.z);
                across.length() - f64::from(Shape::TUBE)
            })
            .filter(is_seen),
        }
    }
}

/// Returns the roots of the quadratic `c[0] x² + c[1] x + c[2]`, in order. Precondition: not all are 0.
fn roots([a, b, c]: [f64; 3]) -> impl Iterator<Item = f64> {
    let discriminant = b * b - 4.0 * a * c;
    // Both terms have the same sign, so that no digits cancel.
    let q = -0.5 * (b + discriminant.max(0.0).sqrt().copysign(b));
    let mut roots = [c / q, q / a];
    roots.sort_by(f64::total_cmp);
    let is_real = discriminant >= 0.0;
    roots.into_iter().filter(move |root| is_real && root.is_finite())
}

/// Returns the ray parameter, as a multiple of `direction` from `eye` (outside), at which `distance` from a surface
/// within 2 of the origin is 0.
fn trace(eye: DVec3, direction: DVec3, distance: impl Fn(DVec3) -> f64) -> Option<f64> {
    const MAX_STEPS: usize = 4096;
    let length = direction.length();
    let ahead = -eye.dot(direction) / (length * length);
    let mut depth = (ahead - 2.0 / length).max(0.0);
    let last = ahead + 2.0 / length;
    for _ in 0..MAX_STEPS {
        let apart = distance(eye + direction * depth);
        if apart <= 1e-13 {
            return Some(depth);
        }
        depth += apart / length;
        if depth > last {
            return None;
        }
    }
    None
}
