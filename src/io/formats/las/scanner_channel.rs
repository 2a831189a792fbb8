//! Prediction context of the layered points of one scanner channel (see [`super::layered_point`]): its last point, and
//! all models that adapt to its points.
//!
//! A symbol encodes the changes, in the context of the kind of the last return. Steps in the plane are predicted by the
//! median step between similar returns, heights by the last return at the same distance from the end of its pulse,
//! classes by the last one, and intensities by the last similar return. For steps and intensities, returns are similar
//! only if both or none of them have a new time, and thus begin a pulse.
//!
//! Source: LAZ Specification 1.4 R1 (rapidlasso), item `POINT14`.

use super::gps_times::GpsTimes;
use super::header::take;
use super::median::Median;
use laz::decoders::ArithmeticDecoder;
use laz::decompressors::{IntegerDecompressor, IntegerDecompressorBuilder};
use laz::models::{ArithmeticModel, ArithmeticModelBuilder};
use std::array::from_fn;
use std::io::{Cursor, Result};

pub(super) type Layer = ArithmeticDecoder<Cursor<Vec<u8>>>;

pub(super) const POINT_BYTES: usize = 30;

/// Byte offsets of the fields in a point; the coordinates are at its start.
const INTENSITY: usize = 12;
const RETURNS: usize = 14;
const CHANNEL: usize = 15;
const CLASS: usize = 16;
const TIME: usize = 22;

const CHANNEL_SHIFT: u32 = 4;
const CHANNEL_MASK: u8 = 3 << CHANNEL_SHIFT;

/// Flags of the change symbol for fields other than the return number, which is in its last two bits.
pub(super) const OTHER_CHANNEL: u32 = 1 << 6;
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

/// Prediction context of the points of one scanner channel.
pub(super) struct Channel {
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

/// The largest contexts of coders of y and z, apart from whether there is a single return: bits of the steps before
/// them.
const Y_BITS: u32 = 20;
const Z_BITS: u32 = 18;

impl Channel {
    /// The context of the first point of a chunk.
    pub(super) fn new(point: [u8; POINT_BYTES]) -> Self {
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

    /// The channel `number`, which first comes up behind the point `last` of another one.
    pub(super) fn behind(mut last: [u8; POINT_BYTES], number: usize) -> Self {
        last[CHANNEL] = last[CHANNEL] & !CHANNEL_MASK | (number as u8) << CHANNEL_SHIFT;
        Self::new(last)
    }

    pub(super) fn number(&self) -> usize {
        usize::from((self.point[CHANNEL] & CHANNEL_MASK) >> CHANNEL_SHIFT)
    }

    pub(super) fn last_point(&self) -> &[u8; POINT_BYTES] {
        &self.point
    }

    fn put<const N: usize>(&mut self, at: usize, bytes: [u8; N]) {
        self.point[at..at + N].copy_from_slice(&bytes);
    }

    /// Number of returns and of the return.
    fn pulse(&self) -> (usize, usize) {
        let returns = usize::from(self.point[RETURNS]);
        (returns >> 4, returns & 15)
    }

    /// Returns the kind of the last return as bit flags: first of its pulse, last of its pulse, new time.
    fn last_kind(&self) -> usize {
        let (count, number) = self.pulse();
        usize::from(number == 1) | usize::from(number >= count) << 1 | usize::from(self.has_new_time) << 2
    }

    /// Returns the kind of this return as bit flags: last of its pulse, first of its pulse.
    fn kind(&self) -> usize {
        let (count, number) = self.pulse();
        usize::from(number >= count) | usize::from(number == 1) << 1
    }

    /// Decodes the change symbol of the next point; a point of another channel continues there.
    pub(super) fn next_changes(&mut self, layer: &mut Layer) -> Result<u32> {
        let kind = self.last_kind();
        layer.decode_symbol(&mut self.changes[kind])
    }

    /// Decodes the channel offset of the point, 1 to 3.
    pub(super) fn next_other_channel(&mut self, layer: &mut Layer) -> Result<usize> {
        Ok(1 + layer.decode_symbol(&mut self.other_channels)? as usize)
    }

    pub(super) fn next_returns(&mut self, layer: &mut Layer, changes: u32) -> Result<()> {
        self.has_new_time = changes & OTHER_TIME != 0;
        let (mut count, last) = self.pulse();
        if changes & OTHER_COUNT != 0 {
            count = layer.decode_symbol(adaptive(&mut self.counts[count], 16))? as usize;
        }
        let number = match changes & 3 {
            0 => last,
            1 => last + 1,
            2 => last + 15,
            _ if self.has_new_time => layer.decode_symbol(adaptive(&mut self.returns[last], 16))? as usize,
            _ => last + 2 + layer.decode_symbol(&mut self.returns_of_pulse)? as usize,
        };
        self.point[RETURNS] = ((count << 4) | (number % 16)) as u8;
        Ok(())
    }

    pub(super) fn next_position(&mut self, layer: &mut Layer, heights: Option<&mut Layer>) -> Result<()> {
        let (count, number) = self.pulse();
        let single = u32::from(count == 1);
        let pulse = usize::from(PULSES[count][number] - b'0');
        let medians = &mut self.steps[2 * pulse + usize::from(self.has_new_time)];
        let even = |bits: u32, max: u32| bits.min(max) & !1;

        let x_step = self.x.decompress(layer, medians[0].get(), single)?;
        let context = single + even(self.x.k(), Y_BITS);
        let y_step = self.y.decompress(layer, medians[1].get(), context)?;
        for (axis, step) in [x_step, y_step].into_iter().enumerate() {
            medians[axis].add(step);
            let last = i32::from_le_bytes(take(&self.point, 4 * axis));
            self.point[4 * axis..4 * axis + 4].copy_from_slice(&last.wrapping_add(step).to_le_bytes());
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

    pub(super) fn next_class(&mut self, layer: &mut Layer) -> Result<()> {
        let is_single = usize::from(self.kind() == 3);
        let context = usize::from(self.point[CLASS] & 31) << 1 | is_single;
        self.point[CLASS] = layer.decode_symbol(adaptive(&mut self.classes[context], 256))? as u8;
        Ok(())
    }

    pub(super) fn next_intensity(&mut self, layer: &mut Layer) -> Result<()> {
        let kind = self.kind();
        let last = &mut self.intensities[kind << 1 | usize::from(self.has_new_time)];
        let predicted = i32::from(*last);
        *last = self.intensity.decompress(layer, predicted, kind as u32)? as u16;
        let intensity = last.to_le_bytes();
        self.put(INTENSITY, intensity);
        Ok(())
    }

    pub(super) fn next_time(&mut self, layer: &mut Layer) -> Result<()> {
        if self.has_new_time {
            let bits = self.times.next(layer)?;
            self.put(TIME, bits.to_le_bytes());
        }
        Ok(())
    }
}

/// Models for rare contexts are made when these come up.
fn adaptive(model: &mut Option<ArithmeticModel>, symbols: u32) -> &mut ArithmeticModel {
    model.get_or_insert_with(|| ArithmeticModelBuilder::new(symbols).build())
}
