//! Its passes.

use crate::render::gpu::constants::declared;
use crate::render::gpu::layout::{Shared, shared_struct};
use crate::render::gpu::part::{Part, Uniform};
use crate::render::gpu::passes::{ColorUse, MULTIPLIED, ScreenPass};
use crate::render::gpu::targets::{Source, Target};
use crate::render::gpu::wgsl::shader_file;
use crate::scene::{EyeDomeLight, ScenePacket};
use bytemuck::Zeroable;

/// Eye-dome lighting pass: multiplies the drawn surface by the shade of each pixel.
pub(super) const PASS: ScreenPass = ScreenPass {
    name: "eye-dome lighting",
    files: &[shader_file!("effects/eye_dome.wgsl")],
    parts: &[&PART],
    source: Some(Source::Depths),
    color: ColorUse {
        target: Target::Picture,
        blend: Some(MULTIPLIED),
    },
    depth: None,
};

/// Eye-dome lighting of the attribute pass's output, before it is resolved: so the background that shines through at
/// the edges of splats keeps its colour, as the rest of the background does.
pub(super) const OF_SUMS: ScreenPass = ScreenPass {
    name: "eye-dome lighting of sums",
    color: ColorUse {
        target: Target::Sums,
        blend: Some(MULTIPLIED),
    },
    ..PASS
};

const PART: Part = Part {
    constants: || declared![LONE],
    uniform: Some(Uniform {
        name: "eye_dome",
        layout: &EyeDomeUniform::LAYOUT,
        bytes: |packet| bytemuck::bytes_of(&uniform(packet)).to_vec(),
    }),
};

/// Share of neighbours without depth from which a pixel belongs to no surface.
const LONE: f32 = EyeDomeLight::LONE;

shared_struct! {
    /// As [`EyeDomeLight`] has it.
    EyeDomeUniform as "EyeDome" {
        /// Distances of the neighbours, straight and diagonal.
        reach_px: [i32; 2],
        /// Straight and on diagonals.
        gains: [f32; 2],
        /// Maximum contribution of a step.
        max: f32,
        /// The darkness of edges.
        edge: f32,
        /// Padding.
        unused: [f32; 2],
    }
}

fn uniform(packet: &ScenePacket) -> EyeDomeUniform {
    EyeDomeLight::of(packet).map_or_else(EyeDomeUniform::zeroed, |light| EyeDomeUniform {
        reach_px: light.reach_px.map(|reach_px| reach_px as i32),
        gains: light.gains,
        max: light.max,
        edge: light.edge,
        unused: [0.0; 2],
    })
}
