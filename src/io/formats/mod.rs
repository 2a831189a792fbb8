//! Formats of one cloud, a file or folder each, and the table of them. A format knows `columns` and `files`, never
//! another format's reader.

pub(super) mod bin;
pub(super) mod draco;
pub(super) mod e57;
pub(super) mod elevation_grid;
pub(super) mod gltf;
pub(super) mod las;
pub(super) mod npy;
pub(super) mod obj;
pub(super) mod off;
pub(super) mod pcd;
pub(super) mod ply;
pub(super) mod ptx;
pub(super) mod splats;
pub(super) mod stl;
pub(super) mod xyz;

use super::codec::{Codec, NamedColumns};
use super::write::{npy as npy_write, pcd as pcd_write, ply as ply_write, text as text_write};

/// Formats that are read as one cloud per part.
pub(super) const TABLE: &[Codec] = &[
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
];
