//! What is drawn on the processor: one file or folder a primitive, with the names of `render/gpu/primitives`.

pub(super) mod coded;
pub(super) mod points;
pub(super) mod surfels;
pub(super) mod voxels;
