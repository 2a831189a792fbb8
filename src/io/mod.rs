//! Reading and writing point clouds as other programs do.
//!
//! Well-maintained crates read intricate formats (ARCHITECTURE.md, "Libraries"). The payload of simple formats is ours:
//! the crates' readers create one value per property or row, which takes about 40 times as long or more, and one of
//! them allocates the unverified claims of a header. Here every size is checked against the bytes there are, or against
//! [`ReadOptions::max_memory_bytes`], before anything is allocated for it.
//!
//! To add a format: a file in `formats` with its [`Format`] and decoder, and a row of the table there.

mod codec;
pub(crate) mod columns;
mod contents;
mod detect;
mod error;
pub(crate) mod files;
mod format;
mod formats;
mod list;
mod meshes;
pub(crate) mod normals;
mod options;
mod read;
pub(crate) mod recordings;
pub(crate) mod refused;
mod shared;
mod write;

pub use columns::column_map::ColumnMap;
pub use contents::{Contents, Entry, Part, Topic};
pub use detect::supported_extensions;
pub use error::{IoError, Place};
pub use format::Format;
pub(crate) use list::cameras;
pub use list::{contents, list};
pub use options::ReadOptions;
pub(crate) use read::read_sample;
pub use read::{read, read_bytes, read_part, read_part_observed};
pub use recordings::archive::Member;
pub use recordings::packets::Turn;
pub use recordings::recording::Message;
pub use refused::foreign::Foreign;
pub(crate) use refused::foreign_files::kinds_of;
pub use shared::SharedFile;
pub use write::{Loss, Losses, WriteFormat, write};

use codec::Codec;

/// Every format. Extensions are listed in this order; where two formats could be meant, the first one is.
fn codecs() -> impl Iterator<Item = &'static Codec> {
    formats::TABLE.iter().chain(recordings::TABLE)
}
