//! Visible points of an image, surfels made of them, the point under a pixel.

pub(super) mod pick;
pub(super) mod point_size;
pub(super) mod screen_surfels;
pub(super) mod visible_points;
