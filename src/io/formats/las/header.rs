//! The header of a LAS file, and the records after it with more about the points.
//!
//! Only the parts needed to find and read the points are parsed. Counts of records are claims: they are followed as far
//! as the bytes go. The bounding box is not used, as writers get it wrong.

use crate::io::error::Fault;

/// Bytes of the smallest header, of version 1.0.
const MIN_HEADER_BYTES: usize = 227;

/// Bytes of the header of version 1.4, which has wider counts.
const HEADER_1_4_BYTES: usize = 375;

/// Bytes of a point of each format without extra bytes.
const POINT_BYTES: [usize; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];

/// Parsed LAS header.
#[derive(Debug, Clone)]
pub(super) struct LasHeader {
    /// Point format, 0 to 10.
    pub(super) format: u8,
    /// True when the points are compressed (LAZ).
    pub(super) compressed: bool,
    /// Bytes of a point, with extra bytes.
    pub(super) point_bytes: usize,
    /// Points that the file claims.
    pub(super) count: u64,
    /// Byte offset of the points.
    pub(super) points_start: usize,
    pub(super) scale: [f64; 3],
    pub(super) offset: [f64; 3],
    /// Byte offset of the variable length records after the header, and their number according to it.
    records: (usize, u32),
    /// Byte offset and number of the records after the points.
    late_records: (u64, u32),
}

/// A variable-length record.
#[derive(Debug, Clone, Copy)]
pub(super) struct Record<'a> {
    pub(super) user: &'a [u8],
    pub(super) id: u16,
    pub(super) data: &'a [u8],
}

impl Record<'_> {
    pub(super) fn is(&self, user: &[u8], id: u16) -> bool {
        self.user == user && self.id == id
    }
}

/// The `N` bytes at `at`. Precondition: they exist.
pub(in crate::io) fn take<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut raw = [0; N];
    raw.copy_from_slice(&bytes[at..at + N]);
    raw
}

/// True for the first section of a well log, behind comments.
fn is_well_log(bytes: &[u8]) -> bool {
    const LOOKED_AT_BYTES: usize = 4096;
    let head = &bytes[..bytes.len().min(LOOKED_AT_BYTES)];
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let mut lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with(b"#"));
    first.is_some_and(|line| matches!(line, [b'~', b'V' | b'v', ..]))
}

