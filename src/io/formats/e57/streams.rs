//! The binary side of E57: pages with a sum each, packets in them, and in these a stream of bits for each field.

use crate::io::error::Fault;
use crate::io::formats::las::take;
use crate::progress::Progress;
use ::e57::{PointCloud, Record, RecordDataType};

/// Bytes of the sum at the end of each page.
const SUM_BYTES: u64 = 4;

/// Bytes behind a stream, so that its last numbers are read like the others.
const PAD_BYTES: usize = 16;

/// The bytes of a file without the sums of its pages.
pub(super) struct Pages {
    payload: Vec<u8>,
    page_bytes: u64,
}

impl Pages {
    /// Precondition: the crate found the sums of pages of this size right.
    pub(super) fn new(bytes: &[u8], page_bytes: u64) -> Self {
        let pages = bytes.chunks(page_bytes as usize);
        let payload = pages.flat_map(|page| &page[..page.len().saturating_sub(SUM_BYTES as usize)]);
        Self {
            payload: payload.copied().collect(),
            page_bytes,
        }
    }

    /// Returns the payload bytes from file offset `offset` on.
    fn from(&self, offset: u64) -> Option<&[u8]> {
        let sums = offset / self.page_bytes * SUM_BYTES;
        self.payload.get(usize::try_from(offset - sums).ok()?..)
    }
}

/// Bits of a number of this type.
pub(super) fn bits(kind: &RecordDataType) -> u32 {
    match *kind {
        RecordDataType::Single { .. } => 32,
        RecordDataType::Double { .. } => 64,
        RecordDataType::ScaledInteger { min, max, .. } | RecordDataType::Integer { min, max } => {
            max.abs_diff(min).checked_ilog2().map_or(0, |bits| bits + 1)
        }
    }
}

/// The numbers of one field of a scan.
pub(super) struct FieldStream<'a> {
    pub(super) record: &'a Record,
    /// One behind the other, and [`PAD_BYTES`].
    bytes: Vec<u8>,
    progress: Progress,
}

impl FieldStream<'_> {
    /// Hands over the first `count` numbers with their indices, none of them once cancelled. Precondition: [`read`] was
    /// called with this count.
    pub(super) fn for_each(&self, count: usize, mut each: impl FnMut(usize, f64)) {
        if self.progress.is_cancelled() {
            return;
        }
        // Numbers without one object each, unlike in the crate `e57`: 10 to 20 million points per second.
        match self.record.data_type {
            RecordDataType::Single { .. } => {
                for (index, raw) in self.bytes.as_chunks().0[..count].iter().enumerate() {
                    each(index, f64::from(f32::from_le_bytes(*raw)));
                }
            }
            RecordDataType::Double { .. } => {
                for (index, raw) in self.bytes.as_chunks().0[..count].iter().enumerate() {
                    each(index, f64::from_le_bytes(*raw));
                }
            }
            RecordDataType::Integer { min, .. } => {
                self.for_each_integer(count, min, each);
            }
            RecordDataType::ScaledInteger { min, scale, offset, .. } => {
                self.for_each_integer(count, min, |index, value| {
                    each(index, value * scale + offset);
                });
            }
        }
        self.progress.advance(count);
    }

    fn for_each_integer(&self, count: usize, min: i64, mut each: impl FnMut(usize, f64)) {
        let bits = bits(&self.record.data_type) as usize;
        let mask = (1u128 << bits) - 1;
        for index in 0..count {
            let start = index * bits;
            let window = u128::from_le_bytes(take(&self.bytes, start / 8));
            let above = (window >> (start % 8)) & mask;
            each(index, (i128::from(min) + above as i128) as f64);
        }
    }
}

/// The streams of scan `index`, each of which has one number per point of the scan.
pub(super) fn read<'a>(
    index: usize,
    scan: &'a PointCloud,
    pages: &Pages,
    progress: &Progress,
) -> Result<Vec<FieldStream<'a>>, Fault> {
    const SECTION_BYTES: usize = 32;
    /// Byte position of the header field of the section that holds the offset of the packets.
    const PACKETS_AT: usize = 16;
    const DATA_PACKET: u8 = 1;
    const DATA_HEADER_BYTES: usize = 6;
    let fault = |problem: &str| Fault::entry("scan", index, problem);
    let cut = || fault("its points end before the last one: the file is truncated, or its description is wrong");

    let section = pages.from(scan.file_offset);
    let section = section.and_then(|rest| rest.get(..SECTION_BYTES)).ok_or_else(cut)?;
    if section[0] != 1 {
        return Err(fault("its points are not where its description says"));
    }
    let mut streams: Vec<FieldStream<'a>> = scan
        .prototype
        .iter()
        .map(|record| FieldStream {
            record,
            bytes: Vec::new(),
            progress: progress.clone(),
        })
        .collect();
    let is_whole = |stream: &FieldStream<'_>| {
        let needed = u128::from(scan.records) * u128::from(bits(&stream.record.data_type));
        stream.bytes.len() as u128 * 8 >= needed
    };
    let mut rest = pages
        .from(u64::from_le_bytes(take(section, PACKETS_AT)))
        .ok_or_else(cut)?;
    while !streams.iter().all(is_whole) {
        if progress.is_cancelled() {
            return Err(Fault::cancelled());
        }
        let header = rest.get(..DATA_HEADER_BYTES).ok_or_else(cut)?;
        // Packets are aligned to multiples of four.
        let length = (usize::from(u16::from_le_bytes(take(header, 2))) + 1).next_multiple_of(4);
        let (packet, others) = rest.split_at_checked(length).ok_or_else(cut)?;
        rest = others;
        // Index packets and unknown ones are skipped.
        if header[0] != DATA_PACKET {
            if header[0] > 2 {
                return Err(fault("there is a packet of an unknown kind among its points"));
            }
            continue;
        }
        let wrong = || fault("a packet of its points does not agree with its description");
        if usize::from(u16::from_le_bytes(take(header, 4))) != streams.len() {
            return Err(wrong());
        }
        let sizes_end = DATA_HEADER_BYTES + 2 * streams.len();
        let sizes = packet.get(DATA_HEADER_BYTES..sizes_end).ok_or_else(wrong)?;
        let mut data = &packet[sizes_end..];
        for (stream, &size) in streams.iter_mut().zip(sizes.as_chunks().0) {
            let (own, others) = data
                .split_at_checked(usize::from(u16::from_le_bytes(size)))
                .ok_or_else(wrong)?;
            stream.bytes.extend(own);
            data = others;
        }
    }
    for stream in &mut streams {
        stream.bytes.resize(stream.bytes.len() + PAD_BYTES, 0);
    }
    Ok(streams)
}
