//! SPZ (Niantic Labs 2024 to 2026): an array an attribute: positions, opacities, colours, logarithms of half axes,
//! rotations, harmonics. Axes point right, up and back.
//!
//! Versions 1 to 3 are one gzip stream with a header of 16 bytes. Version 4 has a header of 32 bytes that is not
//! packed, records of vendors, which are stepped over, a table with the sizes of its streams, and each array as a
//! stream of Zstandard.
//!
//! Positions are of half precision in version 1 and in fixed point behind it. Versions 1 and 2 have a rotation as the
//! vector part of a quaternion whose real part is not negative, the others as its three smallest parts, ten bits each.

use super::{LARGEST_OF_OTHERS, SPLAT_BYTES, SplatShape, channel_of_harmonic, put_shapes, with_largest};
use crate::binary::half;
use crate::cloud::{AxisConvention, Positions, RawCloud};
use crate::io::error::{Fault, Place};
use crate::io::files::unpack::{Packing, unpack, unpack_gzip};
use crate::io::format::{Format, Magic, Traits};
use crate::io::options::ReadOptions;
use glam::Quat;
use std::io::Cursor;

/// Packed splats; gzip files with another extension are not.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "SPZ",
    extensions: &["spz"],
    magic: &[Magic::start(b"\x1f\x8b"), Magic::start(MAGIC)],
    needs_extension: true,
    convention: Some(AxisConvention::YUp),
    ..Traits::PLAIN
});

const MAGIC: &[u8] = b"NGSP";

/// Header size of a file that is compressed as a whole.
const HEADER_BYTES: usize = 16;

/// Header size of a file whose arrays are compressed.
const LONG_HEADER_BYTES: usize = 32;

/// The size of a stream before and after unpacking.
const TABLE_ROW_BYTES: usize = 16;

/// The version whose arrays are packed one by one.
const STREAMS_VERSION: u32 = 4;

/// Scale of the constant terms of harmonics in the file: they are divided by it.
const COLOR_SCALE: f32 = 0.15;

/// Steps of a part of a rotation of three parts from zero to its largest value.
const PART_STEPS: u32 = (1 << 9) - 1;

/// Parsed SPZ header.
struct Header {
    version: u32,
    count: usize,
    fractional_bits: u8,
}

/// The arrays that are read, in the order of the file.
const ARRAYS: [&str; 5] = ["positions", "opacities", "colours", "sizes", "rotations"];

impl Header {
    /// Parses the header from 16 bytes at least.
    fn of(head: &[u8; HEADER_BYTES]) -> Result<Self, Fault> {
        if !head.starts_with(MAGIC) {
            return Err(Fault::header("it does not begin with `NGSP`: this is not an SPZ file"));
        }
        Ok(Self {
            version: number(head, 4),
            count: number(head, 8) as usize,
            fractional_bits: head[13],
        })
    }

    /// Bytes a splat of each of [`ARRAYS`].
    fn widths(&self) -> [usize; 5] {
        let position = if self.version == 1 { 6 } else { 9 };
        let rotation = if self.version < 3 { 3 } else { 4 };
        [position, 1, 3, 3, rotation]
    }
}

