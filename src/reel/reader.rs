//! A file being read: its head and index, or, without an index, the groups found by going from chunk to chunk.

use super::cut::note_of_group;
use super::error::{Fault, ReelError};
use super::file::{
    CHUNK_HEADER_BYTES, ChunkHeader, ChunkKind, Directory, FilePart, Head, Index, MAGIC_AND_VERSION_BYTES, SYNC,
    TRAILER_BYTES, Trailer, VERSION, bytes_at,
};
use super::frame::StreamKind;
use super::{MAGIC, ReadAt};
use std::cmp::Ordering;
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Bytes that are looked through at a time for the next chunk behind a damaged one.
const PIECE: usize = 1 << 16;

/// Bytes behind a damaged group that are looked through: groups are smaller, and a sparse file has terabytes of zeros.
const MAX_SEARCHED_BYTES: u64 = 1 << 30;

/// Bytes of the largest directory or index: millions of frames.
const MAX_CHECKED_BYTES: u32 = 1 << 28;

/// A sequence file.
pub struct ReelFile {
    bytes: Arc<dyn ReadAt>,
    path: PathBuf,
    len: u64,
    head: Head,
    index: Index,
    /// Byte offset at which the next group would be written.
    end: u64,
    damage: Vec<String>,
    /// True if the end of the file truncates its last group.
    is_cut: bool,
}

impl fmt::Debug for ReelFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ReelFile")
            .field("path", &self.path)
            .field("len", &self.len)
            .field("head", &self.head)
            .finish_non_exhaustive()
    }
}

/// Metadata of a frame, known before it is decoded.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameInfo<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its time stamp.
    pub time: Option<Duration>,
    /// Points of the cloud that was written.
    pub points_written: u64,
    /// Points of the frame, once all of it is decoded.
    pub points: usize,
    /// The frames of its group.
    pub group: Range<usize>,
    /// Points of every choice of how much is decoded, from the root down; the last is all.
    pub level_points: &'a [usize],
    /// Bytes of each kind of stream, in the order of [`StreamKind::ALL`].
    pub bytes_by_stream: [u64; StreamKind::ALL.len()],
}

impl ReelFile {
    /// Opens the file at a path.
    ///
    /// # Errors
    /// As [`ReelFile::open`], and a file that cannot be opened.
    pub fn open_path(path: &Path) -> Result<Self, ReelError> {
        let file = crate::regular_file::open(path).map_err(|source| ReelError::Io {
            path: path.to_owned(),
            byte: 0,
            source,
        })?;
        Self::open(Arc::new(file), path)
    }

    /// Opens a file named `path` in messages: reads its head and its index. Without an index, as after a crash or while
    /// it is written, groups are found one by one. In a group truncated by the end of the file, the frames have the
    /// levels that are there.
    ///
    /// # Errors
    /// Another kind of file, one of a later version, and one without a byte that could be read.
    pub fn open(bytes: Arc<dyn ReadAt>, path: &Path) -> Result<Self, ReelError> {
        let io_error = |byte: u64| {
            move |source| ReelError::Io {
                path: path.to_owned(),
                byte,
                source,
            }
        };
        let len = bytes.len().map_err(io_error(0))?;
        let mut begin = [0; MAGIC_AND_VERSION_BYTES];
        let there = begin.len().min(len as usize);
        bytes.read_at(0, &mut begin[..there]).map_err(io_error(0))?;
        check_begin(&begin[..there], path)?;
        let mut file = Self {
            bytes,
            path: path.to_owned(),
            len,
            head: Head::default(),
            index: Index::default(),
            end: len,
            damage: Vec::new(),
            is_cut: false,
        };
        file.read_head();
        if !file.read_index() {
            file.scan()?;
        }
        Ok(file)
    }

    fn fault(&self, byte: u64, fault: Fault) -> ReelError {
        fault.at(&self.path, byte)
    }

    fn io_error(&self, byte: u64, source: std::io::Error) -> ReelError {
        ReelError::Io {
            path: self.path.clone(),
            byte,
            source,
        }
    }

    /// `count` bytes from a place on, if they are there.
    fn take(&self, offset: u64, count: u64) -> Result<Vec<u8>, ReelError> {
        let end = offset.checked_add(count);
        if end.is_none_or(|end| end > self.len) {
            let problem = format!("{count} bytes were expected, the file has {}", self.len);
            return Err(self.fault(offset, Fault::new(problem)));
        }
        bytes_at(&*self.bytes, offset, count as usize).map_err(|source| self.io_error(offset, source))
    }

