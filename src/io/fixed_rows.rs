//! Rows of one length in a file, made into points piece by piece.
//!
//! A plain copy of a file into memory is bound by memory, and so is taking it apart: whoever reads the whole first moves every
//! byte three times through memory that no cache holds. Here each thread reads a piece that its core's cache holds and takes it
//! apart, and the arrays of the cloud are written once, from their beginning to their end. Threads follow one another from the
//! file to the positions to the other attributes, each step being held by one of them, so that pieces stay in order and a step
//! is taken while others take theirs. Neither the file nor a second copy of a column is in memory beside the cloud.
//!
//! A decoder whose header tells of such rows says so ([`super::ply`], [`super::pcd`]). Whatever is unusual is left to the reading of
//! whole files, which also has the words for what is wrong: headers that claim more than there is, attributes of which a row
//! alone does not tell what it means.

use super::attributes::Roles;
use super::column::{Column, Scalar, Values};
use super::growing::{Growing, lock};
use crate::cloud::RawCloud;
use glam::DVec3;
use rayon::prelude::*;
use std::fs::File;
use std::io::{self, Read, Seek as _, SeekFrom};
use std::path::Path;
use std::sync::Mutex;

/// What is read at once: about what a core's own cache holds. Less is slower, for threads meet more often.
const PIECE_BYTES: usize = 1 << 20;

/// More threads than steps only wait: reading, positions, other attributes.
const STAGES: usize = 3;

/// A number in each row.
#[derive(Debug)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) scalar: Scalar,
    /// Bytes before it in the row.
    pub(super) offset: usize,
}

/// Rows as a header describes them.
#[derive(Debug)]
pub(super) struct FixedRows {
    /// Bytes of the file before the first row.
    pub(super) start: usize,
    pub(super) row_bytes: usize,
    pub(super) count: usize,
    pub(super) big_endian: bool,
    /// All within `row_bytes`.
    pub(super) fields: Vec<Field>,
    /// See [`RawCloud::sensor`].
    pub(super) sensor: Option<DVec3>,
}

impl FixedRows {
    /// The columns of rows that lie in `bytes` one after the other.
    pub(super) fn columns<'a>(&self, bytes: &'a [u8]) -> Vec<Column<'a>> {
        let column = |field: &Field| Column {
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

    /// The cloud in the file at `path`; `None` where it takes the whole file to tell what it means or what is wrong.
    pub(super) fn read(&self, path: &Path) -> io::Result<Option<RawCloud>> {
        let columns = self.columns(&[]);
        let roles = Roles::of(&columns)
            .ok()
            .filter(|roles| roles.are_local(&columns));
        let (Some(roles), Some(bytes)) = (roles, self.count.checked_mul(self.row_bytes)) else {
            return Ok(None);
        };
        let mut file = File::open(path)?;
        let available = file.metadata()?.len().saturating_sub(self.start as u64);
        if self.row_bytes == 0 || available < bytes as u64 {
            return Ok(None);
        }
        file.seek(SeekFrom::Start(self.start as u64))?;
        let growing = Growing::new(roles, &columns, self.count);
        self.append_pieces(file, &growing, PIECE_BYTES)?;
        let mut cloud = growing.finish();
        cloud.sensor = self.sensor;
        Ok(Some(cloud))
    }

    /// Appends the rows that `reader` has, about `piece_bytes` at once.
    fn append_pieces(
        &self,
        reader: impl Read + Send,
        growing: &Growing,
        piece_bytes: usize,
    ) -> io::Result<()> {
        let piece_rows = (piece_bytes / self.row_bytes).max(1);
        let source = Mutex::new((reader, self.count));
        let work = || {
            let mut piece = Vec::new();
            loop {
                let mut turn = lock(&source);
                let (reader, rows_left) = &mut *turn;
                let rows = piece_rows.min(*rows_left);
                if rows == 0 {
                    return Ok(());
                }
                piece.resize(rows * self.row_bytes, 0);
                let outcome = reader.read_exact(&mut piece);
                // Nothing is read behind what could not be.
                *rows_left = outcome.as_ref().map_or(0, |()| *rows_left - rows);
                outcome?;
                growing.append(&self.columns(&piece), rows, turn);
            }
        };
        if self.count <= piece_rows {
            return work();
        }
        let workers = 0..rayon::current_num_threads().min(STAGES);
        workers.into_par_iter().try_for_each(|_| work())
    }
}
