//! Its pass.

use crate::render::gpu::constants::declared;
use crate::render::gpu::part::Part;
use crate::render::gpu::passes::{ColorUse, ScreenPass};
use crate::render::gpu::targets::{Source, Target};
use crate::render::gpu::wgsl::shader_file;
use crate::scene::Antialiasing;

/// The image shown, from several drawn pixels for each.
pub(super) const PASS: ScreenPass = ScreenPass {
    name: "supersample",
    files: &[shader_file!("effects/supersample.wgsl")],
    parts: &[&PART],
    source: Some(Source::Picture),
    color: ColorUse::replacing(Target::Shown),
    depth: None,
};

/// Pixels drawn per pixel shown, along both edges of the image.
const SAMPLES_PER_EDGE: u32 = Antialiasing::Supersample.samples_per_edge();

const PART: Part = Part {
    constants: || declared![SAMPLES_PER_EDGE],
    uniform: None,
};
