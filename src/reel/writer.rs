//! Writing a file, group after group; readable up to the last whole group at any time.

use super::encode::{EncodedGroup, NewFrame, encode_group};
use super::error::ReelError;
use super::file::{ChunkHeader, ChunkKind, FilePart, Head, Index, Trailer, VERSION};
use super::options::ReelOptions;
use super::reader::ReelFile;
use super::{MAGIC, ReadAt};
use crate::regular_file;
use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bytes of a group that are copied at a time.
const PIECE: u64 = 1 << 22;

/// Writes a sequence file.
#[derive(Debug)]
pub struct ReelWriter<W: Write> {
    out: W,
    /// For messages.
    path: PathBuf,
    options: ReelOptions,
    index: Index,
    /// Bytes written so far, by whomever.
    written: u64,
}

impl ReelWriter<BufWriter<File>> {
    /// Creates a new file, replacing any existing one of that name.
    pub fn create(path: &Path, options: ReelOptions) -> Result<Self, ReelError> {
        let file = File::create(path).map_err(|source| io_error(path, 0, source))?;
        Self::new(BufWriter::new(file), path, options)
    }

    /// Creates a new file, replacing any existing one of that name, that states which frames of a conversion it has.
    pub fn create_part(path: &Path, options: ReelOptions, part: FilePart) -> Result<Self, ReelError> {
        let file = regular_file::create(path).map_err(|source| io_error(path, 0, source))?;
        options.check()?;
        let head = Head {
            part: Some(part),
            ..head_of(&options)
        };
        Self::with_head(BufWriter::new(file), path, options, &head)
    }

    /// A new file of groups that are copied from others ([`ReelWriter::copy_groups`]), with the head of `like`, but all
    /// frames.
    pub fn create_like(path: &Path, like: &ReelFile) -> Result<Self, ReelError> {
        let file = regular_file::create(path).map_err(|source| io_error(path, 0, source))?;
        let head = Head {
            part: like.part().map(FilePart::whole),
            ..like.head().clone()
        };
        Self::with_head(BufWriter::new(file), path, ReelOptions::default(), &head)
    }

    /// An existing file, to which groups are added; data after its last complete group is lost. The frame rate of the
    /// file is unchanged.
    pub fn append_to(path: &Path, options: ReelOptions) -> Result<Self, ReelError> {
        options.check()?;
        let io_error = |source| io_error(path, 0, source);
        let file = OpenOptions::new().read(true).write(true).open(path).map_err(io_error)?;
        let bytes: Arc<dyn ReadAt> = Arc::new(file.try_clone().map_err(io_error)?);
        let reel = ReelFile::open(bytes, path)?;
        let (index, end) = reel.into_index();
        file.set_len(end).map_err(io_error)?;
        let mut out = BufWriter::new(file);
        out.seek(SeekFrom::Start(end)).map_err(io_error)?;
        Ok(Self {
            out,
            path: path.to_owned(),
            options,
            index,
            written: end,
        })
    }
}

fn io_error(path: &Path, byte: u64, source: std::io::Error) -> ReelError {
    ReelError::Io {
        path: path.to_owned(),
        byte,
        source,
    }
}

/// Returns the header of a file with these options.
fn head_of(options: &ReelOptions) -> Head {
    let creator = concat!("pointreel ", env!("CARGO_PKG_VERSION"));
    Head {
        fps: options.fps,
        keyframes: options.keyframes,
        settings: vec![
            ("creator".into(), creator.into()),
            ("precision".into(), format!("{:?}", options.precision)),
            ("coding".into(), format!("{:?}", options.coding).to_lowercase()),
            ("normal bits".into(), options.normal_bits.to_string()),
            ("colour error".into(), options.color_error.to_string()),
            ("scalar bits".into(), options.scalar_bits.to_string()),
        ],
        part: None,
    }
}

impl<W: Write> ReelWriter<W> {
    /// Writes to anything; `path` is for messages.
    pub fn new(out: W, path: &Path, options: ReelOptions) -> Result<Self, ReelError> {
        options.check()?;
        let head = head_of(&options);
        Self::with_head(out, path, options, &head)
    }

    fn with_head(out: W, path: &Path, options: ReelOptions, head: &Head) -> Result<Self, ReelError> {
        let mut writer = Self {
            out,
            path: path.to_owned(),
            options,
            index: Index::default(),
            written: 0,
        };
        let mut begin = MAGIC.to_vec();
        begin.extend(VERSION.iter().flat_map(|number| number.to_le_bytes()));
        writer.put(&begin)?;
        writer.chunk(ChunkKind::Head, &head.to_bytes(), &[])?;
        Ok(writer)
    }

    fn put(&mut self, bytes: &[u8]) -> Result<(), ReelError> {
        let byte = self.written;
        self.out
            .write_all(bytes)
            .map_err(|source| io_error(&self.path, byte, source))?;
        self.written += bytes.len() as u64;
        Ok(())
    }

    fn chunk(&mut self, kind: ChunkKind, checked: &[u8], rest: &[u8]) -> Result<(), ReelError> {
        let header = ChunkHeader::new(kind, checked, rest.len() as u64);
        self.put(&header.to_bytes())?;
        self.put(checked)?;
        self.put(rest)
    }

    /// Encodes frames and writes them as a group: at most [`ReelOptions::keyframes`] of them is meant.
    pub fn write_group(&mut self, frames: &[NewFrame<'_>]) -> Result<(), ReelError> {
        let group = encode_group(frames, &self.options)?;
        self.write_encoded(&group)
    }

    /// Writes a group that was encoded with the same options. Once this returns, any reader that opens the file can
    /// read it.
    pub fn write_encoded(&mut self, group: &EncodedGroup) -> Result<(), ReelError> {
        let offset = self.written;
        self.chunk(ChunkKind::Group, &group.directory_bytes, &group.data)?;
        self.index.push(offset, &group.directory);
        let byte = self.written;
        self.out.flush().map_err(|source| io_error(&self.path, byte, source))
    }

    /// Writes the groups of another file behind those that are there, as they are.
    pub fn copy_groups(&mut self, from: &ReelFile) -> Result<(), ReelError> {
        for group in 0..from.groups().count() {
            let (directory, chunk) = from.group_chunk(group)?;
            let offset = self.written;
            let mut rest = chunk;
            while !rest.is_empty() {
                let count = (rest.end - rest.start).min(PIECE);
                self.put(&from.data(rest.start, count)?)?;
                rest.start += count;
            }
            self.index.push(offset, &directory);
        }
        Ok(())
    }

    /// Number of frames so far, those that were there before counted.
    pub fn frame_count(&self) -> usize {
        self.index.frames.len()
    }

    /// Number of bytes so far.
    pub fn byte_size(&self) -> u64 {
        self.written
    }

    /// Writes the index, and returns the underlying writer.
    pub fn finish(mut self) -> Result<W, ReelError> {
        let index_offset = self.written;
        let index = self.index.to_bytes();
        self.chunk(ChunkKind::Index, &index, &[])?;
        self.put(&Trailer { index_offset }.to_bytes())?;
        let byte = self.written;
        self.out.flush().map_err(|source| io_error(&self.path, byte, source))?;
        Ok(self.out)
    }
}
