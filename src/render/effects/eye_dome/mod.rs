//! Eye-dome lighting (Boucheny 2009): pixels behind their neighbours get darker. The formula:
//! `scene/effects/eye_dome.rs`.

mod cpu;
#[cfg(feature = "gpu")]
mod gpu;

use super::effect::{Effect, OnCpu, Stage};
use crate::scene::EyeDomeLight;

/// Shades the drawn surface by its depths.
pub(super) const EFFECT: Effect = Effect {
    stage: Stage::Drawn,
    is_on: |packet| EyeDomeLight::of(packet).is_some(),
    #[cfg(feature = "gpu")]
    passes: &[&gpu::PASS, &gpu::OF_SUMS],
    on_cpu: OnCpu::Rows(cpu::step),
};
