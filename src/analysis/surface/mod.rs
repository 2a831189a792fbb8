//! The surface around each point, from the neighbours that `search` finds: normals, their orientation, radii, ellipses.
//! Knows no colours.

#[cfg(test)]
pub(super) mod block_tests;
pub(super) mod blocks;
pub(super) mod curved_splats;
pub(super) mod directions;
pub(super) mod ellipses;
pub(super) mod file_surface;
pub(super) mod four_matrices;
pub(super) mod holes;
pub(super) mod noise;
#[cfg(test)]
pub(super) mod noise_tests;
pub(super) mod normals;
pub(super) mod options;
pub(super) mod orientation;
pub(super) mod outlier;
#[cfg(test)]
pub(super) mod plane_tests;
pub(super) mod radii;
pub(super) mod robust_planes;
pub(super) mod smoothing;
pub(super) mod steps;
pub(super) mod wide_planes;
