//! What files of several formats have in common: words of a text, JSON, little-endian numbers, tables of numpy.

pub(super) mod bytes;
pub(super) mod json;
pub(super) mod npy_table;
pub(super) mod text;
