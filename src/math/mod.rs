//! Geometry that knows nothing of clouds: boxes, view frusta, Morton codes and the cube they divide, eigenvectors.

mod aabb;
mod cube;
pub(crate) mod few_codes;
mod frustum;
mod items;
pub mod morton;
pub(crate) mod morton_sort;
mod symmetric_eigen;

pub use aabb::Aabb;
pub use cube::Cube;
pub use frustum::{Containment, Frustum};
pub use morton_sort::order_of_codes;
pub use symmetric_eigen::{SymmetricEigen, SymmetricMat3};
