//! The shadow of the key light (Williams 1978; Reeves et al. 1987), a part of deferred shading. How:
//! `scene/light/shadow.rs`.

pub(in crate::render) mod cpu;
#[cfg(feature = "gpu")]
pub(in crate::render) mod gpu;
