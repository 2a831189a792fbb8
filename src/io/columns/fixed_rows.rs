//! Fixed-length rows of a file, decoded into points piece by piece.
//!
//! A plain copy of a file into memory is memory-bound, and so is parsing it: reading the whole file first moves every
//! byte three times through memory that no cache holds. Here each thread reads a piece that fits into its core's cache
//! and parses it, and the arrays of the cloud are written once, from their beginning to their end. Threads follow one
//! another from the file to the positions to the other attributes to each scalar field, each step being locked by one
//! of them, so that pieces stay in order and threads work on different steps concurrently. Neither the file nor a
//! second copy of a column is in memory in addition to the cloud.
//!
//! A decoder whose header describes such rows declares them ([`crate::io::formats::ply`], [`crate::io::formats::pcd`]).
//! Unusual files are left to the whole-file readers, which also have the error messages: headers that claim too many
//! rows, attributes that cannot be interpreted from a row alone.

use super::attributes::Roles;
use super::column::{Column, Scalar, Values};
use super::growing::Growing;
use crate::cloud::{AxisConvention, Dropped, ImageGrid, RawCloud};
use crate::io::files::watched::cancelled;
use crate::locks::lock;
use crate::progress::Progress;
use glam::DVec3;
use rayon::prelude::*;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek as _, SeekFrom};
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Size of a piece that is read at once: about the size of a core's own cache. Less is slower, as threads contend more
/// often.
const PIECE_BYTES: usize = 1 << 20;

/// Rows that a thread reads one after the other, between two checks of the clock.
const ROWS_PER_TASK: usize = 1 << 13;
const ROWS_PER_LOOK: usize = 1 << 5;

/// Rows nearer to each other than a page of memory are read together with the bytes between them, up to this many at
/// once.
const NARROW_GAP_BYTES: usize = 1 << 12;
const READ_AT_ONCE_BYTES: usize = 1 << 17;

/// A number in each row.
#[derive(Debug)]
pub(in crate::io) struct RowField {
    pub(in crate::io) name: String,
    pub(in crate::io) scalar: Scalar,
    /// Bytes before it in the row.
    pub(in crate::io) offset: usize,
}

/// Rows as a header describes them.
#[derive(Debug)]
pub(in crate::io) struct FixedRows {
    /// Bytes of the file before the first row.
    pub(in crate::io) start: usize,
    pub(in crate::io) row_bytes: usize,
    pub(in crate::io) count: usize,
    pub(in crate::io) big_endian: bool,
    pub(in crate::io) fields: Vec<RowField>,
    /// True if nothing follows the rows.
    pub(in crate::io) is_all: bool,
    /// See [`RawCloud::sensor`].
    pub(in crate::io) sensor: Option<DVec3>,
    /// See [`RawCloud::convention`].
    pub(in crate::io) convention: Option<AxisConvention>,
    /// See [`RawCloud::grid`].
    pub(in crate::io) grid: Option<ImageGrid>,
    /// Data of the file that is not part of the cloud.
    pub(in crate::io) dropped: Vec<Dropped>,
}

/// A warning of `rest` bytes that no header speaks of; none of a line ending.
pub(in crate::io) fn bytes_behind(rest: u64) -> Option<String> {
    const LINE_ENDING_BYTES: u64 = 2;
    let warning = || {
        format!("{rest} bytes behind the data that the header describes are not read: its counts or types may be wrong")
    };
    (rest > LINE_ENDING_BYTES).then(warning)
}

impl FixedRows {
    /// Bytes of the rows in the file, as far as the header can be believed.
    pub(in crate::io) fn file_bytes(&self) -> u64 {
        (self.count as u64).saturating_mul(self.row_bytes as u64)
    }

    /// Returns the note about trailing bytes after the rows in a file of `file_bytes`.
    pub(in crate::io) fn bytes_behind(&self, file_bytes: u64) -> Option<String> {
        let end = (self.start as u64).saturating_add(self.file_bytes());
        let rest = file_bytes.checked_sub(end).filter(|_| self.is_all)?;
        bytes_behind(rest)
    }

