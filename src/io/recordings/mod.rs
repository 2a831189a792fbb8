//! Files whose frames are whole files, messages or packets: archives, MCAP and bags, captures, Matroska.

pub(super) mod archive;
pub(super) mod containers;
pub(crate) mod matroska;
pub(crate) mod packets;
pub(crate) mod recording;

use super::codec::Codec;

/// Files that hold others.
pub(super) const TABLE: &[Codec] = &[
    Codec::container(containers::MCAP),
    Codec::container(containers::BAG),
    Codec::container(containers::DB3),
    Codec::container(containers::CAPTURE),
    Codec::container(containers::ZIP),
    Codec::container(containers::TAR),
];
