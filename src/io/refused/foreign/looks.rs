//! Structures of files that first bytes alone do not tell.

use std::path::Path;

/// The text that `bytes` begin with, without byte order mark and leading white space.
pub(super) fn text(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start()
}

pub(super) fn begins_with(bytes: &[u8], words: &[u8]) -> bool {
    let begin = bytes.get(..words.len());
    begin.is_some_and(|begin| begin.eq_ignore_ascii_case(words))
}

pub(super) fn contains(bytes: &[u8], words: &[u8]) -> bool {
    bytes.windows(words.len()).any(|window| window == words)
}

/// True for a JSON object in whose beginning all of `keys` are.
pub(super) fn is_json_with(bytes: &[u8], keys: &[&str]) -> bool {
    let has = |key: &&str| contains(bytes, format!("\"{key}\"").as_bytes());
    text(bytes).starts_with(b"{") && keys.iter().all(has)
}

pub(super) fn name_ends_with(name: &Path, ending: &str) -> bool {
    let name = name.file_name().and_then(|name| name.to_str());
    name.is_some_and(|name| name.to_ascii_lowercase().ends_with(ending))
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?))
}

pub(super) fn web_page(_: &Path, bytes: &[u8]) -> bool {
    let text = text(bytes);
    begins_with(text, b"<!doctype html") || begins_with(text, b"<html") || begins_with(text, b"<head>")
}

/// Answers of object stores.
pub(super) fn store_error(_: &Path, bytes: &[u8]) -> bool {
    let text = text(bytes);
    let is_xml = text.starts_with(b"<?xml") && contains(text, b"<Error>") && contains(text, b"<Code>");
    is_xml || (text.starts_with(b"<Error>") && contains(text, b"<Code>"))
}

pub(super) fn potree_1(_: &Path, bytes: &[u8]) -> bool {
    is_json_with(bytes, &["octreeDir", "hierarchyStepSize"])
}

pub(super) fn potree_2(_: &Path, bytes: &[u8]) -> bool {
    is_json_with(bytes, &["hierarchy", "firstChunkSize"])
}

pub(super) fn ept(_: &Path, bytes: &[u8]) -> bool {
    is_json_with(bytes, &["hierarchyType", "dataType"])
}

pub(super) fn tileset(_: &Path, bytes: &[u8]) -> bool {
    is_json_with(bytes, &["asset", "geometricError"])
}

/// The versions of Livox' recordings have the same first bytes.
fn livox(bytes: &[u8]) -> Option<u8> {
    bytes
        .starts_with(b"livox_tech")
        .then(|| bytes.get(16).copied())
        .flatten()
}

pub(super) fn lvx(_: &Path, bytes: &[u8]) -> bool {
    livox(bytes) == Some(1)
}

pub(super) fn lvx_2(_: &Path, bytes: &[u8]) -> bool {
    livox(bytes).is_some_and(|version| version != 1)
}

pub(super) fn sog_text(_: &Path, bytes: &[u8]) -> bool {
    is_json_with(bytes, &["means", "quats"]) || is_json_with(bytes, &["means", "scales"])
}

/// Log ASCII Standard of wells, which shares its extension with LiDAR data.
pub(super) fn well_log(_: &Path, bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with(b"#"));
    first.is_some_and(|line| begins_with(line, b"~V"))
}

/// Protein Data Bank: records of columns, the first six are the name.
pub(super) fn pdb(_: &Path, bytes: &[u8]) -> bool {
    const FIRST: [&[u8]; 8] = [
        b"HEADER    ",
        b"TITLE     ",
        b"COMPND    ",
        b"REMARK ",
        b"CRYST1",
        b"ATOM  ",
        b"HETATM",
        b"MODEL ",
    ];
    let has_atoms = bytes.starts_with(b"ATOM  ")
        || bytes.starts_with(b"HETATM")
        || contains(bytes, b"\nATOM  ")
        || contains(bytes, b"\nHETATM");
    FIRST.iter().any(|first| bytes.starts_with(first)) && (has_atoms || bytes.starts_with(b"HEADER    "))
}

pub(super) fn mol_2(_: &Path, bytes: &[u8]) -> bool {
    contains(bytes, b"@<TRIPOS>MOLECULE")
}

