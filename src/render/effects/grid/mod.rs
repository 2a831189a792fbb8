//! The grid on the ground, hidden by surfaces in front of it. The plane and its lines: `scene/view/ground.rs`.

mod cpu;
#[cfg(feature = "gpu")]
mod gpu;

use super::effect::{Effect, OnCpu, Stage};

/// Lines on the ground.
pub(super) const EFFECT: Effect = Effect {
    stage: Stage::Picture,
    is_on: |packet| packet.ground.is_some(),
    #[cfg(feature = "gpu")]
    passes: &[&gpu::PASS],
    on_cpu: OnCpu::Rows(cpu::step),
};
