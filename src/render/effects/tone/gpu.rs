//! Its pass.

use crate::render::gpu::layout::{Shared, shared_struct};
use crate::render::gpu::part::{Part, Uniform, no_constants};
use crate::render::gpu::passes::{ColorUse, ScreenPass};
use crate::render::gpu::targets::{Source, Target};
use crate::render::gpu::wgsl::shader_file;

/// The image with other colours.
pub(super) const PASS: ScreenPass = ScreenPass {
    name: "tone curve",
    files: &[shader_file!("effects/tone.wgsl")],
    parts: &[&PART],
    source: Some(Source::PictureCopy),
    color: ColorUse::replacing(Target::Picture),
    depth: None,
};

const PART: Part = Part {
    constants: no_constants,
    uniform: Some(Uniform {
        name: "tone",
        layout: &ToneUniform::LAYOUT,
        bytes: |packet| {
            let uniform = ToneUniform {
                exponent: packet.style.light.tone_exponent().unwrap_or(1.0),
                unused_a: 0.0,
                unused_b: [0.0; 2],
            };
            bytemuck::bytes_of(&uniform).to_vec()
        },
    }),
};

shared_struct! {
    /// The curve.
    ToneUniform as "Tone" {
        /// The power that channels from 0 to 1 are raised to.
        exponent: f32,
        /// Padding.
        unused_a: f32,
        /// Padding.
        unused_b: [f32; 2],
    }
}
