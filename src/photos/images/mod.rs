//! Input images prepared for drawing: masked, undistorted, halved, with levels and gains.

pub(super) mod budget;
pub(super) mod gains;
pub(super) mod loading;
pub(super) mod mips;
pub(super) mod photo_image;
pub(super) mod photos;
pub(super) mod prepared;
pub(super) mod shared_points;
pub(super) mod texture;
pub(super) mod undistort;
