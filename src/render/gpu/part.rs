//! What the WGSL of a part of a picture has from Rust: constants, and a uniform of its own.

use super::layout::Layout;
use crate::scene::ScenePacket;

/// Of a pass over the screen, or of what several of them import.
#[derive(Debug)]
pub(in crate::render) struct Part {
    /// Declarations that its WGSL counts on.
    pub(in crate::render) constants: fn() -> String,
    pub(in crate::render) uniform: Option<Uniform>,
}

/// A uniform.
#[derive(Debug)]
pub(in crate::render) struct Uniform {
    /// Of the variable; no other has the same.
    pub(in crate::render) name: &'static str,
    pub(in crate::render) layout: &'static Layout,
    /// Of a packet, as it is drawn ([`ScenePacket::as_drawn`]).
    pub(in crate::render) bytes: fn(&ScenePacket) -> Vec<u8>,
}

/// Of a part without constants.
pub(in crate::render) const fn no_constants() -> String {
    String::new()
}
