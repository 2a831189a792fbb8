//! From a file to a cloud.

use super::codec::Encoded;
use super::contents::Part;
use super::error::{Fault, IoError};
use super::format::Format;
use super::list::{first_bytes, list_format};
use crate::cloud::{RawCloud, even_places};
use crate::io::columns::fixed_rows::FixedRows;
use crate::io::files::watched;
use crate::io::formats::las;
use crate::io::meshes::mesh;
use crate::io::options::ReadOptions;
use crate::io::recordings::{archive, packets, recording};
use crate::progress::Progress;
use std::path::Path;
use std::time::Duration;

/// The user of the first record behind the header of a COPC file.
const COPC: &[u8] = b"copc\0";

/// Reads the cloud in the file at `path`: by its first bytes, else by its extension. Of a file with many frames, all
/// that belong together (scans) or the first one.
pub fn read(path: &Path) -> Result<RawCloud, IoError> {
    read_part(path, &Part::Whole, &ReadOptions::default())
}

/// Reads one of the frames that [`super::list`] found in the file at `path`.
pub fn read_part(path: &Path, part: &Part, options: &ReadOptions) -> Result<RawCloud, IoError> {
    read_part_observed(path, part, options, &Progress::default())
}

/// [`read_part`], which tells `progress` how much of the file is read, then how much of it is decoded where the decoder
/// can say so, and ends soon after it was cancelled.
///
/// # Errors
/// As [`read_part`], and [`IoError::Cancelled`].
pub fn read_part_observed(
    path: &Path,
    part: &Part,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<RawCloud, IoError> {
    let cloud = read_watched(path, part, options, progress);
    if progress.is_cancelled() {
        return Err(IoError::Cancelled { path: path.to_owned() });
    }
    cloud
}

fn read_watched(path: &Path, part: &Part, options: &ReadOptions, progress: &Progress) -> Result<RawCloud, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    match part {
        Part::Member(member) => {
            let (name, bytes) = archive::read(path, member, options, progress)?;
            let options = options.holding(member.shared_bytes());
            return read_bytes_with(&name, &bytes, &Part::Whole, &options, progress);
        }
        Part::Message(message) => return recording::read(path, message, options),
        Part::Turn(turn) => return packets::read(path, turn, options, progress),
        Part::Whole | Part::Sole | Part::Scan(_) | Part::TimeStep(_) | Part::Layer(_) => {}
    }
    let magic = first_bytes(path)?;
    if magic.is_empty() {
        return Err(IoError::Empty { path: path.to_owned() });
    }
    // A file of an unsupported type may be larger than memory.
    let Some(format) = Format::detect(path, &magic) else {
        return Err(IoError::unknown(path, &magic));
    };
    // Archives and recordings may be larger than memory: only their first frame is read.
    if matches!(part, Part::Whole | Part::Sole) && format.is_container() {
        let contents = list_format(path, format, None, options)?;
        let count = contents.entries.len();
        return match contents.entries.first() {
            Some(_) if count > 1 && *part == Part::Sole => Err(IoError::NotListed {
                path: path.to_owned(),
                count,
            }),
            Some(first) if first.part != Part::Whole => read_watched(path, &first.part, options, progress),
            _ => Err(IoError::NoFrame {
                path: path.to_owned(),
                format,
                holds: contents.without_frames,
            }),
        };
    }
    if let Some((format, rows)) = fixed_rows(path, &magic) {
        // If a header claims more than the file holds, the error is reported when the whole file is read.
        let available = std::fs::metadata(path).map_err(failed)?.len();
        let needed = if rows.file_bytes() <= available {
            rows.memory_bytes()
        } else {
            available
        };
        let what = format!("{} points", rows.count);
        let claim = options.claim(&what, needed);
        claim.map_err(|fault| fault.of(path, format))?;
        if let Some(mut cloud) = rows.read(path, progress).map_err(failed)? {
            cloud.warnings.extend(rows.bytes_behind(available));
            place_warnings(&mut cloud, path, format);
            return Ok(cloud);
        }
    }
    // From a file with coarse levels only some points are read.
    let has_levels = format == las::FORMAT && magic.windows(COPC.len()).any(|bytes| bytes == COPC);
    if has_levels && let Some(cloud) = las::windows::read_levels(path, options, progress)? {
        return finished(Ok(cloud), path, format, options);
    }
    let bytes = watched::read_file(path, options.left_bytes(), progress)?;
    read_bytes_with(path, &bytes, part, options, progress)
}

