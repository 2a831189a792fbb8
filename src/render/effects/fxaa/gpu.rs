//! Its pass.

use crate::render::constants::{
    FXAA_BLUE, FXAA_DETAIL, FXAA_END_OF_EDGE, FXAA_GREEN, FXAA_MAX_BLENDED, FXAA_MIN_CONTRAST, FXAA_MIN_SHARE, FXAA_RED,
};
use crate::render::gpu::constants::declared;
use crate::render::gpu::part::Part;
use crate::render::gpu::passes::{ColorUse, ScreenPass};
use crate::render::gpu::targets::{Source, Target};
use crate::render::gpu::wgsl::shader_file;
use crate::scene::Antialiasing;

/// The image shown, with smooth edges.
pub(super) const PASS: ScreenPass = ScreenPass {
    name: "FXAA",
    files: &[shader_file!("effects/fxaa.wgsl")],
    parts: &[&PART],
    source: Some(Source::Picture),
    color: ColorUse::replacing(Target::Shown),
    depth: None,
};

/// Maximum number of search steps along an edge to find its end.
const FXAA_SEARCH_STEPS: i32 = Antialiasing::FXAA_SEARCH_STEPS as i32;

const PART: Part = Part {
    constants: || {
        declared![
            FXAA_BLUE,
            FXAA_DETAIL,
            FXAA_END_OF_EDGE,
            FXAA_GREEN,
            FXAA_MIN_CONTRAST,
            FXAA_MIN_SHARE,
            FXAA_MAX_BLENDED,
            FXAA_RED,
            FXAA_SEARCH_STEPS,
        ]
    },
    uniform: None,
};
