//! Upper limits of images and videos.

/// Max edge of an image.
pub const MAX_EDGE_PX: u32 = 65_536;

/// Max frames of a video: nine hours at 30 fps.
pub(super) const MAX_PICTURES: usize = 1_000_000;
