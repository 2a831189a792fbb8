//! A column of numbers, wherever it lies: in rows, in a block of its own, or parsed from text.

use std::ops::Range;

/// Type of a binary number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    pub(super) fn byte_size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The largest value, for colours: integers run from 0 to it, floats from 0 to 1.
    fn full_scale(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            // Integers wider than 16 bits hold 8-bit colours in every file that was seen.
            Self::U8 | Self::I32 | Self::U32 | Self::I64 | Self::U64 => f64::from(u8::MAX),
            Self::F32 | Self::F64 => 1.0,
        }
    }

    /// The first `byte_size` bytes as a number. Precondition: they are there.
    pub(super) fn read(self, bytes: &[u8], big_endian: bool) -> f64 {
        macro_rules! number {
            ($ty:ty) => {{
                let mut raw = [0; size_of::<$ty>()];
                raw.copy_from_slice(&bytes[..size_of::<$ty>()]);
                if big_endian {
                    <$ty>::from_be_bytes(raw) as f64
                } else {
                    <$ty>::from_le_bytes(raw) as f64
                }
            }};
        }
        match self {
            Self::I8 => number!(i8),
            Self::U8 => number!(u8),
            Self::I16 => number!(i16),
            Self::U16 => number!(u16),
            Self::I32 => number!(i32),
            Self::U32 => number!(u32),
            Self::I64 => number!(i64),
            Self::U64 => number!(u64),
            Self::F32 => number!(f32),
            Self::F64 => number!(f64),
        }
    }
}

/// Where the numbers are.
#[derive(Debug, Clone)]
pub(super) enum Values<'a> {
    /// Number `i` is at byte `start + i * step`. Every one lies within `bytes`.
    Packed {
        bytes: &'a [u8],
        start: usize,
        step: usize,
        big_endian: bool,
    },
    /// Already parsed.
    Parsed(Vec<f64>),
}

/// A named column.
#[derive(Debug, Clone)]
pub(super) struct Column<'a> {
    pub(super) name: String,
    /// Type in the file; text counts as [`Scalar::F64`].
    pub(super) scalar: Scalar,
    pub(super) values: Values<'a>,
}

/// The loop of [`Column::for_each_f32`] and its twin: one for every type and byte order, so that neither is asked for
/// every number.
macro_rules! walk {
    ($column:expr, $range:expr, $each:expr, $target:ty) => {{
        let (bytes, start, step, big_endian) = match &$column.values {
            Values::Parsed(values) => {
                for index in $range {
                    $each(index, values[index] as $target);
                }
                return;
            }
            Values::Packed {
                bytes,
                start,
                step,
                big_endian,
            } => (*bytes, *start, *step, *big_endian),
        };
        macro_rules! numbers {
            ($from:ty, $read:path) => {
                for index in $range {
                    let at = start + index * step;
                    let mut raw = [0; size_of::<$from>()];
                    raw.copy_from_slice(&bytes[at..at + size_of::<$from>()]);
                    $each(index, $read(raw) as $target);
                }
            };
        }
        match ($column.scalar, big_endian) {
            (Scalar::I8, _) => numbers!(i8, i8::from_le_bytes),
            (Scalar::U8, _) => numbers!(u8, u8::from_le_bytes),
            (Scalar::I16, false) => numbers!(i16, i16::from_le_bytes),
            (Scalar::I16, true) => numbers!(i16, i16::from_be_bytes),
            (Scalar::U16, false) => numbers!(u16, u16::from_le_bytes),
            (Scalar::U16, true) => numbers!(u16, u16::from_be_bytes),
            (Scalar::I32, false) => numbers!(i32, i32::from_le_bytes),
            (Scalar::I32, true) => numbers!(i32, i32::from_be_bytes),
            (Scalar::U32, false) => numbers!(u32, u32::from_le_bytes),
            (Scalar::U32, true) => numbers!(u32, u32::from_be_bytes),
            (Scalar::I64, false) => numbers!(i64, i64::from_le_bytes),
            (Scalar::I64, true) => numbers!(i64, i64::from_be_bytes),
            (Scalar::U64, false) => numbers!(u64, u64::from_le_bytes),
            (Scalar::U64, true) => numbers!(u64, u64::from_be_bytes),
            (Scalar::F32, false) => numbers!(f32, f32::from_le_bytes),
            (Scalar::F32, true) => numbers!(f32, f32::from_be_bytes),
            (Scalar::F64, false) => numbers!(f64, f64::from_le_bytes),
            (Scalar::F64, true) => numbers!(f64, f64::from_be_bytes),
        }
    }};
}

