//! E57 files of LiDAR scanners: one or more scans, each with its own fields and pose.
//!
//! The crate `e57` reads the header and the description (XML) and verifies the checksums of the pages. The points are
//! read here, see [`streams`]: the crate would create an object per number, and fills memory where a record has no
//! bits.

mod scan;
mod streams;

use crate::cloud::{AxisConvention, LengthUnit, Positions, RawCloud, ScalarField};
use crate::io::columns::attributes;
use crate::io::contents::{Entry, Part};
use crate::io::error::{Fault, IoError};
use crate::io::files::watched::Watched;
use crate::io::format::{Format, Holding, Magic, Traits};
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use ::e57::{E57Reader, PointCloud};
use glam::DVec3;
use scan::Scan;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;
use std::time::Duration;
use streams::Pages;

/// ASTM E57 format of LiDAR scanners; E2807 specifies metres.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "E57",
    extensions: &["e57"],
    magic: &[Magic::start(b"ASTM-E57")],
    convention: Some(AxisConvention::UsuallyZUp),
    unit: Some(LengthUnit::Metre),
    holds: Holding::Scans,
    ..Traits::PLAIN
});

/// All scans, or the one that `part` names.
pub(in crate::io) fn decode(
    bytes: &[u8],
    part: &Part,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<RawCloud, Fault> {
    let mut scans = open(Cursor::new(bytes), bytes.len() as u64)?.pointclouds();
    progress.set(0, bytes.len());
    let checked = Watched {
        reader: Cursor::new(bytes),
        progress,
    };
    let page_bytes = E57Reader::validate_crc(checked).map_err(|error| {
        Fault::header(format!(
            "{}: the file was changed or cut after it was written",
            reasons(&error)
        ))
    })?;
    if let Part::Scan(index) = *part {
        let count = scans.len();
        if index >= count {
            return Err(Fault::entry(
                "scan",
                index,
                format!("the file has {count} scans: it changed since it was opened"),
            ));
        }
        scans = vec![scans.swap_remove(index)];
    }
    let has_points = scans.iter().any(|scan| scan.records > 0);
    scans.retain(|scan| scan.records > 0 || !has_points);
    scan::check_claims(&scans, bytes.len(), options)?;
    let pages = Pages::new(bytes, page_bytes);
    let numbers = |scan: &PointCloud| scan.records as usize * scan.prototype.len();
    progress.set(0, scans.iter().map(numbers).sum());
    let sensor = match scans.as_slice() {
        [scan] => scan.transform.as_ref().map(|pose| {
            let place = &pose.translation;
            DVec3::new(place.x, place.y, place.z)
        }),
        _ => None,
    };
    let scans = scans
        .iter()
        .enumerate()
        .map(|(index, scan)| Scan::read(index, scan, &pages, progress))
        .collect::<Result<Vec<Scan>, Fault>>()?;
    let mut cloud = merge(scans);
    cloud.sensor = sensor.filter(|place| place.is_finite());
    Ok(cloud)
}

/// The scans in the file at `path` that have points, or all of it if that is not more than one.
pub(in crate::io) fn list(path: &Path, _options: &ReadOptions) -> Result<Vec<Entry>, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let file = File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?.len();
    let scans = open(BufReader::new(file), length)
        .map_err(|fault| fault.of(path, FORMAT))?
        .pointclouds();
    let with_points = scans.iter().enumerate().filter(|(_, scan)| scan.records > 0);
    let mut entries: Vec<Entry> = with_points.map(|(index, scan)| entry(index, scan)).collect();
    if entries.len() <= 1 {
        return Ok(vec![Entry::whole()]);
    }
    if entries.iter().all(|entry| entry.time.is_some()) {
        entries.sort_by_key(|entry| entry.time);
    }
    Ok(entries)
}

