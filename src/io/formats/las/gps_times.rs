//! GPS times as LAZ packs them, for points in one stream (formats 1 and 3 to 5) and for those in layers (6 to 10).
//!
//! Times are 64 bits of a float, predicted as integers. Lines of flight overlap in a sorted file, so there are four
//! *sequences*, each with its last time and the step between two pulses. A symbol says how a time follows from the
//! sequence in use: a number of steps further and a difference from that (in a coder that depends on the number),
//! unchanged, as the first time of a new sequence, or in another sequence, whose symbol follows. Sequences without a
//! step have separate symbols. The fourth factor beyond the range of symbols, or 0, since a step last fitted makes its
//! difference the new step.
//!
//! The crate `laz` calls itself for each change of the sequence. A writer finds the target sequence and changes once;
//! modified bytes can request endless changes, within a byte, until the stack overflows, which cannot be caught. This
//! is why the times are unpacked here, with a bound. The oldest of the three encodings has a single sequence and is
//! left to the crate.
//!
//! Source: LAZ Specification 1.4 R1 (rapidlasso), items `GPSTIME11` and `POINT14`.

use laz::decoders::ArithmeticDecoder;
use laz::decompressors::{IntegerDecompressor, IntegerDecompressorBuilder};
use laz::models::{ArithmeticModel, ArithmeticModelBuilder};
use laz::record::FieldDecompressor;
use std::io::{Error, ErrorKind, Read, Result};

const SEQUENCES: usize = 4;

/// More changes of the sequence for one time come back to where they began.
const MAX_CHANGES: usize = SEQUENCES;

/// Symbols of a sequence with a step: factors, from these on negative ones, and non-factors.
const LARGEST_FACTOR: u32 = 500;
const SMALLEST_FACTOR: u32 = LARGEST_FACTOR + 10;
const UNCHANGED: u32 = SMALLEST_FACTOR + 1;
const NEW_SEQUENCE: u32 = UNCHANGED + 1;
const SYMBOLS: u32 = NEW_SEQUENCE + SEQUENCES as u32;

/// Symbols of a sequence without a step: unchanged, a first step, a new sequence, three other sequences.
const SYMBOLS_WITHOUT_STEP: u32 = 6;

/// Since the step last fitted, before it becomes another.
const MAX_MISFITS: u8 = 3;

/// One of the interleaved sequences.
#[derive(Debug, Clone, Copy, Default)]
struct Sequence {
    /// Bits of the last time.
    time: i64,
    step: i32,
    /// Number of times with a factor beyond the range of symbols since the step last fitted.
    misfits: u8,
}

/// The times of a chunk, or in layers of a scanner channel, one after the other.
pub(super) struct GpsTimes {
    sequences: [Sequence; SEQUENCES],
    current: usize,
    newest: usize,
    /// Symbols that are not there: layers say elsewhere that a time is unchanged.
    missing: u32,
    symbols: ArithmeticModel,
    symbols_without_step: ArithmeticModel,
    differences: IntegerDecompressor,
}

impl GpsTimes {
    /// For points in one stream.
    pub(super) fn in_one_stream() -> Self {
        Self::new(0, 0)
    }

    /// For points in layers, the first with the time `first`, as bits.
    pub(super) fn in_layers(first: i64) -> Self {
        Self::new(first, 1)
    }

    fn new(first: i64, missing: u32) -> Self {
        /// Coders of differences, by the factor.
        const CONTEXTS: u32 = 9;
        let mut sequences = [Sequence::default(); SEQUENCES];
        sequences[0].time = first;
        Self {
            sequences,
            current: 0,
            newest: 0,
            missing,
            symbols: ArithmeticModelBuilder::new(SYMBOLS - missing).build(),
            symbols_without_step: ArithmeticModelBuilder::new(SYMBOLS_WITHOUT_STEP - missing).build(),
            differences: IntegerDecompressorBuilder::new()
                .bits(32)
                .contexts(CONTEXTS)
                .build_initialized(),
        }
    }

