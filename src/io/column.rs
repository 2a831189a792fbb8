//! A column of numbers, wherever it lies: in rows, in a block of its own, or parsed from text.

use crate::cloud::RawCloud;
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

    /// What is full intensity in colours of which `largest` is the brightest channel: told by the type, but writers put
    /// 0 to 255 into 16 bits and into floats, too, and 16 bits into wider types.
    fn full_scale(self, largest: f64) -> f64 {
        const BYTE: f64 = u8::MAX as f64;
        const WORD: f64 = u16::MAX as f64;
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => BYTE,
            Self::F32 | Self::F64 if largest <= 1.0 => 1.0,
            _ if largest <= BYTE => BYTE,
            Self::I16 => f64::from(i16::MAX),
            _ => WORD,
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

    /// `count` numbers with all digits.
    pub(super) fn to_f64(&self, count: usize) -> Vec<f64> {
        let mut numbers = vec![0.0; count];
        self.for_each_f64(0..count, |index, value| numbers[index] = value);
        numbers
    }

    /// The four bytes of `count` numbers as they are in the file, for colours packed into one number.
    pub(super) fn bits(&self, count: usize) -> Vec<u32> {
        match &self.values {
            Values::Packed {
                bytes,
                start,
                step,
                big_endian,
            } if self.scalar.byte_size() == 4 => (0..count)
                .map(|index| {
                    let at = start + index * step;
                    let mut raw = [0; 4];
                    raw.copy_from_slice(&bytes[at..at + 4]);
                    if *big_endian {
                        u32::from_be_bytes(raw)
                    } else {
                        u32::from_le_bytes(raw)
                    }
                })
                .collect(),
            Values::Parsed(values) if self.scalar == Scalar::F32 => values
                .iter()
                .take(count)
                .map(|&value| (value as f32).to_bits())
                .collect(),
            // Negative integers hold the same 32 bits, wider ones the same value.
            _ => {
                let mut bits = vec![0; count];
                self.for_each_f64(0..count, |index, value| bits[index] = value as i64 as u32);
                bits
            }
        }
    }

    /// The largest of `count` numbers.
    fn largest(&self, count: usize) -> f64 {
        let mut largest = f64::NEG_INFINITY;
        // f64::max takes the other operand for NaN.
        self.for_each_f64(0..count, |_, value| largest = largest.max(value));
        largest
    }

    /// Writes the column into one of the four channels of `colors`, as 8 bits.
    fn write_channel(&self, colors: &mut [[u8; 4]], channel: usize, full_scale: f64) {
        let scale = 255.0 / full_scale;
        self.for_each_f64(0..colors.len(), |index, value| {
            colors[index][channel] = (value * scale).round() as u8;
        });
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
                vectors[index][component] = value;
            });
        }
    }
    vectors
}

#[inline]
fn components(raw: &[u8; 12], read: impl Fn([u8; 4]) -> f32) -> [f32; 3] {
    let (parts, _) = raw.as_chunks::<4>();
    [read(parts[0]), read(parts[1]), read(parts[2])]
}

