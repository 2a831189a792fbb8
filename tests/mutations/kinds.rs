//! Mutated files: one row per kind. Kinds of one set take turns in it.

use crate::mutate::Shape::{self, Binary, Json, Text, TextHead};
use crate::repair::Repair;

/// Files of an extension.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kind {
    pub(crate) set: &'static str,
    /// Without dot, in lower case.
    pub(crate) extension: &'static str,
    pub(crate) shape: Shape,
    pub(crate) repair: Repair,
}

const fn kind(set: &'static str, extension: &'static str, shape: Shape, repair: Repair) -> Kind {
    Kind {
        set,
        extension,
        shape,
        repair,
    }
}

/// Kinds that are read as a file. Settings are read by the window alone (`drive.rs`).
pub(crate) const KINDS: &[Kind] = &[
    kind("reel", "reel", Binary, Repair::Reel),
    kind(STREAMS, "pointreel-stream", Binary, Repair::Stream),
    kind("sessions", "pointreel", Json, Repair::Nothing),
    kind(SETTINGS, "json", Json, Repair::Nothing),
    kind("ply", "ply", TextHead, Repair::Nothing),
    kind("pcd", "pcd", TextHead, Repair::Nothing),
    kind("text", "xyz", Text, Repair::Nothing),
    kind("text", "txt", Text, Repair::Nothing),
    kind("text", "csv", Text, Repair::Nothing),
    kind("text", "asc", Text, Repair::Nothing),
    kind("text", "pts", Text, Repair::Nothing),
    kind("text", "ptx", Text, Repair::Nothing),
    kind("las", "las", Binary, Repair::Nothing),
    kind("las", "laz", Binary, Repair::Nothing),
    kind("e57", "e57", Binary, Repair::E57),
    kind("draco", "drc", Binary, Repair::Nothing),
    kind("meshes", "obj", Text, Repair::Nothing),
    kind("meshes", "off", Text, Repair::Nothing),
    kind("meshes", "stl", Binary, Repair::Nothing),
    kind("meshes", "gltf", Json, Repair::Nothing),
    kind("meshes", "glb", Binary, Repair::Gltf),
    kind("arrays", "npy", TextHead, Repair::Nothing),
    kind("arrays", "npz", Binary, Repair::Zip),
    kind("arrays", "bin", Binary, Repair::Nothing),
    kind("splats", "splat", Binary, Repair::Nothing),
    kind("splats", "spz", Binary, Repair::Gzip),
    kind("recordings", "bag", Binary, Repair::Nothing),
    kind("recordings", "mcap", Binary, Repair::Mcap),
    kind("recordings", "db3", Binary, Repair::Nothing),
    kind("packets", "pcap", Binary, Repair::Nothing),
    kind("packets", "pcapng", Binary, Repair::PcapNg),
    kind("archives", "zip", Binary, Repair::Zip),
    kind("archives", "tar", Binary, Repair::Tar),
    kind("archives", "tgz", Binary, Repair::Gzip),
    kind("archives", "gz", Binary, Repair::Gzip),
    kind("depth", "mkv", Binary, Repair::Nothing),
];

/// Recordings of live streams, which are sent to a client too.
pub(crate) const STREAMS: &str = "streams";

/// No files, but faults that the watching of processes is tried with.
pub(crate) const FAULTS: &str = "faults";

/// Files that the window keeps.
pub(crate) const SETTINGS: &str = "settings";

/// Sets whose seeds are folders, which are opened as such.
pub(crate) const FOLDERS: [&str; 2] = ["photos", "depth"];

/// Files that are read along with others alone.
const BESIDE: &[Kind] = &[
    kind("", "png", Binary, Repair::Png),
    kind("", "json", Json, Repair::Nothing),
    kind("", "out", Text, Repair::Nothing),
    kind("", "nvm", Text, Repair::Nothing),
    kind("", "bin", Binary, Repair::Nothing),
];

/// Names of all sets, in order.
pub(crate) fn sets() -> Vec<&'static str> {
    let mut sets: Vec<&str> = KINDS.iter().map(|kind| kind.set).chain(FOLDERS).collect();
    let mut known = std::collections::BTreeSet::new();
    sets.retain(|set| known.insert(*set));
    sets
}

pub(crate) fn extension_of(name: &str) -> String {
    name.rsplit_once('.')
        .map_or("", |(_, extension)| extension)
        .to_ascii_lowercase()
}

/// The kind of a file of this name in a set.
pub(crate) fn kind_of(set: &str, name: &str) -> Kind {
    let extension = extension_of(name);
    let own = KINDS.iter().filter(|kind| kind.set == set);
    let known = own.chain(BESIDE).chain(KINDS).find(|kind| kind.extension == extension);
    known.copied().unwrap_or(kind("", "", Binary, Repair::Nothing))
}
