//! The vertical gradient behind the cloud.

pub(in crate::render) mod cpu;
#[cfg(feature = "gpu")]
mod gpu;

use super::effect::{Effect, OnCpu, Stage};

/// A gradient; a single colour is only the clear colour of the image.
pub(super) const EFFECT: Effect = Effect {
    stage: Stage::Behind,
    is_on: |packet| {
        let background = packet.style.backdrop.background;
        background.top != background.bottom
    },
    #[cfg(feature = "gpu")]
    passes: &[&gpu::PASS],
    on_cpu: OnCpu::InTiles,
};
