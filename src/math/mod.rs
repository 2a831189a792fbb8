//! Geometry that knows nothing of clouds: boxes, view frusta, Morton codes, eigenvectors.

mod aabb;
mod frustum;

pub use aabb::Aabb;
pub use frustum::{Containment, Frustum};