/// Gives `cloud` the colours in `channels`, and notes whether they were narrower than their fields.
pub(super) fn set_colors(
    cloud: &mut RawCloud,
    channels: [&Column<'_>; 3],
    alpha: Option<&Column<'_>>,
    count: usize,
) {
    let (colors, is_narrow) = colors(channels, alpha, count);
    cloud.colors = Some(colors);
    cloud.has_narrow_colors = is_narrow;
}

/// Colour channels as 8 bits red, green, blue and alpha, which is full where there is no column for it.
///
/// The second answer is whether 8 bits were found in fields of 16.
fn colors(
    channels: [&Column<'_>; 3],
    alpha: Option<&Column<'_>>,
    count: usize,
) -> (Vec<[u8; 4]>, bool) {
    let mut is_narrow = false;
    let mut colors: Vec<[u8; 4]> = if let Some(rows) = SideBySide::<3>::new(channels, Scalar::U8) {
        rows.read(count)
            .map(|[red, green, blue]| [red, green, blue, 255])
            .collect()
    } else {
        // One channel may be dark, all three tell what is bright.
        let largest = channels
            .map(|column| column.largest(count))
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max);
        let is_word = |column: &Column<'_>| matches!(column.scalar, Scalar::I16 | Scalar::U16);
        is_narrow = channels.into_iter().all(is_word) && largest > 0.0 && largest <= 255.0;
        let mut colors = vec![[255; 4]; count];
        for (channel, column) in channels.into_iter().enumerate() {
            column.write_channel(&mut colors, channel, column.scalar.full_scale(largest));
        }
        colors
    };
    if let Some(alpha) = alpha {
        let full_scale = alpha.scalar.full_scale(alpha.largest(count));
        alpha.write_channel(&mut colors, 3, full_scale);
    }
    (colors, is_narrow)
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
                vectors[index][component] = value;
            });
        }
    }
    vectors
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed(
        bytes: &[u8],
        scalar: Scalar,
        start: usize,
        step: usize,
        big_endian: bool,
    ) -> Column<'_> {
        Column {
            name: "c".to_owned(),
            scalar,
            values: Values::Packed {
                bytes,
                start,
                step,
                big_endian,
            },
        }
    }

    fn parsed(values: &[f64], scalar: Scalar) -> Column<'static> {
        Column {
            name: "c".to_owned(),
            scalar,
            values: Values::Parsed(values.to_vec()),
        }
    }

    #[test]
    fn gaps_and_byte_orders_make_no_difference() {
        let expected = [[1.0f32, -2.0, 3.5], [f32::MAX, 0.0, -0.125]];
        for big_endian in [false, true] {
            for (pad, gap) in [(0, 0), (3, 0), (0, 2), (1, 5)] {
                let mut bytes = Vec::new();
                for vector in expected {
                    bytes.extend(vec![0xee; pad]);
                    for component in vector {
                        bytes.extend(if big_endian {
                            component.to_be_bytes()
                        } else {
                            component.to_le_bytes()
                        });
                        bytes.extend(vec![0xee; gap]);
                    }
                }
                let step = bytes.len() / 2;
                let columns = [0, 1, 2]
                    .map(|i| packed(&bytes, Scalar::F32, pad + i * (4 + gap), step, big_endian));
                let columns = columns.each_ref();
                assert_eq!(
                    vectors_f32(columns, 2),
                    expected,
                    "{pad} {gap} {big_endian}"
                );
                let wide = expected.map(|vector| vector.map(f64::from));
                assert_eq!(vectors_f64(columns, 2), wide, "{pad} {gap} {big_endian}");
            }
        }
    }

    #[test]
    fn blocks_cover_every_row_once() {
        for count in [0, 1, BLOCK_ROWS - 1, BLOCK_ROWS, 3 * BLOCK_ROWS + 7] {
            assert!(blocks(count).flatten().eq(0..count), "{count}");
        }
    }

    #[test]
    fn channels_are_scaled_by_type_and_by_the_brightest_of_them() {
        for (color, scalar, expected) in [
            ([0.0, 1.0, 255.0], Scalar::U8, [0, 1, 255, 255]),
            ([0.0, 0.5, 1.0], Scalar::F32, [0, 128, 255, 255]),
            ([1.0, 127.6, 255.0], Scalar::F32, [1, 128, 255, 255]),
            ([0.0, 32768.0, 65535.0], Scalar::U16, [0, 128, 255, 255]),
            ([1.0, 32768.0, 65535.0], Scalar::F64, [0, 128, 255, 255]),
            ([0.0, 7.0, 255.0], Scalar::U16, [0, 7, 255, 255]),
            ([0.0, 7.0, 255.0], Scalar::I32, [0, 7, 255, 255]),
            (
                [f64::NAN, -1.0, f64::INFINITY],
                Scalar::F64,
                [0, 0, 255, 255],
            ),
        ] {
            let columns = color.map(|channel| parsed(&[channel], scalar));
            let (found, is_narrow) = colors(columns.each_ref(), None, 1);
            assert_eq!(found, [expected], "{color:?} {scalar:?}");
            let narrow = scalar == Scalar::U16 && color[2] == 255.0;
            assert_eq!(is_narrow, narrow, "{color:?} {scalar:?}");
        }
    }

    #[test]
    fn alpha_has_a_scale_of_its_own() {
        let channels = [9.0, 8.0, 255.0].map(|channel| parsed(&[channel], Scalar::F32));
        let alpha = parsed(&[0.5], Scalar::F32);
        assert_eq!(
            colors(channels.each_ref(), Some(&alpha), 1).0,
            [[9, 8, 255, 128]]
        );
        let rows = [1, 2, 3, 4, 0, 5, 6, 7, 8, 0];
        let columns = [0, 1, 2, 3].map(|start| packed(&rows, Scalar::U8, start, 5, false));
        let [red, green, blue, alpha] = columns.each_ref();
        let (together, _) = colors([red, green, blue], Some(alpha), 2);
        assert_eq!(together, [[1, 2, 3, 4], [5, 6, 7, 8]]);
        let (reversed, _) = colors([blue, green, red], None, 2);
        assert_eq!(reversed, [[3, 2, 1, 255], [7, 6, 5, 255]]);
    }

    #[test]
    fn packed_colors_keep_their_bits_whatever_type_carries_them() {
        // 0xffc00001 is a NaN as a float, a negative number as an integer.
        let bits = 0xffc0_0001_u32;
        for scalar in [Scalar::U32, Scalar::I32, Scalar::F32] {
            assert_eq!(
                packed(&bits.to_le_bytes(), scalar, 0, 4, false).bits(1),
                [bits]
            );
            assert_eq!(
                packed(&bits.to_be_bytes(), scalar, 0, 4, true).bits(1),
                [bits]
            );
        }
        assert_eq!(parsed(&[f64::from(bits)], Scalar::U32).bits(1), [bits]);
        assert_eq!(
            parsed(&[f64::from(bits as i32)], Scalar::I32).bits(1),
            [bits]
        );
        let float = f32::from_bits(0x00ff_8000);
        assert_eq!(
            parsed(&[f64::from(float)], Scalar::F32).bits(1),
            [0x00ff_8000]
        );
    }
}