    fn chunk_header(&self, offset: u64) -> Result<ChunkHeader, ReelError> {
        let bytes = self.take(offset, CHUNK_HEADER_BYTES as u64)?;
        let mut header = [0; CHUNK_HEADER_BYTES];
        header.copy_from_slice(&bytes);
        ChunkHeader::read(&header).map_err(|fault| self.fault(offset, fault))
    }

    /// Reads the checksummed part of a chunk, if the chunk is of the given kind.
    fn checked(&self, offset: u64, kind: ChunkKind) -> Result<(ChunkHeader, Vec<u8>), ReelError> {
        let header = self.chunk_header(offset)?;
        if header.kind != kind {
            let problem = format!("a chunk of kind {kind:?} was expected, found was {:?}", header.kind);
            return Err(self.fault(offset, Fault::new(problem)));
        }
        if header.checked_len > MAX_CHECKED_BYTES {
            let problem = format!("a directory of {} bytes: at most 256 MiB can be", header.checked_len);
            return Err(self.fault(offset, Fault::new(problem)));
        }
        let start = offset + CHUNK_HEADER_BYTES as u64;
        let checked = self.take(start, u64::from(header.checked_len))?;
        header.check(&checked).map_err(|fault| self.fault(start, fault))?;
        Ok((header, checked))
    }

    /// The directory of the group at a place, as all of it was written.
    fn read_directory(&self, offset: u64) -> Result<(ChunkHeader, Directory), ReelError> {
        let (header, bytes) = self.checked(offset, ChunkKind::Group)?;
        let directory = Directory::read(&bytes, header.unchecked_len()).map_err(|fault| self.fault(offset, fault))?;
        Ok((header, directory))
    }

    /// A damaged head costs nothing that is drawn.
    fn read_head(&mut self) {
        let head = self
            .checked(MAGIC_AND_VERSION_BYTES as u64, ChunkKind::Head)
            .and_then(|(_, bytes)| {
                Head::read(&bytes).map_err(|fault| self.fault(MAGIC_AND_VERSION_BYTES as u64, fault))
            });
        match head {
            Ok(head) => self.head = head,
            Err(error) => self.damage.push(error.to_string()),
        }
    }

    /// False if there is no readable index.
    fn read_index(&mut self) -> bool {
        let Some(trailer_offset) = self.len.checked_sub(TRAILER_BYTES as u64) else {
            return false;
        };
        let Ok(bytes) = self.take(trailer_offset, TRAILER_BYTES as u64) else {
            return false;
        };
        let mut trailer = [0; TRAILER_BYTES];
        trailer.copy_from_slice(&bytes);
        let Some(trailer) = Trailer::read(&trailer) else {
            return false;
        };
        let index = self
            .checked(trailer.index_offset, ChunkKind::Index)
            .and_then(|(_, bytes)| Index::read(&bytes).map_err(|fault| self.fault(trailer.index_offset, fault)));
        match index {
            Ok(index) => {
                self.index = index;
                self.end = trailer.index_offset;
                true
            }
            Err(error) => {
                self.damage.push(error.to_string());
                false
            }
        }
    }

    /// Finds the groups one by one.
    fn scan(&mut self) -> Result<(), ReelError> {
        let mut offset = MAGIC_AND_VERSION_BYTES as u64;
        self.end = offset;
        while offset + CHUNK_HEADER_BYTES as u64 <= self.len {
            match self.scan_chunk(offset) {
                Ok(Some(next)) => {
                    offset = next;
                    self.end = next;
                }
                // The last chunk, which is incomplete.
                Ok(None) => break,
                Err(error) => {
                    self.damage.push(error.to_string());
                    match self.find_chunk(offset + 1)? {
                        Some(next) => offset = next,
                        None => break,
                    }
                }
            }
        }
        if self.damage.is_empty() {
            self.damage.push(format!(
                "{} has no index at its end: it is still being written, or was cut; it has {} whole frames",
                self.path.display(),
                self.index.frames.len()
            ));
        }
        Ok(())
    }

