//! Text with one point per line: coordinates in columns, and scalars, colours, normals and words in others.
//!
//! **How it works.** Decorations around rows are removed ([`layout`]). The first lines determine the separator of cells
//! ([`dialect`]), the line of column names and the types of cells ([`head`]). Names or the user give the meaning of
//! columns ([`naming`]), else their values do ([`guess`], [`leading`]). All rows are parsed on all cores ([`rows`]);
//! other lines are skipped and counted. Then the rows are divided into frames ([`frames`], [`counted`], [`markers`]).
//! Poses and grids of values are not points ([`refusal`]).

mod counted;
pub(super) mod dialect;
mod divide;
mod encoding;
mod frames;
mod guess;
mod head;
mod layout;
mod leading;
mod markers;
mod naming;
mod parsed;
mod refusal;
pub(in crate::io) mod rows;
mod sequence;
mod table;

pub(in crate::io) use dialect::Dialect;
pub(in crate::io) use guess::{MAX_GUESSED_COLUMN, guessed_names};
pub(in crate::io) use sequence::list;
pub(in crate::io) use table::Table;

use crate::cloud::{AxisConvention, RawCloud};
use crate::io::codec::Encoded;
use crate::io::contents::Part;
use crate::io::error::Fault;
use crate::io::format::{Format, Holding, Traits};
use std::path::Path;

/// Text with coordinates in columns.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "text",
    extensions: &["xyz", "txt", "csv", "asc", "pts", "xyzn", "xyzrgb", "xyzi", "tsv"],
    convention: Some(AxisConvention::UsuallyZUp),
    looks_like: Some(is_table_of_numbers),
    holds: Holding::Blocks,
    ..Traits::PLAIN
});

/// Extensions of tables of numbers and of other files as well: the first lines tell.
const SHARED_EXTENSIONS: [&str; 4] = ["dat", "neu", "3d", "txyz"];

/// True for a file with one of the shared extensions that begins with rows of numbers, behind comments and names.
fn is_table_of_numbers(name: &Path, bytes: &[u8]) -> bool {
    const MAX_LINES: usize = 64;
    let is_shared = |known: &&str| {
        name.extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case(known))
    };
    let head = dialect::sample(bytes);
    if !SHARED_EXTENSIONS.iter().any(is_shared) || head.contains(&0) {
        return false;
    }
    let plain = layout::plain(head);
    let dialect = Dialect::of(&plain.text);
    let lines = plain.text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let lines = lines.filter(|line| !line.is_empty() && dialect::comment(line).is_none());
    let lines: Vec<&[u8]> = lines.take(MAX_LINES).collect();
    let width = |line: &&[u8]| rows::numbers_in(line, dialect).map_or(0, |row| row.len());
    let widths: Vec<usize> = lines.iter().map(width).skip_while(|width| *width < 3).collect();
    // ZMap+ grids wrap their lines after a header between two of these characters.
    let is_grid = lines.iter().any(|line| line.starts_with(b"@"));
    let is_max = |first: &usize| widths.iter().filter(|width| *width == first).count() * 2 > widths.len();
    !is_grid && widths.first().is_some_and(is_max)
}

/// The text of a file as UTF-8.
pub(in crate::io) use encoding::utf8;

pub(in crate::io) fn decode(file: &Encoded<'_>) -> Result<RawCloud, Fault> {
    let table = Table::open(file.name, file.bytes, file.options, file.progress)?;
    match file.part {
        Part::Layer(frame) => table.frame(*frame, file.options),
        _ => table.first(file.options),
    }
}
