//! The first field of points in layers (formats 6 to 10), `POINT14`: all that every point has.
//!
//! A *layer* is a stream of bytes that packs one part of all points of a chunk, so that parts nobody wants are passed over: positions in
//! the plane with returns and channels, heights, classes, flags, intensities, angles, user data, sources and times. A layer of no
//! bytes says that its part is that of the first point everywhere. The first layer begins each point with a symbol of what changes.
//! Points are predicted from the last one of the same *scanner channel*: each of the four has a context, with all that adapts
//! to the points; it begins as a copy of the point before when its channel first comes up. Steps in the plane are predicted
//! by the median of those between returns alike, heights and intensities by the last return alike.
//!
//! This is here because of the times: those of the crate `laz` overflow the stack (see [`super::gps_times`]), and which points have a
//! new time, in which context, only the unpacker of the other layers knows. Flags, angles, user data and sources are always passed
//! over and stay as the first point of the channel has them: no cloud has a place for them.
//!
//! Source: LAZ Specification 1.4 R1 (rapidlasso), item `POINT14`.

use super::gps_times::GpsTimes;
use super::header::take;
use laz::DecompressionSelection;
use laz::decoders::ArithmeticDecoder;
use laz::decompressors::{IntegerDecompressor, IntegerDecompressorBuilder};
use laz::models::{ArithmeticModel, ArithmeticModelBuilder};
use laz::record::LayeredFieldDecompressor;
use std::array::from_fn;
use std::io::{Cursor, ErrorKind, Read, Result, Seek};

const POINT_BYTES: usize = 30;

/// Where parts are in a point; the coordinates are at its start.
const INTENSITY: usize = 12;
const RETURNS: usize = 14;
const CHANNEL: usize = 15;
const CLASS: usize = 16;
const TIME: usize = 22;

const CHANNELS: usize = 4;
const CHANNEL_SHIFT: u32 = 4;
const CHANNEL_MASK: u8 = 3 << CHANNEL_SHIFT;

/// What the symbol of changes says about other parts than the return number, which is in its last two bits.
const OTHER_CHANNEL: u32 = 1 << 6;
const OTHER_TIME: u32 = 1 << 4;
const OTHER_COUNT: u32 = 1 << 2;

/// By number of returns and number of the return, in either order: which returns have steps alike.
const PULSES: [&[u8; 16]; 16] = [
    b"0123453445555555",
    b"1013333333333333",
    b"2124444444433333",
    b"3345444444444444",
    b"4344544444444444",
    b"5344454444444444",
    b"3344445444444444",
    b"4344444544444444",
    b"4344444454444444",
    b"5344444445444444",
    b"5344444444544444",
    b"5334444444455444",
    b"5334444444455544",
    b"5334444444445554",
    b"5334444444444555",
    b"5334444444444455",
];
const PULSE_KINDS: usize = 6;

type Layer = ArithmeticDecoder<Cursor<Vec<u8>>>;

/// Unpacks the field, see the module.
pub(super) struct LayeredPoint {
    /// The version 3 tells the fields behind this one the channel of a point only where it changes.
    tells_every_channel: bool,
    layer_bytes: [u32; LAYERS],
    layers: [Option<Layer>; LAYERS],
    current: usize,
    channels: [Option<Box<Channel>>; CHANNELS],
}

