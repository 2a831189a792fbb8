//! A table of numbers as numpy writes it, as in `poses_bounds.npy` and depths in `.npy`.
//!
//! Rows and columns of numbers of any type, in the order of C or of Fortran. (The header: `binary`. Clouds in NPY
//! files: `io/formats/npy`, which comes after this module.)

use crate::binary::{Header, Layout};
use crate::photos::error::PhotosError;
use std::path::Path;

/// Rows of numbers.
#[derive(Debug, PartialEq)]
pub(in crate::photos) struct NpyTable {
    pub(in crate::photos) columns: usize,
    /// Row by row.
    pub(in crate::photos) numbers: Vec<f64>,
}

impl NpyTable {
    /// The table in `bytes`, the contents of the file `path`. Dimensions of one entry after rows and columns do not
    /// count.
    pub(in crate::photos) fn parse(path: &Path, bytes: &[u8]) -> Result<Self, PhotosError> {
        let wrong = |problem: String| PhotosError::invalid(path, "the header", problem);
        let header = Header::parse(bytes).map_err(|error| wrong(format!("{error}; save it with numpy.save")))?;
        let Layout::Table(number) = header.layout else {
            return Err(wrong("expected a table of numbers, found records".to_owned()));
        };
        let [rows, columns] = *without_ones(&header.shape) else {
            let shape = &header.shape;
            return Err(wrong(format!(
                "expected a table of rows and columns, found the shape {shape:?}"
            )));
        };
        let payload = &bytes[header.payload_at..];
        let count = rows
            .checked_mul(columns)
            .filter(|&count| count <= payload.len() / number.bytes());
        let Some(count) = count else {
            return Err(wrong(format!(
                "{rows} rows of {columns} numbers are claimed, and {} bytes follow the header: the file was cut, or \
                 its header is wrong",
                payload.len()
            )));
        };
        let stored = payload.chunks_exact(number.bytes()).take(count);
        let stored: Vec<f64> = stored.map(|bytes| number.read(bytes)).collect();
        let numbers = if header.is_fortran {
            (0..count)
                .map(|at| stored[at % columns * rows + at / columns])
                .collect()
        } else {
            stored
        };
        Ok(Self { columns, numbers })
    }
}

/// The dimensions without single-entry ones after the second.
fn without_ones(shape: &[usize]) -> &[usize] {
    let ones = shape.iter().skip(2).rev().take_while(|&&length| length == 1).count();
    &shape[..shape.len() - ones]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, payload: &[u8]) -> Vec<u8> {
        let length = (header.len() as u16).to_le_bytes();
        [b"\x93NUMPY\x01\x00".as_slice(), &length, header.as_bytes(), payload].concat()
    }

    fn doubles(numbers: &[f64]) -> Vec<u8> {
        numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
    }

    #[test]
    fn tables_are_read_in_both_orders_and_both_widths() {
        let rows = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let parse = |header: &str, payload: &[u8]| NpyTable::parse(Path::new("a.npy"), &file(header, payload)).unwrap();
        let expected = NpyTable {
            columns: 3,
            numbers: rows.to_vec(),
        };
        let by_rows = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }\n";
        assert_eq!(parse(by_rows, &doubles(&rows)), expected);
        let by_columns = "{'fortran_order': True, 'shape': (2, 3), 'descr': '<f8'}";
        assert_eq!(parse(by_columns, &doubles(&[1.0, 4.0, 2.0, 5.0, 3.0, 6.0])), expected);
        let floats: Vec<u8> = rows.iter().flat_map(|&number| (number as f32).to_le_bytes()).collect();
        assert_eq!(
            parse("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3)}", &floats),
            expected
        );
        let words: Vec<u8> = rows.iter().flat_map(|&number| (number as u16).to_be_bytes()).collect();
        assert_eq!(
            parse("{'descr': '>u2', 'fortran_order': False, 'shape': (2, 3, 1)}", &words),
            expected
        );
    }

    #[test]
    fn arrays_that_are_not_tables_are_rejected_with_a_reason() {
        let error = |bytes: &[u8]| NpyTable::parse(Path::new("a.npy"), bytes).unwrap_err().to_string();
        for (header, words) in [
            (
                "{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (1,)}",
                "found records",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (1,)}",
                "the shape [1]",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3, 5)}",
                "the shape [2, 3, 5]",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 17)}",
                "8 bytes follow the header",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (18446744073709551615, 17)}",
                "8 bytes follow the header",
            ),
            ("{'descr': '", "not understood"),
            ("", "not understood"),
        ] {
            let error = error(&file(header, &[0; 8]));
            assert!(error.contains(words), "{header}: {error}");
        }
        for bytes in [
            &b""[..],
            b"\x93NUMPY",
            b"\x93NUMPY\x01\x00\xff\xff{",
            b"\x93NUMPY\x09\x00\x00\x00",
            b"PK",
        ] {
            assert!(error(bytes).contains("numpy.save"), "{bytes:?}");
        }
    }
}
