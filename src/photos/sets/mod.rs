//! Calibrated photographs with their points as plain data. Knows no file format.

pub(super) mod lens;
pub(super) mod photo;
pub(super) mod points;
pub(super) mod view_set;
