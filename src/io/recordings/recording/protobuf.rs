//! The wire format of Protocol Buffers: fields of a number and one of four kinds of value, in any order;
//! <https://protobuf.dev/programming-guides/encoding/>.
//!
//! By hand, because the time of a message is wanted of its first bytes alone, and its points are left where they are.

use super::bytes::Bytes;

/// Bits of the number of a field that say its kind.
const KIND_BITS: u32 = 3;
/// A varint of 64 bits has no more bytes.
const MAX_VARINT_BYTES: u32 = 10;

/// A value as it is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Value<'a> {
    Varint(u64),
    Fixed64(u64),
    /// Text, bytes or a message.
    Bytes(&'a [u8]),
    Fixed32(u32),
}

impl<'a> Value<'a> {
    /// An integer of any kind; zero for other values.
    pub(super) fn number(self) -> u64 {
        match self {
            Self::Varint(number) | Self::Fixed64(number) => number,
            Self::Fixed32(number) => number.into(),
            Self::Bytes(_) => 0,
        }
    }

    /// A number of double precision; zero for other values.
    pub(super) fn double(self) -> f64 {
        match self {
            Self::Fixed64(bits) => f64::from_bits(bits),
            _ => 0.0,
        }
    }

    /// Text, bytes or a message; empty for other values.
    pub(super) fn bytes(self) -> &'a [u8] {
        match self {
            Self::Bytes(bytes) => bytes,
            _ => &[],
        }
    }
}

/// The fields of a message one after the other.
#[derive(Debug, Clone)]
pub(super) struct MessageFields<'a>(Bytes<'a>);

impl<'a> MessageFields<'a> {
    pub(super) fn new(message: &'a [u8]) -> Self {
        Self(Bytes::new(message))
    }

    fn varint(&mut self) -> Option<u64> {
        let mut number = 0;
        for index in 0..MAX_VARINT_BYTES {
            let byte = self.0.u8()?;
            number |= u64::from(byte & 0x7f) << (7 * index);
            if byte < 0x80 {
                return Some(number);
            }
        }
        None
    }

    fn field(&mut self) -> Option<(u64, Value<'a>)> {
        let key = self.varint()?;
        let value = match key & ((1 << KIND_BITS) - 1) {
            0 => Value::Varint(self.varint()?),
            1 => Value::Fixed64(self.0.u64()?),
            2 => {
                let count = usize::try_from(self.varint()?).ok()?;
                Value::Bytes(self.0.take(count)?)
            }
            5 => Value::Fixed32(self.0.u32()?),
            _ => return None,
        };
        Some((key >> KIND_BITS, value))
    }
}

impl<'a> Iterator for MessageFields<'a> {
    /// Number and value; `None` where the message is cut or is none.
    type Item = Option<(u64, Value<'a>)>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.0.is_empty() {
            return None;
        }
        let field = self.field();
        if field.is_none() {
            // The rest cannot be interpreted.
            self.0 = Bytes::new(&[]);
        }
        Some(field)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_every_kind_are_read() {
        // The examples of the specification: field 1 is 150, field 2 is "testing".
        let message = [
            &[0x08, 0x96, 0x01][..],
            &[0x12, 0x07],
            b"testing",
            &[0x1d, 1, 2, 3, 4],
            &[0x21],
            &1.5f64.to_le_bytes(),
            // Field 5 is -1, field 2000 is 0.
            &[0x28, 255, 255, 255, 255, 255, 255, 255, 255, 255, 1],
            &[0x80, 0x7d, 0],
        ]
        .concat();
        let fields: Vec<_> = MessageFields::new(&message).map(Option::unwrap).collect();
        assert_eq!(
            fields,
            [
                (1, Value::Varint(150)),
                (2, Value::Bytes(b"testing")),
                (3, Value::Fixed32(0x0403_0201)),
                (4, Value::Fixed64(1.5f64.to_bits())),
                (5, Value::Varint(u64::MAX)),
                (2000, Value::Varint(0)),
            ]
        );
        assert_eq!(fields[3].1.double(), 1.5);
    }

    #[test]
    fn truncated_or_invalid_data_ends_the_fields() {
        for broken in [
            &[0x08][..],
            &[0x08, 0x80],
            &[0x12, 0x07, 1],
            &[0x12, 255, 255, 255, 255, 255, 255, 255, 255, 255, 1],
            &[0x1d, 1, 2, 3],
            &[0x21, 1],
            // Groups were removed from this version; a varint has ten bytes at most.
            &[0x0b],
            &[0x08, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 1],
        ] {
            let fields: Vec<_> = MessageFields::new(broken).collect();
            assert_eq!(fields, [None], "{broken:?}");
        }
    }
}
