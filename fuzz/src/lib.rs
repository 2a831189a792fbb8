//! The readers alone, by their sources: with the window and wgpu around them every target would take ten minutes to build.

#![allow(dead_code, reason = "the readers are made for the whole program")]

pub mod cloud {
    //! What readers hand over.
    #[path = "../../../src/cloud/raw.rs"]
    mod raw;
    pub use raw::*;
}

#[path = "../../src/io/mod.rs"]
pub mod io;

mod memory {
    /// The same on every machine, so that a finding is one everywhere.
    pub(crate) fn machine_bytes() -> Option<u64> {
        Some(1 << 30)
    }
}
