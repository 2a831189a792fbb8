//! Files with coarse levels (COPC) that are larger than the memory they may take: the levels that fit are read alone,
//! chunk by chunk, with the header and the pages that say where they are.

use super::header::LasHeader;
use super::laz::{Compression, LazChunk};
use super::{COMPRESSION_ID, COMPRESSION_USER, FORMAT, coarse, copc, extra, geographic, points, unit, warn_of_levels};
use crate::cloud::RawCloud;
use crate::io::error::{Fault, IoError};
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::ops::Range;
use std::path::Path;

/// Bytes in which the header is.
const HEADER_BYTES: u64 = 375;

/// Records behind the points that are longer are not about coordinates.
const MAX_LATE_BYTES: u64 = 16 << 20;

/// The coarse levels of the file at `path` for which there is memory; `None` where all of it fits, and where it has
/// none.
pub(in crate::io) fn read_levels(
    path: &Path,
    options: &ReadOptions,
    progress: &Progress,
) -> Result<Option<RawCloud>, IoError> {
    let failed = |source| IoError::Io {
        path: path.to_owned(),
        source,
    };
    let mut file = File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?.len();
    if length <= options.left_bytes() {
        return Ok(None);
    }
    let Some(mut windows) = Windows::open(&mut file, length, *options).map_err(failed)? else {
        return Ok(None);
    };
    windows.read(progress).map_err(|fault| fault.of(path, FORMAT))
}

/// Parts of a file.
struct Windows<'a> {
    file: &'a mut File,
    length: usize,
    /// The header and the records behind it, then those behind the points.
    head: Vec<u8>,
    head_bytes: usize,
    options: ReadOptions,
}

impl<'a> Windows<'a> {
    /// Opens it with the head of the file; `None` where memory does not suffice for that.
    fn open(file: &'a mut File, length: u64, options: ReadOptions) -> io::Result<Option<Self>> {
        let Ok(length) = usize::try_from(length) else {
            return Ok(None);
        };
        let mut windows = Self {
            file,
            length,
            head: Vec::new(),
            head_bytes: 0,
            options,
        };
        let start = windows.bytes(0..length.min(HEADER_BYTES as usize))?;
        let points_start = start
            .get(96..100)
            .map_or(0, |raw| u32::from_le_bytes([raw[0], raw[1], raw[2], raw[3]]));
        let head_bytes = length.min(start.len().max(points_start as usize));
        if windows.options.claim("the head", head_bytes as u64).is_err() {
            return Ok(None);
        }
        windows.head = windows.bytes(0..head_bytes)?;
        windows.head_bytes = head_bytes;
        windows.options = options.holding(head_bytes);
        Ok(Some(windows))
    }

    fn bytes(&mut self, range: Range<usize>) -> io::Result<Vec<u8>> {
        let mut bytes = vec![0; range.len()];
        self.file.seek(SeekFrom::Start(range.start as u64))?;
        self.file.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    fn read(&mut self, progress: &Progress) -> Result<Option<RawCloud>, Fault> {
        let header = LasHeader::read(&self.head)?;
        let header = self.with_late_records(header);
        let head = std::mem::take(&mut self.head);
        let (length, options) = (self.length, self.options);
        let page = |range: Range<usize>| {
            let fits = range.end <= length && options.claim("a page", range.len() as u64).is_ok();
            fits.then(|| self.bytes(range).ok().map(Cow::Owned)).flatten()
        };
        let Some(levels) = copc::levels(&header, header.records(&head), length, page) else {
            return Ok(None);
        };
        let mut records = header.records(&head);
        let Some(record) = records.find(|record| record.is(COMPRESSION_USER, COMPRESSION_ID)) else {
            return Ok(None);
        };
        let compression = Compression::new(&header, record.data)?;
        let extra = extra::fields(&header, header.records(&head));
        // Unpacked points and the cloud are in memory at the same time.
        let point_bytes = points::Layout::of(header.format).cloud_bytes(&extra) + header.point_bytes;
        let needed = |points: u64, packed: u64| points.saturating_mul(point_bytes as u64).saturating_add(packed);
        let (chunks, count) = coarse(levels, |points, packed| needed(points, packed) <= options.left_bytes());
        if count == 0 {
            let what = format!("a cloud of {} points", header.count);
            return Err(Fault::too_large(&what, needed(header.count, 0), &options));
        }
        warn_of_levels(count, &header, &options);
        let (packed, chunks) = self.chunks(&chunks, progress)?;
        let rows = compression.unpack(&packed, &chunks, progress)?;
        drop(packed);
        let mut cloud = points::cloud(&header, &extra, &rows);
        cloud.unit = unit::unit(header.records(&head));
        geographic::note(&mut cloud, header.records(&head));
        Ok(Some(cloud))
    }

    /// `header`, with the records behind the points read behind the head.
    fn with_late_records(&mut self, header: LasHeader) -> LasHeader {
        let Some(start) = header
            .late_records_start()
            .and_then(|start| usize::try_from(start).ok())
        else {
            return header;
        };
        let bytes = self.length.saturating_sub(start) as u64;
        let fits = bytes <= MAX_LATE_BYTES && self.options.claim("records", bytes).is_ok();
        let late = fits
            .then(|| self.bytes(start..self.length).ok())
            .flatten()
            .unwrap_or_default();
        self.options = self.options.holding(late.len());
        self.head.extend(late);
        header.with_late_records_at(self.head_bytes)
    }

    /// The bytes of `chunks` one after the other, and the chunks in these.
    fn chunks(&mut self, chunks: &[LazChunk], progress: &Progress) -> Result<(Vec<u8>, Vec<LazChunk>), Fault> {
        let all = chunks.iter().map(|chunk| chunk.bytes.len()).sum();
        let mut packed = Vec::with_capacity(all);
        progress.set(0, all);
        let mut moved = Vec::with_capacity(chunks.len());
        for chunk in chunks {
            if progress.is_cancelled() {
                return Err(Fault::cancelled());
            }
            let start = packed.len();
            let bytes = self.bytes(chunk.bytes.clone()).map_err(|error| {
                Fault::header(format!(
                    "the chunk at byte {} cannot be read ({error})",
                    chunk.bytes.start
                ))
            })?;
            packed.extend(bytes);
            moved.push(LazChunk {
                bytes: start..packed.len(),
                points: chunk.points,
            });
            progress.set(packed.len(), all);
        }
        Ok((packed, moved))
    }
}
