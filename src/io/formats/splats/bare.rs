//! `.splat`: bare records of 32 bytes without a header, as viewers in browsers read them (Kwok 2023): position and half
//! axes as single precision, colour and opacity as bytes, and the rotation, real part first, as bytes around 128.

use super::{SPLAT_BYTES, SplatShape, put_shapes};
use crate::cloud::{Positions, RawCloud};
use crate::io::error::{Fault, Place};
use crate::io::format::{Format, Traits};
use crate::io::options::ReadOptions;
use glam::Quat;

/// Records without a header, known by the extension alone.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "SPLAT",
    extensions: &["splat"],
    ..Traits::PLAIN
});

const RECORD_BYTES: usize = 32;

pub(in crate::io) fn decode(bytes: &[u8], options: &ReadOptions) -> Result<RawCloud, Fault> {
    let (records, rest) = bytes.as_chunks::<RECORD_BYTES>();
    if !rest.is_empty() {
        return Err(Fault::new(
            Place::Byte(records.len() * RECORD_BYTES),
            format!(
                "the last {} bytes are not a whole record: expected a multiple of {RECORD_BYTES} bytes, the file is \
                 truncated or of another kind",
                rest.len()
            ),
        ));
    }
    options.claim_entries("the splats", records.len(), SPLAT_BYTES)?;
    let float = |record: &[u8; RECORD_BYTES], index: usize| {
        let at = 4 * index;
        f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]])
    };
    let three = |record: &[u8; RECORD_BYTES], first: usize| [0, 1, 2].map(|axis| float(record, first + axis));
    let positions = records.iter().map(|record| three(record, 0)).collect();
    let mut cloud = RawCloud::from_positions(Positions::F32(positions));
    cloud.attributes.colors = Some(
        records
            .iter()
            .map(|record| [record[24], record[25], record[26], record[27]])
            .collect(),
    );
    put_shapes(&mut cloud, &[], |index| {
        let record = &records[index];
        let part = |index: usize| (f32::from(record[28 + index]) - 128.0) / 128.0;
        SplatShape {
            log_scales: three(record, 3).map(f32::ln),
            rotation: Quat::from_xyzw(part(1), part(2), part(3), part(0)),
        }
    });
    Ok(cloud)
}
