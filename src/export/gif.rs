//! GIF files: a palette of up to 255 colours per image, found by a neural net (`NeuQuant`) where there are more.
//!
//! Unchanged pixels are omitted (transparent): they keep their colours, whatever the palette of the new image, so that
//! static parts do not flicker.

use super::changes::changed_part;
use super::error::ExportError;
use super::sink::{FrameSink, VideoStream};
use crate::persist::Partial;
use color_quant::NeuQuant;
use gif::{Encoder, Frame, Repeat};
use image::RgbaImage;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// Sampling step of the pixels that the net learns from: every tenth.
const SPEED: i32 = 10;

/// Palette size: 256 entries, less the transparent one.
const COLORS: usize = 255;

/// A GIF that is being written.
pub(super) struct GifFile {
    output: PathBuf,
    /// Closed before its output is removed.
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
            let mut encoder = Encoder::new(BufWriter::new(file), width, height, &[]).map_err(io::Error::other)?;
            encoder.set_repeat(Repeat::Infinite).map_err(io::Error::other)?;
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
        let before = self.before.as_ref().map(|before| part.of(before));
        let (indices, palette, transparent) = quantised(&part.of(picture), before.as_deref());
        let frame = Frame {
            left,
            top,
            width,
            height,
            delay: self.stream.ticks(self.index, 100.0) as u16,
            buffer: indices.into(),
            palette: Some(palette),
            transparent: Some(transparent),
            ..Frame::default()
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

/// Pixels as places in a palette of red, green and blue; and the place that stands for pixels that are as `before`.
fn quantised(pixels: &[u8], before: Option<&[u8]>) -> (Vec<u8>, Vec<u8>, u8) {
    let (pixels, _) = pixels.as_chunks::<4>();
    let before = before.map(|before| before.as_chunks::<4>().0);
    let is_new = |place: usize| before.is_none_or(|before| before[place] != pixels[place]);
    let new: Vec<[u8; 4]> = (0..pixels.len())
        .filter(|&place| is_new(place))
        .map(|place| pixels[place])
        .collect();
    let palette = Palette::of(&new);
    let mut colors = palette.colors();
    let transparent = (colors.len() / 3) as u8;
    colors.extend([0; 3]);
    let index = |place: usize| {
        if is_new(place) {
            palette.index_of(pixels[place])
        } else {
            transparent
        }
    };
    ((0..pixels.len()).map(index).collect(), colors, transparent)
}

/// The colours of some pixels.
enum Palette {
    /// All of them, in order.
    Exact(Vec<[u8; 4]>),
    /// Such that each has one nearby.
    Learnt(NeuQuant),
}

impl Palette {
    fn of(pixels: &[[u8; 4]]) -> Self {
        let mut colors = BTreeSet::new();
        let are_few = pixels.iter().all(|&color| {
            colors.insert(color);
            colors.len() <= COLORS
        });
        if are_few {
            Self::Exact(colors.into_iter().collect())
        } else {
            Self::Learnt(NeuQuant::new(SPEED, COLORS, pixels.as_flattened()))
        }
    }

    /// Red, green and blue of each.
    fn colors(&self) -> Vec<u8> {
        match self {
            Self::Exact(colors) => colors.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect(),
            Self::Learnt(net) => net.color_map_rgb(),
        }
    }

    fn index_of(&self, color: [u8; 4]) -> u8 {
        let index = match self {
            Self::Exact(colors) => colors.partition_point(|known| *known < color),
            Self::Learnt(net) => net.index_of(&color),
        };
        index as u8
    }
}

fn failed(output: &Path, reason: io::Error) -> ExportError {
    ExportError::Write {
        path: output.to_owned(),
        reason,
    }
}
