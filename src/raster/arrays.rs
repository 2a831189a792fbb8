//! Images as arrays of numpy: `.npy`, and one of the arrays of an `.npz`.
//!
//! Two dimensions are rows and columns; a third of one entry is dropped, one of three are colours. Floats are
//! unchanged; whole numbers become 16 bits, as in images.

use super::pixels::{Raster, Samples, checked_bytes, checked_size};
use crate::binary::{Header, Layout, Number, Scalar};
use std::io::{Cursor, Read};

/// First bytes of a file that is an array.
pub(super) const NPY: &[u8] = b"\x93NUMPY";

/// First bytes of an archive of arrays.
pub(super) const NPZ: &[u8] = b"PK\x03\x04";

/// Names of the array of depths among several.
const DEPTHS: &[&str] = &["depth", "depths", "depth_map", "depthmap", "z"];

/// Maximum size of the head of an array, bytes.
const HEAD_BYTES: usize = 1 << 16;

/// The image that an array is.
pub(super) fn decode_npy(bytes: &[u8], max_bytes: u64) -> Result<Raster, String> {
    let shape = Shape::of(bytes)?;
    let [width, height] = checked_size(shape.size_px)?;
    let pixels = width as usize * height as usize;
    // Each pixel is converted via a double.
    checked_bytes(pixels as u64 * shape.channels as u64 * 8, max_bytes)?;
    let payload = bytes.get(shape.payload_at..).unwrap_or_default();
    let entries = pixels * shape.channels;
    let entry_bytes = shape.number.bytes();
    if payload.len() / entry_bytes < entries {
        return Err(format!(
            "it claims {height} × {width} entries of {entry_bytes} bytes and has {} bytes: it is truncated",
            payload.len()
        ));
    }
    let number = |index: usize| shape.number.read(&payload[index * entry_bytes..]);
    // In Fortran order the row index varies fastest.
    let at = |pixel: usize, channel: usize| {
        let (row, column) = (pixel / width as usize, pixel % width as usize);
        if shape.is_fortran {
            (channel * width as usize + column) * height as usize + row
        } else {
            pixel * shape.channels + channel
        }
    };
    let samples = if shape.channels == 3 {
        let channel = |pixel: usize, channel: usize| number(at(pixel, channel)).clamp(0.0, 255.0) as u8;
        Samples::Rgb8(
            (0..pixels)
                .map(|pixel| [0, 1, 2].map(|at| channel(pixel, at)))
                .collect(),
        )
    } else {
        samples(shape.number.scalar, (0..pixels).map(|pixel| number(at(pixel, 0))))?
    };
    Ok(Raster {
        size_px: [width, height],
        samples,
    })
}

/// The image that one of the arrays of an archive is: the one that is named after depths, or the only one.
pub(super) fn decode_npz(bytes: &[u8], max_bytes: u64) -> Result<Raster, String> {
    decode_npy(&depths_in(bytes, max_bytes)?, max_bytes)
}

/// Width and height of an array, read from its head only.
pub(super) fn npy_size_px(bytes: &[u8]) -> Result<[u32; 2], String> {
    checked_size(Shape::of(bytes)?.size_px)
}

/// Width and height of the array that [`decode_npz`] reads.
pub(super) fn npz_size_px(bytes: &[u8]) -> Result<[u32; 2], String> {
    npy_size_px(&depths_in(bytes, HEAD_BYTES as u64)?)
}

/// Array shape and type stated by the header.
struct Shape {
    size_px: [u32; 2],
    channels: usize,
    number: Number,
    is_fortran: bool,
    payload_at: usize,
}

impl Shape {
    fn of(bytes: &[u8]) -> Result<Self, String> {
        let header = Header::parse(bytes).map_err(|error| error.to_string())?;
        let Layout::Table(number) = header.layout else {
            return Err("it is an array of records, expected numbers in rows and columns".to_owned());
        };
        let (rows, columns, channels) = match *header.shape.as_slice() {
            [rows, columns] | [rows, columns, 1] | [1, rows, columns] => (rows, columns, 1),
            [rows, columns, 3] => (rows, columns, 3),
            ref other => {
                let shape: Vec<String> = other.iter().map(usize::to_string).collect();
                return Err(format!(
                    "it is an array of {}, expected rows × columns: save one image per file",
                    shape.join(" × ")
                ));
            }
        };
        let edge = |entries: usize| u32::try_from(entries).unwrap_or(u32::MAX);
        Ok(Self {
            size_px: [edge(columns), edge(rows)],
            channels,
            number,
            is_fortran: header.is_fortran,
            payload_at: header.payload_at,
        })
    }
}

