//! Photographs with their cameras: rectification, places in the world. Knows of matching only its result.

pub(super) mod pair;
pub(super) mod places;
pub(super) mod rectify;
pub(super) mod view;
