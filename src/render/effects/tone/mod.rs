//! The tone curve (gamma correction): a power of display-referred colours, which leaves black and white unchanged and
//! brightens or darkens the tones between. So it is the same in parts of an image, and transparent pixels stay so.

mod cpu;
#[cfg(feature = "gpu")]
mod gpu;

use super::effect::{Effect, OnCpu, Stage};

/// Brighter or darker colours.
pub(super) const EFFECT: Effect = Effect {
    stage: Stage::Picture,
    is_on: |packet| packet.style.light.tone_exponent().is_some(),
    #[cfg(feature = "gpu")]
    passes: &[&gpu::PASS],
    on_cpu: OnCpu::Rows(cpu::step),
};
