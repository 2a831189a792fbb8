//! Effects: steps over the whole of an image, on CPU and GPU.
//!
//! An effect is a folder: `mod.rs` has its row (when a packet has it, and where it stands), `gpu.rs` its passes with
//! their uniform and constants, `cpu.rs` the software renderer's part. Its WGSL is `shaders/effects/NAME.wgsl`. Parts
//! of deferred shading that are requested separately (shadows, ambient occlusion) are folders without a row: their WGSL
//! is imported by the lighting pass.

pub(in crate::render) mod ambient_occlusion;
pub(in crate::render) mod background;
mod effect;
mod eye_dome;
mod fxaa;
mod grid;
pub(in crate::render) mod shadow;
mod supersample;
mod tone;

pub(in crate::render) use effect::{Effect, OnCpu, PictureRow, RowStep, Stage};

#[cfg(feature = "gpu")]
use super::gpu::passes::ScreenPass;
#[cfg(feature = "gpu")]
use super::gpu::targets::Target;
use crate::scene::ScenePacket;

/// All of them, in the order of steps within a stage.
pub(in crate::render) const EFFECTS: [&Effect; 6] = [
    &background::EFFECT,
    &eye_dome::EFFECT,
    &grid::EFFECT,
    &tone::EFFECT,
    &fxaa::EFFECT,
    &supersample::EFFECT,
];

/// The effects of a packet in a stage.
pub(in crate::render) fn of_stage(packet: &ScenePacket, stage: Stage) -> impl Iterator<Item = &'static Effect> {
    let all = EFFECTS.into_iter().filter(move |effect| effect.stage == stage);
    all.filter(|effect| (effect.is_on)(packet))
}

#[cfg(feature = "gpu")]
/// Their passes into a target.
pub(in crate::render) fn passes(
    packet: &ScenePacket,
    stage: Stage,
    target: Target,
) -> impl Iterator<Item = &'static ScreenPass> {
    let passes = of_stage(packet, stage).flat_map(|effect| effect.passes.iter().copied());
    passes.filter(move |pass| pass.color.target == target)
}