const LAYERS: usize = 9;
/// Flags, angles, user data and sources.
const PASSED_OVER: [usize; 4] = [3, 5, 6, 7];

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

    fn init_first_point(
        &mut self,
        bytes: &mut R,
        first: &mut [u8],
        context: &mut usize,
    ) -> Result<()> {
        bytes.read_exact(first)?;
        let point: [u8; POINT_BYTES] = take(first, 0);
        self.current = usize::from((point[CHANNEL] & CHANNEL_MASK) >> CHANNEL_SHIFT);
        self.channels = from_fn(|_| None);
        self.channels[self.current] = Some(Box::new(Channel::new(point)));
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
        let changes = xy.decode_symbol(&mut channel.changes[channel.last_kind()])?;
        if changes & OTHER_CHANNEL != 0 {
            let further = 1 + xy.decode_symbol(&mut channel.other_channels)? as usize;
            let mut point = channel.point;
            self.current = (self.current + further) % CHANNELS;
            point[CHANNEL] = point[CHANNEL] & !CHANNEL_MASK | (self.current as u8) << CHANNEL_SHIFT;
            channel =
                self.channels[self.current].get_or_insert_with(|| Box::new(Channel::new(point)));
            *context = self.current;
        }
        if self.tells_every_channel {
            *context = self.current;
        }

        channel.has_new_time = changes & OTHER_TIME != 0;
        channel.next_returns(xy, changes)?;
        channel.next_position(xy, z.as_mut())?;
        if let Some(class) = class {
            channel.next_class(class)?;
        }
        if let Some(intensity) = intensity {
            channel.next_intensity(intensity)?;
        }
        if let (Some(time), true) = (time, channel.has_new_time) {
            let bits = channel.times.next(time)?;
            channel.put(TIME, bits.to_le_bytes());
        }
        row.copy_from_slice(&channel.point);
        Ok(())
    }
}

/// What predicts the points of one scanner channel.
struct Channel {
    /// The last one.
    point: [u8; POINT_BYTES],
    has_new_time: bool,
    /// By kinds of returns, each without and with a new time.
    steps: [[Median; 2]; 2 * PULSE_KINDS],
    /// By the returns behind this one.
    heights: [i32; 8],
    /// By first and last of a pulse, each without and with a new time.
    intensities: [u16; 8],
    changes: [ArithmeticModel; 8],
    other_channels: ArithmeticModel,
    counts: [Option<ArithmeticModel>; 16],
    returns: [Option<ArithmeticModel>; 16],
    returns_of_pulse: ArithmeticModel,
    x: IntegerDecompressor,
    y: IntegerDecompressor,
    z: IntegerDecompressor,
    classes: [Option<ArithmeticModel>; 64],
    intensity: IntegerDecompressor,
    times: GpsTimes,
}

/// The largest contexts of coders of y and z, apart from whether there is a single return: bits of the steps before them.
const Y_BITS: u32 = 20;
const Z_BITS: u32 = 18;

impl Channel {
    fn new(point: [u8; POINT_BYTES]) -> Self {
        let model = |symbols| ArithmeticModelBuilder::new(symbols).build();
        let integer = |bits, contexts| {
            let mut builder = IntegerDecompressorBuilder::new();
            builder.bits(bits).contexts(contexts).build_initialized()
        };
        Self {
            has_new_time: false,
            steps: [[Median::default(); 2]; 2 * PULSE_KINDS],
            heights: [i32::from_le_bytes(take(&point, 8)); 8],
            intensities: [u16::from_le_bytes(take(&point, INTENSITY)); 8],
            changes: from_fn(|_| model(128)),
            other_channels: model(3),
            counts: from_fn(|_| None),
            returns: from_fn(|_| None),
            returns_of_pulse: model(13),
            x: integer(32, 2),
            y: integer(32, Y_BITS + 2),
            z: integer(32, Z_BITS + 2),
            classes: from_fn(|_| None),
            intensity: integer(16, 4),
            times: GpsTimes::in_layers(i64::from_le_bytes(take(&point, TIME))),
            point,
        }
    }

    fn put<const N: usize>(&mut self, at: usize, bytes: [u8; N]) {
        self.point[at..at + N].copy_from_slice(&bytes);
    }

    /// Number of returns and of the return.
    fn pulse(&self) -> (usize, usize) {
        let returns = usize::from(self.point[RETURNS]);
        (returns >> 4, returns & 15)
    }

    /// Whether the last return was the first of its pulse, the last, and had a new time.
    fn last_kind(&self) -> usize {
        let (count, number) = self.pulse();
        usize::from(number == 1)
            | usize::from(number >= count) << 1
            | usize::from(self.has_new_time) << 2
    }

    /// Whether this return is the last of its pulse, and the first.
    fn kind(&self) -> usize {
        let (count, number) = self.pulse();
        usize::from(number >= count) | usize::from(number == 1) << 1
    }