    /// Bytes of the cloud in memory: fields of a byte or two take four.
    pub(in crate::io) fn memory_bytes(&self) -> u64 {
        let columns = self.columns(&[]);
        let point_bytes = Roles::of(&columns).map_or(self.row_bytes, |roles| roles.point_bytes(&columns));
        (self.count as u64).saturating_mul(point_bytes as u64)
    }

    /// The columns of rows that lie in `bytes` one after the other.
    pub(in crate::io) fn columns<'a>(&self, bytes: &'a [u8]) -> Vec<Column<'a>> {
        let column = |field: &RowField| Column {
            name: field.name.clone(),
            scalar: field.scalar,
            values: Values::Packed {
                bytes,
                start: field.offset,
                step: self.row_bytes,
                big_endian: self.big_endian,
            },
        };
        self.fields.iter().map(column).collect()
    }

    /// The cloud in the file at `path`; `None` where interpreting it, or finding its fault, takes the whole file.
    pub(in crate::io) fn read(&self, path: &Path, progress: &Progress) -> io::Result<Option<RawCloud>> {
        let Some((roles, mut file)) = self.open(path)? else {
            return Ok(None);
        };
        file.seek(SeekFrom::Start(self.start as u64))?;
        let growing = Growing::new(roles, &self.columns(&[]), self.count);
        progress.set(0, self.count * self.row_bytes);
        self.append_pieces(file, &growing, PIECE_BYTES, progress)?;
        Ok(Some(self.finished(growing)))
    }

    /// The cloud of the rows at `places` (ascending), reading little more than these; `None` as for
    /// [`FixedRows::read`], and where that takes longer than `max_time`: a disk may have to seek for every row.
    ///
    /// Precondition: each place is below the number of rows.
    pub(in crate::io) fn read_at(
        &self,
        path: &Path,
        places: &[usize],
        max_time: Duration,
    ) -> io::Result<Option<RawCloud>> {
        let Some((roles, _)) = self.open(path)? else {
            return Ok(None);
        };
        let begin = Instant::now();
        let mut rows = vec![0; places.len() * self.row_bytes];
        let gap_bytes = self.count * self.row_bytes / places.len().max(1);
        let buffer_bytes = if gap_bytes < NARROW_GAP_BYTES {
            READ_AT_ONCE_BYTES
        } else {
            self.row_bytes
        };
        rows.par_chunks_mut(ROWS_PER_TASK * self.row_bytes)
            .zip(places.par_chunks(ROWS_PER_TASK))
            .try_for_each(|(rows, places)| {
                let mut reader = BufReader::with_capacity(buffer_bytes, File::open(path)?);
                let mut at = 0;
                for (index, place) in places.iter().enumerate() {
                    let start = self.start + place * self.row_bytes;
                    reader.seek_relative((start - at) as i64)?;
                    reader.read_exact(&mut rows[index * self.row_bytes..][..self.row_bytes])?;
                    at = start + self.row_bytes;
                    if index % ROWS_PER_LOOK == 0 && begin.elapsed() > max_time {
                        return Err(io::ErrorKind::TimedOut.into());
                    }
                }
                Ok(())
            })
            .map(|()| {
                let growing = Growing::new(roles, &self.columns(&[]), places.len());
                growing.append(&self.columns(&rows), places.len(), ());
                Some(self.finished(growing))
            })
            .or_else(|error: io::Error| match error.kind() {
                io::ErrorKind::TimedOut => Ok(None),
                _ => Err(error),
            })
    }

    /// The points that were read, with the header's data about all of them.
    fn finished(&self, growing: Growing) -> RawCloud {
        let mut cloud = RawCloud {
            sensor: self.sensor,
            convention: self.convention,
            grid: self.grid,
            ..growing.finish()
        };
        cloud.dropped.extend_from_slice(&self.dropped);
        cloud
    }

    /// Returns the roles of the columns, and the file at `path`, if each row fully describes its point and the file has
    /// all rows that the header claims.
    fn open(&self, path: &Path) -> io::Result<Option<(Roles, File)>> {
        let columns = self.columns(&[]);
        let roles = Roles::of(&columns).ok();
        let roles = roles.filter(|roles| roles.are_local(&columns));
        let is_within = |field: &RowField| field.offset + field.scalar.byte_size() <= self.row_bytes;
        let (Some(roles), Some(bytes), true) = (
            roles,
            self.count.checked_mul(self.row_bytes),
            self.fields.iter().all(is_within),
        ) else {
            return Ok(None);
        };
        let file = File::open(path)?;
        let available = file.metadata()?.len().saturating_sub(self.start as u64);
        Ok((available >= bytes as u64).then_some((roles, file)))
    }

    /// Appends the rows that `reader` has, about `piece_bytes` at once.
    fn append_pieces(
        &self,
        reader: impl Read + Send,
        growing: &Growing,
        piece_bytes: usize,
        progress: &Progress,
    ) -> io::Result<()> {
        let piece_rows = (piece_bytes / self.row_bytes).max(1);
        let source = Mutex::new((reader, self.count));
        let work = || {
            let mut piece = Vec::new();
            loop {
                if progress.is_cancelled() {
                    return Err(cancelled());
                }
                let mut turn = lock(&source);
                let (reader, rows_left) = &mut *turn;
                let rows = piece_rows.min(*rows_left);
                if rows == 0 {
                    return Ok(());
                }
                piece.resize(rows * self.row_bytes, 0);
                let outcome = reader.read_exact(&mut piece);
                // Nothing is read after a failed read.
                *rows_left = outcome.as_ref().map_or(0, |()| *rows_left - rows);
                outcome?;
                growing.append(&self.columns(&piece), rows, turn);
                progress.advance(piece.len());
            }
        };
        if self.count <= piece_rows {
            return work();
        }
        // More threads than steps would only wait: one step for reading, and one for each of the arrays.
        let workers = 0..rayon::current_num_threads().min(1 + growing.step_count());
        workers.into_par_iter().try_for_each(|_| work())
    }
}