fn samples(scalar: Option<Scalar>, numbers: impl Iterator<Item = f64>) -> Result<Samples, String> {
    match scalar {
        None | Some(Scalar::F32 | Scalar::F64) => Ok(Samples::GrayF32(numbers.map(|number| number as f32).collect())),
        Some(Scalar::U8) => Ok(Samples::Gray8(numbers.map(|number| number as u8).collect())),
        Some(_) => {
            let word = |number: f64| match number {
                // Nothing was measured below zero.
                ..0.0 => Ok(0),
                number if number <= f64::from(u16::MAX) => Ok(number as u16),
                number => Err(format!(
                    "it has the whole number {number}, and those of depth images end at 65535: save it as floats, in \
                     metres"
                )),
            };
            Ok(Samples::Gray16(numbers.map(word).collect::<Result<_, _>>()?))
        }
    }
}

/// The arrays in an archive with their names in lower case, no more than `max_bytes` of all.
pub(crate) fn members_of_npz(bytes: &[u8], max_bytes: u64) -> Result<Vec<(String, Vec<u8>)>, String> {
    let damaged = |error: &dyn std::fmt::Display| format!("the archive is damaged ({error})");
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let mut members = Vec::new();
    let mut left = max_bytes;
    for index in 0..archive.len() {
        let member = archive.by_index(index).map_err(|error| damaged(&error))?;
        let name = member.name().map_err(|error| damaged(&error))?.to_ascii_lowercase();
        let Some(name) = name.strip_suffix(".npy").map(str::to_owned) else {
            continue;
        };
        let mut unpacked = Vec::new();
        member
            .take(left)
            .read_to_end(&mut unpacked)
            .map_err(|error| damaged(&error))?;
        left -= unpacked.len() as u64;
        members.push((name, unpacked));
    }
    Ok(members)
}

/// The bytes of the array of depths in an archive, at most `max_bytes` of them.
fn depths_in(bytes: &[u8], max_bytes: u64) -> Result<Vec<u8>, String> {
    let damaged = |error: &dyn std::fmt::Display| format!("the archive is damaged ({error})");
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    let mut names: Vec<(usize, String)> = Vec::new();
    for index in 0..archive.len() {
        if let Some(Ok(name)) = archive.name_for_index(index)
            && let Some(name) = name.strip_suffix(".npy")
        {
            names.push((index, name.to_ascii_lowercase()));
        }
    }
    let named = DEPTHS
        .iter()
        .find_map(|depth| names.iter().find(|(_, name)| name == depth));
    let index = match (named, names.as_slice()) {
        (Some((index, _)), _) | (None, [(index, _)]) => *index,
        (None, names) => {
            let names: Vec<&str> = names.iter().map(|(_, name)| name.as_str()).collect();
            return Err(format!(
                "its arrays are {}, and none is named depth: save one array per file",
                names.join(", ")
            ));
        }
    };
    let member = archive.by_index(index).map_err(|error| damaged(&error))?;
    let mut unpacked = Vec::new();
    member
        .take(max_bytes)
        .read_to_end(&mut unpacked)
        .map_err(|error| damaged(&error))?;
    Ok(unpacked)
}

#[cfg(test)]
mod tests {
    use super::super::{decode, size_px};
    use super::*;
    use std::io::Write as _;

