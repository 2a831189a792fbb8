//! Posed images with their cameras: rectification, triangulation of world positions. Of matching, only the result is
//! used here.

pub(super) mod pair;
pub(super) mod places;
pub(super) mod rectify;
pub(super) mod view;
