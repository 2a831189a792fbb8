//! A column of numbers, wherever it lies: in rows, in a block of its own, or parsed from text.

use glam::Vec3;

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

impl Column<'_> {
    /// Number `index`. Precondition: the column has it.
    pub(super) fn get(&self, index: usize) -> f64 {
        match &self.values {
            Values::Packed {
                bytes,
                start,
                step,
                big_endian,
            } => self
                .scalar
                .read(&bytes[start + index * step..], *big_endian),
            Values::Parsed(values) => values[index],
        }
    }

    /// The four bytes of number `index` as they are in the file, for colours packed into one number.
    /// `None` unless it has four bytes.
    pub(super) fn bits(&self, index: usize) -> Option<u32> {
        match (&self.values, self.scalar.byte_size()) {
            (
                Values::Packed {
                    bytes,
                    start,
                    step,
                    big_endian,
                },
                4,
            ) => {
                let at = start + index * step;
                let raw = <[u8; 4]>::try_from(bytes.get(at..at + 4)?).ok()?;
                Some(if *big_endian {
                    u32::from_be_bytes(raw)
                } else {
                    u32::from_le_bytes(raw)
                })
            }
            // A wider number holds the value, not the bits.
            (Values::Packed { .. }, _) => Some(self.get(index) as u32),
            (Values::Parsed(values), 4) if self.scalar == Scalar::F32 => {
                Some((values[index] as f32).to_bits())
            }
            (Values::Parsed(values), _) => Some(values[index] as u32),
        }
    }

    /// `count` numbers as f32.
    pub(super) fn to_f32(&self, count: usize) -> Vec<f32> {
        (0..count).map(|index| self.get(index) as f32).collect()
    }

    /// `count` colour channels as 8 bits.
    pub(super) fn to_channel(&self, count: usize) -> Vec<u8> {
        match &self.values {
            Values::Packed {
                bytes, start, step, ..
            } if self.scalar == Scalar::U8 => (0..count)
                .map(|index| bytes[start + index * step])
                .collect(),
            _ => {
                let full_scale = self.full_scale(count);
                (0..count)
                    .map(|index| (self.get(index) / full_scale * 255.0).round() as u8)
                    .collect()
            }
        }
    }

    /// What is full intensity: told by the type, but writers put 0 to 255 into floats and into 16 bits, too.
    fn full_scale(&self, count: usize) -> f64 {
        let exceeds = |limit: f64| (0..count).any(|index| self.get(index) > limit);
        match self.scalar {
            Scalar::F32 | Scalar::F64 if exceeds(1.0) => 255.0,
            Scalar::I16 | Scalar::U16 if !exceeds(255.0) => 255.0,
            other => other.full_scale(),
        }
    }
}

/// Three columns as vectors, quickly where they are little-endian f32 side by side, as in nearly all files.
pub(super) fn vectors_f32(columns: [&Column<'_>; 3], count: usize) -> Vec<[f32; 3]> {
    if let Some((bytes, start, step)) = side_by_side_f32(columns) {
        return (0..count)
            .map(|index| {
                let at = start + index * step;
                let component = |i: usize| {
                    let mut raw = [0; 4];
                    raw.copy_from_slice(&bytes[at + 4 * i..at + 4 * i + 4]);
                    f32::from_le_bytes(raw)
                };
                [component(0), component(1), component(2)]
            })
            .collect();
    }
    let [x, y, z] = columns;
    (0..count)
        .map(|index| {
            Vec3::new(
                x.get(index) as f32,
                y.get(index) as f32,
                z.get(index) as f32,
            )
            .to_array()
        })
        .collect()
}

fn side_by_side_f32<'a>(columns: [&Column<'a>; 3]) -> Option<(&'a [u8], usize, usize)> {
    let place = |column: &Column<'a>| match column.values {
        Values::Packed {
            bytes,
            start,
            step,
            big_endian: false,
        } if column.scalar == Scalar::F32 => Some((bytes, start, step)),
        _ => None,
    };
    let (bytes, start, step) = place(columns[0])?;
    let follows =
        |column, offset| place(column).is_some_and(|(_, s, st)| s == start + offset && st == step);
    (follows(columns[1], 4) && follows(columns[2], 8)).then_some((bytes, start, step))
}