#[cfg(test)]
mod tests {
    use super::super::growing;
    use super::*;
    use crate::cloud::Frame;
    use crate::io::{ReadOptions, read, read_bytes};

    const COUNT: usize = 1000;

    /// Rows with every role that can be read from a row alone, in an unusual order, with a gap and columns apart.
    fn rows(big_endian: bool) -> FixedRows {
        let names_and_types = [
            ("red", Scalar::U8),
            ("z", Scalar::F32),
            ("unknown", Scalar::U16),
            ("x", Scalar::I16),
            ("y", Scalar::F32),
            ("green", Scalar::U8),
            ("blue", Scalar::U8),
            ("alpha", Scalar::I8),
            ("nx", Scalar::F32),
            ("ny", Scalar::F32),
            ("nz", Scalar::F32),
            ("radius", Scalar::F64),
            ("ring", Scalar::U8),
            ("gps_time", Scalar::F64),
        ];
        let mut row_bytes = 0;
        let fields = names_and_types.map(|(name, scalar)| {
            let offset = row_bytes;
            row_bytes += scalar.byte_size();
            let name = name.to_owned();
            RowField { name, scalar, offset }
        });
        FixedRows {
            start: 0,
            row_bytes,
            count: COUNT,
            big_endian,
            fields: fields.into(),
            is_all: false,
            sensor: None,
            convention: None,
            grid: None,
            dropped: Vec::new(),
        }
    }

    /// Bytes in which no two rows are alike, and which some numbers read as NaN.
    fn bytes(rows: &FixedRows) -> Vec<u8> {
        let scrambled = |index: usize| (index.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 56) as u8;
        (0..rows.count * rows.row_bytes).map(scrambled).collect()
    }

