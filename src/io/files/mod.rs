//! A file on its way in: memory it may take, bytes that are counted, unpacked, or shared by its frames; other files that it names.

pub(super) mod beside;
pub(super) mod budget;
pub(crate) mod long_walk;
pub(super) mod options;
pub(super) mod shared;
pub(crate) mod timestamps;
pub(super) mod unpack;
pub(super) mod utm;
pub(super) mod watched;