    /// The chunk at a place; where the next one is, unless this one is not whole.
    fn scan_chunk(&mut self, offset: u64) -> Result<Option<u64>, ReelError> {
        let header = self.chunk_header(offset)?;
        let end = (offset + CHUNK_HEADER_BYTES as u64).checked_add(header.len);
        let Some(end) = end.filter(|&end| end <= self.len) else {
            if header.kind == ChunkKind::Group {
                self.take_cut_group(offset);
            }
            return Ok(None);
        };
        match header.kind {
            ChunkKind::Group => {
                let (_, directory) = self.read_directory(offset)?;
                self.index.push(offset, &directory);
            }
            // The next chunk to be written replaces it.
            ChunkKind::Index => return Ok(None),
            ChunkKind::Head | ChunkKind::Unknown(_) => {}
        }
        Ok(Some(end))
    }

    /// The last group, of which the file has only the beginning.
    fn take_cut_group(&mut self, offset: u64) {
        let first = self.index.frames.len();
        let (header, mut directory) = match self.read_directory(offset) {
            Ok(read) => read,
            Err(error) => {
                let path = self.path.display();
                self.damage.push(format!(
                    "{path} ends early: within a group, whose frames, from frame {first} on, are missing ({error})"
                ));
                return;
            }
        };
        let missing = directory.cut(self.data_there(offset, &header).unwrap_or(0));
        self.damage.push(note_of_group(&self.path, &directory, first, missing));
        if !directory.frames.is_empty() {
            self.index.push(offset, &directory);
            self.is_cut = true;
        }
    }

    /// Bytes of the data of a group that the end of the file cuts; `None` of a whole one.
    fn data_there(&self, offset: u64, header: &ChunkHeader) -> Option<u64> {
        let start = offset + CHUNK_HEADER_BYTES as u64;
        let end = start.saturating_add(header.len);
        (end > self.len).then(|| self.len.saturating_sub(start + u64::from(header.checked_len)))
    }

    /// Finds the next chunk, searching from a byte offset on, and returns its offset.
    fn find_chunk(&self, from: u64) -> Result<Option<u64>, ReelError> {
        let mut offset = from;
        let end = from.saturating_add(MAX_SEARCHED_BYTES).min(self.len);
        while offset + (SYNC.len() as u64) < end {
            let count = (PIECE as u64).min(end - offset);
            let piece = self.take(offset, count)?;
            for (place, _) in piece
                .windows(SYNC.len())
                .enumerate()
                .filter(|(_, bytes)| *bytes == SYNC)
            {
                let found = offset + place as u64;
                if self.chunk_header(found).is_ok() {
                    return Ok(Some(found));
                }
            }
            offset += (count - SYNC.len() as u64).max(1);
        }
        Ok(None)
    }