    /// The next time, as bits. An error where the bytes end, or change the sequence without end.
    pub(super) fn next(&mut self, bytes: &mut ArithmeticDecoder<impl Read>) -> Result<i64> {
        for _ in 0..=MAX_CHANGES {
            let change = self.follow(bytes)?;
            if change == 0 {
                return Ok(self.sequences[self.current].time);
            }
            self.current = (self.current + change as usize) % SEQUENCES;
        }
        Err(Error::new(
            ErrorKind::InvalidData,
            "a GPS time changes from sequence to sequence and belongs to none",
        ))
    }

    /// Unpacks one symbol and its data; returns the number of sequences to advance to find the time, 0 if done.
    fn follow(&mut self, bytes: &mut ArithmeticDecoder<impl Read>) -> Result<u32> {
        let sequence = &mut self.sequences[self.current];
        if sequence.step == 0 {
            match bytes.decode_symbol(&mut self.symbols_without_step)? + self.missing {
                0 => {}
                1 => {
                    sequence.step = self.differences.decompress(bytes, 0, 0)?;
                    sequence.time = sequence.time.wrapping_add(i64::from(sequence.step));
                    sequence.misfits = 0;
                }
                2 => self.begin(bytes)?,
                other => return Ok(other - 2),
            }
            return Ok(0);
        }
        let symbol = bytes.decode_symbol(&mut self.symbols)?;
        if symbol < UNCHANGED {
            self.step(bytes, symbol)?;
            return Ok(0);
        }
        match symbol + self.missing {
            UNCHANGED => {}
            NEW_SEQUENCE => self.begin(bytes)?,
            other => return Ok(other - NEW_SEQUENCE),
        }
        Ok(0)
    }

    /// Some steps further, and the difference from that.
    fn step(&mut self, bytes: &mut ArithmeticDecoder<impl Read>, symbol: u32) -> Result<()> {
        let sequence = &mut self.sequences[self.current];
        let (factor, context) = match symbol {
            0 => (0, 7),
            1 => (1, 1),
            2..10 => (symbol as i32, 2),
            10..LARGEST_FACTOR => (symbol as i32, 3),
            LARGEST_FACTOR => (symbol as i32, 4),
            _ => {
                let negative = LARGEST_FACTOR as i32 - symbol as i32;
                (negative, if symbol < SMALLEST_FACTOR { 5 } else { 6 })
            }
        };
        let predicted = sequence.step.wrapping_mul(factor);
        let difference = self.differences.decompress(bytes, predicted, context)?;
        sequence.time = sequence.time.wrapping_add(i64::from(difference));
        match symbol {
            1 => sequence.misfits = 0,
            0 | LARGEST_FACTOR | SMALLEST_FACTOR if sequence.misfits == MAX_MISFITS => {
                sequence.step = difference;
                sequence.misfits = 0;
            }
            0 | LARGEST_FACTOR | SMALLEST_FACTOR => sequence.misfits += 1,
            _ => {}
        }
        Ok(())
    }

    /// A time far from all others begins a sequence in the place of the oldest one.
    fn begin(&mut self, bytes: &mut ArithmeticDecoder<impl Read>) -> Result<()> {
        let predicted = (self.sequences[self.current].time >> 32) as i32;
        let high = self.differences.decompress(bytes, predicted, 8)?;
        let low = bytes.read_int()?;
        self.newest = (self.newest + 1) % SEQUENCES;
        self.current = self.newest;
        self.sequences[self.current] = Sequence {
            time: i64::from(high) << 32 | i64::from(low),
            ..Sequence::default()
        };
        Ok(())
    }
}

impl<R: Read> FieldDecompressor<R> for GpsTimes {
    fn size_of_field(&self) -> usize {
        size_of::<i64>()
    }

    fn decompress_first(&mut self, bytes: &mut R, first: &mut [u8]) -> Result<()> {
        let mut time = [0; size_of::<i64>()];
        bytes.read_exact(&mut time)?;
        self.sequences[0].time = i64::from_le_bytes(time);
        first.copy_from_slice(&time);
        Ok(())
    }

    fn decompress_with(&mut self, bytes: &mut ArithmeticDecoder<R>, time: &mut [u8]) -> Result<()> {
        time.copy_from_slice(&self.next(bytes)?.to_le_bytes());
        Ok(())
    }
}
