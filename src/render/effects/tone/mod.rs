//! The tone curve (gamma correction): a power of display-referred colours, which leaves black and white where they are
//! and brightens or darkens what is between. So it is the same in parts of a picture, and what is transparent stays so.

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
