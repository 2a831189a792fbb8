//! Stages of estimating a surface, for who shows how far it is.

/// Steps a point of each stage, in proportion to its time with two threads (`benches/README.md`).
pub(super) const TREE_STEPS: usize = 4;
pub(super) const NEIGHBOURS_STEPS: usize = 6;
pub(super) const PLANES_STEPS: usize = 3;
pub(super) const RADII_STEPS: usize = 3;
/// One thread joins the neighbourhoods.
pub(super) const OUTWARDS_STEPS: usize = 32;
pub(super) const REPRESENTATIVES_STEPS: usize = 1;
