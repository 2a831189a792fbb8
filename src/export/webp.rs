//! Animated WebP files, lossless: images by the encoder of the crate `image`, and the container around them.
//!
//! How it works: a RIFF file with the size in the chunk `VP8X`, endless repetition in `ANIM`, and an image in each
//! `ANMF`: the rectangle that changed, its duration, and its pixels (`VP8L`). See the WebP container specification
//! (<https://developers.google.com/speed/webp/docs/riff_container>).

use super::changes::{ChangedRect, changed_part};
use super::error::ExportError;
use super::sink::{FrameSink, VideoStream};
use crate::persist::Partial;
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, RgbaImage};
use std::fs::File;
use std::io::{self, BufWriter, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

const IS_ANIMATED: u8 = 0x02;
const HAS_ALPHA: u8 = 0x10;
/// A part replaces the pixels before it, alpha included.
const DO_NOT_BLEND: u8 = 0x02;

/// A WebP that is being written.
pub(super) struct WebpFile {
    output: PathBuf,
    /// Closed before its output is removed.
    file: BufWriter<File>,
    partial: Partial,
    stream: VideoStream,
    index: usize,
    before: Option<RgbaImage>,
    /// Bytes after the eight of the RIFF header.
    bytes: u64,
}

impl WebpFile {
    pub(super) fn create(output: &Path, stream: &VideoStream) -> Result<Self, ExportError> {
        let [width, height] = stream.size_px;
        let mut header = b"RIFF\0\0\0\0WEBP".to_vec();
        let alpha = if stream.is_transparent { HAS_ALPHA } else { 0 };
        let mut canvas = vec![IS_ANIMATED | alpha, 0, 0, 0];
        canvas.extend(three_bytes(width - 1));
        canvas.extend(three_bytes(height - 1));
        chunk(&mut header, *b"VP8X", &[&canvas]);
        // A transparent background, looping forever.
        chunk(&mut header, *b"ANIM", &[&[0; 6]]);
        let create = || {
            let (partial, file) = Partial::create(output)?;
            let mut file = BufWriter::new(file);
            file.write_all(&header)?;
            Ok((partial, file))
        };
        let (partial, file) = create().map_err(|reason| failed(output, reason))?;
        Ok(Self {
            output: output.to_owned(),
            partial,
            file,
            stream: *stream,
            index: 0,
            before: None,
            bytes: header.len() as u64 - 8,
        })
    }

    /// Appends a part of an image.
    fn write(&mut self, part: ChangedRect, pixels: &[u8]) -> Result<(), ExportError> {
        let [width, height] = part.size;
        let opaque: Vec<u8>;
        let (pixels, color_type) = if self.stream.is_transparent {
            (pixels, ExtendedColorType::Rgba8)
        } else {
            let (pixels, _) = pixels.as_chunks::<4>();
            opaque = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
            (opaque.as_slice(), ExtendedColorType::Rgb8)
        };
        let mut picture = Vec::new();
        // libwebp compresses better and could be lossy, but would make a C compiler a build requirement and add a
        // parser in C.
        WebPEncoder::new_lossless(&mut picture)
            .encode(pixels, width, height, color_type)
            .map_err(|reason| failed(&self.output, io::Error::other(reason)))?;
        let duration_ms = self.stream.ticks(self.index, 1000.0) as u32;
        let mut place: Vec<u8> = Vec::with_capacity(16);
        for number in [part.start[0] / 2, part.start[1] / 2, width - 1, height - 1, duration_ms] {
            place.extend(three_bytes(number));
        }
        place.push(DO_NOT_BLEND);
        let mut written = Vec::new();
        // The encoder writes a RIFF file; only the chunks after its header are needed.
        chunk(&mut written, *b"ANMF", &[&place, &picture[12..]]);
        self.bytes += written.len() as u64;
        if self.bytes > u64::from(u32::MAX) {
            return Err(ExportError::TooManyBytes);
        }
        self.file
            .write_all(&written)
            .map_err(|reason| failed(&self.output, reason))
    }
}

impl FrameSink for WebpFile {
    fn push(&mut self, picture: &RgbaImage) -> Result<(), ExportError> {
        // Positions are stored divided by two.
        let part = changed_part(self.before.as_ref(), picture, 2);
        self.write(part, &part.of(picture))?;
        self.index += 1;
        self.before = Some(picture.clone());
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), ExportError> {
        let Self {
            output,
            mut file,
            partial,
            bytes,
            ..
        } = *self;
        let finish = || {
            file.seek(SeekFrom::Start(4))?;
            file.write_all(&(bytes as u32).to_le_bytes())?;
            file.into_inner()?.sync_data()?;
            partial.finish()
        };
        finish().map_err(|reason: io::Error| failed(&output, reason))
    }
}

/// Appends a chunk of these parts, padded to an even length.
fn chunk(file: &mut Vec<u8>, name: [u8; 4], parts: &[&[u8]]) {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    file.extend(name);
    file.extend((length as u32).to_le_bytes());
    for part in parts {
        file.extend_from_slice(part);
    }
    file.extend((length % 2 == 1).then_some(0));
}

fn three_bytes(number: u32) -> [u8; 3] {
    let [low, center, high, _] = number.to_le_bytes();
    [low, center, high]
}

fn failed(output: &Path, reason: io::Error) -> ExportError {
    ExportError::Write {
        path: output.to_owned(),
        reason,
    }
}