    fn in_pieces(
        rows: &FixedRows,
        reader: impl Read + Send,
        piece_bytes: usize,
        threads: usize,
    ) -> io::Result<RawCloud> {
        let columns = rows.columns(&[]);
        let growing = Growing::new(Roles::of(&columns).unwrap(), &columns, rows.count);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build()
            .unwrap()
            .install(|| rows.append_pieces(reader, &growing, piece_bytes, &Progress::default()))
            .map(|()| growing.finish())
    }

    #[test]
    fn chunk_size_and_thread_count_do_not_change_the_cloud() {
        for big_endian in [false, true] {
            let rows = rows(big_endian);
            let bytes = bytes(&rows);
            let whole = growing::cloud(&rows.columns(&bytes), COUNT, &ReadOptions::default()).unwrap();
            assert_eq!(whole.positions.len(), COUNT);
            assert_eq!(whole.attributes.scalars.len(), 3);
            // NaN is not equal to itself, but prints the same.
            let whole = format!("{whole:?}");
            for threads in [1, 2, 3, 5] {
                for piece_rows in [0, 1, 7, 333, 500, COUNT, 2 * COUNT] {
                    let piece_bytes = piece_rows * rows.row_bytes + 3;
                    let cloud = in_pieces(&rows, &bytes[..], piece_bytes, threads).unwrap();
                    assert!(format!("{cloud:?}") == whole, "{threads} {piece_rows}");
                }
            }
        }
    }

    #[test]
    fn a_file_truncated_while_reading_is_an_error() {
        let rows = rows(false);
        let bytes = bytes(&rows);
        for threads in [1, 3] {
            for available in [0, 1, bytes.len() / 2, bytes.len() - 1] {
                let outcome = in_pieces(&rows, &bytes[..available], 999, threads);
                assert_eq!(outcome.unwrap_err().kind(), io::ErrorKind::UnexpectedEof);
            }
        }
    }

