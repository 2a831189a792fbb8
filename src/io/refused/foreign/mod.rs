//! Kinds of files that are not read, recognised so that a refusal names them, their writers, and converters.
//!
//! **How it works.** One row per kind ([`Foreign`]). Content is examined first: magic bytes of the kind, or a
//! structure. It takes precedence over the *extension* of a format that is read, as `.bin`, `.las` and `.txt` are
//! extensions of many programs; it never takes precedence over the *first bytes* of such a format. Names count where
//! content says nothing. Kinds that are ZIP archives or folders are recognised by the names of their files, databases
//! (`SQLite`) by the names of their tables.
//!
//! To add a kind: a row in one of the tables below, and its sample in the test of this module.

mod clouds;
mod data;
mod devices;
mod documents;
mod gis;
mod graphics;
mod looks;
mod looks_text;
mod row;
mod scenes;
mod science;
mod splats;
#[cfg(test)]
mod tests;

use crate::io::format::Format;
pub use row::Foreign;
use std::path::Path;

/// All rows; of two that match, the earlier one counts.
const TABLES: [&[Foreign]; 9] = [
    clouds::ROWS,
    splats::ROWS,
    scenes::ROWS,
    data::ROWS,
    devices::ROWS,
    gis::ROWS,
    science::ROWS,
    graphics::ROWS,
    documents::ROWS,
];

pub(in crate::io) fn rows() -> impl Iterator<Item = &'static Foreign> {
    TABLES.iter().flat_map(|table| table.iter())
}

/// The kind of a file that begins with `bytes`, by its content or its whole name.
pub(in crate::io) fn by_content(name: &Path, bytes: &[u8]) -> Option<&'static Foreign> {
    // Takes precedence over extensions such as `.bin`: a row needs bytes that no plausible file of bare floats begins
    // with.
    let bytes = &bytes[..bytes.len().min(Format::MAGIC_BYTES)];
    rows()
        .find(|row| {
            row.magic.iter().any(|magic| magic.is_in(bytes)) || row.looks_like.is_some_and(|is| is(name, bytes))
        })
        .or_else(|| rows().find(|row| row.has_name(name)))
}

/// The kind of a file by its extension.
pub(crate) fn by_extension(name: &Path) -> Option<&'static Foreign> {
    let extension = name.extension()?.to_str()?.to_ascii_lowercase();
    rows().find(|row| row.extensions.contains(&extension.as_str()))
}

/// The kind of a file by all that is known of it.
pub(in crate::io) fn recognise(name: &Path, bytes: &[u8]) -> Option<&'static Foreign> {
    by_content(name, bytes).or_else(|| by_extension(name))
}

/// The kind of an archive or a folder with files of these names.
pub(crate) fn by_members<'a>(names: &(impl Iterator<Item = &'a str> + Clone)) -> Option<&'static Foreign> {
    let has = |wanted: &&str| {
        let is = |name: &str| match wanted.strip_prefix('*') {
            Some(ending) => {
                let tail = name.len().checked_sub(ending.len()).and_then(|at| name.get(at..));
                tail.is_some_and(|tail| tail.eq_ignore_ascii_case(ending))
            }
            None => name.eq_ignore_ascii_case(wanted),
        };
        let file_name = |name: &'a str| name.rsplit('/').next().unwrap_or(name);
        names.clone().map(file_name).any(is)
    };
    rows().find(|row| !row.members.is_empty() && row.members.iter().all(has))
}

/// The kind of an `SQLite` database with these tables.
pub(in crate::io) fn by_tables(names: &[String]) -> Option<&'static Foreign> {
    let has = |wanted: &&str| names.iter().any(|name| name.eq_ignore_ascii_case(wanted));
    rows().find(|row| !row.tables.is_empty() && row.tables.iter().all(has))
}

impl Foreign {
    fn has_name(&self, path: &Path) -> bool {
        let name = path.file_name().and_then(|name| name.to_str());
        name.is_some_and(|name| self.names.iter().any(|known| name.eq_ignore_ascii_case(known)))
    }

    /// With its article: `a CloudCompare project`.
    pub(in crate::io) fn name(&self) -> &'static str {
        self.name
    }
}

/// `a CloudCompare project (written by CloudCompare), which is not read: open it …`; `a web page: download …`.
impl std::fmt::Display for Foreign {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            name, writer, advice, ..
        } = self;
        match *writer {
            "" => write!(formatter, "{name}: {advice}"),
            _ => write!(formatter, "{name} (written by {writer}), which is not read: {advice}"),
        }
    }
}
