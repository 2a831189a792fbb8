//! ASPRS LAS 1.0 to 1.4 with point formats 0 to 10, compressed (LAZ) and cloud-optimised (COPC).
//!
//! Header and points have a fixed layout and are read here: it takes one pass over the bytes, and wrong values that are
//! not needed (bounding boxes, counts of records) do no harm. The compression is the crate's except for some fields,
//! see [`laz`].

mod copc;
mod extra;
mod fields;
mod geographic;
mod gps_times;
mod header;
mod layered_point;
mod laz;
mod median;
mod points;
mod reference_system;
mod scanner_channel;
#[cfg(test)]
mod tests;
mod unit;
pub(in crate::io) mod windows;
pub(in crate::io) mod write;
mod write_fields;

pub(in crate::io) use header::take;

use crate::cloud::{AxisConvention, RawCloud};
use crate::io::error::{Fault, mebibytes};
use crate::io::format::{Format, Magic, Traits};
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use header::LasHeader;
use laz::{Compression, LazChunk};
use std::borrow::Cow;

/// ASPRS LAS, LAZ and COPC.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "LAS",
    extensions: &["las", "laz"],
    magic: &[Magic::start(b"LASF")],
    convention: Some(AxisConvention::ZUp),
    ..Traits::PLAIN
});

/// User ID of the record that describes the compression.
const COMPRESSION_USER: &[u8] = b"laszip encoded";
const COMPRESSION_ID: u16 = 22204;

/// Memory that the crate `laz` keeps for each extra byte of a point, on each thread, while it decompresses: four models
/// of 256 symbols in layers, one in the older stream.
const EXTRA_MODEL_BYTES: u64 = 4 * 2400;

pub(in crate::io) fn decode(bytes: &[u8], options: &ReadOptions, progress: &Progress) -> Result<RawCloud, Fault> {
    let mut header = LasHeader::read(bytes)?;
    let unfinished = unfinished(&mut header, bytes);
    let extra = extra::fields(&header, header.records(bytes));
    let cloud_bytes = points::Layout::of(header.format).cloud_bytes(&extra) as u64;
    let fits = |points: u64, point_bytes: u64| {
        points
            .checked_mul(point_bytes)
            .is_some_and(|needed| needed <= options.left_bytes())
    };
    let check = |point_bytes: u64| {
        if fits(header.count, point_bytes) {
            return Ok(());
        }
        let what = format!("a cloud of {} points", header.count);
        let needed = header.count.saturating_mul(point_bytes);
        Err(Fault::too_large(&what, needed, options))
    };
    let with_unit = |mut cloud: RawCloud| {
        cloud.unit = unit::unit(header.records(bytes));
        cloud.warnings.extend(unfinished.clone());
        geographic::note(&mut cloud, header.records(bytes));
        Ok(cloud)
    };
    if !header.compressed {
        let rows = rows(&header, bytes)?;
        check(cloud_bytes)?;
        return with_unit(points::cloud(&header, &extra, rows));
    }

    let record = header
        .records(bytes)
        .find(|record| record.is(COMPRESSION_USER, COMPRESSION_ID))
        .ok_or_else(|| Fault::header("the points are compressed, but no record says how: the file is damaged"))?;
    let compression = Compression::new(&header, record.data)?;
    let extra_bytes = header.point_bytes - header.extra_start();
    let model_bytes = EXTRA_MODEL_BYTES * extra_bytes as u64 * rayon::current_num_threads() as u64;
    let what = format!("the unpacking of points with {extra_bytes} extra bytes each");
    options.claim(&what, model_bytes)?;
    // Unpacked points and the cloud are in memory at the same time.
    let point_bytes = cloud_bytes + header.point_bytes as u64;
    let page = |range| bytes.get(range).map(Cow::Borrowed);
    let levels = copc::levels(&header, header.records(bytes), bytes.len(), page);
    let rows = if let Some(levels) = levels {
        let (chunks, points) = coarse(levels, |points, _| fits(points, point_bytes));
        if points == 0 {
            check(point_bytes)?;
        } else if points < header.count {
            warn_of_levels(points, &header, options);
        }
        match compression.unpack(bytes, &chunks, progress) {
            Err(_) if points == header.count => compression.unpack_all(&header, bytes, progress)?,
            unpacked => unpacked?,
        }
    } else {
        check(point_bytes)?;
        compression.unpack_all(&header, bytes, progress)?
    };
    with_unit(points::cloud(&header, &extra, &rows))
}

/// Returns the warning about a file whose header has a point count of zero although there are bytes for some: the
/// writer was interrupted before the header was filled in. Points that can be read are then counted in `header`.
fn unfinished(header: &mut LasHeader, bytes: &[u8]) -> Option<String> {
    /// An empty compressed file has a table of its chunks.
    const EMPTY_LAZ_BYTES: usize = 256;
    if header.count > 0 {
        return None;
    }
    let area = header.point_area(bytes).len();
    if header.compressed {
        return (area > EMPTY_LAZ_BYTES).then(|| {
            format!(
                "header: it counts no points, but {area} bytes of packed points may follow: who wrote the file did not \
                 finish it, write it again (LASzip's `laszip -i` may repair it)"
            )
        });
    }
    let count = area / header.point_bytes;
    header.count = count as u64;
    (count > 0).then(|| {
        format!(
            "header: it counts no points, but {count} points are behind it, which are read: who wrote the file did not \
             finish it"
        )
    })
}

/// The points of a file without compression.
fn rows<'a>(header: &LasHeader, bytes: &'a [u8]) -> Result<&'a [u8], Fault> {
    let available = &bytes[header.points_start..];
    usize::try_from(header.count)
        .ok()
        .and_then(|count| available.get(..count.checked_mul(header.point_bytes)?))
        .ok_or_else(|| {
            Fault::entry(
                "point",
                available.len() / header.point_bytes,
                format!(
                    "the file ends here, but its header claims {} points of {} bytes: it is truncated, or its header \
                     is wrong",
                    header.count, header.point_bytes
                ),
            )
        })
}

fn warn_of_levels(points: u64, header: &LasHeader, options: &ReadOptions) {
    log::warn!(
        "read {points} of {} points, the coarse levels of the file: all would take more than the {} of memory that \
         they may, raise --max-memory if the machine has it",
        header.count,
        mebibytes(options.max_memory_bytes)
    );
}

/// The chunks of all levels, from the coarsest on, whose points and packed bytes satisfy `fits`, and the number of
/// these points.
fn coarse(levels: Vec<Vec<LazChunk>>, fits: impl Fn(u64, u64) -> bool) -> (Vec<LazChunk>, u64) {
    let mut chunks = Vec::new();
    let (mut points, mut packed) = (0u64, 0u64);
    for level in levels {
        let more: u64 = level.iter().map(|chunk| chunk.points as u64).sum();
        let more_packed: u64 = level.iter().map(|chunk| chunk.bytes.len() as u64).sum();
        if !fits(points + more, packed + more_packed) {
            break;
        }
        points += more;
        packed += more_packed;
        chunks.extend(level);
    }
    (chunks, points)
}