impl Column<'_> {
    /// Hands over the numbers of `range` with their indices. Precondition: the column has them.
    fn for_each_f32(&self, range: Range<usize>, mut each: impl FnMut(usize, f32)) {
        walk!(self, range, each, f32);
    }

    /// [`Self::for_each_f32`] with all digits.
    fn for_each_f64(&self, range: Range<usize>, mut each: impl FnMut(usize, f64)) {
        walk!(self, range, each, f64);
    }

    /// `count` numbers as f32.
    pub(super) fn to_f32(&self, count: usize) -> Vec<f32> {
        let mut numbers = vec![0.0; count];
        self.for_each_f32(0..count, |index, value| numbers[index] = value);
        numbers
    }

    /// The four bytes of number `index` as they are in the file, for colours packed into one number.
    pub(super) fn bits(&self, index: usize) -> u32 {
        let mut bits = 0;
        // The bits of a float must not be touched: a NaN is a colour like any other.
        let is_float = self.scalar == Scalar::F32;
        match &self.values {
            Values::Packed {
                bytes,
                start,
                step,
                big_endian,
            } if is_float => {
                let at = start + index * step;
                let mut raw = [0; 4];
                raw.copy_from_slice(&bytes[at..at + 4]);
                bits = if *big_endian {
                    u32::from_be_bytes(raw)
                } else {
                    u32::from_le_bytes(raw)
                };
            }
            Values::Parsed(values) if is_float => bits = (values[index] as f32).to_bits(),
            // Signed integers hold the same 32 bits, wider ones the same value.
            _ => self.for_each_f64(index..index + 1, |_, value| bits = value as i64 as u32),
        }
        bits
    }

    /// Writes the column into one of the four channels of `colors`, as 8 bits.
    pub(super) fn write_channel(&self, colors: &mut [[u8; 4]], channel: usize) {
        let all = 0..colors.len();
        match &self.values {
            Values::Packed {
                bytes, start, step, ..
            } if self.scalar == Scalar::U8 => {
                for (index, color) in colors.iter_mut().enumerate() {
                    color[channel] = bytes[start + index * step];
                }
            }
            _ => {
                let scale = 255.0 / self.full_scale(colors.len());
                self.for_each_f64(all, |index, value| {
                    colors[index][channel] = (value * scale).round() as u8;
                });
            }
        }
    }

    /// What is full intensity: told by the type, but writers put 0 to 255 into floats and into 16 bits, too.
    fn full_scale(&self, count: usize) -> f64 {
        let exceeds = |limit: f64| {
            let mut largest = f64::NEG_INFINITY;
            self.for_each_f64(0..count, |_, value| largest = largest.max(value));
            largest > limit
        };
        match self.scalar {
            Scalar::F32 | Scalar::F64 if exceeds(1.0) => 255.0,
            Scalar::I16 | Scalar::U16 if !exceeds(255.0) => 255.0,
            other => other.full_scale(),
        }
    }
}

/// Rows that are read of three columns before the next ones: all of them then lie in the fastest cache.
const BLOCK_ROWS: usize = 512;

fn blocks(count: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count)
        .step_by(BLOCK_ROWS)
        .map(move |start| start..count.min(start + BLOCK_ROWS))
}

/// Three columns as vectors.
pub(super) fn vectors_f32(columns: [&Column<'_>; 3], count: usize) -> Vec<[f32; 3]> {
    if let Some(rows) = SideBySide::<12>::new(columns, Scalar::F32) {
        return if rows.big_endian {
            rows.read(count)
                .map(|raw| components(&raw, f32::from_be_bytes))
                .collect()
        } else {
            rows.read(count)
                .map(|raw| components(&raw, f32::from_le_bytes))
                .collect()
        };
    }
    let mut vectors = vec![[0.0; 3]; count];
    for rows in blocks(count) {
        for (component, column) in columns.iter().enumerate() {
            column.for_each_f32(rows.clone(), |index, value| {
                vectors[index][component] = value
            });
        }
    }
    vectors
}

#[inline(always)]
fn components(raw: &[u8; 12], read: impl Fn([u8; 4]) -> f32) -> [f32; 3] {
    let (parts, _) = raw.as_chunks::<4>();
    [read(parts[0]), read(parts[1]), read(parts[2])]
}

/// Colour channels as 8 bits red, green, blue and alpha, which is full where there is no column for it.
pub(super) fn colors(
    channels: [&Column<'_>; 3],
    alpha: Option<&Column<'_>>,
    count: usize,
) -> Vec<[u8; 4]> {
    let mut colors: Vec<[u8; 4]> = if let Some(rows) = SideBySide::<3>::new(channels, Scalar::U8) {
        rows.read(count)
            .map(|[red, green, blue]| [red, green, blue, 255])
            .collect()
    } else {
        let mut colors = vec![[255; 4]; count];
        for (channel, column) in channels.into_iter().enumerate() {
            column.write_channel(&mut colors, channel);
        }
        colors
    };
    if let Some(alpha) = alpha {
        alpha.write_channel(&mut colors, 3);
    }
    colors
}

/// Three columns without a gap between them, `BYTES` together, as nearly all files have them: read with one copy a row.
struct SideBySide<'a, const BYTES: usize> {
    bytes: &'a [u8],
    step: usize,
    big_endian: bool,
}

impl<'a, const BYTES: usize> SideBySide<'a, BYTES> {
    fn new(columns: [&Column<'a>; 3], expected: Scalar) -> Option<Self> {
        let place = |column: &Column<'a>| match column.values {
            Values::Packed {
                bytes,
                start,
                step,
                big_endian,
            } if column.scalar == expected => Some((bytes, start, step, big_endian)),
            _ => None,
        };
        let (bytes, start, step, big_endian) = place(columns[0])?;
        let width = expected.byte_size();
        let follows = |index: usize| {
            place(columns[index]).is_some_and(|(_, other_start, other_step, _)| {
                other_start == start + index * width && other_step == step
            })
        };
        (follows(1) && follows(2) && BYTES == 3 * width).then(|| Self {
            bytes: bytes.get(start..).unwrap_or(&[]),
            step,
            big_endian,
        })
    }

    fn read(&self, count: usize) -> impl Iterator<Item = [u8; BYTES]> {
        (0..count).map(|index| {
            let at = index * self.step;
            let mut raw = [0; BYTES];
            raw.copy_from_slice(&self.bytes[at..at + BYTES]);
            raw
        })
    }
}

/// Three columns as vectors with all digits.
pub(super) fn vectors_f64(columns: [&Column<'_>; 3], count: usize) -> Vec<[f64; 3]> {
    let mut vectors = vec![[0.0; 3]; count];
    for rows in blocks(count) {
        for (component, column) in columns.iter().enumerate() {
            column.for_each_f64(rows.clone(), |index, value| {
                vectors[index][component] = value
            });
        }
    }
    vectors
}