    fn next_returns(&mut self, layer: &mut Layer, changes: u32) -> Result<()> {
        let (mut count, last) = self.pulse();
        if changes & OTHER_COUNT != 0 {
            count = layer.decode_symbol(adaptive(&mut self.counts[count], 16))? as usize;
        }
        let number = match changes & 3 {
            0 => last,
            1 => last + 1,
            2 => last + 15,
            _ if self.has_new_time => {
                layer.decode_symbol(adaptive(&mut self.returns[last], 16))? as usize
            }
            _ => last + 2 + layer.decode_symbol(&mut self.returns_of_pulse)? as usize,
        };
        self.point[RETURNS] = (count << 4 | number % 16) as u8;
        Ok(())
    }

    fn next_position(&mut self, layer: &mut Layer, heights: Option<&mut Layer>) -> Result<()> {
        let (count, number) = self.pulse();
        let single = u32::from(count == 1);
        let pulse = usize::from(PULSES[count][number] - b'0');
        let medians = &mut self.steps[2 * pulse + usize::from(self.has_new_time)];
        let even = |bits: u32, most: u32| bits.min(most) & !1;

        let x_step = self.x.decompress(layer, medians[0].get(), single)?;
        let context = single + even(self.x.k(), Y_BITS);
        let y_step = self.y.decompress(layer, medians[1].get(), context)?;
        for (axis, step) in [x_step, y_step].into_iter().enumerate() {
            medians[axis].add(step);
            let last = i32::from_le_bytes(take(&self.point, 4 * axis));
            self.point[4 * axis..4 * axis + 4]
                .copy_from_slice(&last.wrapping_add(step).to_le_bytes());
        }
        if let Some(layer) = heights {
            let context = single + even(self.x.k().midpoint(self.y.k()), Z_BITS);
            let height = &mut self.heights[count.abs_diff(number).min(7)];
            *height = self.z.decompress(layer, *height, context)?;
            let height = height.to_le_bytes();
            self.put(8, height);
        }
        Ok(())
    }

    fn next_class(&mut self, layer: &mut Layer) -> Result<()> {
        let is_single = usize::from(self.kind() == 3);
        let context = usize::from(self.point[CLASS] & 31) << 1 | is_single;
        self.point[CLASS] = layer.decode_symbol(adaptive(&mut self.classes[context], 256))? as u8;
        Ok(())
    }

    fn next_intensity(&mut self, layer: &mut Layer) -> Result<()> {
        let kind = self.kind();
        let last = &mut self.intensities[kind << 1 | usize::from(self.has_new_time)];
        let predicted = i32::from(*last);
        *last = self.intensity.decompress(layer, predicted, kind as u32)? as u16;
        let intensity = last.to_le_bytes();
        self.put(INTENSITY, intensity);
        Ok(())
    }
}

/// Models for rare contexts are made when these come up.
fn adaptive(model: &mut Option<ArithmeticModel>, symbols: u32) -> &mut ArithmeticModel {
    model.get_or_insert_with(|| ArithmeticModelBuilder::new(symbols).build())
}

/// The middle one of five values. A new one takes the place of the largest or the smallest, by turns: when it falls into the half from
/// which one was dropped, the next is dropped from the other half.
#[derive(Debug, Clone, Copy)]
struct Median {
    sorted: [i32; 5],
    drops_largest: bool,
}

impl Default for Median {
    fn default() -> Self {
        Self {
            sorted: [0; 5],
            drops_largest: true,
        }
    }
}

impl Median {
    fn get(self) -> i32 {
        self.sorted[2]
    }

    fn add(&mut self, value: i32) {
        let median = self.get();
        let mut rest = value;
        if self.drops_largest {
            for place in &mut self.sorted[..4] {
                (*place, rest) = (rest.min(*place), rest.max(*place));
            }
            self.sorted[4] = rest;
            self.drops_largest = value < median;
        } else {
            for place in self.sorted[1..].iter_mut().rev() {
                (*place, rest) = (rest.max(*place), rest.min(*place));
            }
            self.sorted[0] = rest;
            self.drops_largest = value <= median;
        }
    }
}
