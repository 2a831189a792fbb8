//! The wgpu renderer: five instancing strategies times the passes of each primitive.
//!
//! Long-lived knowledge (pipelines, layouts) is in `passes::Pipelines`, resident data in `residency`, the order of
//! passes of one image in `plan`, its commands in `picture`. A strategy owns upload and draw call, a pass owns targets
//! and blending; neither knows the other. A primitive (`primitives`) lists the passes that draw it.

mod coded;
pub mod complexity;
mod compute;
pub(in crate::render) mod constants;
mod context;
mod depth_images;
mod gather;
mod gather_program;
#[cfg(test)]
mod gather_tests;
pub mod gpu_data;
mod instancing;
mod late_read;
pub(in crate::render) mod layout;
pub(in crate::render) mod part;
pub(in crate::render) mod passes;
mod photo_answers;
mod photos;
mod picture;
mod plan;
mod presence;
mod primitives;
mod readback;
mod record_buffers;
mod recording;
mod renderer;
mod residency;
pub(in crate::render) mod shader_file;
mod shader_library;
mod shader_reload;
pub mod shaders;
mod stereo;
mod streams;
pub(in crate::render) mod targets;
mod textures;
mod timer;
mod uniforms;
mod visible;
pub(in crate::render) mod wgsl;

pub use context::{Context, ContextOptions};
pub(crate) use presence::may_have_gpu;
pub use renderer::{DEFAULT_RESIDENT_BUDGET_BYTES, GpuRenderer};
pub use stereo::CardMatcher;
