//! Shader imports: files of `shaders/`, and WGSL generated from Rust definitions. A file that a single row names, such
//! as a pass's, is with that row, and so are the definitions it alone gets from Rust.

use super::constants;
use super::gpu_data::{SplatVertex, ViewUniform};
use super::layout::Shared;
use super::shader_file::{GeneratedRow, ShaderFile, shader_file};

/// Files that others import.
pub(super) const LIBRARY: &[ShaderFile] = &[
    shader_file!("coded/code.wgsl"),
    shader_file!("common/blended_surface.wgsl"),
    shader_file!("common/f64.wgsl"),
    shader_file!("common/facet.wgsl"),
    shader_file!("common/fragments.wgsl"),
    shader_file!("common/fullscreen.wgsl"),
    shader_file!("common/light.wgsl"),
    shader_file!("common/linear.wgsl"),
    shader_file!("common/oct_encode.wgsl"),
    shader_file!("common/photo_table.wgsl"),
    shader_file!("common/photos.wgsl"),
    shader_file!("common/quads.wgsl"),
    shader_file!("common/records.wgsl"),
    shader_file!("common/rims.wgsl"),
    shader_file!("common/scan.wgsl"),
    shader_file!("common/smallest_eigenvector.wgsl"),
    shader_file!("common/view.wgsl"),
    shader_file!("depth_images/image.wgsl"),
    shader_file!("effects/ambient_occlusion.wgsl"),
    shader_file!("effects/shadow.wgsl"),
    shader_file!("fetch/indexed.wgsl"),
    shader_file!("primitives/filtered_by_ewa.wgsl"),
    shader_file!("primitives/splats.wgsl"),
    shader_file!("primitives/voxels.wgsl"),
    shader_file!("screen_normals/cells.wgsl"),
    shader_file!("screen_normals/ramp.wgsl"),
    shader_file!("screen_normals/view.wgsl"),
    shader_file!("stereo/exact_share.wgsl"),
    shader_file!("stereo/pair.wgsl"),
];

/// WGSL snippets that are generated from Rust definitions.
pub(super) const GENERATED: &[GeneratedRow] = &[
    ("generated/constants", constants::shared),
    ("generated/splat_vertex", || SplatVertex::LAYOUT.declaration()),
    ("generated/view", || ViewUniform::LAYOUT.declaration()),
];