    /// Its name in messages.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Number of its bytes when it was opened.
    pub fn byte_size(&self) -> u64 {
        self.len
    }

    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        self.index.frames.len()
    }

    /// Returns the metadata of a frame; `None` if the frame does not exist.
    pub fn frame(&self, index: usize) -> Option<FrameInfo<'_>> {
        let frame = self.index.frames.get(index)?;
        let group = self.group_of(index)?;
        Some(FrameInfo {
            name: &frame.name,
            time: frame.time,
            points_written: frame.points_written,
            points: frame.level_points.last().copied().unwrap_or(0),
            group: self.index.groups[group].frames.clone(),
            level_points: &frame.level_points,
            bytes_by_stream: frame.bytes,
        })
    }

    /// Returns the run of frames encoded relative to one another that includes `index`: they are best decoded in their
    /// order. Precondition: there is such a frame.
    pub fn run_of(&self, index: usize) -> Range<usize> {
        let is_inter = |frame: usize| self.index.frames[frame].bytes[StreamKind::Motion as usize] > 0;
        let group = match self.group_of(index) {
            Some(group) => self.index.groups[group].frames.clone(),
            None => index..index + 1,
        };
        let start = (group.start..=index).rev().find(|&frame| !is_inter(frame));
        let end = (index + 1..group.end).find(|&frame| !is_inter(frame));
        start.unwrap_or(group.start)..end.unwrap_or(group.end)
    }

    /// Returns the frame rate in frames per second, if the file states it.
    pub fn fps(&self) -> Option<f64> {
        self.head.fps
    }

    /// Frames of a group, as the file was written.
    pub fn keyframes(&self) -> u32 {
        self.head.keyframes
    }

    /// Returns the settings that the file was made with: human-readable names and values.
    pub fn settings(&self) -> &[(String, String)] {
        &self.head.settings
    }

    /// Returns the part of a conversion that the file holds, if the file states it.
    pub fn part(&self) -> Option<&FilePart> {
        self.head.part.as_ref()
    }

    /// Returns the damage notes, i.e. descriptions of the unreadable parts: one sentence each, with file and position.
    pub fn damage(&self) -> &[String] {
        &self.damage
    }

    /// Frames of each group.
    pub fn groups(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        self.index.groups.iter().map(|group| group.frames.clone())
    }

    pub(super) fn group_of(&self, frame: usize) -> Option<usize> {
        let group = self.index.groups.partition_point(|group| group.frames.end <= frame);
        (group < self.index.groups.len()).then_some(group)
    }

    /// The directory of a group, its first frame, and where its data begins.
    pub(super) fn directory(&self, group: usize) -> Result<(Directory, Range<usize>, u64), ReelError> {
        let entry = &self.index.groups[group];
        let (header, mut directory) = self.read_directory(entry.offset)?;
        if let Some(bytes) = self.data_there(entry.offset, &header) {
            directory.cut(bytes);
        }
        if directory.frames.len() != entry.frames.len() {
            let (found, expected) = (directory.frames.len(), entry.frames.len());
            let problem = format!("a group has {found} frames, and {expected} by the index");
            return Err(self.fault(entry.offset, Fault::new(problem)));
        }
        let mut listed = Index::default();
        listed.push(entry.offset, &directory);
        let by_index = &self.index.frames[entry.frames.clone()];
        if let Some(place) = (0..by_index.len()).find(|&place| listed.frames[place] != by_index[place]) {
            let frame = entry.frames.start + place;
            let problem = format!("the index and the directory of the group say different things of frame {frame}");
            return Err(self.fault(entry.offset, Fault::new(problem)));
        }
        let data = entry.offset + CHUNK_HEADER_BYTES as u64 + u64::from(header.checked_len);
        Ok((directory, entry.frames.clone(), data))
    }

    /// The directory of a group, and where its chunk is.
    pub(super) fn group_chunk(&self, group: usize) -> Result<(Directory, Range<u64>), ReelError> {
        let offset = self.index.groups[group].offset;
        let (header, directory) = self.read_directory(offset)?;
        let end = (offset + CHUNK_HEADER_BYTES as u64).checked_add(header.len);
        match end.filter(|&end| end <= self.len) {
            Some(end) => Ok((directory, offset..end)),
            None => Err(self.fault(offset, Fault::new("the end of the file cuts this group"))),
        }
    }

    /// Returns the file header.
    pub(super) fn head(&self) -> &Head {
        &self.head
    }

    /// Bytes of a group's data.
    pub(super) fn data(&self, offset: u64, count: u64) -> Result<Vec<u8>, ReelError> {
        self.take(offset, count)
    }

    /// The index, and where the next group is to be written.
    pub(super) fn into_index(self) -> (Index, u64) {
        let this = self.whole_groups();
        (this.index, this.end)
    }

    /// Returns true if the end of the file truncates its last group, so that frames of it are coarser than they were
    /// written.
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// Returns the file without the group truncated by its end: that one may still be being written.
    #[must_use]
    pub fn whole_groups(mut self) -> Self {
        if std::mem::take(&mut self.is_cut) {
            self.index.pop();
        }
        self
    }
}

fn check_begin(begin: &[u8], path: &Path) -> Result<(), ReelError> {
    let Some(rest) = begin.strip_prefix(&MAGIC) else {
        return Err(ReelError::Magic {
            path: path.to_owned(),
            found: begin[..begin.len().min(MAGIC.len())].to_vec(),
        });
    };
    let [known, _] = VERSION;
    match *rest {
        [low, high, _, _] => {
            let (path, found) = (path.to_owned(), u16::from_le_bytes([low, high]));
            match found.cmp(&known) {
                Ordering::Equal => Ok(()),
                Ordering::Less => Err(ReelError::Earlier { path, found, known }),
                Ordering::Greater => Err(ReelError::Version { path, found, known }),
            }
        }
        _ => Err(Fault::new("the file ends before its version").at(path, MAGIC.len() as u64)),
    }
}
