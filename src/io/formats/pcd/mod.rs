//! PCD of the Point Cloud Library, versions 0.5 to 0.7: ascii, binary, and binary compressed with LZF, column by
//! column.
//!
//! Blocks are decompressed by `lzf-rust`.

mod header;

use crate::cloud::{AxisConvention, Dropped, ImageGrid, RawCloud};
use crate::io::columns::column::{Column, Scalar, Values};
use crate::io::columns::fixed_rows::{self, FixedRows};
use crate::io::columns::numbers::{Tokens, line_endings, note_row, quoted, with_decimal_points};
use crate::io::columns::{attributes, growing};
use crate::io::error::{Fault, Place};
use crate::io::format::{Format, Traits};
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use crate::raster::unpack_lzf;
use glam::DVec3;
use header::{Encoding, Header, PcdField};

/// LZF stores at most 264 bytes in three.
const MAX_LZF_RATIO: usize = 88;

/// The crate counts the bytes of a block in an i32.
const MAX_LZF_BYTES: usize = i32::MAX as usize;

/// A file with more lines that are not points is damaged.
const MAX_ODD_ROWS: usize = 16;

/// Point Cloud Library: ascii, binary, compressed.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "PCD",
    extensions: &["pcd"],
    looks_like: Some(|_, bytes| begins_like_pcd(bytes)),
    convention: Some(AxisConvention::UsuallyZUp),
    ..Traits::PLAIN
});

