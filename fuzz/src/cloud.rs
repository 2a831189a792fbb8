//! What readers hand over.

#[path = "../../src/cloud/raw.rs"]
mod raw;
#[path = "../../src/cloud/sample.rs"]
mod sample;
#[path = "../../src/cloud/unit.rs"]
mod unit;

pub use raw::*;
pub(crate) use sample::even_places;
pub use unit::LengthUnit;
