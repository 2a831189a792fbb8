//! Kinds of files that are not read: each is reported by name, with a converter.

pub(crate) mod foreign;
pub(super) mod foreign_files;