/// Four bytes from `at` on. Precondition: they exist.
fn number(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

pub(in crate::io) fn decode(bytes: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    if bytes.starts_with(MAGIC) {
        return of_streams(bytes, options);
    }
    let unpacked = unpack_gzip(Cursor::new(bytes), options).map_err(Fault::header)?;
    let Some(head) = unpacked.first_chunk() else {
        return Err(Fault::header("it ends within its header: it is truncated"));
    };
    let header = Header::of(head)?;
    if !(1..STREAMS_VERSION).contains(&header.version) {
        return Err(Fault::header(format!(
            "it is packed as a whole and says that it is of version {}, expected 1 to 3",
            header.version
        )));
    }
    let options = options.holding(unpacked.len());
    let mut rest = &unpacked[HEADER_BYTES..];
    let mut arrays = [&[][..]; 5];
    for ((array, name), width) in arrays.iter_mut().zip(ARRAYS).zip(header.widths()) {
        let length = header.count.checked_mul(width).filter(|&length| length <= rest.len());
        let Some(length) = length else {
            return Err(Fault::new(
                Place::Byte(unpacked.len() - rest.len()),
                format!(
                    "the {name} of {} splats are claimed here, but only {} bytes follow: the file is truncated, or its \
                     header is wrong",
                    header.count,
                    rest.len()
                ),
            ));
        };
        (*array, rest) = rest.split_at(length);
    }
    options.claim_entries(&format!("{} splats", header.count), header.count, SPLAT_BYTES)?;
    Ok(cloud(&header, arrays))
}

/// A file whose arrays are packed one by one.
fn of_streams(bytes: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    let (Some(head), Some(long)) = (bytes.first_chunk(), bytes.first_chunk::<LONG_HEADER_BYTES>()) else {
        return Err(Fault::header("it ends within its header: it is truncated"));
    };
    let header = Header::of(head)?;
    if header.version != STREAMS_VERSION {
        return Err(Fault::header(format!(
            "version {} is not read, expected 1 to {STREAMS_VERSION}: save it as one of these",
            header.version
        )));
    }
    // An empty file has no packed data.
    if header.count == 0 {
        return Ok(cloud(&header, [&[]; 5]));
    }
    let (streams, table) = (usize::from(long[15]), number(long, 16) as usize);
    if streams < ARRAYS.len() || table < LONG_HEADER_BYTES {
        return Err(Fault::header(format!(
            "it says that it has {streams} streams, told of from byte {table} on: expected {} at least, behind the \
             {LONG_HEADER_BYTES} bytes of the header",
            ARRAYS.len()
        )));
    }
    let behind = table.checked_add(streams * TABLE_ROW_BYTES);
    let Some(mut at) = behind.filter(|&behind| behind <= bytes.len()) else {
        return Err(Fault::new(
            Place::Byte(bytes.len()),
            format!("it ends before or in its table of {streams} streams from byte {table} on: it is truncated"),
        ));
    };
    let widths = header.widths();
    let splat_bytes = widths.iter().sum::<usize>() + SPLAT_BYTES;
    options.claim_entries(&format!("{} splats", header.count), header.count, splat_bytes)?;
    let rows = bytes[table..].as_chunks::<TABLE_ROW_BYTES>().0;
    let mut arrays: [Vec<u8>; 5] = Default::default();
    for (index, (array, name)) in arrays.iter_mut().zip(ARRAYS).enumerate() {
        let [packed, whole] = sizes(rows[index]);
        let expected = (header.count * widths[index]) as u64;
        if whole != expected {
            return Err(Fault::new(
                Place::Byte(table + index * TABLE_ROW_BYTES),
                format!(
                    "the {name} of {} splats are {whole} bytes, expected {expected}",
                    header.count
                ),
            ));
        }
        let packed = usize::try_from(packed).ok().and_then(|packed| at.checked_add(packed));
        let Some(stream) = packed.and_then(|end| bytes.get(at..end)) else {
            return Err(Fault::new(
                Place::Byte(at),
                format!("the file ends within the {name} that begin here: it is truncated, or its table is wrong"),
            ));
        };
        let unpacked = unpack(Packing::Zstd, stream, expected, options);
        *array = unpacked.map_err(|problem| Fault::new(Place::Byte(at), format!("the {name}: {problem}")))?;
        at += stream.len();
    }
    Ok(cloud(&header, arrays.each_ref().map(Vec::as_slice)))
}

/// A row of the table of streams: bytes before and after unpacking.
fn sizes(row: [u8; TABLE_ROW_BYTES]) -> [u64; 2] {
    let row = u128::from_le_bytes(row);
    [row as u64, (row >> 64) as u64]
}

/// The splats of these arrays, each as long as the header has it.
fn cloud(header: &Header, [positions, alphas, colors, scales, rotations]: [&[u8]; 5]) -> RawCloud {
    let places = if header.version == 1 {
        let positions = positions.as_chunks::<6>().0;
        positions.iter().copied().map(half_position).collect()
    } else {
        let unit = 0.5f64.powi(i32::from(header.fractional_bits));
        let position = |bytes: &[u8; 9]| {
            [0, 3, 6].map(|at| {
                // The upper byte holds the sign.
                let fixed = i32::from_le_bytes([0, bytes[at], bytes[at + 1], bytes[at + 2]]) >> 8;
                (f64::from(fixed) * unit) as f32
            })
        };
        positions.as_chunks::<9>().0.iter().map(position).collect()
    };
    let mut cloud = RawCloud::from_positions(Positions::F32(places));
    let color = |(rgb, &alpha): (&[u8; 3], &u8)| {
        let [r, g, b] = rgb.map(|channel| channel_of_harmonic((f32::from(channel) / 255.0 - 0.5) / COLOR_SCALE));
        [r, g, b, alpha]
    };
    cloud.attributes.colors = Some(colors.as_chunks::<3>().0.iter().zip(alphas).map(color).collect());
    let scales = scales.as_chunks::<3>().0;
    let rotation_bytes = header.widths()[4];
    put_shapes(&mut cloud, &[], |index| {
        let rotation = &rotations[index * rotation_bytes..][..rotation_bytes];
        SplatShape {
            log_scales: scales[index].map(|scale| f32::from(scale) / 16.0 - 10.0),
            rotation: match *rotation {
                [x, y, z] => of_vector_part([x, y, z]),
                [a, b, c, d] => of_smallest_three(u32::from_le_bytes([a, b, c, d])),
                _ => Quat::IDENTITY,
            },
        }
    });
    cloud.convention = FORMAT.convention();
    cloud
}

/// A position of version 1.
fn half_position(bytes: [u8; 6]) -> [f32; 3] {
    [0, 2, 4].map(|at| half(u16::from_le_bytes([bytes[at], bytes[at + 1]])) as f32)
}

/// The rotation of versions 1 and 2.
fn of_vector_part(bytes: [u8; 3]) -> Quat {
    let [x, y, z] = bytes.map(|byte| f32::from(byte) / 127.5 - 1.0);
    let w = (1.0 - (x * x + y * y + z * z)).max(0.0).sqrt();
    Quat::from_xyzw(x, y, z, w)
}

/// The rotation from version 3 on: a sign and nine bits for each part but the largest, the last of x, y, z and w
/// lowest.
fn of_smallest_three(word: u32) -> Quat {
    let part = |place: u32| {
        let bits = word >> (10 * place);
        let size = LARGEST_OF_OTHERS * (bits & PART_STEPS) as f32 / PART_STEPS as f32;
        if bits >> 9 & 1 == 1 { -size } else { size }
    };
    Quat::from_array(with_largest([part(2), part(1), part(0)], word >> 30))
}
