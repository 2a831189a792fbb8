//! Photographs with their cameras: grey images, rectification, places in the world. Knows nothing of matching but its
//! result.

pub(super) mod image;
pub(super) mod pair;
pub(super) mod places;
pub(super) mod rectify;
pub(super) mod view;
