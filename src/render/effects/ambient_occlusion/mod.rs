//! Ambient occlusion (Loos and Sloan 2010), a part of deferred shading. The formula:
//! `scene/effects/ambient_occlusion.rs`.

pub(in crate::render) mod cpu;
#[cfg(feature = "gpu")]
pub(in crate::render) mod gpu;
