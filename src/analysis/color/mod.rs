//! Colours of points: from the file, from numbers through colour maps, of classes. Knows nothing of neighbours.

pub(super) mod classes;
pub(super) mod color_maps;
pub(super) mod color_places;
pub(super) mod color_scale;
pub(super) mod colors;
