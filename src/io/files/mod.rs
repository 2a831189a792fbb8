//! Input files: memory limits, counted and unpacked bytes, other files that they name.

pub(super) mod budget;
pub(crate) mod long_walk;
pub(super) mod sidecars;
pub(crate) mod timestamps;
pub(super) mod unpack;
pub(super) mod utm;
pub(super) mod watched;
