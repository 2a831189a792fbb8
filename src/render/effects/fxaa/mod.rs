//! Fast approximate antialiasing (Lottes 2009): the image shown, with smooth edges.

mod cpu;
#[cfg(feature = "gpu")]
mod gpu;

use super::effect::{Effect, OnCpu, Stage};
use crate::scene::Antialiasing;

/// Smooth edges.
pub(super) const EFFECT: Effect = Effect {
    stage: Stage::Shown,
    is_on: |packet| packet.style.drawing.antialiasing == Antialiasing::Fxaa,
    #[cfg(feature = "gpu")]
    passes: &[&gpu::PASS],
    on_cpu: OnCpu::Shown(cpu::smooth),
};
