//! A row of the tables of foreign files.

use crate::io::format::Magic;
use std::path::Path;

/// A kind of file that is not read.
#[derive(Debug)]
pub struct Foreign {
    /// With its article: `a CloudCompare project`.
    pub(super) name: &'static str,
    /// The programs or devices that write it; empty where that adds nothing.
    pub(super) writer: &'static str,
    /// Advice for converting it, after a colon.
    pub(super) advice: &'static str,
    /// Bytes that no other file has at this place; any of them is enough.
    pub(super) magic: &'static [Magic],
    /// A structure, where first bytes are not enough.
    pub(super) looks_like: Option<fn(&Path, &[u8]) -> bool>,
    /// Whole names, in lower case, that take precedence over the extension of a format that is read.
    pub(super) names: &'static [&'static str],
    /// Without dot, in lower case.
    pub(super) extensions: &'static [&'static str],
    /// Names of files that an archive or folder of the kind holds, all of them; `*.x` is any name with that extension.
    pub(super) members: &'static [&'static str],
    /// Tables that an `SQLite` database of the kind holds, all of them, in lower case.
    pub(super) tables: &'static [&'static str],
}

/// A row without anything to recognise it by.
pub(super) const ROW: Foreign = Foreign {
    name: "",
    writer: "",
    advice: "",
    magic: &[],
    looks_like: None,
    names: &[],
    extensions: &[],
    members: &[],
    tables: &[],
};
