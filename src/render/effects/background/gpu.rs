//! Its pass.

use crate::render::gpu::layout::{Shared, shared_struct};
use crate::render::gpu::part::{Part, Uniform, no_constants};
use crate::render::gpu::passes::{ColorUse, ScreenPass};
use crate::render::gpu::targets::Target;
use crate::render::gpu::wgsl::shader_file;
use crate::scene::ScenePacket;
use glam::Vec3;

/// The gradient behind the cloud.
pub(super) const PASS: ScreenPass = ScreenPass {
    name: "background",
    files: &[shader_file!("effects/background.wgsl")],
    parts: &[&PART],
    source: None,
    color: ColorUse::replacing(Target::Picture),
    depth: None,
};

const PART: Part = Part {
    constants: no_constants,
    uniform: Some(Uniform {
        name: "background",
        layout: &BackgroundUniform::LAYOUT,
        bytes: |packet| bytemuck::bytes_of(&uniform(packet)).to_vec(),
    }),
};

shared_struct! {
    /// Display-referred colours.
    BackgroundUniform as "Background" {
        /// At the top of the first row.
        top: [f32; 3],
        /// Padding.
        unused_a: f32,
        /// At the bottom of the last row.
        bottom: [f32; 3],
        /// Padding.
        unused_b: f32,
    }
}

fn uniform(packet: &ScenePacket) -> BackgroundUniform {
    let background = packet.style.backdrop.background;
    // A part of an image shows only a part of the gradient.
    let [top, bottom] = packet.view.rows_of_whole.map(|share| {
        let [top, bottom] = [background.top, background.bottom].map(normalized);
        top * (1.0 - share) + bottom * share
    });
    BackgroundUniform {
        top: top.to_array(),
        unused_a: 0.0,
        bottom: bottom.to_array(),
        unused_b: 0.0,
    }
}

fn normalized(color: [u8; 3]) -> Vec3 {
    Vec3::from_array(color.map(|channel| f32::from(channel) / 255.0))
}
