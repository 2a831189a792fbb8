//! Memory limit of reading, and treatment of meshes.

use crate::io::columns::column_map::ColumnMap;
use crate::io::format::Format;
use std::num::NonZeroUsize;

/// Options for reading files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadOptions {
    /// Most bytes that one frame may take in memory: a file that unpacks to more is refused before it is unpacked, or
    /// read in part where it has coarse levels.
    pub max_memory_bytes: u64,
    /// Number of points sampled evenly from the faces of a mesh, instead of its vertices.
    pub sample_count: Option<NonZeroUsize>,
    /// Number of points sampled from files of mesh formats only, whose vertices alone show little.
    pub mesh_sample_count: Option<NonZeroUsize>,
    /// True if vertex colours exclude the textures on the faces between them, which are then returned separately, for
    /// callers that draw faces.
    pub keeps_textures: bool,
    /// Meaning of the columns of text and of files without a header (`.bin`); their names and values decide if `None`.
    pub columns: Option<ColumnMap>,
    /// Bytes of them that are in memory while the rest is read, such as the file itself.
    pub(in crate::io) held_bytes: u64,
}

impl ReadOptions {
    /// Limit where the memory of the machine is not known.
    const FALLBACK_BYTES: u64 = 4 << 30;

    /// Returns the options that apply to a file of `format`.
    pub(in crate::io) fn of_format(self, format: Format) -> Self {
        let of_meshes = self.mesh_sample_count.filter(|_| format.is_for_meshes());
        self.with_sample_count(self.sample_count.or(of_meshes))
    }

    /// Returns the options with another memory limit.
    #[must_use]
    pub fn with_max_memory(self, max_memory_bytes: u64) -> Self {
        Self {
            max_memory_bytes,
            ..self
        }
    }

    /// Returns the options with other columns of text and of files without a header.
    #[must_use]
    pub fn with_columns(self, columns: Option<ColumnMap>) -> Self {
        Self { columns, ..self }
    }

    /// Returns the options for reading the vertices of meshes, with their faces and textures.
    #[must_use]
    pub fn of_meshes(self) -> Self {
        Self {
            keeps_textures: true,
            ..self.with_sample_count(None).with_mesh_sample_count(None)
        }
    }

    /// Returns the options with the given number of points sampled from each file of a mesh format; `None` for its
    /// vertices.
    #[must_use]
    pub fn with_mesh_sample_count(self, mesh_sample_count: Option<NonZeroUsize>) -> Self {
        Self {
            mesh_sample_count,
            ..self
        }
    }

    /// Returns the options with the given number of points sampled from anything that has faces; `None` for its
    /// vertices.
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
