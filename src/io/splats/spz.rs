//! SPZ, versions 2 and 3 (Niantic Labs 2024): a gzip stream of a header of 16 bytes and one array an attribute:
//! positions in fixed point, opacities, colours, logarithms of half axes, rotations, harmonics. Axes point right, up
//! and back.
//!
//! Version 2 has the rotation as the vector part of a quaternion whose real part is not negative, version 3 as the
//! three smallest parts, ten bits each.

use super::super::error::{Fault, Place};
use super::super::format::{Format, Magic, Traits};
use super::super::options::ReadOptions;
use super::super::unpack::{Packing, unpack_unknown};
use super::{LARGEST_OF_OTHERS, SplatShape, channel_of_harmonic, put_shapes, with_largest};
use crate::cloud::{AxisConvention, Positions, RawCloud};
use glam::Quat;

/// Packed splats; other gzip files than those of its name are not.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "SPZ",
    extensions: &["spz"],
    magic: &[Magic::start(b"\x1f\x8b")],
    needs_extension: true,
    convention: Some(AxisConvention::YUp),
    ..Traits::PLAIN
});

const MAGIC: &[u8; 4] = b"NGSP";

const HEADER_BYTES: usize = 16;

/// What constant terms of harmonics are divided by in the file.
const COLOR_SCALE: f32 = 0.15;

/// Steps of a part of a rotation of version 3 from zero to its largest value.
const PART_STEPS: u32 = (1 << 9) - 1;

/// What the header says.
struct Header {
    version: u32,
    count: usize,
    fractional_bits: u8,
}

pub(in crate::io) fn decode(bytes: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    let unpacked = unpack_unknown(Packing::Gzip, bytes, options).map_err(Fault::header)?;
    let header = header(&unpacked)?;
    let count = header.count;
    let rotation_bytes = if header.version == 2 { 3 } else { 4 };
    let mut rest = &unpacked[HEADER_BYTES..];
    let mut array = |name: &str, width: usize| {
        let length = count.checked_mul(width).filter(|&length| length <= rest.len());
        let Some(length) = length else {
            return Err(Fault::new(
                Place::Byte(unpacked.len() - rest.len()),
                format!(
                    "the {name} of {count} splats are claimed here, but only {} bytes follow: the file is truncated, \
                     or its header is wrong",
                    rest.len()
                ),
            ));
        };
        let (array, behind) = rest.split_at(length);
        rest = behind;
        Ok(array)
    };
    let positions = array("positions", 9)?;
    let alphas = array("opacities", 1)?;
    let colors = array("colours", 3)?;
    let scales = array("sizes", 3)?;
    let rotations = array("rotations", rotation_bytes)?;
    let unit = 0.5f64.powi(i32::from(header.fractional_bits));
    let position = |bytes: &[u8; 9]| {
        [0, 3, 6].map(|at| {
            // The upper byte has the sign.
            let fixed = i32::from_le_bytes([0, bytes[at], bytes[at + 1], bytes[at + 2]]) >> 8;
            (f64::from(fixed) * unit) as f32
        })
    };
    let places = positions.as_chunks::<9>().0.iter().map(position).collect();
    let mut cloud = RawCloud::from_positions(Positions::F32(places));
    let color = |(rgb, &alpha): (&[u8; 3], &u8)| {
        let [r, g, b] = rgb.map(|channel| channel_of_harmonic((f32::from(channel) / 255.0 - 0.5) / COLOR_SCALE));
        [r, g, b, alpha]
    };
    cloud.attributes.colors = Some(colors.as_chunks::<3>().0.iter().zip(alphas).map(color).collect());
    let scales = scales.as_chunks::<3>().0;
    put_shapes(&mut cloud, |index| {
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
    Ok(cloud)
}

fn header(bytes: &[u8]) -> Result<Header, Fault> {
    let Some(head) = bytes.first_chunk::<HEADER_BYTES>() else {
        return Err(Fault::header("it ends within its header: it is truncated"));
    };
    if !head.starts_with(MAGIC) {
        return Err(Fault::header("it does not begin with `NGSP`: this is no SPZ file"));
    }
    let number = |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
    let version = number(4);
    if !(2..=3).contains(&version) {
        return Err(Fault::header(format!(
            "version {version} is not read, expected 2 or 3: save it as one of these"
        )));
    }
    Ok(Header {
        version,
        count: number(8) as usize,
        fractional_bits: head[13],
    })
}

/// The rotation of version 2.
fn of_vector_part(bytes: [u8; 3]) -> Quat {
    let [x, y, z] = bytes.map(|byte| f32::from(byte) / 127.5 - 1.0);
    let w = (1.0 - (x * x + y * y + z * z)).max(0.0).sqrt();
    Quat::from_xyzw(x, y, z, w)
}

/// The rotation of version 3: a sign and nine bits for each part but the largest, the last of x, y, z and w lowest.
fn of_smallest_three(word: u32) -> Quat {
    let part = |place: u32| {
        let bits = word >> (10 * place);
        let size = LARGEST_OF_OTHERS * (bits & PART_STEPS) as f32 / PART_STEPS as f32;
        if bits >> 9 & 1 == 1 { -size } else { size }
    };
    Quat::from_array(with_largest([part(2), part(1), part(0)], word >> 30))
}