fn entry(index: usize, scan: &PointCloud) -> Entry {
    let name = scan.name.as_deref().map(str::trim).unwrap_or_default();
    let start = scan.acquisition_start.as_ref().map(|start| start.gps_time);
    Entry {
        name: if name.is_empty() {
            format!("scan {}", index + 1)
        } else {
            name.to_owned()
        },
        time: start
            .filter(|&seconds| seconds > 0.0)
            .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
        part: Part::Scan(index),
    }
}

fn open<T: Read + Seek>(mut file: T, length: u64) -> Result<E57Reader<T>, Fault> {
    /// Byte range of the header field that holds the length of the description.
    const DESCRIPTION_BYTES: std::ops::Range<usize> = 32..40;
    let mut header = Vec::new();
    file.by_ref()
        .take(DESCRIPTION_BYTES.end as u64)
        .read_to_end(&mut header)
        .and_then(|_| file.rewind())
        .map_err(|error| Fault::header(format!("the header cannot be read ({error})")))?;
    // The crate allocates the claimed length before reading.
    let claimed = header
        .get(DESCRIPTION_BYTES)
        .map_or(0, |raw| u64::from_le_bytes(super::las::take(raw, 0)));
    if claimed > length {
        return Err(Fault::header(format!(
            "the description takes {claimed} bytes of {length}: the file is truncated, or its header is wrong"
        )));
    }
    E57Reader::new(file).map_err(|error| Fault::header(reasons(&error)))
}

/// An error with those behind it.
fn reasons(error: &::e57::Error) -> String {
    let mut text = error.to_string();
    let mut source = std::error::Error::source(error);
    while let Some(error) = source {
        let reason = error.to_string();
        if !text.contains(&reason) {
            text = format!("{text}: {reason}");
        }
        source = error.source();
    }
    text
}

/// The names of the fields of any scan, in the order in which they come up.
fn field_names(scans: &[Scan]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (name, _) in scans.iter().flat_map(|scan| &scan.scalars) {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

/// The scans as one cloud. Where only some of them have colours they are white in the others, and an intensity is 0;
/// other fields are missing values (NaN) in scans that have none.
fn merge(scans: Vec<Scan>) -> RawCloud {
    const WHITE: [u8; 4] = [255; 4];
    let count = scans.iter().map(|scan| scan.positions.len()).sum();
    let has = |what: fn(&Scan) -> bool| scans.iter().any(what);
    let all = |what: fn(&Scan) -> bool| !scans.is_empty() && scans.iter().all(what);
    let mut colors = has(|scan| scan.colors.is_some()).then(|| Vec::with_capacity(count));
    let mut normals = all(|scan| scan.normals.is_some()).then(|| Vec::with_capacity(count));
    let names = field_names(&scans).into_iter();
    let mut fields: Vec<(String, Vec<f64>)> = names.map(|name| (name, Vec::with_capacity(count))).collect();
    let mut positions = Vec::with_capacity(count);
    for scan in scans {
        let length = scan.positions.len();
        positions.extend(scan.positions);
        if let Some(colors) = &mut colors {
            colors.extend(scan.colors.unwrap_or_else(|| vec![WHITE; length]));
        }
        if let Some(normals) = &mut normals {
            normals.extend(scan.normals.unwrap_or_default());
        }
        for (name, values) in &mut fields {
            match scan.scalars.iter().find(|(found, _)| found == name) {
                Some((_, more)) => values.extend(more),
                None if name == scan::INTENSITY => values.resize(values.len() + length, 0.0),
                None => values.resize(values.len() + length, f64::NAN),
            }
        }
    }
    let mut cloud = RawCloud::from_positions(Positions::F64(positions));
    cloud.attributes.colors = colors;
    cloud.attributes.normals = normals;
    cloud.attributes.scalars = fields
        .into_iter()
        .map(|(name, values)| ScalarField::from_f64(name, &values))
        .collect();
    attributes::sort_fields(&mut cloud.attributes.scalars);
    cloud
}
