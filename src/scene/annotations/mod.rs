//! Annotations drawn over the image by its viewer: labels, legend, scale bar, lengths between places.

pub(super) mod followed;
pub(super) mod labels;
pub(super) mod legend;
pub(super) mod measurement_kind;
pub(super) mod on_screen;
pub(super) mod scale_bar;
