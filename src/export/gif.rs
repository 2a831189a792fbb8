//! GIF files: up to 256 colours a picture, of its own, found by a neural net (NeuQuant) where there are more.

use super::changes::changed_part;
use super::{ExportError, FrameSink, VideoStream};
use crate::kept::Partial;
use gif::{Encoder, Frame, Repeat};
use image::RgbaImage;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// How many of the pixels the net learns from: each tenth. All of them take five times as long for a third of a dB.
const SPEED: i32 = 10;

/// A GIF that is being written.
pub(super) struct GifFile {
    output: PathBuf,
    /// Closed before what was written is removed.
    encoder: Encoder<BufWriter<File>>,
    partial: Partial,
    stream: VideoStream,
    index: usize,
    before: Option<RgbaImage>,
}

impl GifFile {
    pub(super) fn create(output: &Path, stream: &VideoStream) -> Result<Self, ExportError> {
        let create = || {
            let (partial, file) = Partial::create(output)?;
            let [width, height] = stream.size_px.map(|edge| edge as u16);
            let mut encoder =
                Encoder::new(BufWriter::new(file), width, height, &[]).map_err(io::Error::other)?;
            encoder
                .set_repeat(Repeat::Infinite)
                .map_err(io::Error::other)?;
            Ok((partial, encoder))
        };
        let (partial, encoder) = create().map_err(|reason| failed(output, reason))?;
        Ok(Self {
            output: output.to_owned(),
            partial,
            encoder,
            stream: *stream,
            index: 0,
            before: None,
        })
    }
}

impl FrameSink for GifFile {
    fn push(&mut self, picture: &RgbaImage) -> Result<(), ExportError> {
        let part = changed_part(self.before.as_ref(), picture, 1);
        let [width, height] = part.size.map(|edge| edge as u16);
        let [left, top] = part.start.map(|edge| edge as u16);
        let mut pixels = part.of(picture);
        let frame = Frame {
            left,
            top,
            delay: self.stream.ticks(self.index, 100.0) as u16,
            ..Frame::from_rgba_speed(width, height, &mut pixels, SPEED)
        };
        self.encoder
            .write_frame(&frame)
            .map_err(|reason| failed(&self.output, io::Error::other(reason)))?;
        self.index += 1;
        self.before = Some(picture.clone());
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), ExportError> {
        let Self {
            output,
            partial,
            encoder,
            ..
        } = *self;
        let finish = || {
            let written = encoder.into_inner().map_err(io::Error::other)?;
            written.into_inner()?.sync_data()?;
            partial.finish()
        };
        finish().map_err(|reason: io::Error| failed(&output, reason))
    }
}

fn failed(output: &Path, reason: io::Error) -> ExportError {
    ExportError::Write {
        path: output.to_owned(),
        reason,
    }
}
