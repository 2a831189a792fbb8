//! A file on its way in: memory it may take, bytes that are counted or unpacked; other files that it
//! names.

pub(super) mod budget;
pub(crate) mod long_walk;
pub(super) mod sidecars;
pub(crate) mod timestamps;
pub(super) mod unpack;
pub(super) mod utm;
pub(super) mod watched;
