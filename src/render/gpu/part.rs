//! Shader parts: the constants and the uniform that Rust provides to the WGSL of a part of an image.

use super::layout::Layout;
use crate::scene::ScenePacket;

/// Shader part of a screen-space pass, or of several that import it.
#[derive(Debug)]
pub(in crate::render) struct Part {
    /// Declarations that its WGSL counts on.
    pub(in crate::render) constants: fn() -> String,
    pub(in crate::render) uniform: Option<Uniform>,
}

/// A uniform.
#[derive(Debug)]
pub(in crate::render) struct Uniform {
    /// Variable name of the uniform; no other has the same.
    pub(in crate::render) name: &'static str,
    pub(in crate::render) layout: &'static Layout,
    /// Uniform contents for a packet, as it is drawn ([`ScenePacket::as_drawn`]).
    pub(in crate::render) bytes: fn(&ScenePacket) -> Vec<u8>,
}

/// Returns the empty declarations of a part without constants.
pub(in crate::render) const fn no_constants() -> String {
    String::new()
}
