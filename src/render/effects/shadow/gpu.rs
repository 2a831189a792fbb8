//! Rust-side constants and bindings of `shaders/effects/shadow.wgsl`.

use crate::render::gpu::constants::declared;
use crate::render::gpu::layout::{Shared, shared_struct};
use crate::render::gpu::part::{Part, Uniform};
use crate::scene::{ScenePacket, Shadow};
use bytemuck::Zeroable;

/// Shader part for passes that apply lighting.
pub(in crate::render) const PART: Part = Part {
    constants: || declared![SHADOW_EDGE_PX, SHADOW_OFFSET_TEXELS, SHADOW_SLOPE_TEXELS],
    uniform: Some(Uniform {
        name: "shadow",
        layout: &ShadowUniform::LAYOUT,
        bytes: |packet| bytemuck::bytes_of(&uniform(packet)).to_vec(),
    }),
};

const SHADOW_EDGE_PX: f32 = Shadow::EDGE_PX as f32;
const SHADOW_OFFSET_TEXELS: f32 = Shadow::OFFSET_TEXELS[0];
const SHADOW_SLOPE_TEXELS: f32 = Shadow::OFFSET_TEXELS[1];

shared_struct! {
    /// As [`Shadow`] has it.
    ShadowUniform as "Shadow" {
        /// Rows of the matrix from view space into the space of the lamp, which the shadow map is drawn in.
        lamp_from_view_x: [f32; 4],
        /// The second row.
        lamp_from_view_y: [f32; 4],
        /// The third row.
        lamp_from_view_z: [f32; 4],
        /// Cotangent of half the field of view of the lamp.
        focal: f32,
        /// Distance of the lamp to its near plane.
        near: f32,
        /// Edge of a texel of the shadow map at the centre of the cloud, scene units; 0 without shadows.
        texel: f32,
        /// Padding.
        unused: f32,
    }
}

fn uniform(packet: &ScenePacket) -> ShadowUniform {
    Shadow::of(packet).map_or_else(ShadowUniform::zeroed, |shadow| {
        let [x, y, z] = shadow.lamp_from_view.map(|row| row.to_array());
        let lamp_view = &shadow.lamp_packet.view;
        ShadowUniform {
            lamp_from_view_x: x,
            lamp_from_view_y: y,
            lamp_from_view_z: z,
            focal: lamp_view.focal[0],
            near: lamp_view.near,
            texel: shadow.texel,
            unused: 0.0,
        }
    })
}
