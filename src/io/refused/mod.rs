//! Kinds of files that are not read: each is called by its name, with what converts it.

pub(crate) mod foreign;
pub(super) mod foreign_files;
