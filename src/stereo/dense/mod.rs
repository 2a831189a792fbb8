//! Dense multi-view stereo: depths of each view, retained where views agree, as one cloud or surface. Depends on
//! `matching` and `views`.

pub(super) mod all_views;
pub(super) mod cloud;
pub(super) mod consistency;
pub(super) mod pairwise;
pub(super) mod plane_sweep;
pub(super) mod surface;
