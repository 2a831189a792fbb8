//! Geometry that knows nothing of clouds: boxes, spheres, frusta, Morton codes, the cube they divide, eigenvectors.

mod aabb;
mod cube;
pub(crate) mod few_codes;
mod frustum;
mod items;
mod lattice;
pub mod morton;
pub(crate) mod morton_sort;
mod sphere;
mod symmetric_eigen;

pub use aabb::Aabb;
pub use cube::Cube;
pub use frustum::{Containment, Frustum};
pub use lattice::Lattice;
pub use morton_sort::order_of_codes;
pub use sphere::Sphere;
pub use symmetric_eigen::{SymmetricEigen, SymmetricMat3};
