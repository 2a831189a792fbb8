//! Upper limits of images and videos.

/// Longest edge of a picture.
pub const MAX_EDGE_PX: u32 = 65_536;

/// Most pictures of a video: nine hours at 30 a second.
pub(super) const MAX_PICTURES: usize = 1_000_000;
