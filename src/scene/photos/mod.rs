//! View-dependent texturing: camera positions of the posed images, and the depth maps of their scenes.

pub(super) mod photo_depths;
pub(super) mod photo_views;
pub(super) mod photos_in_frame;
