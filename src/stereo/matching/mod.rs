//! From two rectified images to disparities: costs, their sums, winners, filters. Knows images, and nothing of cameras.

pub(super) mod census;
pub(crate) mod constants;
pub(super) mod contrast;
pub(super) mod costs;
pub(super) mod disparity;
pub(super) mod filters;
pub(super) mod local;
pub(super) mod matcher;
pub(super) mod pyramid;
pub(super) mod range;
pub(super) mod refine;
pub(super) mod semi_global;
pub(super) mod winner;