    #[test]
    fn reading_selected_rows_matches_the_full_read() {
        let rows = rows(true);
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes(&rows)).unwrap();
        let whole = rows.read(file.path(), &Progress::default()).unwrap().unwrap();
        for places in [vec![], vec![0, 1, 7, 500, COUNT - 1], (0..COUNT).collect()] {
            let mut expected = whole.clone();
            let retained: Vec<u32> = places.iter().map(|&place| place as u32).collect();
            expected.keep(&retained);
            let found = rows.read_at(file.path(), &places, Duration::MAX).unwrap();
            let found = found.unwrap();
            assert_eq!(found.attributes.scalars.len(), 3);
            // GPS times have their own offset.
            let comparable = |mut cloud: RawCloud| {
                cloud.attributes.scalars.retain(|field| field.name == "ring");
                format!("{cloud:?}")
            };
            if places.is_empty() {
                assert!(found.positions.is_empty());
            } else {
                assert!(comparable(found) == comparable(expected));
            }
        }
        let in_no_time = rows.read_at(file.path(), &[1], Duration::ZERO).unwrap();
        assert!(in_no_time.is_none(), "it takes too long");
    }

    #[test]
    fn row_access_is_unavailable_where_a_full_read_is_needed() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes(&rows(false))).unwrap();
        let changed = |change: fn(&mut FixedRows)| {
            let mut rows = rows(false);
            change(&mut rows);
            rows.read(file.path(), &Progress::default()).unwrap().is_some()
        };
        assert!(changed(|_| ()));
        assert!(changed(|rows| rows.count -= 1));
        assert!(!changed(|rows| rows.count += 1), "more than there is");
        assert!(!changed(|rows| rows.start = 1), "more than there is");
        assert!(!changed(|rows| rows.count = usize::MAX), "more than can be");
        let wider = |rows: &mut FixedRows| rows.fields[5].scalar = Scalar::U16;
        assert!(!changed(wider), "colours wider than a byte");
        assert!(!changed(|rows| rows.fields[3].name.clear()), "no x");
        let beyond = |rows: &mut FixedRows| rows.fields[2].offset = rows.row_bytes - 1;
        assert!(!changed(beyond), "a field that is not in its row");
    }

    /// Partial reads equal the same rows of a full read.
    #[test]
    fn a_sample_of_a_file_matches_that_of_its_cloud() {
        let file = tempfile::Builder::new().suffix(".ply").tempfile().unwrap();
        let header = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {COUNT}\nproperty float x\n\
             property float y\nproperty float z\nproperty uchar red\nproperty uchar green\n\
             property uchar blue\nend_header\n"
        );
        let mut bytes = header.into_bytes();
        for index in 0..COUNT {
            let place = [index * 37 % 101, index % 7, index].map(|axis| axis as f32);
            bytes.extend(place.iter().flat_map(|axis| axis.to_le_bytes()));
            bytes.extend([index as u8, (index >> 8) as u8, 9]);
        }
        std::fs::write(file.path(), &bytes).unwrap();
        let sample = |max, min| crate::io::read_sample(file.path(), max, min, Duration::MAX).unwrap();
        assert!(sample(100, COUNT + 1).is_none());
        let (raw, count) = sample(100, COUNT).unwrap();
        let found = Frame::from_sampled(raw, DVec3::ZERO, count).unwrap();
        let whole = read(file.path()).unwrap();
        let expected = Frame::from_raw_sample(whole, DVec3::ZERO, 100).unwrap();
        assert_eq!(found, expected);
        assert_eq!((found.len(), found.points_in_file()), (100, COUNT));
    }

    #[test]
    fn a_file_beyond_the_memory_limit_is_rejected_before_reading() {
        let file = tempfile::Builder::new().suffix(".ply").tempfile().unwrap();
        let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1000\nproperty float x\n\
                      property float y\nproperty float z\nend_header\n";
        let mut bytes = header.as_bytes().to_vec();
        bytes.resize(bytes.len() + 12_000, 0);
        std::fs::write(file.path(), &bytes).unwrap();
        let read = |max_bytes| {
            let options = ReadOptions::default().with_max_memory(max_bytes);
            crate::io::read_part(file.path(), &crate::io::Part::Whole, &options)
        };
        assert_eq!(read(12_000).unwrap().positions.len(), 1000);
        let error = read(11_999).unwrap_err().to_string();
        assert!(error.contains("1000 points would take"), "{error}");
    }

    #[test]
    fn headers_of_any_length_are_read_from_files_as_from_memory() {
        const MAGIC_BYTES: usize = crate::io::Format::MAGIC_BYTES;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ply");
        for ending in ["\n", "\r\n", "\r"] {
            for header_bytes in (MAGIC_BYTES - 3..MAGIC_BYTES + 4).chain([400, 9000]) {
                let lines = [
                    "ply",
                    "format binary_little_endian 1.0",
                    "element camera 2",
                    "property short id",
                    "element vertex 2",
                    "property float x",
                    "property float y",
                    "property float z",
                    "element face 0",
                    "property list uchar int vertex_indices",
                    "comment ",
                    "end_header",
                ];
                let length = lines.concat().len() + lines.len() * ending.len();
                let padding = format!("comment {}", "-".repeat(header_bytes - length));
                let header = lines.map(|line| if line == "comment " { &padding } else { line });
                let mut bytes = (header.join(ending) + ending).into_bytes();
                assert_eq!(bytes.len(), header_bytes);
                bytes.extend([9; 4]);
                bytes.extend((1..=6u8).flat_map(|number| f32::from(number).to_le_bytes()));
                std::fs::write(&path, &bytes).unwrap();
                let cloud = read(&path).unwrap();
                assert_eq!(cloud, read_bytes(&path, &bytes).unwrap());
                assert_eq!(cloud.positions.get(1), DVec3::new(4.0, 5.0, 6.0));
            }
        }
    }
}
