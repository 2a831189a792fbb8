//! Memory that reading may take, and what it makes of meshes.
//!
//! **The budget of a file.** [`ReadOptions::max_memory_bytes`] is the limit of the peak, not of the file. Whoever reads
//! says what is in memory already ([`ReadOptions::holding`]: the file, what it was unpacked to, parsed columns) and
//! asks before anything else is allocated ([`ReadOptions::claim`], [`ReadOptions::reserve`]): a claim that does not fit
//! is refused in a sentence, before the memory is taken.

use super::column_map::ColumnMap;
use super::error::Fault;
use super::format::Format;
use std::num::NonZeroUsize;

/// How files are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Most bytes that one frame may take in memory: a file that unpacks to more is refused before it is unpacked, or
    /// read in part where it has coarse levels.
    pub max_memory_bytes: u64,
    /// Points sampled evenly from the faces of a mesh in place of its vertices.
    pub sample_count: Option<NonZeroUsize>,
    /// The same for files of formats that are for meshes, whose vertices alone show little.
    pub mesh_sample_count: Option<NonZeroUsize>,
    /// Whether the colours of vertices are without the textures on the faces between them, which are handed over apart,
    /// for those who draw faces.
    pub keeps_textures: bool,
    /// Meaning of the columns of text and of files without a header (`.bin`); their names and values decide if `None`.
    pub columns: Option<ColumnMap>,
    /// Bytes of them that are in memory while the rest is read, such as the file itself.
    pub(super) held_bytes: u64,
}

impl ReadOptions {
    /// Limit where the memory of the machine is not known.
    const FALLBACK_BYTES: u64 = 4 << 30;

    /// What holds for a file of `format`.
    pub(super) fn of_format(self, format: Format) -> Self {
        let of_meshes = self.mesh_sample_count.filter(|_| format.is_for_meshes());
        self.with_sample_count(self.sample_count.or(of_meshes))
    }

    /// The same where `bytes` more are in memory until the reading ends.
    pub(super) fn holding(self, bytes: usize) -> Self {
        Self {
            held_bytes: self.held_bytes.saturating_add(bytes as u64),
            ..self
        }
    }

    /// Bytes that may still be taken.
    pub(super) fn left_bytes(&self) -> u64 {
        self.max_memory_bytes.saturating_sub(self.held_bytes)
    }

    /// Fails where `bytes` more, which `what` would take, are beyond the limit.
    pub(super) fn claim(&self, what: &str, bytes: u64) -> Result<(), Fault> {
        if bytes > self.left_bytes() {
            return Err(Fault::too_large(what, bytes, self));
        }
        Ok(())
    }

    /// [`Self::claim`] for `count` entries of `entry_bytes` each.
    pub(super) fn claim_entries(&self, what: &str, count: usize, entry_bytes: usize) -> Result<(), Fault> {
        self.claim(what, (count as u64).saturating_mul(entry_bytes as u64))
    }

    /// Makes room for `more` entries in a list whose length nothing tells beforehand: it doubles, as far as there is
    /// memory. The list before, which is copied, and what the allocator keeps of it count as well.
    pub(super) fn reserve<T>(&self, list: &mut Vec<T>, more: usize, what: &str) -> Result<(), Fault> {
        if list.capacity() - list.len() >= more {
            return Ok(());
        }
        let grown = (2 * list.capacity()).max(list.len().saturating_add(more));
        self.claim_entries(what, grown, 2 * size_of::<T>())?;
        list.reserve_exact(grown - list.len());
        Ok(())
    }

    /// The same with another limit.
    #[must_use]
    pub fn with_max_memory(self, max_memory_bytes: u64) -> Self {
        Self {
            max_memory_bytes,
            ..self
        }
    }

    /// The same with other columns of text and of files without a header.
    #[must_use]
    pub fn with_columns(self, columns: Option<ColumnMap>) -> Self {
        Self { columns, ..self }
    }

    /// The same for the vertices of meshes, with their faces and textures.
    #[must_use]
    pub fn of_meshes(self) -> Self {
        Self {
            keeps_textures: true,
            ..self.with_sample_count(None).with_mesh_sample_count(None)
        }
    }

    /// The same with so many points from each file of a mesh format; `None` for its vertices.
    #[must_use]
    pub fn with_mesh_sample_count(self, mesh_sample_count: Option<NonZeroUsize>) -> Self {
        Self {
            mesh_sample_count,
            ..self
        }
    }

    /// The same with so many points from whatever has faces; `None` for its vertices.
    #[must_use]
    pub fn with_sample_count(self, sample_count: Option<NonZeroUsize>) -> Self {
        Self { sample_count, ..self }
    }
}

impl Default for ReadOptions {
    /// Half of the machine's memory, meshes by their vertices.
    fn default() -> Self {
        let machine_bytes = crate::memory::machine_bytes();
        Self {
            max_memory_bytes: machine_bytes.map_or(Self::FALLBACK_BYTES, |bytes| bytes / 2),
            sample_count: None,
            columns: None,
            mesh_sample_count: None,
            keeps_textures: false,
            held_bytes: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_counts_against_every_claim() {
        let options = ReadOptions::default().with_max_memory(1000).holding(600);
        assert!(options.claim("the points", 400).is_ok());
        let refused = options.claim("the points", 401).unwrap_err().problem;
        assert!(refused.contains("the points would take"), "{refused}");
        assert!(options.claim_entries("the points", usize::MAX, 12).is_err());
        assert!(options.holding(usize::MAX).claim("the points", 1).is_err());
    }

    #[test]
    fn lists_grow_as_far_as_there_is_memory() {
        let options = ReadOptions::default().with_max_memory(1024);
        let mut list: Vec<u64> = Vec::new();
        let refused = loop {
            if let Err(fault) = options.reserve(&mut list, 1, "the faces") {
                break fault;
            }
            list.push(0);
        };
        assert!(refused.problem.contains("the faces"), "{}", refused.problem);
        assert_eq!(list.len(), 64);
    }
}
