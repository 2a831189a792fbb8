//! Geometry that knows nothing of clouds: boxes, view frusta, Morton codes, eigenvectors.

mod aabb;
mod frustum;
pub mod morton;
mod morton_sort;
mod symmetric_eigen;

pub use aabb::Aabb;
pub use frustum::{Containment, Frustum};
pub use morton_sort::{SortedCodes, sort_codes};
pub use symmetric_eigen::{SymmetricEigen, SymmetricMat3};
