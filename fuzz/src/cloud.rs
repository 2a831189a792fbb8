//! What readers hand over.

#[path = "../../src/cloud/raw.rs"]
mod raw;

pub use raw::*;