/// The first line that is not a comment begins with VERSION, or with FIELDS as some writers omit VERSION.
fn begins_like_pcd(bytes: &[u8]) -> bool {
    bytes[..bytes.len().min(Format::MAGIC_BYTES)]
        .split(|&byte| byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"))
        .is_some_and(|line| line.starts_with(b"VERSION ") || line.starts_with(b"FIELDS "))
}

pub(in crate::io) fn decode(bytes: &[u8], options: &ReadOptions, progress: &Progress) -> Result<RawCloud, Fault> {
    let header = Header::parse(bytes)?;
    let (head, payload) = bytes.split_at(header.byte_size);
    let table = Table::new(&header, payload)?;
    let mut warnings = Vec::new();
    let mut cloud = table.with_columns(
        header.encoding,
        head,
        payload,
        options,
        progress,
        |columns, rows, odd, options| {
            warnings = odd;
            growing::cloud(columns, rows, options)
        },
    )?;
    cloud.sensor = sensor(&header);
    cloud.grid = grid(&header);
    let rotation = dropped(&header);
    cloud.warnings.extend(header.warnings);
    cloud.dropped.extend(rotation);
    cloud.warnings.extend(warnings);
    Ok(cloud)
}

/// The rotation of the viewpoint, if there is one.
fn dropped(header: &Header) -> Option<Dropped> {
    header.rotation.map(|[w, x, y, z]| {
        Dropped::noted(format!(
            "the rotation of VIEWPOINT ({w} {x} {y} {z}) is not read: points are where the file has them"
        ))
    })
}

/// The normals in a file that may have no points.
pub(in crate::io) fn normals(bytes: &[u8], options: &ReadOptions, progress: &Progress) -> Result<Vec<[f32; 3]>, Fault> {
    let header = Header::parse(bytes)?;
    let (head, payload) = bytes.split_at(header.byte_size);
    let table = Table::new(&header, payload)?;
    table.with_columns(
        header.encoding,
        head,
        payload,
        options,
        progress,
        |columns, rows, _, _| attributes::normals(columns, rows),
    )
}

/// Names of the point attributes in a file that begins with `head`.
pub(in crate::io) fn point_names(head: &[u8]) -> Option<Vec<String>> {
    let header = Header::parse(head).ok()?;
    let fields = header.fields.into_iter();
    Some(fields.map(|field| field.name).collect())
}

/// Returns the layout of the point rows in a file that begins with `head`, if they can be read without the whole of it.
/// Warnings about the header are reported when whole files are read.
pub(in crate::io) fn fixed_rows(head: &[u8]) -> Option<FixedRows> {
    let header = Header::parse(head).ok()?;
    // If a header is as long as `head`, its last line may be truncated.
    let is_plain = header.encoding == Encoding::Binary
        && header.byte_size < head.len()
        && header.warnings.is_empty()
        && !header.has_empty_fields();
    let rows = Table::new(&header, &[]).ok().filter(|_| is_plain)?;
    Some(FixedRows {
        sensor: sensor(&header),
        convention: FORMAT.convention(),
        grid: grid(&header),
        dropped: dropped(&header).into_iter().collect(),
        ..rows.rows(header.byte_size)
    })
}

/// The points as the header describes them.
struct Table {
    fields: Vec<PcdField>,
    row_bytes: usize,
    rows: usize,
}

/// A number of each point.
struct Number {
    name: String,
    scalar: Scalar,
    /// Bytes before it in a row.
    offset: usize,
    /// Bytes before its field in a row, and bytes of the field.
    field_offset: usize,
    field_bytes: usize,
}

impl Table {
    /// Fields that have no numbers by the header take no bytes in `payload`, unless there is space for one of each: old
    /// converters counted none where they wrote one.
    fn new(header: &Header, payload: &[u8]) -> Result<Self, Fault> {
        let as_written = Self::of(header, header.fields.clone())?;
        if !header.has_empty_fields() || as_written.rows == 0 {
            return Ok(as_written);
        }
        let mut fields = header.fields.clone();
        for field in fields.iter_mut().filter(|field| field.count == 0) {
            field.count = 1;
        }
        let with_one = Self::of(header, fields)?;
        let has_space = match header.encoding {
            Encoding::Ascii => with_one.is_line(payload),
            Encoding::Binary => with_one.fits(payload.len()),
            Encoding::BinaryCompressed => unpacked_bytes(payload).is_some_and(|bytes| with_one.fits(bytes)),
        };
        Ok(if has_space { with_one } else { as_written })
    }

    fn of(header: &Header, fields: Vec<PcdField>) -> Result<Self, Fault> {
        let claim = || Fault::header(format!("{} points of this size are more than can be", header.points));
        let row_bytes = fields
            .iter()
            .try_fold(0usize, |sum, field| sum.checked_add(field.bytes()?))
            .ok_or_else(claim)?;
        Ok(Self {
            fields,
            row_bytes,
            rows: usize::try_from(header.points).map_err(|_| claim())?,
        })
    }

    fn fits(&self, bytes: usize) -> bool {
        self.rows
            .checked_mul(self.row_bytes)
            .is_some_and(|needed| needed <= bytes)
    }

    /// Returns true if the first line of text has a word for every number.
    fn is_line(&self, payload: &[u8]) -> bool {
        let lines = payload.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
        let first = lines.into_iter().find(|line| !line.is_empty()).unwrap_or_default();
        let words = first.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        words.count() >= self.row_numbers()
    }

    /// Numbers of a row, padding counted.
    fn row_numbers(&self) -> usize {
        let counts = self.fields.iter().map(|field| field.count);
        counts.fold(0usize, usize::saturating_add)
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

    /// The numbers of a row but for padding: with separate entries for fields with several.
    fn numbers(&self) -> Vec<Number> {
        let mut numbers = Vec::new();
        let mut field_offset = 0;
        for field in &self.fields {
            let field_bytes = field.number_bytes * field.count;
            for (place, scalar) in (0..field.count).zip(std::iter::repeat(field.scalar)) {
                let Some(scalar) = scalar else { break };
                numbers.push(Number {
                    name: field.number_name(place),
                    scalar,
                    offset: field_offset + place * field.number_bytes,
                    field_offset,
                    field_bytes,
                });
            }
            field_offset += field_bytes;
        }
        numbers
    }

    /// Point after point, behind `start` bytes.
    fn rows(&self, start: usize) -> FixedRows {
        let field = |number: Number| fixed_rows::RowField {
            name: number.name,
            scalar: number.scalar,
            offset: number.offset,
        };
        FixedRows {
            start,
            row_bytes: self.row_bytes,
            count: self.rows,
            big_endian: false,
            fields: self.numbers().into_iter().map(field).collect(),
            is_all: false,
            sensor: None,
            convention: FORMAT.convention(),
            grid: None,
            dropped: Vec::new(),
        }
    }

    /// Field after field, as the compressed encoding stores them.
    fn blocks<'a>(&self, bytes: &'a [u8]) -> Vec<Column<'a>> {
        let column = |number: Number| Column {
            name: number.name,
            scalar: number.scalar,
            values: Values::Packed {
                bytes,
                start: number.field_offset * self.rows + (number.offset - number.field_offset),
                step: number.field_bytes,
                big_endian: false,
            },
        };
        self.numbers().into_iter().map(column).collect()
    }

    fn decompress(&self, payload: &[u8], payload_start: usize, options: &ReadOptions) -> Result<Vec<u8>, Fault> {
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
        // `lzf-rust` checks its bounds; the claimed size is checked here, before memory is allocated for it.
        if unpacked > packed.saturating_mul(MAX_LZF_RATIO).min(MAX_LZF_BYTES) {
            return Err(fault(format!("{packed} bytes cannot unpack to the claimed {unpacked}")));
        }
        options.claim("the unpacked points", unpacked as u64)?;
        let block = match unpack_lzf(packed_bytes, unpacked) {
            Ok(block) => block,
            // A block that was not worth compressing may be stored uncompressed.
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

    /// The columns of points as text, and its oddities. A line that is not a point is a missing one, or is skipped
    /// where the others match the count in the header.
    fn ascii(
        &self,
        payload: &[u8],
        first_line: usize,
        options: &ReadOptions,
        progress: &Progress,
    ) -> Result<(Vec<Column<'static>>, Vec<String>), Fault> {
        /// A digit and a separator.
        const MIN_NUMBER_BYTES: usize = 2;
        self.check_claim(self.row_numbers().saturating_mul(MIN_NUMBER_BYTES), payload.len() + 1)?;
        let what = format!("the numbers of {} points", self.rows);
        options.claim_entries(&what, self.rows, self.row_numbers().saturating_mul(size_of::<f64>()))?;
        let column = |number: Number| Column {
            name: number.name,
            scalar: number.scalar,
            values: Values::Parsed(Vec::with_capacity(self.rows)),
        };
        let mut columns: Vec<Column<'static>> = self.numbers().into_iter().map(column).collect();
        let mut warnings = Vec::new();
        let decimal = with_decimal_points(payload, self.row_numbers(), self.rows);
        if decimal.is_some() {
            warnings.push("numbers have decimal commas: they are read as decimal points".to_owned());
        }
        let mut tokens = Tokens::new(decimal.as_deref().unwrap_or(payload), first_line);
        let mut odd_rows = 0;
        let mut row = 0;
        while row < self.rows {
            note_row(row, self.rows, progress)?;
            if let Err(fault) = self.ascii_row(row, &mut tokens, &mut columns) {
                let Place::Line(line) = fault.place else {
                    return Err(fault);
                };
                odd_rows += 1;
                let needed = self.rows - row - 1;
                let lines = tokens.lines_behind();
                let are_too_many = odd_rows > MAX_ODD_ROWS.min(self.rows - 1);
                if are_too_many || !(needed..=needed + 1).contains(&lines) {
                    return Err(fault);
                }
                let is_extra = lines > needed;
                row += usize::from(!is_extra);
                for column in &mut columns {
                    if let Values::Parsed(values) = &mut column.values {
                        values.resize(row, f64::NAN);
                    }
                }
                let what = if is_extra {
                    "this line is skipped"
                } else {
                    "this point is missing"
                };
                warnings.push(format!("line {line}: {}: {what}", fault.problem));
            } else {
                row += 1;
            }
            // A point is a line: anything after its last field belongs to no field.
            tokens.skip_line();
        }
        note_row(self.rows, self.rows, progress)?;
        Ok((columns, warnings))
    }

    /// Adds the numbers of point `row` to `columns`.
    fn ascii_row(&self, row: usize, tokens: &mut Tokens<'_>, columns: &mut [Column<'static>]) -> Result<(), Fault> {
        let mut column = columns.iter_mut();
        for field in &self.fields {
            for _ in 0..field.count {
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
                if field.scalar.is_some()
                    && let Some(Column {
                        values: Values::Parsed(values),
                        ..
                    }) = column.next()
                {
                    values.push(value);
                }
            }
        }
        Ok(())
    }

    /// Returns the result of `make` for the columns, the number of rows and the oddities after the header, in this
    /// encoding.
    fn with_columns<T>(
        &self,
        encoding: Encoding,
        header: &[u8],
        payload: &[u8],
        options: &ReadOptions,
        progress: &Progress,
        make: impl FnOnce(&[Column<'_>], usize, Vec<String>, &ReadOptions) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        match encoding {
            Encoding::Ascii => {
                let first_line = line_endings(header) + 1;
                let (columns, odd) = self.ascii(payload, first_line, options, progress)?;
                make(&columns, self.rows, odd, options)
            }
            Encoding::Binary => {
                self.check_claim(self.row_bytes, payload.len())?;
                make(&self.rows(0).columns(payload), self.rows, Vec::new(), options)
            }
            Encoding::BinaryCompressed => {
                let block = self.decompress(payload, header.len(), options)?;
                let options = options.holding(block.len());
                make(&self.blocks(&block), self.rows, Vec::new(), &options)
            }
        }
    }
}

/// Two u32: the sizes of the compressed block before and after it is unpacked.
const SIZES_BYTES: usize = 8;

/// Bytes that the compressed block in `payload` is said to unpack to.
fn unpacked_bytes(payload: &[u8]) -> Option<usize> {
    let bytes = payload.get(4..SIZES_BYTES)?;
    Some(u32::from_le_bytes(bytes.try_into().ok()?) as usize)
}

/// The lines of the points of an organised cloud.
fn grid(header: &Header) -> Option<ImageGrid> {
    let side = |points: u64| u32::try_from(points).ok();
    let point_count = usize::try_from(header.points).ok()?;
    ImageGrid::of(side(header.width)?, side(header.height)?, point_count)
}

/// Most writers leave the viewpoint at the origin, which is not informative unless the points still lie in the grid of
/// the camera that took them.
fn sensor(header: &Header) -> Option<DVec3> {
    let position = header.viewpoint;
    let is_organised = header.height > 1;
    (position.is_finite() && (position != DVec3::ZERO || is_organised)).then_some(position)
}
