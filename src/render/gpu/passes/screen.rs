//! Passes over the whole target.

use super::shade::{SHADE, SHADE_PHOTO_ANSWERS, SHADE_PHOTO_ANSWERS_PHYSICAL, SHADE_PHOTOS};
use super::shade::{SHADE_PHOTOS_PHYSICAL, SHADE_PHYSICAL};
use super::state::{COMPLETED, ColorUse, OVER, ScreenPass};
use crate::render::constants::{FARTHEST_GREY, NEAREST_GREY, opaque_weight};
use crate::render::gpu::constants::declared;
use crate::render::gpu::layout::{Shared, shared_struct};
use crate::render::gpu::part::{Part, Uniform, no_constants};
use crate::render::gpu::targets::{Source, Target};
use crate::render::gpu::wgsl::shader_file;
use crate::scene::rim_px;

/// Screen-space passes, all of them except the effects'.
pub(in crate::render::gpu) const SCREEN_PASSES: [&ScreenPass; 12] = [
    &SHADE,
    &SHADE_PHYSICAL,
    &SHADE_PHOTOS,
    &SHADE_PHOTOS_PHYSICAL,
    &PHOTO_ANSWERS,
    &PULL,
    &PUSH,
    &SHADE_PHOTO_ANSWERS,
    &SHADE_PHOTO_ANSWERS_PHYSICAL,
    &RESOLVE,
    &RESOLVE_PHOTOS,
    &DEPTH_VIEW,
];

/// View-dependent texturing of each pixel from the input images, with surfaces that they do not show filled from their
/// surroundings.
pub(in crate::render::gpu) const PHOTO_ANSWERS: ScreenPass = ScreenPass {
    name: "photo answers",
    files: &[shader_file!("passes/photo_answers.wgsl")],
    parts: &[],
    source: Some(Source::Textured),
    color: ColorUse::replacing(Target::PhotoAnswers),
    depth: None,
};

/// A coarser level of these.
pub(in crate::render::gpu) const PULL: ScreenPass = ScreenPass {
    name: "pull",
    files: &[shader_file!("passes/pull.wgsl")],
    parts: &[],
    source: Some(Source::FinerLevel),
    color: ColorUse::replacing(Target::PhotoLevel),
    depth: None,
};

/// Push pass: fills the holes of a level from the next coarser one.
pub(in crate::render::gpu) const PUSH: ScreenPass = ScreenPass {
    name: "push",
    files: &[shader_file!("passes/push.wgsl")],
    parts: &[],
    source: Some(Source::CoarserLevel),
    color: ColorUse {
        target: Target::PhotoLevel,
        blend: Some(COMPLETED),
    },
    depth: None,
};

/// Normalises the sums of the attribute pass, and lays the result over the background.
pub(in crate::render::gpu) const RESOLVE: ScreenPass = ScreenPass {
    name: "resolve",
    files: &[shader_file!("passes/resolve.wgsl")],
    parts: &[&RESOLVING],
    source: Some(Source::Sums),
    color: ColorUse {
        target: Target::Picture,
        blend: Some(OVER),
    },
    depth: None,
};

/// Resolve pass for surfaces with view-dependent texturing, whose gaps are closed.
pub(in crate::render::gpu) const RESOLVE_PHOTOS: ScreenPass = ScreenPass {
    name: "resolve images",
    files: &[shader_file!("passes/resolve_photos.wgsl")],
    source: Some(Source::TexturedSums),
    ..RESOLVE
};

/// The visibility pass as grey (Fig. 3c).
pub(in crate::render::gpu) const DEPTH_VIEW: ScreenPass = ScreenPass {
    name: "depth view",
    files: &[shader_file!("passes/depth_view.wgsl")],
    parts: &[&GREY],
    source: Some(Source::Depths),
    ..RESOLVE
};

const RESOLVING: Part = Part {
    constants: no_constants,
    uniform: Some(Uniform {
        name: "resolving",
        layout: &ResolvingUniform::LAYOUT,
        bytes: |packet| {
            let uniform = ResolvingUniform {
                opaque_weight: opaque_weight(&packet.style),
                rim_px: rim_px(packet) as f32,
                unused: [0.0; 2],
            };
            bytemuck::bytes_of(&uniform).to_vec()
        },
    }),
};

shared_struct! {
    /// Uniform for resolving sums into colours.
    ResolvingUniform as "Resolving" {
        /// Summed weight from which a pixel hides the background.
        opaque_weight: f32,
        /// Maximum width of the splat edges through which other surfaces shine; 0: none.
        rim_px: f32,
        /// Padding.
        unused: [f32; 2],
    }
}

const GREY: Part = Part {
    constants: || declared![FARTHEST_GREY, NEAREST_GREY],
    uniform: Some(Uniform {
        name: "depth_view",
        layout: &DepthViewUniform::LAYOUT,
        bytes: |packet| {
            let uniform = DepthViewUniform {
                range: packet.depth_range(),
                unused: [0.0; 2],
            };
            bytemuck::bytes_of(&uniform).to_vec()
        },
    }),
};

shared_struct! {
    /// Uniform for the display of depths.
    DepthViewUniform as "DepthView" {
        /// View distances drawn white and black.
        range: [f32; 2],
        /// Padding.
        unused: [f32; 2],
    }
}