/// At most `max_points` of the points in the file at `path`, and its number of points, if its rows have one length and
/// it has at least `min_points`: one point in each of `max_points` equal parts, without reading the rest. `None`
/// otherwise, and if finding them takes longer than `max_time`.
pub(crate) fn read_sample(
    path: &Path,
    max_points: usize,
    min_points: usize,
    max_time: Duration,
) -> Result<Option<(RawCloud, usize)>, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let magic = first_bytes(path)?;
    let rows = fixed_rows(path, &magic);
    let Some((format, rows)) = rows.filter(|(_, rows)| rows.count >= min_points) else {
        return Ok(None);
    };
    let places = even_places(rows.count, max_points);
    let cloud = rows.read_at(path, &places, max_time).map_err(failed)?;
    Ok(cloud.map(|mut cloud| {
        place_warnings(&mut cloud, path, format);
        (cloud, rows.count)
    }))
}

/// The format and the rows of a file that begins with `magic`, if they are of one length.
fn fixed_rows(path: &Path, magic: &[u8]) -> Option<(Format, FixedRows)> {
    let format = Format::detect(path, magic)?;
    let columns = format.codec()?.columns.as_ref()?;
    let rows = (columns.fixed_rows)(magic);
    rows.map(|rows| (format, rows))
}

/// Reads the cloud in `bytes`; `name` is used in error messages, and its extension determines the format where the
/// first bytes do not.
pub fn read_bytes(name: &Path, bytes: &[u8]) -> Result<RawCloud, IoError> {
    let (options, progress) = (ReadOptions::default(), Progress::default());
    read_bytes_with(name, bytes, &Part::Whole, &options, &progress)
}

fn read_bytes_with(
    name: &Path,
    bytes: &[u8],
    part: &Part,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<RawCloud, IoError> {
    if bytes.is_empty() {
        return Err(IoError::Empty { path: name.to_owned() });
    }
    let unknown = || IoError::unknown(name, bytes);
    let format = Format::detect(name, bytes).ok_or_else(unknown)?;
    let codec = format.codec().ok_or_else(unknown)?;
    let options = &options.of_format(format).holding(bytes.len());
    let decoded = (codec.decode)(&Encoded {
        format,
        name,
        bytes,
        part,
        options,
        progress,
    });
    finished(decoded, name, format, options)
}

/// Says in each warning which file it is of.
fn place_warnings(cloud: &mut RawCloud, name: &Path, format: Format) {
    for warning in &mut cloud.warnings {
        *warning = format!("{}, {warning} ({format} file)", name.display());
    }
}

/// Finishes the cloud that a decoder has read from a file of `format`, adding what the format defines for all its
/// clouds.
pub(super) fn finished(
    decoded: Result<RawCloud, Fault>,
    name: &Path,
    format: Format,
    options: &ReadOptions,
) -> Result<RawCloud, IoError> {
    let sampled = |mut cloud: RawCloud| {
        cloud.convention = cloud.convention.or(format.convention());
        cloud.unit = cloud.unit.or(format.unit());
        place_warnings(&mut cloud, name, format);
        if let Some(count) = options.sample_count
            && !cloud.faces.is_empty()
        {
            let options = options.holding(cloud.byte_size());
            mesh::sample(&mut cloud, count, &options)?;
        }
        Ok(cloud)
    };
    decoded.and_then(sampled).map_err(|fault| fault.of(name, format))
}
