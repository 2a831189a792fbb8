//! Writing clouds to files that other programs read.
//!
//! A cloud is a list of named columns ([`columns`]), which every format writes in its own layout. Double precision
//! stays double precision where the format has it. Text has the shortest digits that are read back as the same number.

mod columns;
mod encoder;
mod format;
mod loss;
mod losses;
pub(super) mod npy;
pub(super) mod pcd;
pub(super) mod ply;
pub(super) mod text;

pub(super) use encoder::{Encoder, Held, WriteSeek};
pub use format::{WriteFormat, write};
pub use loss::{Loss, Losses};
