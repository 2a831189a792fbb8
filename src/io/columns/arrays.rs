//! Columns become arrays of a cloud: three of them vectors, three or four of them colours.
//!
//! Rows are appended, so that an array is written once, and may be appended piece by piece as a file is read
//! ([`super::growing`]). Columns that lie side by side, as nearly all files have them, are read with one copy a row.

use super::column::{Column, Scalar, Values};
use crate::cloud::{ColorDepth, Dropped, RawCloud};
use std::ops::Range;
use std::slice::ChunksExact;

/// Rows that are read of three columns before the next ones: all of them then lie in the fastest cache.
const BLOCK_ROWS: usize = 512;

fn blocks(count: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count)
        .step_by(BLOCK_ROWS)
        .map(move |start| start..count.min(start + BLOCK_ROWS))
}

/// Three columns as vectors.
pub(in crate::io) fn vectors_f32(columns: [&Column<'_>; 3], count: usize) -> Vec<[f32; 3]> {
    let mut vectors = Vec::with_capacity(count);
    append_f32(&mut vectors, columns, count);
    vectors
}

/// [`vectors_f32`] with all digits.
pub(in crate::io) fn vectors_f64(columns: [&Column<'_>; 3], count: usize) -> Vec<[f64; 3]> {
    let mut vectors = Vec::with_capacity(count);
    append_f64(&mut vectors, columns, count);
    vectors
}

/// Appends the first `count` rows of three columns.
pub(super) fn append_f32(vectors: &mut Vec<[f32; 3]>, columns: [&Column<'_>; 3], count: usize) {
    if let Some(rows) = SideBySide::<12>::new(&columns, Scalar::F32, count) {
        return if rows.big_endian {
            vectors.extend(rows.read().map(|raw| parts(raw).map(f32::from_be_bytes)));
        } else {
            vectors.extend(rows.read().map(|raw| parts(raw).map(f32::from_le_bytes)));
        };
    }
    let start = vectors.len();
    vectors.resize(start + count, [0.0; 3]);
    let vectors = &mut vectors[start..];
    for rows in blocks(count) {
        for (component, column) in columns.iter().enumerate() {
            column.for_each_f32(rows.clone(), |index, value| {
                vectors[index][component] = value;
            });
        }
    }
}

/// [`append_f32`] with all digits.
pub(super) fn append_f64(vectors: &mut Vec<[f64; 3]>, columns: [&Column<'_>; 3], count: usize) {
    if let Some(rows) = SideBySide::<24>::new(&columns, Scalar::F64, count) {
        return if rows.big_endian {
            vectors.extend(rows.read().map(|raw| parts(raw).map(f64::from_be_bytes)));
        } else {
            vectors.extend(rows.read().map(|raw| parts(raw).map(f64::from_le_bytes)));
        };
    }
    let start = vectors.len();
    vectors.resize(start + count, [0.0; 3]);
    let vectors = &mut vectors[start..];
    for rows in blocks(count) {
        for (component, column) in columns.iter().enumerate() {
            column.for_each_f64(rows.clone(), |index, value| {
                vectors[index][component] = value;
            });
        }
    }
}

/// The bytes of the numbers in a row of three.
#[inline]
fn parts<const BYTES: usize, const WIDTH: usize>(raw: &[u8; BYTES]) -> [[u8; WIDTH]; 3] {
    let (parts, _) = raw.as_chunks::<WIDTH>();
    [parts[0], parts[1], parts[2]]
}

/// Gives `cloud` the colours in `channels`, and notes whether they were narrower than their fields.
pub(in crate::io) fn set_colors(
    cloud: &mut RawCloud,
    channels: [&Column<'_>; 3],
    alpha: Option<&Column<'_>>,
    count: usize,
) {
    let scales = Scales::of(channels, alpha, count);
    let mut colors = Vec::with_capacity(count);
    if append_colors(&mut colors, channels, alpha, &scales, count) {
        cloud.dropped.push(rounded_colors());
    }
    cloud.attributes.colors = Some(colors);
    cloud.has_narrow_colors = scales.is_narrow;
    cloud.color_depth = scales.depth;
}

/// Full-scale values of colour channels.
#[derive(Debug)]
pub(super) struct Scales {
    channels: [f64; 3],
    alpha: f64,
    /// True if 8-bit values were found in 16-bit fields.
    pub(super) is_narrow: bool,
    /// The range that was concluded from the largest value.
    pub(in crate::io) depth: Option<ColorDepth>,
}

impl Scales {
    /// Looks at `count` rows where types do not tell it.
    pub(in crate::io) fn of(channels: [&Column<'_>; 3], alpha: Option<&Column<'_>>, count: usize) -> Self {
        // A single channel may be dark, all three together show the range.
        let largest = largest(&channels, count);
        let is_word = |column: &Column<'_>| matches!(column.scalar, Scalar::I16 | Scalar::U16);
        Self {
            channels: channels.map(|column| column.scalar.full_scale(largest)),
            alpha: alpha.map_or(1.0, |column| column.scalar.full_scale(self::largest(&[column], count))),
            is_narrow: channels.into_iter().all(is_word) && largest > 0.0 && largest <= 255.0,
            depth: depth_of(channels[0].scalar, largest),
        }
    }
}

/// The range of colours whose brightest channel is `largest`; `None` where the type determines it.
fn depth_of(scalar: Scalar, largest: f64) -> Option<ColorDepth> {
    if scalar.byte_size() == 1 || !largest.is_finite() {
        return None;
    }
    let full_scale = scalar.full_scale(largest);
    Some(match full_scale {
        ..=1.0 => ColorDepth::Unit,
        ..=255.0 => ColorDepth::Bits8,
        _ => ColorDepth::Bits16,
    })
}

/// The largest number in `columns`, unless they are bytes, in which it tells nothing.
fn largest(columns: &[&Column<'_>], count: usize) -> f64 {
    if columns.iter().all(|column| column.scalar.byte_size() == 1) {
        return f64::NAN;
    }
    let largest = columns.iter().map(|column| column.largest(count));
    largest.fold(f64::NEG_INFINITY, f64::max)
}

/// Returns the note about colours reduced to 8 bits.
pub(super) fn rounded_colors() -> Dropped {
    Dropped::quiet("colours have more than 8 bits a channel in the file: they are kept with 8")
}

/// Appends colour channels as 8 bits red, green, blue and alpha, which is full where there is no column for it. True if
/// that rounds values.
pub(super) fn append_colors(
    colors: &mut Vec<[u8; 4]>,
    channels: [&Column<'_>; 3],
    alpha: Option<&Column<'_>>,
    scales: &Scales,
    count: usize,
) -> bool {
    let [red, green, blue] = channels;
    if let Some(alpha) = alpha
        && let Some(rows) = SideBySide::<4>::new(&[red, green, blue, alpha], Scalar::U8, count)
    {
        colors.extend(rows.read());
        return false;
    }
    let mut is_rounded = false;
    let start = colors.len();
    if let Some(rows) = SideBySide::<3>::new(&channels, Scalar::U8, count) {
        let opaque = |&[red, green, blue]: &[u8; 3]| [red, green, blue, 255];
        colors.extend(rows.read().map(opaque));
    } else {
        colors.resize(start + count, [255; 4]);
        for (channel, column) in channels.into_iter().enumerate() {
            is_rounded |= write_channel(&mut colors[start..], column, channel, scales.channels[channel]);
        }
    }
    if let Some(alpha) = alpha {
        is_rounded |= write_channel(&mut colors[start..], alpha, 3, scales.alpha);
    }
    is_rounded
}

/// Writes `column` into one of the four channels of `colors`, as 8 bits. True if that rounds values.
fn write_channel(colors: &mut [[u8; 4]], column: &Column<'_>, channel: usize, full_scale: f64) -> bool {
    /// Tolerance as a fraction of a quantisation step: single-precision fractions that originated from 8 bits are this
    /// near.
    const NEAR: f64 = 1e-3;
    let scale = 255.0 / full_scale;
    let mut is_rounded = false;
    column.for_each_f64(0..colors.len(), |index, value| {
        let rounded = (value * scale).round();
        is_rounded |= (value * scale - rounded).abs() > NEAR;
        colors[index][channel] = rounded as u8;
    });
    is_rounded
}

/// Columns of one type without a gap between them, `BYTES` together.
struct SideBySide<'a, const BYTES: usize> {
    rows: ChunksExact<'a, u8>,
    /// Bytes before them in each row.
    offset: usize,
    big_endian: bool,
}

impl<'a, const BYTES: usize> SideBySide<'a, BYTES> {
    /// The first `count` rows of `columns`, if they lie so.
    fn new(columns: &[&Column<'a>], expected: Scalar, count: usize) -> Option<Self> {
        let place = |column: &Column<'a>| match column.values {
            Values::Packed {
                bytes,
                start,
                step,
                big_endian,
            } if column.scalar == expected => Some((bytes, start, step, big_endian)),
            _ => None,
        };
        let (bytes, start, step, big_endian) = place(columns.first()?)?;
        let width = expected.byte_size();
        let is_gapless = columns.iter().enumerate().all(|(index, column)| {
            place(column).is_some_and(|(_, other_start, other_step, _)| {
                other_start == start + index * width && other_step == step
            })
        });
        let offset = start.checked_rem(step)?;
        if !is_gapless || BYTES != columns.len() * width || offset + BYTES > step {
            return None;
        }
        let rows = bytes.get(start - offset..)?.get(..count * step)?;
        Some(Self {
            rows: rows.chunks_exact(step),
            offset,
            big_endian,
        })
    }

    fn read(self) -> impl Iterator<Item = &'a [u8; BYTES]> {
        let Self { rows, offset, .. } = self;
        rows.map(move |row| &row[offset..].as_chunks::<BYTES>().0[0])
    }
}

#[cfg(test)]
mod tests {
    use super::super::column::tests::{packed, parsed};
    use super::*;
    use crate::cloud::Positions;

    fn colors(channels: [&Column<'_>; 3], alpha: Option<&Column<'_>>, count: usize) -> (Vec<[u8; 4]>, bool) {
        let mut cloud = RawCloud::from_positions(Positions::F32(Vec::new()));
        set_colors(&mut cloud, channels, alpha, count);
        (cloud.attributes.colors.unwrap(), cloud.has_narrow_colors)
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
                let columns = [0, 1, 2].map(|i| packed(&bytes, Scalar::F32, pad + i * (4 + gap), step, big_endian));
                let columns = columns.each_ref();
                assert_eq!(vectors_f32(columns, 2), expected, "{pad} {gap} {big_endian}");
                let wide = expected.map(|vector| vector.map(f64::from));
                assert_eq!(vectors_f64(columns, 2), wide, "{pad} {gap} {big_endian}");
            }
        }
    }

    #[test]
    fn blocks_cover_every_row_exactly_once() {
        for count in [0, 1, BLOCK_ROWS - 1, BLOCK_ROWS, 3 * BLOCK_ROWS + 7] {
            assert!(blocks(count).flatten().eq(0..count), "{count}");
        }
    }

    #[test]
    fn channels_are_scaled_by_type_and_by_the_brightest_channel() {
        for (color, scalar, expected) in [
            ([0.0, 1.0, 255.0], Scalar::U8, [0, 1, 255, 255]),
            ([0.0, 0.5, 1.0], Scalar::F32, [0, 128, 255, 255]),
            ([1.0, 127.6, 255.0], Scalar::F32, [1, 128, 255, 255]),
            ([0.0, 32768.0, 65535.0], Scalar::U16, [0, 128, 255, 255]),
            ([1.0, 32768.0, 65535.0], Scalar::F64, [0, 128, 255, 255]),
            ([0.0, 7.0, 255.0], Scalar::U16, [0, 7, 255, 255]),
            ([0.0, 7.0, 255.0], Scalar::I32, [0, 7, 255, 255]),
            ([f64::NAN, -1.0, f64::INFINITY], Scalar::F64, [0, 0, 255, 255]),
        ] {
            let columns = color.map(|channel| parsed(&[channel], scalar));
            let (found, is_narrow) = colors(columns.each_ref(), None, 1);
            assert_eq!(found, [expected], "{color:?} {scalar:?}");
            let narrow = scalar == Scalar::U16 && color[2] == 255.0;
            assert_eq!(is_narrow, narrow, "{color:?} {scalar:?}");
        }
    }

    #[test]
    fn alpha_has_a_separate_scale() {
        let channels = [9.0, 8.0, 255.0].map(|channel| parsed(&[channel], Scalar::F32));
        let alpha = parsed(&[0.5], Scalar::F32);
        assert_eq!(colors(channels.each_ref(), Some(&alpha), 1).0, [[9, 8, 255, 128]]);
        let rows = [1, 2, 3, 4, 0, 5, 6, 7, 8, 0];
        let columns = [0, 1, 2, 3].map(|start| packed(&rows, Scalar::U8, start, 5, false));
        let [red, green, blue, alpha] = columns.each_ref();
        let (together, _) = colors([red, green, blue], Some(alpha), 2);
        assert_eq!(together, [[1, 2, 3, 4], [5, 6, 7, 8]]);
        let (reversed, _) = colors([blue, green, red], None, 2);
        assert_eq!(reversed, [[3, 2, 1, 255], [7, 6, 5, 255]]);
    }
}
