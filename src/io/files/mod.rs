//! A file on its way in: memory it may take, bytes that are counted or unpacked; other files that it
//! names.

pub(super) mod beside;
pub(super) mod budget;
pub(crate) mod long_walk;
pub(crate) mod timestamps;
pub(super) mod unpack;
pub(super) mod utm;
pub(super) mod watched;
