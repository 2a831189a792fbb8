//! Reading and writing point clouds as other programs do.
//!
//! Well-kept crates read what is intricate (ARCHITECTURE.md, "Libraries"). The payload of simple formats is ours: the
//! crates' readers make a value a property or a row, which takes about 40 times as long or more, and one of them
//! allocates what a header merely claims. Here every size is checked against the bytes there are, or against
//! [`ReadOptions::max_memory_bytes`], before anything is allocated for it.
//!
//! To add a format: a file with its [`Format`] and what decodes it, and a row in the table below.

mod archive;
mod arrays;
mod attributes;
mod beside;
mod bin;
mod broken_faces;
mod budget;
mod codec;
mod column;
mod column_map;
mod column_names;
mod containers;
mod contents;
mod detect;
mod draco;
mod e57;
mod elevation_grid;
mod error;
mod fixed_rows;
pub(crate) mod foreign;
mod foreign_files;
mod format;
mod gltf;
mod growing;
mod las;
mod likeness;
mod list;
pub(crate) mod long_walk;
pub(crate) mod matroska;
mod mesh;
pub(crate) mod normals;
mod npy;
mod numbers;
mod obj;
mod off;
mod options;
pub(crate) mod packets;
mod pcd;
mod picture;
mod ply;
mod ptx;
mod read;
pub(crate) mod recording;
mod shared;
mod splats;
mod stl;
pub(crate) mod timestamps;
mod unique_names;
mod unpack;
mod utm;
mod watched;
mod write;
mod xyz;

pub use archive::Member;
pub use column_map::ColumnMap;
pub use contents::{Contents, Entry, Part, Topic};
pub use detect::supported_extensions;
pub use error::{IoError, Place};
pub use foreign::Foreign;
pub(crate) use foreign_files::kinds_of;
pub use format::Format;
pub(crate) use list::cameras;
pub use list::{contents, list};
pub use options::ReadOptions;
pub use packets::Turn;
pub(crate) use read::read_sample;
pub use read::{read, read_bytes, read_part, read_part_observed};
pub use recording::Message;
pub use shared::SharedFile;
pub use write::{Loss, Losses, WriteFormat, write};

use codec::{Codec, NamedColumns};
use write::{npy as npy_write, pcd as pcd_write, ply as ply_write, text as text_write};

/// Every format. Extensions are listed in this order; where two formats could be meant, the first one is.
const TABLE: &[Codec] = &[
    Codec {
        columns: Some(NamedColumns {
            fixed_rows: ply::fixed_rows,
            point_names: ply::point_names,
            normals: ply::normals,
        }),
        encoders: &[ply_write::BINARY, ply_write::ASCII],
        ..Codec::reading(ply::FORMAT, |file| ply::decode(file.bytes, file.options, file.progress))
    },
    Codec {
        columns: Some(NamedColumns {
            fixed_rows: pcd::fixed_rows,
            point_names: pcd::point_names,
            normals: pcd::normals,
        }),
        encoders: &[pcd_write::ENCODER],
        ..Codec::reading(pcd::FORMAT, |file| pcd::decode(file.bytes, file.options, file.progress))
    },
    Codec {
        encoders: &[las::write::LAS, las::write::LAZ],
        ..Codec::reading(las::FORMAT, |file| las::decode(file.bytes, file.options, file.progress))
    },
    Codec {
        list: Some(e57::list),
        ..Codec::reading(e57::FORMAT, |file| {
            e57::decode(file.bytes, file.part, file.options, file.progress)
        })
    },
    Codec::reading(draco::FORMAT, |file| draco::decode(file.bytes, file.options)),
    Codec {
        list: Some(xyz::list),
        encoders: &[text_write::ENCODER],
        ..Codec::reading(xyz::FORMAT, xyz::decode)
    },
    Codec::reading(elevation_grid::ESRI, |file| {
        elevation_grid::decode_esri(file.bytes, file.options, file.progress)
    }),
    Codec::reading(elevation_grid::SURFER, |file| {
        elevation_grid::decode_surfer(file.bytes, file.options, file.progress)
    }),
    Codec::reading(ptx::FORMAT, |file| ptx::decode(file.bytes, file.options, file.progress)),
    Codec::reading(obj::FORMAT, obj::decode),
    Codec::reading(off::FORMAT, |file| off::decode(file.bytes, file.options)),
    Codec::reading(stl::FORMAT, |file| stl::decode(file.bytes, file.options)),
    Codec {
        list: Some(gltf::list),
        ..Codec::reading(gltf::FORMAT, |file| {
            gltf::decode(file.name, file.bytes, file.part, file.options)
        })
    },
    Codec {
        encoders: &[npy_write::ENCODER],
        list: Some(npy::list_array),
        ..Codec::reading(npy::FORMAT, |file| npy::decode(file.bytes, file.part, file.options))
    },
    Codec {
        list: Some(npy::list),
        ..Codec::reading(npy::ARCHIVE, |file| {
            npy::decode_archive(file.bytes, file.part, file.options)
        })
    },
    Codec::reading(splats::spz::FORMAT, |file| {
        splats::spz::decode(file.bytes, file.options)
    }),
    Codec::reading(splats::bare::FORMAT, |file| {
        splats::bare::decode(file.bytes, file.options)
    }),
    Codec::reading(bin::FORMAT, |file| bin::decode(file.name, file.bytes, file.options)),
    Codec::container(containers::MCAP),
    Codec::container(containers::BAG),
    Codec::container(containers::DB3),
    Codec::container(containers::CAPTURE),
    Codec::container(containers::ZIP),
    Codec::container(containers::TAR),
];