    fn npy(descr: &str, is_fortran: bool, shape: &str, payload: &[u8]) -> Vec<u8> {
        let order = if is_fortran { "True" } else { "False" };
        let header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.into_bytes());
        bytes.extend(payload);
        bytes
    }

    fn bytes<T, const N: usize>(numbers: &[T], of: impl Fn(&T) -> [u8; N]) -> Vec<u8> {
        numbers.iter().flat_map(of).collect()
    }

    #[test]
    fn every_type_and_order_is_the_same_image() {
        let rows = [1.0_f32, 2.0, 3.0, 4.0, 5.0, 6.0];
        let columns = [1.0_f32, 4.0, 2.0, 5.0, 3.0, 6.0];
        let doubles = rows.map(f64::from);
        for file in [
            npy("<f4", false, "(2, 3)", &bytes(&rows, |number| number.to_le_bytes())),
            npy(">f4", false, "(2, 3, 1)", &bytes(&rows, |number| number.to_be_bytes())),
            npy("<f4", true, "(2, 3)", &bytes(&columns, |number| number.to_le_bytes())),
            npy(
                "<f8",
                false,
                "(1, 2, 3)",
                &bytes(&doubles, |number| number.to_le_bytes()),
            ),
        ] {
            let raster = decode(&file, 1 << 20).unwrap();
            assert_eq!(raster.size_px, [3, 2]);
            assert_eq!(raster.samples, Samples::GrayF32(rows.to_vec()));
            assert_eq!(size_px(&file).unwrap(), [3, 2]);
        }
        let millimetres = [0_u16, 1000, 65535, 2, 3, 4];
        let signed = [-5_i32, 1000, 65535, 2, 3, 4];
        for file in [
            npy(
                "<u2",
                false,
                "(2, 3)",
                &bytes(&millimetres, |number| number.to_le_bytes()),
            ),
            npy("<i4", false, "(2, 3)", &bytes(&signed, |number| number.to_le_bytes())),
        ] {
            let raster = decode(&file, 1 << 20).unwrap();
            assert_eq!(raster.samples, Samples::Gray16(millimetres.to_vec()));
        }
        let colors = decode(&npy("|u1", false, "(1, 2, 3)", &[1, 2, 3, 4, 5, 6]), 1 << 20).unwrap();
        assert_eq!(
            colors.size_px,
            [3, 2],
            "an image of three columns, by its first dimension"
        );
        let colors = decode(&npy("|u1", false, "(2, 1, 3)", &[1, 2, 3, 4, 5, 6]), 1 << 20).unwrap();
        assert_eq!(colors.samples, Samples::Rgb8(vec![[1, 2, 3], [4, 5, 6]]));
    }

    #[test]
    fn the_archive_member_named_after_depths_is_read() {
        let array = |value: f32| npy("<f4", false, "(1, 1)", &value.to_le_bytes());
        let archive = |arrays: &[(&str, f32)]| {
            let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
            for (name, value) in arrays {
                writer
                    .start_file(*name, zip::write::SimpleFileOptions::default())
                    .unwrap();
                writer.write_all(&array(*value)).unwrap();
            }
            writer.finish().unwrap().into_inner()
        };
        for arrays in [&[("arr_0.npy", 7.0)][..], &[("mask.npy", 1.0), ("depth.npy", 7.0)]] {
            let file = archive(arrays);
            assert_eq!(decode(&file, 1 << 20).unwrap().samples, Samples::GrayF32(vec![7.0]));
            assert_eq!(size_px(&file).unwrap(), [1, 1]);
        }
        let error = decode(&archive(&[("a.npy", 1.0), ("b.npy", 2.0)]), 1 << 20).unwrap_err();
        assert!(error.contains("its arrays are a, b"), "{error}");
    }

    #[test]
    fn invalid_images_are_rejected_with_a_reason() {
        for (file, expected) in [
            (npy("<f4", false, "(2, 3)", &[0; 20]), "truncated"),
            (npy("<f4", false, "(4, 5, 6)", &[0; 480]), "4 × 5 × 6"),
            (npy("<f4", false, "(60000, 60000)", &[]), "along an edge"),
            (npy("<f4", false, "(30000, 30000)", &[]), "--max-memory"),
            (npy("<u4", false, "(1, 1)", &70_000_u32.to_le_bytes()), "70000"),
        ] {
            let error = decode(&file, 1 << 20).unwrap_err();
            assert!(error.contains(expected), "{expected}: {error}");
        }
    }
}
