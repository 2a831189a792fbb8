//! Antialiasing by supersampling: the image shown, from several drawn pixels for each.

mod cpu;
#[cfg(feature = "gpu")]
mod gpu;

use super::effect::{Effect, OnCpu, Stage};
use crate::scene::Antialiasing;

/// Means of pixels.
pub(super) const EFFECT: Effect = Effect {
    stage: Stage::Shown,
    is_on: |packet| packet.style.drawing.antialiasing == Antialiasing::Supersample,
    #[cfg(feature = "gpu")]
    passes: &[&gpu::PASS],
    on_cpu: OnCpu::Shown(cpu::average),
};
