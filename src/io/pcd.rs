//! PCD of the Point Cloud Library, versions 0.5 to 0.7: ascii, binary, and binary compressed with LZF, column by
//! column.
//!
//! The header is read by `pcd-rs`, blocks are decompressed by `lzf`.

use super::attributes;
use super::column::{Column, Scalar, Values};
use super::error::{Fault, Place};
use super::fixed_rows::{self, FixedRows};
use super::format::{Format, Traits};
use super::growing;
use super::numbers::{Tokens, line_endings, note_row, quoted};
use crate::cloud::{AxisConvention, ImageGrid, RawCloud};
use crate::progress::Progress;
use glam::DVec3;
use pcd_rs::{DataKind, PcdMeta, ValueKind};

/// Longer headers are not believed to be headers.
const MAX_HEADER_BYTES: usize = 1 << 20;

/// LZF stores at most 264 bytes in three.
const MAX_LZF_RATIO: usize = 88;

/// The crate counts the bytes of a block in an i32.
const MAX_LZF_BYTES: usize = i32::MAX as usize;

/// Point Cloud Library: ascii, binary, compressed.
pub(super) const FORMAT: Format = Format::new(&Traits {
    name: "PCD",
    extensions: &["pcd"],
    looks_like: Some(|_, bytes| begins_like_pcd(bytes)),
    convention: Some(AxisConvention::UsuallyZUp),
    ..Traits::PLAIN
});

