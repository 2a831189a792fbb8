//! The fields that compressed points consist of, and their decoders: the crate `laz`, except for GPS times and the
//! first field of layered points, which contains some (see [`super::gps_times`]).

use super::gps_times::GpsTimes;
use super::layered_point::LayeredPoint;
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{DecompressionSelection, LazItem, LazItemType};
use std::io::Cursor;

/// Fields from this version on are in layers.
pub(super) const LAYERED_VERSION: u16 = 3;

/// Unpacks a chunk of points with the fields `items`, from the place of `packed` on, into `rows`. The sizes of its
/// layers have been checked.
pub(super) fn unpack(items: &[LazItem], packed: &mut Cursor<&[u8]>, rows: &mut [u8]) -> laz::Result<()> {
    if items[0].version() >= LAYERED_VERSION {
        let mut chunk = LayeredPointRecordDecompressor::new(packed);
        for item in items {
            match (item.item_type(), item.version()) {
                (LazItemType::Point14, version @ 3..=4) => {
                    chunk.add_field_decompressor(LayeredPoint::new(version));
                }
                _ => chunk.set_fields_from(&vec![*item])?,
            }
        }
        // Clouds cannot store waveform data.
        chunk.set_selection(DecompressionSelection::all().skip_wavepacket());
        chunk.decompress_many(rows)?;
    } else {
        let mut chunk = SequentialPointRecordDecompressor::new(packed);
        for item in items {
            match (item.item_type(), item.version()) {
                (LazItemType::GpsTime, 2) => {
                    chunk.add_field_decompressor(GpsTimes::in_one_stream());
                }
                _ => chunk.set_fields_from(&vec![*item])?,
            }
        }
        chunk.decompress_many(rows)?;
    }
    Ok(())
}

/// Bytes of a field of a point. Only fields of extra bytes have a size given by the file.
pub(super) fn bytes(item: LazItem) -> usize {
    match item.item_type() {
        LazItemType::Point10 => 20,
        LazItemType::GpsTime | LazItemType::RGBNIR14 => 8,
        LazItemType::RGB12 | LazItemType::RGB14 => 6,
        LazItemType::WavePacket13 | LazItemType::WavePacket14 => 29,
        LazItemType::Point14 => 30,
        LazItemType::Byte(_) | LazItemType::Byte14(_) => usize::from(item.size()),
    }
}

/// Layers that a field is in.
pub(super) fn layers(item: LazItem) -> usize {
    match item.item_type() {
        LazItemType::Point14 => 9,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(bytes) => usize::from(bytes),
        _ => 1,
    }
}
