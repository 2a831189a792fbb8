//! Screen-space effects as settings decide them, in pixels of the image: ambient occlusion, eye-dome lighting, closed
//! gaps, halos, splat edges.

pub(super) mod ambient_occlusion;
pub(super) mod eye_dome;
pub(super) mod gaps;
pub(super) mod halo;
pub(super) mod rims;
