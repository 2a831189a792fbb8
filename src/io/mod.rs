//! Reading and writing point clouds as other programs do.
//!
//! Well-kept crates read what is intricate (ARCHITECTURE.md, "Libraries"). The payload of simple formats is ours: the
//! crates' readers make a value a property or a row, which takes about 40 times as long or more, and one of them
//! allocates what a header merely claims. Here every size is checked against the bytes there are, or against
//! [`ReadOptions::max_memory_bytes`], before anything is allocated for it.
//!
//! To add a format: a file with its [`Format`] and what decodes it, and a row in the table below.

mod codec;
pub(crate) mod columns;
mod contents;
mod detect;
mod error;
pub(crate) mod files;
mod format;
mod formats;
mod list;
mod meshes;
mod read;
pub(crate) mod recordings;
pub(crate) mod refused;
mod write;

pub use columns::column_map::ColumnMap;
pub use contents::{Contents, Entry, Part, Topic};
pub use detect::supported_extensions;
pub use error::{IoError, Place};
pub use files::options::ReadOptions;
pub use files::shared::SharedFile;
pub use format::Format;
pub(crate) use list::cameras;
pub use list::{contents, list};
pub(crate) use read::read_sample;
pub use read::{read, read_bytes, read_part, read_part_observed};
pub use recordings::archive::Member;
pub use recordings::packets::Turn;
pub use recordings::recording::Message;
pub use refused::foreign::Foreign;
pub(crate) use refused::foreign_files::kinds_of;
pub use write::{Loss, Losses, WriteFormat, write};

use codec::{Codec, NamedColumns};
use write::{npy as npy_write, pcd as pcd_write, ply as ply_write, text as text_write};

/// Every format. Extensions are listed in this order; where two formats could be meant, the first one is.
const TABLE: &[Codec] = &[
    Codec {
        columns: Some(NamedColumns {
            fixed_rows: formats::ply::fixed_rows,
            point_names: formats::ply::point_names,
            normals: formats::ply::normals,
        }),
        encoders: &[ply_write::BINARY, ply_write::ASCII],
        ..Codec::reading(formats::ply::FORMAT, |file| {
            formats::ply::decode(file.bytes, file.options, file.progress)
        })
    },
    Codec {
        columns: Some(NamedColumns {
            fixed_rows: formats::pcd::fixed_rows,
            point_names: formats::pcd::point_names,
            normals: formats::pcd::normals,
        }),
        encoders: &[pcd_write::ENCODER],
        ..Codec::reading(formats::pcd::FORMAT, |file| {
            formats::pcd::decode(file.bytes, file.options, file.progress)
        })
    },
    Codec {
        encoders: &[formats::las::write::LAS, formats::las::write::LAZ],
        ..Codec::reading(formats::las::FORMAT, |file| {
            formats::las::decode(file.bytes, file.options, file.progress)
        })
    },
    Codec {
        list: Some(formats::e57::list),
        ..Codec::reading(formats::e57::FORMAT, |file| {
            formats::e57::decode(file.bytes, file.part, file.options, file.progress)
        })
    },
    Codec::reading(formats::draco::FORMAT, |file| {
        formats::draco::decode(file.bytes, file.options)
    }),
    Codec {
        list: Some(formats::xyz::list),
        encoders: &[text_write::ENCODER],
        ..Codec::reading(formats::xyz::FORMAT, formats::xyz::decode)
    },
    Codec::reading(formats::elevation_grid::ESRI, |file| {
        formats::elevation_grid::decode_esri(file.bytes, file.options, file.progress)
    }),
    Codec::reading(formats::elevation_grid::SURFER, |file| {
        formats::elevation_grid::decode_surfer(file.bytes, file.options, file.progress)
    }),
    Codec::reading(formats::ptx::FORMAT, |file| {
        formats::ptx::decode(file.bytes, file.options, file.progress)
    }),
    Codec::reading(formats::obj::FORMAT, formats::obj::decode),
    Codec::reading(formats::off::FORMAT, |file| {
        formats::off::decode(file.bytes, file.options)
    }),
    Codec::reading(formats::stl::FORMAT, |file| {
        formats::stl::decode(file.bytes, file.options)
    }),
    Codec {
        list: Some(formats::gltf::list),
        ..Codec::reading(formats::gltf::FORMAT, |file| {
            formats::gltf::decode(file.name, file.bytes, file.part, file.options)
        })
    },
    Codec {
        encoders: &[npy_write::ENCODER],
        list: Some(formats::npy::list_array),
        ..Codec::reading(formats::npy::FORMAT, |file| {
            formats::npy::decode(file.bytes, file.part, file.options)
        })
    },
    Codec {
        list: Some(formats::npy::list),
        ..Codec::reading(formats::npy::ARCHIVE, |file| {
            formats::npy::decode_archive(file.bytes, file.part, file.options)
        })
    },
    Codec::reading(formats::splats::spz::FORMAT, |file| {
        formats::splats::spz::decode(file.bytes, file.options)
    }),
    Codec::reading(formats::splats::bare::FORMAT, |file| {
        formats::splats::bare::decode(file.bytes, file.options)
    }),
    Codec::reading(formats::bin::FORMAT, |file| {
        formats::bin::decode(file.name, file.bytes, file.options)
    }),
    Codec::container(recordings::containers::MCAP),
    Codec::container(recordings::containers::BAG),
    Codec::container(recordings::containers::DB3),
    Codec::container(recordings::containers::CAPTURE),
    Codec::container(recordings::containers::ZIP),
    Codec::container(recordings::containers::TAR),
];
