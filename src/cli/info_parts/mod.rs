//! Parts of the answer of `info`.

pub(super) mod camera_info;
pub(super) mod photo_info;
pub(super) mod reel_info;