/// The fourth line ends with the version.
pub(super) fn mdl_mol(_: &Path, bytes: &[u8]) -> bool {
    let counts = bytes.split(|&byte| byte == b'\n').nth(3).map(<[u8]>::trim_ascii);
    counts.is_some_and(|line| line.ends_with(b"V2000") || line.ends_with(b"V3000"))
}

pub(super) fn cif(_: &Path, bytes: &[u8]) -> bool {
    begins_with(text(bytes), b"data_") && (contains(bytes, b"_cell") || contains(bytes, b"_atom_site"))
}

/// Protocol 4 or 5 of pickle: a frame follows, of less than a terabyte.
pub(super) fn pickle(_: &Path, bytes: &[u8]) -> bool {
    let begins = matches!(bytes, [0x80, 4 | 5, 0x95, ..]);
    begins && u64_at(bytes, 3).is_some_and(|length| length < 1 << 40)
}

/// The length of the header, and the header, which is JSON.
pub(super) fn safetensors(_: &Path, bytes: &[u8]) -> bool {
    let length = u64_at(bytes, 0);
    length.is_some_and(|length| (2..100 << 20).contains(&length)) && bytes.get(8..10) == Some(b"{\"")
}

const ZSTD: &[u8] = b"\x28\xb5\x2f\xfd";

pub(super) fn packed_ros_2_bag(name: &Path, bytes: &[u8]) -> bool {
    const ENDINGS: [&str; 4] = [".db3.zstd", ".db3.zst", ".mcap.zstd", ".mcap.zst"];
    bytes.starts_with(ZSTD) && ENDINGS.iter().any(|ending| name_ends_with(name, ending))
}

pub(super) fn blend(name: &Path, bytes: &[u8]) -> bool {
    bytes.starts_with(b"BLENDER") || (bytes.starts_with(ZSTD) && name_ends_with(name, ".blend"))
}

pub(super) fn ros_2_metadata(_: &Path, bytes: &[u8]) -> bool {
    begins_with(text(bytes), b"rosbag2_bagfile_information:")
}

pub(super) fn ifc(_: &Path, bytes: &[u8]) -> bool {
    bytes.starts_with(b"ISO-10303-21;") && (contains(bytes, b"'IFC") || contains(bytes, b"IFC2X3"))
}

pub(super) fn vtk_xml(_: &Path, bytes: &[u8]) -> bool {
    let text = text(bytes);
    begins_with(text, b"<VTKFile") || (begins_with(text, b"<?xml") && contains(text, b"<VTKFile"))
}

pub(super) fn collada(_: &Path, bytes: &[u8]) -> bool {
    begins_with(text(bytes), b"<?xml") && contains(bytes, b"<COLLADA")
}

pub(super) fn x3d(_: &Path, bytes: &[u8]) -> bool {
    begins_with(text(bytes), b"#VRML") || (begins_with(text(bytes), b"<?xml") && contains(bytes, b"<X3D"))
}

/// A group code and its value, a line each.
pub(super) fn dxf(_: &Path, bytes: &[u8]) -> bool {
    let mut lines = text(bytes).split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    lines.next() == Some(b"0") && lines.next() == Some(b"SECTION")
}

pub(super) fn usd_text(_: &Path, bytes: &[u8]) -> bool {
    bytes.starts_with(b"#usda ")
}

/// Boxes of MPEG-4: the first one is the type of file.
pub(super) fn mpeg_4(_: &Path, bytes: &[u8]) -> bool {
    const BRANDS_OF_IMAGES: [&[u8]; 4] = [b"heic", b"heix", b"avif", b"mif1"];
    let is_image = |brand: &[u8]| BRANDS_OF_IMAGES.contains(&brand);
    bytes.get(4..8) == Some(b"ftyp") && !bytes.get(8..12).is_some_and(is_image)
}

pub(super) fn heif(name: &Path, bytes: &[u8]) -> bool {
    bytes.get(4..8) == Some(b"ftyp") && !mpeg_4(name, bytes)
}

pub(super) fn avi(_: &Path, bytes: &[u8]) -> bool {
    bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"AVI ")
}

pub(super) fn webp(_: &Path, bytes: &[u8]) -> bool {
    bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP")
}

/// A pointer of git-annex is a path into its store.
pub(super) fn annex_pointer(_: &Path, bytes: &[u8]) -> bool {
    bytes.len() < 1024 && (bytes.starts_with(b"/annex/objects/") || contains(bytes, b".git/annex/objects/"))
}
