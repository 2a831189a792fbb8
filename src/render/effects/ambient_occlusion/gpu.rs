//! Rust-side constants and bindings of `shaders/effects/ambient_occlusion.wgsl`.

use crate::render::gpu::constants::declared;
use crate::render::gpu::layout::{Shared, shared_struct};
use crate::render::gpu::part::{Part, Uniform};
use crate::scene::{AmbientOcclusion, ScenePacket};
use bytemuck::Zeroable;

/// Shader part for passes that apply lighting.
pub(in crate::render) const PART: Part = Part {
    constants: || [lines(), declared![OCCLUSION_LINE_COUNT, OCCLUSION_ROUGHNESS]].join("\n"),
    uniform: Some(Uniform {
        name: "occlusion",
        layout: &OcclusionUniform::LAYOUT,
        bytes: |packet| bytemuck::bytes_of(&uniform(packet)).to_vec(),
    }),
};

const OCCLUSION_LINE_COUNT: u32 = AmbientOcclusion::LINES as u32;
const OCCLUSION_ROUGHNESS: f32 = AmbientOcclusion::ROUGHNESS;

/// Returns the sampling lines of the ambient occlusion as WGSL.
fn lines() -> String {
    let lines = AmbientOcclusion::lines().map(|[x, y]| format!("vec2f({x:?}, {y:?})"));
    format!("const OCCLUSION_LINES = array({});", lines.join(", "))
}

shared_struct! {
    /// As [`AmbientOcclusion`] has it.
    OcclusionUniform as "Occlusion" {
        /// Radius of the ball at the near plane.
        near_radius_px: f32,
        /// The largest one.
        max_radius_px: f32,
        /// Strength of the darkening; 0 without ambient occlusion.
        strength: f32,
        /// Padding.
        unused: f32,
    }
}

fn uniform(packet: &ScenePacket) -> OcclusionUniform {
    AmbientOcclusion::of(packet).map_or_else(OcclusionUniform::zeroed, |occlusion| OcclusionUniform {
        near_radius_px: occlusion.near_radius_px,
        max_radius_px: occlusion.max_radius_px,
        strength: occlusion.strength,
        unused: 0.0,
    })
}
