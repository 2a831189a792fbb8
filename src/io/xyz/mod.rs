//! Text with a point per line: coordinates in columns, and scalars, colours, normals and words in others.
//!
//! **How it works.** The first lines tell how cells are separated ([`dialect`]), which line has the names of columns
//! and what their cells hold ([`head`]). Names or the user say what the columns are ([`naming`]), else their values do
//! ([`guess`]). All rows are parsed on all cores ([`rows`]); a line that is none is skipped and counted. Then the rows
//! are divided into frames ([`frames`], [`counted`]).

mod counted;
pub(super) mod dialect;
mod divide;
mod encoding;
mod frames;
mod guess;
mod head;
mod naming;
mod parsed;
pub(super) mod rows;
mod sequence;
mod table;

pub(super) use dialect::Dialect;
pub(super) use guess::{MAX_GUESSED_COLUMN, guessed_names};
pub(super) use sequence::list;
pub(super) use table::Table;

use super::codec::Encoded;
use super::contents::Part;
use super::error::Fault;
use super::format::{Format, Holding, Traits};
use crate::cloud::{AxisConvention, RawCloud};

/// Text with coordinates in columns.
pub(super) const FORMAT: Format = Format::new(&Traits {
    name: "text",
    extensions: &["xyz", "txt", "csv", "asc", "pts", "xyzn", "xyzrgb", "xyzi", "tsv"],
    convention: Some(AxisConvention::UsuallyZUp),
    holds: Holding::Blocks,
    ..Traits::PLAIN
});

/// The text of a file as UTF-8.
pub(super) use encoding::utf8;

pub(super) fn decode(file: &Encoded<'_>) -> Result<RawCloud, Fault> {
    let table = Table::open(file.name, file.bytes, file.options, file.progress)?;
    match file.part {
        Part::Layer(frame) => table.frame(*frame),
        _ => table.first(),
    }
}
