//! Files of `shaders/`, compiled in.

/// A file of `shaders/`: see `shader_file`.
#[derive(Debug, Clone, Copy)]
pub struct ShaderFile {
    /// Its path in that folder.
    pub(in crate::render) name: &'static str,
    pub(in crate::render) text: &'static str,
}

/// A [`ShaderFile`] by its path in `shaders/`.
macro_rules! shader_file {
    ($name:literal) => {
        $crate::render::gpu::shader_file::ShaderFile {
            name: $name,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $name)),
        }
    };
}

pub(in crate::render) use shader_file;

/// WGSL generated from Rust definitions, by the name that it is imported by.
pub(super) type GeneratedRow = (&'static str, fn() -> String);
