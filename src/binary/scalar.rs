//! Types of binary numbers.

/// Type of a binary number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
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
    pub(crate) fn byte_size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Returns true if conversion to single precision may lose digits. Narrower integers fit an f32 exactly.
    pub(crate) fn is_wide(self) -> bool {
        matches!(self, Self::F64 | Self::I32 | Self::U32 | Self::I64 | Self::U64)
    }

    /// Returns full intensity for colours whose brightest channel is `largest`. It is determined by the type, but
    /// writers put 0 to 255 into 16 bits and into floats, too, and 16 bits into wider types.
    pub(crate) fn full_scale(self, largest: f64) -> f64 {
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
    pub(crate) fn read(self, bytes: &[u8], big_endian: bool) -> f64 {
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
