//! An array of a file: its header, and the columns in its bytes.

use crate::binary::{Header, Number};
use crate::io::columns::column::{Column, Scalar, Values};
use crate::io::error::{Fault, Place};

pub(super) use crate::binary::Layout as ArrayLayout;

/// An array whose bytes are all there.
#[derive(Debug)]
pub(super) struct Array<'a> {
    pub(super) shape: Vec<usize>,
    pub(super) kind: ArrayLayout,
    pub(super) is_fortran: bool,
    pub(super) payload: &'a [u8],
    row_bytes: usize,
    /// Index of the first entry, and stride of the next ones along the first dimension, in entries: for Fortran order
    /// only.
    first: usize,
    apart: usize,
}

/// The `count` numbers from `start` on, `step` bytes apart. Precondition: `bytes` has them.
pub(super) fn column_of(
    number: Number,
    name: String,
    bytes: &[u8],
    [start, step]: [usize; 2],
    count: usize,
) -> Column<'_> {
    let Some(scalar) = number.scalar else {
        let halves = (0..count).map(|index| number.read(&bytes[start + index * step..]));
        return Column {
            name,
            scalar: Scalar::F32,
            values: Values::Parsed(halves.collect()),
        };
    };
    Column {
        name,
        scalar,
        values: Values::Packed {
            bytes,
            start,
            step,
            big_endian: number.big_endian,
        },
    }
}

impl<'a> Array<'a> {
    pub(super) fn parse(bytes: &'a [u8]) -> Result<Self, Fault> {
        let header = Header::parse(bytes).map_err(|error| Fault::header(error.to_string()))?;
        let start = header.payload_at;
        let array = Self::of(header, &bytes[start..]);
        array.check_claim(start)?;
        Ok(array)
    }

    /// An array by its begin, which may end anywhere behind the header; without its payload. `None` if it is none.
    pub(super) fn parse_head(bytes: &[u8]) -> Option<Array<'static>> {
        Some(Array::of(Header::parse(bytes).ok()?, &[]))
    }

    fn of(header: Header, payload: &'a [u8]) -> Self {
        Self {
            row_bytes: header.row_bytes(),
            shape: header.shape,
            kind: header.layout,
            is_fortran: header.is_fortran,
            payload,
            first: 0,
            apart: 1,
        }
    }

    /// Bytes of all entries; `None` on overflow.
    pub(super) fn claimed_bytes(&self) -> Option<usize> {
        let mut lengths = self.shape.iter();
        lengths.try_fold(self.row_bytes, |bytes, &length| bytes.checked_mul(length))
    }

    /// The number at these indices of a whole array of numbers; NaN where there is none.
    pub(super) fn at(&self, indices: &[usize]) -> f64 {
        let ArrayLayout::Table(number) = self.kind else {
            return f64::NAN;
        };
        let sides = indices.iter().zip(&self.shape);
        let place = if self.is_fortran {
            sides.rev().fold(0, |place, (index, side)| place * side + index)
        } else {
            sides.fold(0, |place, (index, side)| place * side + index)
        };
        let bytes = self.payload.get(place * number.bytes()..(place + 1) * number.bytes());
        bytes.map_or(f64::NAN, |bytes| number.read(bytes))
    }

    /// Leaves the layer of this number along the first dimension. Precondition: there is one.
    pub(super) fn take_layer(&mut self, layer: usize) {
        let layers = self.shape.remove(0);
        if self.is_fortran {
            self.first += layer * self.apart;
            self.apart *= layers;
        } else {
            let entries: usize = self.shape.iter().product();
            self.payload = &self.payload[layer * entries * self.row_bytes..];
        }
    }

    /// Returns a table without single layers in addition to its rows and columns, as in shape N × 1 × 3: its numbers
    /// lie in the same order.
    pub(super) fn without_single_layers(mut self) -> Self {
        while self.shape.len() > 2
            && let Some(place) = self.shape.iter().position(|&length| length == 1)
        {
            self.shape.remove(place);
        }
        self
    }

    fn check_claim(&self, start: usize) -> Result<(), Fault> {
        let needed = self.claimed_bytes();
        // A header could claim any number of zero-byte entries.
        if needed.is_none_or(|needed| needed > self.payload.len()) || self.row_bytes == 0 {
            return Err(Fault::new(
                Place::Byte(start),
                format!(
                    "{} bytes follow the header, but it claims an array of {:?} entries of {} bytes: the file is \
                     truncated, or its header is wrong",
                    self.payload.len(),
                    self.shape,
                    self.row_bytes
                ),
            ));
        }
        Ok(())
    }

    /// Column `index` of `width` in a table with `count` rows.
    pub(super) fn column(&self, name: String, index: usize, width: usize, count: usize) -> Column<'a> {
        let ArrayLayout::Table(number) = self.kind else {
            return Column {
                name,
                scalar: Scalar::F64,
                values: Values::Parsed(vec![f64::NAN; count]),
            };
        };
        let bytes = number.bytes();
        let (start, step) = if self.is_fortran {
            ((self.first + self.apart * index * count) * bytes, self.apart * bytes)
        } else {
            (index * bytes, width * bytes)
        };
        column_of(number, name, self.payload, [start, step], count)
    }
}
