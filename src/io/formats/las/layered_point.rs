//! The first field of points in layers (formats 6 to 10), `POINT14`: the data of every point.
//!
//! A *layer* is a stream of bytes that packs one part of all points of a chunk, so that unneeded parts can be skipped:
//! positions in the plane with returns and channels, heights, classes, flags, intensities, angles, user data, sources
//! and times. An empty layer says that its part is the first point's everywhere. The first layer begins each point with
//! a symbol of its changes. Points are predicted from the last one of the same *scanner channel*: each of the four has
//! a context, with all adaptive models (see [`super::scanner_channel`]); it starts from the previous point when its
//! channel first appears.
//!
//! This is here because of the times: the crate `laz` overflows the stack on them (see [`super::gps_times`]), and only
//! the decoder of the other layers knows which points have a new time, in which context. Flags, angles, user data and
//! sources are always skipped and stay as in the first point of the channel: clouds do not store them.
//!
//! Source: LAZ Specification 1.4 R1 (rapidlasso), item `POINT14`.

use super::header::take;
use super::scanner_channel::{Channel, Layer, OTHER_CHANNEL, POINT_BYTES};
use laz::DecompressionSelection;
use laz::decoders::ArithmeticDecoder;
use laz::record::LayeredFieldDecompressor;
use std::array::from_fn;
use std::io::{Cursor, ErrorKind, Read, Result, Seek};

const CHANNELS: usize = 4;
const LAYERS: usize = 9;

/// Layers of flags, angles, user data and sources.
const PASSED_OVER: [usize; 4] = [3, 5, 6, 7];

/// Unpacks the field, see the module.
pub(super) struct LayeredPoint {
    /// The version 3 tells the fields behind this one the channel of a point only where it changes.
    tells_every_channel: bool,
    layer_bytes: [u32; LAYERS],
    layers: [Option<Layer>; LAYERS],
    current: usize,
    channels: [Option<Box<Channel>>; CHANNELS],
}

impl LayeredPoint {
    /// For the field as `version` of the compression packs it, 3 or 4.
    pub(super) fn new(version: u16) -> Self {
        Self {
            tells_every_channel: version >= 4,
            layer_bytes: [0; LAYERS],
            layers: from_fn(|_| None),
            current: 0,
            channels: from_fn(|_| None),
        }
    }
}

impl<R: Read + Seek> LayeredFieldDecompressor<R> for LayeredPoint {
    fn size_of_field(&self) -> usize {
        POINT_BYTES
    }

    fn set_selection(&mut self, _: DecompressionSelection) {}

    fn init_first_point(&mut self, bytes: &mut R, first: &mut [u8], context: &mut usize) -> Result<()> {
        bytes.read_exact(first)?;
        let channel = Channel::new(take(first, 0));
        self.current = channel.number();
        self.channels = from_fn(|_| None);
        self.channels[self.current] = Some(Box::new(channel));
        *context = self.current;
        Ok(())
    }

    fn read_layers_sizes(&mut self, bytes: &mut R) -> Result<()> {
        for size in &mut self.layer_bytes {
            let mut raw = [0; 4];
            bytes.read_exact(&mut raw)?;
            *size = u32::from_le_bytes(raw);
        }
        Ok(())
    }

    fn read_layers(&mut self, bytes: &mut R) -> Result<()> {
        for (index, &size) in self.layer_bytes.iter().enumerate() {
            self.layers[index] = None;
            if PASSED_OVER.contains(&index) {
                bytes.seek_relative(i64::from(size))?;
            } else if size > 0 {
                let mut layer = Vec::new();
                bytes.take(u64::from(size)).read_to_end(&mut layer)?;
                let mut layer = ArithmeticDecoder::new(Cursor::new(layer));
                layer.read_init_bytes()?;
                self.layers[index] = Some(layer);
            }
        }
        Ok(())
    }

    fn decompress_field_with(&mut self, row: &mut [u8], context: &mut usize) -> Result<()> {
        let [Some(xy), z, class, _, intensity, _, _, _, time] = &mut self.layers else {
            return Err(ErrorKind::UnexpectedEof.into());
        };
        let Some(mut channel) = self.channels[self.current].as_mut() else {
            return Err(ErrorKind::InvalidInput.into());
        };
        let changes = channel.next_changes(xy)?;
        if changes & OTHER_CHANNEL != 0 {
            let further = channel.next_other_channel(xy)?;
            let last = *channel.last_point();
            self.current = (self.current + further) % CHANNELS;
            channel = self.channels[self.current].get_or_insert_with(|| Box::new(Channel::behind(last, self.current)));
            *context = self.current;
        }
        if self.tells_every_channel {
            *context = self.current;
        }

        channel.next_returns(xy, changes)?;
        channel.next_position(xy, z.as_mut())?;
        if let Some(class) = class {
            channel.next_class(class)?;
        }
        if let Some(intensity) = intensity {
            channel.next_intensity(intensity)?;
        }
        if let Some(time) = time {
            channel.next_time(time)?;
        }
        row.copy_from_slice(channel.last_point());
        Ok(())
    }
}
