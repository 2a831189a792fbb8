//! Photographs on surfaces: where they were taken from, how far away what each shows is.

pub(super) mod photo_depths;
pub(super) mod photo_views;
pub(super) mod photographs_in_frame;
