//! A table of numbers as numpy writes it, NPY format 1 to 3: what `poses_bounds.npy` is.
//!
//! Only rows and columns of little-endian floats are read, in the order of C or of Fortran. (Clouds in NPY files, of
//! any type and shape: `io/npy`, which comes after this module.) The header is a Python dictionary of three keys.

use super::error::PhotosError;
use std::path::Path;

const MAGIC: &[u8] = b"\x93NUMPY";

/// Rows of numbers.
#[derive(Debug, PartialEq)]
pub(super) struct NpyTable {
    pub(super) columns: usize,
    /// Row by row.
    pub(super) numbers: Vec<f64>,
}

impl NpyTable {
    /// The table in `bytes`, which are those of the file `path`.
    pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Self, PhotosError> {
        let wrong = |problem: &str| PhotosError::invalid(path, "the header", problem);
        let (header, payload) = split(bytes).ok_or_else(|| {
            wrong("expected \\x93NUMPY and a dictionary behind it, found something else: save it with numpy.save")
        })?;
        let header = String::from_utf8_lossy(header);
        let value = |key: &str| {
            let (_, rest) = header
                .split_once(&format!("'{key}'"))
                .or_else(|| header.split_once(&format!("\"{key}\"")))?;
            Some(rest.trim_start().strip_prefix(':')?.trim_start())
        };
        let kind = value("descr").and_then(|text| text.get(1..4));
        let bytes_each = match kind {
            Some("<f8") => 8,
            Some("<f4") => 4,
            _ => return Err(wrong("expected numbers of the type <f8 or <f4: save it as float64")),
        };
        let is_fortran = value("fortran_order").is_some_and(|text| text.starts_with("True"));
        let [rows, columns] = value("shape")
            .and_then(shape)
            .ok_or_else(|| wrong("expected a table of rows and columns, found another shape"))?;
        let count = rows
            .checked_mul(columns)
            .filter(|&count| count <= payload.len() / bytes_each);
        let Some(count) = count else {
            let problem = format!(
                "{rows} rows of {columns} numbers are claimed, and {} bytes follow the header: the file was cut, or \
                 its header is wrong",
                payload.len()
            );
            return Err(PhotosError::invalid(path, "the header", problem));
        };
        let stored: Vec<f64> = match bytes_each {
            8 => payload
                .as_chunks::<8>()
                .0
                .iter()
                .map(|&bytes| f64::from_le_bytes(bytes))
                .take(count)
                .collect(),
            _ => payload
                .as_chunks::<4>()
                .0
                .iter()
                .map(|&bytes| f32::from_le_bytes(bytes).into())
                .take(count)
                .collect(),
        };
        let numbers = if is_fortran {
            (0..count)
                .map(|at| stored[at % columns * rows + at / columns])
                .collect()
        } else {
            stored
        };
        Ok(Self { columns, numbers })
    }
}

/// The dictionary and what follows it.
fn split(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let ([major, _], rest) = bytes.strip_prefix(MAGIC)?.split_first_chunk()?;
    let (length, rest) = match major {
        1 => {
            let (length, rest) = rest.split_first_chunk()?;
            (usize::from(u16::from_le_bytes(*length)), rest)
        }
        2 | 3 => {
            let (length, rest) = rest.split_first_chunk()?;
            (u32::from_le_bytes(*length) as usize, rest)
        }
        _ => return None,
    };
    rest.split_at_checked(length)
}

/// Rows and columns of `(20, 17)`.
fn shape(text: &str) -> Option<[usize; 2]> {
    let (inside, _) = text.strip_prefix('(')?.split_once(')')?;
    let numbers = inside.split(',').map(str::trim).filter(|number| !number.is_empty());
    let numbers: Vec<usize> = numbers.map_while(|number| number.parse().ok()).take(3).collect();
    numbers.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, payload: &[u8]) -> Vec<u8> {
        let length = (header.len() as u16).to_le_bytes();
        [MAGIC, &[1, 0], &length, header.as_bytes(), payload].concat()
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
    }

    #[test]
    fn what_is_no_table_is_an_error_that_says_so() {
        let error = |bytes: &[u8]| NpyTable::parse(Path::new("a.npy"), bytes).unwrap_err().to_string();
        for (header, words) in [
            (
                "{'descr': '<i8', 'fortran_order': False, 'shape': (1, 1)}",
                "<f8 or <f4",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (8,)}",
                "another shape",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3, 5)}",
                "another shape",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 17)}",
                "8 bytes follow the header",
            ),
            (
                "{'descr': '<f8', 'fortran_order': False, 'shape': (18446744073709551615, 17)}",
                "8 bytes follow the header",
            ),
            ("{'descr': '", "<f8 or <f4"),
            ("", "<f8 or <f4"),
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
