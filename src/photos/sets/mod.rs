//! Calibrated images with their points as plain data. Independent of any file format.

pub(super) mod lens;
pub(super) mod photo;
pub(super) mod points;
pub(super) mod view_set;
