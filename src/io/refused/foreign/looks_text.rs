//! Structures of texts: JSON, XML and keywords at the begin of lines.

use super::looks::{begins_with, contains, is_json_with, name_ends_with, text};
use std::path::Path;

/// True for XML in whose beginning one of `elements` is, such as `<gpx`.
fn is_xml_with(bytes: &[u8], elements: &[&[u8]]) -> bool {
    let text = text(bytes);
    text.starts_with(b"<") && elements.iter().any(|element| contains(text, element))
}

/// True for an object with one of these values of the key `type`.
fn is_json_of_type(bytes: &[u8], types: &[&str]) -> bool {
    types.iter().any(|kind| is_json_with(bytes, &["type", kind]))
}

pub(super) fn city_json(_: &Path, bytes: &[u8]) -> bool {
    is_json_of_type(bytes, &["CityJSON", "CityJSONFeature"])
}

pub(super) fn geo_json(_: &Path, bytes: &[u8]) -> bool {
    is_json_of_type(bytes, &["FeatureCollection", "Feature"])
}

pub(super) fn notebook(_: &Path, bytes: &[u8]) -> bool {
    is_json_with(bytes, &["cells", "nbformat"])
}

/// `[[0, 0, 0], …`, `[{"x": 0, …`, or an object with a list of points; only of files named so.
pub(super) fn json_points(name: &Path, bytes: &[u8]) -> bool {
    let is_named_so = [".json", ".jsonl", ".ndjson"]
        .iter()
        .any(|ending| name_ends_with(name, ending));
    let head: Vec<u8> = bytes
        .iter()
        .copied()
        .filter(|byte| !byte.is_ascii_whitespace())
        .collect();
    let is_list = head.starts_with(b"[[") || head.starts_with(br#"[{"x""#) || head.starts_with(br#"{"x":"#);
    let holds_list = ["points", "positions", "vertices", "data", "xyz", "cloud"]
        .iter()
        .any(|key| contains(&head, format!("\"{key}\":[").as_bytes()));
    is_named_so && (is_list || (head.starts_with(b"{") && holds_list))
}

pub(super) fn gml(_: &Path, bytes: &[u8]) -> bool {
    is_xml_with(bytes, &[b"<gml:", b"opengis.net/gml", b"opengis.net/citygml"])
}

pub(super) fn gpx(_: &Path, bytes: &[u8]) -> bool {
    is_xml_with(bytes, &[b"<gpx"])
}

pub(super) fn land_xml(_: &Path, bytes: &[u8]) -> bool {
    is_xml_with(bytes, &[b"<LandXML"])
}

pub(super) fn xdmf(_: &Path, bytes: &[u8]) -> bool {
    is_xml_with(bytes, &[b"<Xdmf"])
}

/// A project names the folder of its archives.
pub(super) fn metashape(name: &Path, bytes: &[u8]) -> bool {
    is_xml_with(bytes, &[b"{projectname}"]) || (name_ends_with(name, ".psx") && is_xml_with(bytes, &[b"<document"]))
}

/// `! comment`, then `@NAME, GRID, …`.
pub(super) fn z_map(_: &Path, bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with(b"!"));
    first.is_some_and(|line| {
        line.starts_with(b"@") && contains(&line.to_ascii_uppercase(), b"GRID") && line.contains(&b',')
    })
}

pub(super) fn ensight(_: &Path, bytes: &[u8]) -> bool {
    let text = text(bytes);
    begins_with(text, b"FORMAT") && contains(text, b"type:") && contains(text, b"ensight")
}

pub(super) fn tecplot(name: &Path, bytes: &[u8]) -> bool {
    let text = text(bytes);
    let is_named_so = [".tec", ".plt"].iter().any(|ending| name_ends_with(name, ending));
    let begins = begins_with(text, b"TITLE") || begins_with(text, b"VARIABLES");
    let upper = text.to_ascii_uppercase();
    is_named_so && begins && contains(&upper, b"VARIABLES") && contains(&upper, b"ZONE")
}

/// Keywords begin with a star, comments with two.
pub(super) fn abaqus(_: &Path, bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with(b"**"));
    first.is_some_and(|line| {
        [&b"*HEADING"[..], b"*NODE", b"*PART", b"*INCLUDE"]
            .iter()
            .any(|word| begins_with(line, word))
    })
}

/// Vertices and edges of a graph of poses.
pub(super) fn g2o(_: &Path, bytes: &[u8]) -> bool {
    let text = text(bytes);
    [&b"VERTEX_"[..], b"EDGE_SE"].iter().any(|word| text.starts_with(word))
}

pub(super) fn meta_image(_: &Path, bytes: &[u8]) -> bool {
    let text = text(bytes);
    begins_with(text, b"ObjectType") && contains(text, b"NDims")
}

/// An IFF file of 32 or 64 bits.
pub(super) fn maya_binary(name: &Path, bytes: &[u8]) -> bool {
    let is_iff = bytes.starts_with(b"FOR4") || bytes.starts_with(b"FOR8");
    is_iff && (contains(&bytes[..bytes.len().min(64)], b"Maya") || name_ends_with(name, ".mb"))
}
