//! The tone curve: a power of display-referred colours, which leaves black and white where they are and brightens or
//! darkens what is between. So it is the same in parts of a picture, and what is transparent stays so.

mod cpu;
mod gpu;

use super::effect::{Effect, OnCpu, Stage};
use crate::scene::ScenePacket;

/// Brighter or darker colours.
pub(super) const EFFECT: Effect = Effect {
    stage: Stage::Picture,
    is_on: |packet| exponent(packet).is_some(),
    passes: &[&gpu::PASS],
    on_cpu: OnCpu::Rows(cpu::step),
};

/// The power that channels from 0 to 1 are raised to; `None` where they stay as they are.
fn exponent(packet: &ScenePacket) -> Option<f32> {
    let gamma = packet.style.light.gamma;
    let changes = gamma > 0.0 && gamma.is_finite() && (gamma - 1.0).abs() > f32::EPSILON;
    changes.then(|| 1.0 / gamma)
}
