//! Colour source of points, as the user chooses it.
//!
//! [`Coloring`] is the choice. Together with [`ColorHints`] and a frame it becomes a [`Paint`](super::Paint), in which
//! nothing is open any more (`resolve.rs`), and that becomes the colours of records (`sequence/records.rs`).

mod choice;
mod field_name;
mod parse_error;
mod range;
mod resolve;
mod source;
mod stored;

pub(super) use choice::UNIFORM_RGB;
pub use choice::{Coloring, UNIFORM_COLOR};
pub use field_name::{FieldName, plain as plain_field_name};
pub use parse_error::ParseColoringError;
pub use range::ColorRange;
pub use resolve::{ColorHints, Paint, PaintValues, value_kind};
pub use source::{ColorSource, DistanceFrom, HeightAxis};
