//! Files whose frames are whole files, messages or packets: archives, MCAP and bags, captures, Matroska.

pub(super) mod archive;
pub(super) mod containers;
pub(crate) mod matroska;
pub(crate) mod packets;
pub(crate) mod recording;
