//! Stages of surface estimation, for progress displays.

/// Steps a point of each stage, in proportion to its time with two threads (`benches/README.md`).
pub(in crate::analysis) const TREE_STEPS: usize = 4;
pub(in crate::analysis) const NEIGHBOURS_STEPS: usize = 6;
pub(in crate::analysis) const PLANES_STEPS: usize = 3;
pub(in crate::analysis) const RADII_STEPS: usize = 3;
/// One thread joins the neighbourhoods.
pub(in crate::analysis) const OUTWARDS_STEPS: usize = 32;
pub(in crate::analysis) const REPRESENTATIVES_STEPS: usize = 1;