/// The first line that is no comment begins with VERSION, or with FIELDS as some writers leave VERSION out.
fn begins_like_pcd(bytes: &[u8]) -> bool {
    bytes[..bytes.len().min(Format::MAGIC_BYTES)]
        .split(|&byte| byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"))
        .is_some_and(|line| line.starts_with(b"VERSION ") || line.starts_with(b"FIELDS "))
}

pub(super) fn decode(bytes: &[u8], progress: &Progress) -> Result<RawCloud, Fault> {
    let (header, payload_start) = parse_header(bytes)?;
    let table = Table::new(&header)?;
    let payload = (&bytes[..payload_start], &bytes[payload_start..]);
    let mut cloud = table.with_columns(header.data, payload, progress, growing::cloud)?;
    cloud.sensor = sensor(&header);
    cloud.grid = grid(&header);
    Ok(cloud)
}

/// The normals in a file that may have no points.
pub(super) fn normals(bytes: &[u8], progress: &Progress) -> Result<Vec<[f32; 3]>, Fault> {
    let (header, payload_start) = parse_header(bytes)?;
    let payload = (&bytes[..payload_start], &bytes[payload_start..]);
    Table::new(&header)?.with_columns(header.data, payload, progress, attributes::normals)
}

/// Names of what each point has in a file that begins with `head`.
pub(super) fn point_names(head: &[u8]) -> Option<Vec<String>> {
    let (header, _) = parse_header(head).ok()?;
    let fields = header.field_defs.fields.into_iter();
    Some(fields.map(|field| field.name).collect())
}

/// Where the points are in a file that begins with `head`, if they can be read without the whole of it.
pub(super) fn fixed_rows(head: &[u8]) -> Option<FixedRows> {
    let (header, start) = parse_header(head).ok()?;
    // The last line of a header that is as long as `head` may be cut off.
    let is_binary = header.data == DataKind::Binary && start < head.len();
    let rows = Table::new(&header).ok().filter(|_| is_binary)?.rows(start);
    Some(FixedRows {
        sensor: sensor(&header),
        convention: FORMAT.convention(),
        grid: grid(&header),
        ..rows
    })
}

/// What the header says, and the number of bytes that it takes.
fn parse_header(bytes: &[u8]) -> Result<(PcdMeta, usize), Fault> {
    let (text, byte_size) = header_text(bytes)?;
    let header = PcdMeta::from_reader(text.as_slice())
        .map_err(|error| Fault::header(format!("the header is not understood ({error})")))?;
    Ok((header, byte_size))
}

/// The lines up to `DATA` as the crate's reader wants them, and the number of bytes that they take in the file.
///
/// Comments may hold what is no text, and every version that was ever written is read like the last: what changed
/// between them is what may be left out.
fn header_text(bytes: &[u8]) -> Result<(Vec<u8>, usize), Fault> {
    let mut text = b"VERSION 0.7\n".to_vec();
    let mut end = 0;
    for line in bytes[..bytes.len().min(MAX_HEADER_BYTES)].split_inclusive(|&byte| byte == b'\n') {
        end += line.len();
        let content = line.trim_ascii();
        if !content.starts_with(b"VERSION") && !content.starts_with(b"#") {
            text.extend(content.iter().map(|&byte| if byte.is_ascii() { byte } else { b'?' }));
            text.push(b'\n');
        }
        if content.len() >= 4 && content[..4].eq_ignore_ascii_case(b"DATA") {
            return Ok((text, end));
        }
    }
    Err(Fault::header(
        "there is no line `DATA`: the header is incomplete, or this is no PCD file",
    ))
}

struct PcdField {
    name: String,
    scalar: Scalar,
    count: usize,
}

/// The points as the header describes them.
struct Table {
    fields: Vec<PcdField>,
    row_bytes: usize,
    rows: usize,
}

impl Table {
    fn new(header: &PcdMeta) -> Result<Self, Fault> {
        let claim = || {
            Fault::header(format!(
                "{} points of this size are more than can be",
                header.num_points
            ))
        };
        let mut fields = Vec::new();
        let mut row_bytes = 0usize;
        for field in &header.field_defs.fields {
            let scalar = match field.kind {
                ValueKind::U8 => Scalar::U8,
                ValueKind::U16 => Scalar::U16,
                ValueKind::U32 => Scalar::U32,
                ValueKind::U64 => Scalar::U64,
                ValueKind::I8 => Scalar::I8,
                ValueKind::I16 => Scalar::I16,
                ValueKind::I32 => Scalar::I32,
                ValueKind::I64 => Scalar::I64,
                ValueKind::F32 => Scalar::F32,
                ValueKind::F64 => Scalar::F64,
            };
            let count = usize::try_from(field.count).map_err(|_| claim())?;
            let bytes = count.checked_mul(scalar.byte_size()).ok_or_else(claim)?;
            row_bytes = row_bytes.checked_add(bytes).ok_or_else(claim)?;
            fields.push(PcdField {
                name: field.name.clone(),
                scalar,
                count,
            });
        }
        Ok(Self {
            fields,
            row_bytes,
            rows: usize::try_from(header.num_points).map_err(|_| claim())?,
        })
    }

    /// Fails when `available` bytes cannot hold the points that the header claims.
    fn check_claim(&self, row_bytes: usize, available: usize) -> Result<usize, Fault> {
        self.rows
            .checked_mul(row_bytes)
            .filter(|&needed| needed <= available)
            .ok_or_else(|| {
                Fault::entry(
                    "point",
                    available.checked_div(row_bytes).unwrap_or(0),
                    format!(
                        "the file ends here, but its header claims {} points of at least {row_bytes} bytes: it is \
                     truncated, or its header is wrong",
                        self.rows
                    ),
                )
            })
    }

    /// The fields but for padding, and the bytes before each in a row. Of fields with several numbers (descriptors) it
    /// is the first.
    fn fields(&self) -> impl Iterator<Item = (&PcdField, usize)> {
        let mut end = 0;
        let placed = self.fields.iter().map(move |field| {
            let offset = end;
            end += field.count * field.scalar.byte_size();
            (field, offset)
        });
        placed.filter(|(field, _)| field.name != "_")
    }

    fn columns<'a>(&self, values: impl Fn(usize, &PcdField) -> Values<'a>) -> Vec<Column<'a>> {
        let column = |(field, offset): (&PcdField, usize)| Column {
            name: field.name.clone(),
            scalar: field.scalar,
            values: values(offset, field),
        };
        self.fields().map(column).collect()
    }

    /// Point after point, behind `start` bytes.
    fn rows(&self, start: usize) -> FixedRows {
        let field = |(field, offset): (&PcdField, usize)| fixed_rows::RowField {
            name: field.name.clone(),
            scalar: field.scalar,
            offset,
        };
        FixedRows {
            start,
            row_bytes: self.row_bytes,
            count: self.rows,
            big_endian: false,
            fields: self.fields().map(field).collect(),
            sensor: None,
            convention: FORMAT.convention(),
            grid: None,
        }
    }

    /// Field after field, as the compressed encoding stores them.
    fn blocks<'a>(&self, bytes: &'a [u8]) -> Vec<Column<'a>> {
        self.columns(|offset, field| Values::Packed {
            bytes,
            start: offset * self.rows,
            step: field.count * field.scalar.byte_size(),
            big_endian: false,
        })
    }

    fn decompress(&self, payload: &[u8], payload_start: usize) -> Result<Vec<u8>, Fault> {
        /// Two u32: the sizes of the block before and after it is unpacked.
        const SIZES_BYTES: usize = 8;
        let fault = |problem: String| Fault::new(Place::Byte(payload_start), problem);
        if self.rows == 0 {
            return Ok(Vec::new());
        }
        let Some((sizes, rest)) = payload.split_at_checked(SIZES_BYTES) else {
            return Err(fault(
                "the file ends before the sizes of the compressed block: it is truncated".to_owned(),
            ));
        };
        let size = |at: usize| u32::from_le_bytes([sizes[at], sizes[at + 1], sizes[at + 2], sizes[at + 3]]) as usize;
        let (packed, unpacked) = (size(0), size(4));
        let Some(packed_bytes) = rest.get(..packed) else {
            return Err(fault(format!(
                "the compressed block should have {packed} bytes but {} are left: the file is truncated",
                rest.len()
            )));
        };
        let needed = self.check_claim(self.row_bytes, unpacked)?;
        if unpacked > packed.saturating_mul(MAX_LZF_RATIO).min(MAX_LZF_BYTES) {
            return Err(fault(format!("{packed} bytes cannot unpack to the claimed {unpacked}")));
        }
        let block = match lzf::decompress(packed_bytes, unpacked) {
            Ok(block) => block,
            // A block that was not worth compressing may be stored as it is.
            Err(_) if packed == unpacked => packed_bytes.to_vec(),
            Err(error) => return Err(fault(format!("the compressed block is damaged ({error})"))),
        };
        if block.len() < needed {
            return Err(fault(format!(
                "the block unpacks to {} bytes, expected {needed}",
                block.len()
            )));
        }
        Ok(block)
    }

    fn ascii(&self, payload: &[u8], first_line: usize, progress: &Progress) -> Result<Vec<Column<'static>>, Fault> {
        /// A digit and a separator.
        const LEAST_NUMBER_BYTES: usize = 2;
        let row_numbers = self
            .fields
            .iter()
            .fold(0usize, |sum, field| sum.saturating_add(field.count));
        self.check_claim(row_numbers.saturating_mul(LEAST_NUMBER_BYTES), payload.len() + 1)?;
        let mut columns = self.columns(|_, _| Values::Parsed(Vec::with_capacity(self.rows)));
        let mut tokens = Tokens::new(payload, first_line);
        for row in 0..self.rows {
            note_row(row, self.rows, progress)?;
            let mut column = columns.iter_mut();
            for field in &self.fields {
                let mut first = f64::NAN;
                for number in 0..field.count {
                    let value = tokens.next_number().ok_or_else(|| {
                        Fault::entry(
                            "point",
                            row,
                            format!("the file ends before field `{}`: it is truncated", field.name),
                        )
                    })?;
                    let value = value.map_err(|token| {
                        Fault::new(
                            Place::Line(tokens.line()),
                            format!("field `{}` is {}, expected a number", field.name, quoted(token)),
                        )
                    })?;
                    if number == 0 {
                        first = value;
                    }
                }
                if field.name != "_"
                    && let Some(Column {
                        values: Values::Parsed(values),
                        ..
                    }) = column.next()
                {
                    values.push(first);
                }
            }
            // A point is a line: what follows its last field is of no field.
            tokens.skip_line();
        }
        note_row(self.rows, self.rows, progress)?;
        Ok(columns)
    }

    /// What `make` makes of the columns and the number of rows behind the header, encoded as `kind`.
    fn with_columns<T>(
        &self,
        kind: DataKind,
        (header, payload): (&[u8], &[u8]),
        progress: &Progress,
        make: impl FnOnce(&[Column<'_>], usize) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        match kind {
            DataKind::Ascii => {
                let first_line = line_endings(header) + 1;
                make(&self.ascii(payload, first_line, progress)?, self.rows)
            }
            DataKind::Binary => {
                self.check_claim(self.row_bytes, payload.len())?;
                make(&self.rows(0).columns(payload), self.rows)
            }
            DataKind::BinaryCompressed => {
                let block = self.decompress(payload, header.len())?;
                make(&self.blocks(&block), self.rows)
            }
        }
    }
}

/// The lines of the points of an organised cloud.
fn grid(header: &PcdMeta) -> Option<ImageGrid> {
    let side = |points: u64| u32::try_from(points).ok();
    let point_count = usize::try_from(header.num_points).ok()?;
    ImageGrid::of(side(header.width)?, side(header.height)?, point_count)
}

/// Most writers leave the viewpoint at the origin, which says nothing, unless the points still lie in the grid of the
/// camera that took them.
fn sensor(header: &PcdMeta) -> Option<DVec3> {
    let viewpoint = &header.viewpoint;
    let position = DVec3::new(viewpoint.tx, viewpoint.ty, viewpoint.tz);
    let is_organised = header.height > 1;
    (position.is_finite() && (position != DVec3::ZERO || is_organised)).then_some(position)
}
