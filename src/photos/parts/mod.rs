//! Parsing helpers shared by several formats: words of a text, JSON, little-endian numbers, tables of numpy.

pub(super) mod bytes;
pub(super) mod json;
pub(super) mod npy_table;
pub(super) mod text;
