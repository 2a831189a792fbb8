//! Files whose frames are whole files, messages or packets: archives, MCAP and bags, captures, Matroska.

pub(super) mod archive;
pub(super) mod containers;
pub(crate) mod matroska;
pub(crate) mod packets;
pub(crate) mod recording;

use super::codec::Codec;

/// Files that hold others.
pub(super) const TABLE: &[Codec] = &[
    Codec::recording(containers::MCAP),
    Codec::recording(containers::BAG),
    Codec::recording(containers::DB3),
    Codec::container(containers::CAPTURE, |path, _, sensor, options| {
        packets::list(path, sensor, options)
    }),
    Codec::container(containers::ZIP, |path, format, _, options| {
        archive::list(path, format, options)
    }),
    Codec::container(containers::TAR, |path, format, _, options| {
        archive::list(path, format, options)
    }),
];
