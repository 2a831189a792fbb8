//! Frames of a file of arrays.
//!
//! **How it works.** The number of layers is determined from the headers alone. Arrays are unpacked once for all frames
//! of a file (`io/shared.rs`); a frame then is a view of its layer, also of those companion arrays that have the same
//! number of layers.

use super::cloud::{MAX_DEFLATED, cloud_of_archive, parsed, place_of_positions, unpacked};
use super::header::Array;
use super::layers::{layer_count, numbered_frames, unroll_images};
use super::looks::{refuse, take_point_map};
use crate::cloud::RawCloud;
use crate::io::columns::column_map::ColumnMap;
use crate::io::contents::{Entry, Part};
use crate::io::error::{Fault, IoError};
use crate::io::files::watched;
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Headers are shorter: numpy writes no longer ones without being asked.
const MAX_HEADER_BYTES: u64 = 1 << 16;

/// No more frames are listed; real sequences have fewer.
const MAX_LAYERS: usize = 1_000_000;

/// The arrays of an NPZ file, unpacked, by their names.
pub(in crate::io) struct Arrays {
    members: Vec<(String, Vec<u8>)>,
    columns: Option<ColumnMap>,
}

impl Arrays {
    /// Those in the `bytes` of a file.
    pub(in crate::io) fn open(bytes: &[u8], options: &ReadOptions) -> Result<Self, Fault> {
        Ok(Self {
            members: unpacked(bytes, options)?,
            columns: options.columns,
        })
    }

    /// The one in the `bytes` of an NPY file.
    pub(in crate::io) fn of_one(bytes: Vec<u8>, columns: Option<ColumnMap>) -> Self {
        Self {
            members: vec![("points".to_owned(), bytes)],
            columns,
        }
    }

    /// The frame of this number, counted from 0; of arrays without layers there is the first alone.
    pub(in crate::io) fn frame(&self, layer: usize, options: &ReadOptions) -> Result<RawCloud, Fault> {
        cloud_of_archive(&self.members, layer, &options.with_columns(self.columns))
    }
}

/// Larger files are not read to determine their content.
const MAX_READ_BYTES: u64 = 1 << 31;

/// The frames of the file at `path`, by the headers of its arrays, and by their values where an array may be an image
/// of points. An unintelligible file is one frame, which then reports the reason.
pub(in crate::io) fn list(path: &Path, options: &ReadOptions) -> Result<Vec<Entry>, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let file = File::open(path).map_err(failed)?;
    let file_bytes = file.metadata().map_err(failed)?.len();
    let layers = layers_of(file, file_bytes);
    let is_one = || {
        let bytes = watched::read_file(path, options.left_bytes(), &Progress::default()).ok()?;
        let members = unpacked(&bytes, &options.holding(bytes.len())).ok()?;
        let arrays = parsed(&members).ok()?;
        let place = place_of_positions(&arrays)?;
        Some(is_one_cloud(arrays, place, options))
    };
    let may_be_one = layers.is_some() && file_bytes <= MAX_READ_BYTES;
    Ok(entries(layers.filter(|_| !may_be_one || is_one() != Some(true))))
}

/// The frames of the NPY file at `path`, as for an archive.
pub(in crate::io) fn list_array(path: &Path, options: &ReadOptions) -> Result<Vec<Entry>, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let file = File::open(path).map_err(failed)?;
    let file_bytes = file.metadata().map_err(failed)?.len();
    let layers = || {
        let array = Array::parse_head(&head(file))?;
        layers_of_array(vec![(String::new(), array)], 0, file_bytes)
    };
    let layers = layers();
    let is_one = || {
        let bytes = watched::read_file(path, options.left_bytes(), &Progress::default()).ok()?;
        let array = Array::parse(&bytes).ok()?;
        Some(is_one_cloud(vec![(String::new(), array)], 0, options))
    };
    let may_be_one = layers.is_some() && file_bytes <= MAX_READ_BYTES;
    Ok(entries(layers.filter(|_| !may_be_one || is_one() != Some(true))))
}

/// Returns true if the array at `place` is one image of points, or nothing that has frames: reading it then reports
/// why.
fn is_one_cloud(mut arrays: Vec<(String, Array<'_>)>, place: usize, options: &ReadOptions) -> bool {
    refuse(&arrays[place].1, options.columns).is_err() || take_point_map(&mut arrays, place, options.columns).is_some()
}

fn entries(layers: Option<usize>) -> Vec<Entry> {
    let Some(layers) = layers else {
        return vec![Entry::whole()];
    };
    let entry = |layer: usize| Entry {
        name: format!("frame {}", layer + 1),
        time: None,
        part: Part::Layer(layer),
    };
    (0..layers).map(entry).collect()
}

/// The begin of an array; less where it cannot be read.
fn head(reader: impl Read) -> Vec<u8> {
    let mut head = Vec::new();
    // An error ends it: the bytes read are then too short for a header.
    let _ = reader.take(MAX_HEADER_BYTES).read_to_end(&mut head);
    head
}

/// The layers of the array with coordinates; `None` if it has none, or claims more than the file can hold.
fn layers_of(file: File, file_bytes: u64) -> Option<usize> {
    let mut archive = zip::ZipArchive::new(file).ok()?;
    let mut heads = Vec::new();
    for index in 0..archive.len() {
        let member = archive.by_index(index).ok()?;
        let name = member.name().ok()?.strip_suffix(".npy").map(str::to_owned);
        if let Some(name) = name {
            heads.push((name.to_ascii_lowercase(), head(member)));
        }
    }
    // Arrays of strings and similar types are not frames.
    let array = |(name, head): &(String, Vec<u8>)| Some((name.clone(), Array::parse_head(head)?));
    let arrays: Vec<(String, Array<'static>)> = heads.iter().filter_map(array).collect();
    let max_bytes = file_bytes.saturating_mul(MAX_DEFLATED);
    match place_of_positions(&arrays) {
        Some(place) => layers_of_array(arrays, place, max_bytes),
        None => numbered_frames(&arrays).map(|places| places.len()),
    }
}

/// The layers of the array at `place`; `None` if it has none, or claims more than `max_bytes`.
fn layers_of_array(mut arrays: Vec<(String, Array<'static>)>, place: usize, max_bytes: u64) -> Option<usize> {
    unroll_images(&mut arrays, place);
    let (_, positions) = arrays.swap_remove(place);
    let positions = positions.without_single_layers();
    let layers = layer_count(&positions).filter(|&layers| layers <= MAX_LAYERS)?;
    positions.claimed_bytes().filter(|&bytes| bytes as u64 <= max_bytes)?;
    Some(layers)
}
