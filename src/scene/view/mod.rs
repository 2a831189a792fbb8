//! Viewpoint of the image: camera, camera path, view of a sensor, ground, text of a view.

pub(super) mod camera;
pub(super) mod ground;
mod near_plane;
pub(super) mod path;
pub(super) mod picture_plane;
pub(super) mod pinhole_view;
pub(super) mod view_text;