impl LasHeader {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        if is_well_log(bytes) {
            return Err(Fault::header(
                "this is a well log (Log ASCII Standard of the CWLS), which has the same extension as LiDAR files: it \
                 holds curves along a borehole and is not a point cloud",
            ));
        }
        if bytes.len() < MIN_HEADER_BYTES || !bytes.starts_with(b"LASF") {
            return Err(Fault::header(format!(
                "a LAS file begins with LASF and a header of {MIN_HEADER_BYTES} bytes at least, this one has {} bytes: \
                 it is truncated, or no LAS file",
                bytes.len()
            )));
        }
        let word = |at| usize::from(u16::from_le_bytes(take(bytes, at)));
        let long = |at| u32::from_le_bytes(take(bytes, at));
        let float = |at| f64::from_le_bytes(take(bytes, at));
        let (major, minor) = (bytes[24], bytes[25]);
        if major != 1 {
            return Err(Fault::header(format!(
                "LAS {major}.{minor} is not known: versions 1.0 to 1.4 are read"
            )));
        }
        // The two highest bits mark compressed points.
        let (format, compressed) = (bytes[104] & 0x3f, bytes[104] & 0xc0 != 0);
        let Some(&min_bytes) = POINT_BYTES.get(usize::from(format)) else {
            return Err(Fault::header(format!(
                "point format {format} is not known: 0 to 10 are read"
            )));
        };
        let point_bytes = word(105);
        if point_bytes < min_bytes {
            return Err(Fault::header(format!(
                "points of format {format} take {min_bytes} bytes at least, but the header says {point_bytes}"
            )));
        }
        let (scale, offset) = ([131, 139, 147].map(float), [155, 163, 171].map(float));
        if scale.iter().chain(&offset).any(|number| !number.is_finite()) {
            return Err(Fault::header(format!(
                "scale {scale:?} and offset {offset:?} must be finite numbers"
            )));
        }
        if let Some(axis) = scale.iter().position(|&scale| scale == 0.0) {
            return Err(Fault::header(format!(
                "the scale along {} is 0, so all points would have the same coordinate: expected the step of \
                 coordinates, such as 0.001",
                ["x", "y", "z"][axis]
            )));
        }
        let header_bytes = word(94);
        let is_1_4 = minor >= 4 && header_bytes >= HEADER_1_4_BYTES && bytes.len() >= HEADER_1_4_BYTES;
        let legacy_count = u64::from(long(107));
        let count = if is_1_4 {
            u64::from_le_bytes(take(bytes, 247))
        } else {
            0
        };
        let points_start = long(96) as usize;
        if points_start > bytes.len() {
            return Err(Fault::header(format!(
                "the points begin at byte {points_start}, but the file ends at {}: it is truncated",
                bytes.len()
            )));
        }
        Ok(Self {
            format,
            compressed,
            point_bytes,
            // Some writers of 1.4 fill only the legacy field.
            count: if count == 0 { legacy_count } else { count },
            points_start,
            scale,
            offset,
            records: (header_bytes, long(100)),
            late_records: if is_1_4 {
                (u64::from_le_bytes(take(bytes, 235)), long(243))
            } else {
                (0, 0)
            },
        })
    }

    /// Bytes behind the header and its records that points may be in, which are those before records behind them.
    pub(super) fn point_area<'a>(&self, bytes: &'a [u8]) -> &'a [u8] {
        let end = match self.late_records {
            (start, left) if left > 0 => usize::try_from(start).unwrap_or(usize::MAX).min(bytes.len()),
            _ => bytes.len(),
        };
        bytes.get(self.points_start..end).unwrap_or_default()
    }

    /// Returns the byte offset of the records after the points, if there are any.
    pub(super) fn late_records_start(&self) -> Option<u64> {
        let (start, count) = self.late_records;
        (count > 0).then_some(start)
    }

    /// Returns the header for bytes that have the records after the points at byte offset `start`.
    pub(super) fn with_late_records_at(self, start: usize) -> Self {
        let (_, count) = self.late_records;
        Self {
            late_records: (start as u64, count),
            ..self
        }
    }

    /// Bytes of a point of the format, behind which the extra bytes are.
    pub(super) fn extra_start(&self) -> usize {
        POINT_BYTES[usize::from(self.format)]
    }

    /// The records behind the header, then those behind the points, as far as there are bytes for them.
    pub(super) fn records<'a>(&self, bytes: &'a [u8]) -> impl Iterator<Item = Record<'a>> {
        let early = VariableLengthRecords {
            bytes: &bytes[..self.points_start],
            at: self.records.0,
            left: self.records.1,
            length_bytes: 2,
        };
        let late = VariableLengthRecords {
            bytes,
            at: usize::try_from(self.late_records.0).unwrap_or(usize::MAX),
            left: self.late_records.1,
            length_bytes: 8,
        };
        early.chain(late)
    }
}

struct VariableLengthRecords<'a> {
    bytes: &'a [u8],
    at: usize,
    left: u32,
    /// Two in records before the points, eight in those behind them.
    length_bytes: usize,
}

impl<'a> Iterator for VariableLengthRecords<'a> {
    type Item = Record<'a>;

    fn next(&mut self) -> Option<Record<'a>> {
        const USER: std::ops::Range<usize> = 2..18;
        const LENGTH_START: usize = 20;
        const DESCRIPTION_BYTES: usize = 32;
        self.left = self.left.checked_sub(1)?;
        let header_bytes = LENGTH_START + self.length_bytes + DESCRIPTION_BYTES;
        let data_start = self.at.checked_add(header_bytes)?;
        let header = self.bytes.get(self.at..data_start)?;
        let mut length = [0; 8];
        length[..self.length_bytes].copy_from_slice(&header[LENGTH_START..LENGTH_START + self.length_bytes]);
        let length = usize::try_from(u64::from_le_bytes(length)).ok()?;
        let end = data_start.checked_add(length)?;
        let data = self.bytes.get(data_start..end)?;
        self.at = end;
        let user = &header[USER];
        let end = user.iter().position(|&byte| byte == 0);
        Some(Record {
            user: &user[..end.unwrap_or(user.len())],
            id: u16::from_le_bytes(take(header, USER.end)),
            data,
        })
    }
}
