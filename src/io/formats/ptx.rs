//! PTX files of Leica: text with several scans, each a grid of points as the scanner saw them, with the pose of the
//! scanner.
//!
//! A scan is ten lines of header (columns, rows, position, three axes, four rows of a matrix), followed by one line per
//! point: `x y z intensity`, and in some files red, green and blue. A row vector times the matrix is the point in the
//! coordinates that all scans share; the position and the axes repeat the same pose. Beams without a return are stored
//! at the scanner: they are retained, as in other readers.

use super::xyz::rows::{self, Kind};
use super::xyz::{self, Dialect};
use crate::cloud::{AxisConvention, ImageGrid, LengthUnit, Positions, RawCloud};
use crate::io::columns::column::{Column, Scalar, Values};
use crate::io::columns::growing;
use crate::io::error::{Fault, Place};
use crate::io::format::{Format, Traits};
use crate::io::options::ReadOptions;
use crate::progress::Progress;
use glam::{DMat4, DVec3, DVec4};

/// Leica PTX: text of scans with poses, in metres. It is known under the names of other text, too.
pub(in crate::io) const FORMAT: Format = Format::new(&Traits {
    name: "PTX",
    extensions: &["ptx"],
    looks_like: Some(|name, bytes| xyz::FORMAT.has_extension_of(name) && is_ptx(bytes)),
    convention: Some(AxisConvention::UsuallyZUp),
    unit: Some(LengthUnit::Metre),
    ..Traits::PLAIN
});

/// Numbers in the lines of a header.
const HEADER_WIDTHS: [usize; 10] = [1, 1, 3, 3, 3, 3, 4, 4, 4, 4];
/// The first line of the matrix.
const MATRIX_LINE: usize = 6;
/// Names of columns, and their types in the file.
const NAMES: [(&str, Scalar); 7] = [
    ("x", Scalar::F64),
    ("y", Scalar::F64),
    ("z", Scalar::F64),
    ("intensity", Scalar::F64),
    ("red", Scalar::U8),
    ("green", Scalar::U8),
    ("blue", Scalar::U8),
];
/// Coordinates, and with them intensity and colour.
const WIDTHS: [usize; 3] = [3, 4, MAX_WIDTH];
const MAX_WIDTH: usize = NAMES.len();
const DIALECT: Dialect = Dialect::MIXED;

/// True when the first lines are a header: no other text has numbers in lines of one, three and four like it.
pub(super) fn is_ptx(start: &[u8]) -> bool {
    Lines::new(start).header().is_ok()
}

pub(in crate::io) fn decode(bytes: &[u8], options: &ReadOptions, progress: &Progress) -> Result<RawCloud, Fault> {
    progress.set(0, bytes.len());
    let mut lines = Lines::new(bytes);
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut sensors = Vec::new();
    let mut grid = None;
    while sensors.is_empty() || !lines.is_at_end() {
        let ([scan_columns, scan_rows], matrix) = lines.header()?;
        let count = (scan_columns * scan_rows) as usize;
        let first_line = lines.number;
        let text = lines.take(count).ok_or_else(|| {
            Fault::new(
                Place::Line(lines.number),
                format!("the file ends here, but the scan before it has {count} points: it is truncated"),
            )
        })?;
        let width = match width(text) {
            Some(width) if WIDTHS.contains(&width) => width,
            None if count == 0 => WIDTHS[0],
            _ => {
                return Err(Fault::new(
                    Place::Line(first_line),
                    "expected x y z intensity, and red green blue or nothing behind them",
                ));
            }
        };
        let kinds = [Kind::Required; MAX_WIDTH];
        let so_far = columns.iter().map(|values| size_of_val(values.as_slice())).sum();
        let left = options.holding(so_far);
        let mut rows = rows::parse(text, first_line, &kinds[..width], DIALECT, &left, progress)?;
        if let Some(fault) = rows.odd_lines.fault() {
            return Err(fault);
        }
        if rows.len() != count {
            let line = rows.lones.first().map_or(first_line, |lone| lone.line);
            return Err(Fault::new(
                Place::Line(line),
                format!("found a line of one number among {count} points, expected {width} numbers"),
            ));
        }
        for index in 0..count {
            let [x, y, z] = [0, 1, 2].map(|axis| rows.columns[axis][index]);
            let point = matrix.transform_point3(DVec3::new(x, y, z));
            for axis in 0..3 {
                rows.columns[axis][index] = point[axis];
            }
        }
        // Attributes that only some of the scans have are skipped.
        if sensors.is_empty() {
            columns = rows.columns;
        } else {
            columns.truncate(width);
            for (all, more) in columns.iter_mut().zip(rows.columns) {
                all.extend(more);
            }
        }
        sensors.push(matrix.w_axis.truncate());
        // A column of the scanner is a line of the file.
        grid = ImageGrid::of(scan_rows as u32, scan_columns as u32, count);
    }
    let count = columns.first().map_or(0, Vec::len);
    if count == 0 {
        return Ok(RawCloud::from_positions(Positions::F64(Vec::new())));
    }
    let columns: Vec<Column<'_>> = NAMES
        .iter()
        .zip(columns)
        .map(|(&(name, scalar), values)| Column {
            name: name.to_owned(),
            scalar,
            values: Values::Parsed(values),
        })
        .collect();
    let mut cloud = growing::cloud(&columns, count, options)?;
    // Several scans were taken from several positions, and are several images.
    if let [sensor] = sensors.as_slice() {
        cloud.sensor = sensor.is_finite().then_some(*sensor);
        cloud.grid = grid;
    }
    Ok(cloud)
}

/// Numbers in the first line of `text` that has any.
fn width(text: &[u8]) -> Option<usize> {
    let lines = text.split(|&byte| byte == b'\n');
    let mut counts = lines
        .filter_map(|line| rows::numbers_in(line, DIALECT))
        .map(|numbers| numbers.len());
    counts.find(|&found| found > 0)
}

/// Lines that are not empty, one after the other.
struct Lines<'a> {
    rest: &'a [u8],
    /// Line number of the next line, counted from 1.
    number: usize,
}

impl<'a> Lines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
            number: 1,
        }
    }

    fn is_at_end(&self) -> bool {
        self.rest.trim_ascii().is_empty()
    }

    /// The next line, empty or not.
    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|&byte| byte == b'\n');
        let (line, rest) = self.rest.split_at(end.map_or(self.rest.len(), |end| end + 1));
        self.rest = rest;
        self.number += 1;
        Some(line.trim_ascii())
    }

    /// The text of the next `count` lines that are not empty.
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        /// Three digits, two spaces and the end of the line.
        const MIN_LINE_BYTES: usize = 6;
        let text = self.rest;
        if count.checked_mul(MIN_LINE_BYTES)? > text.len() + 1 {
            return None;
        }
        let mut found = 0;
        while found < count {
            found += usize::from(!self.next()?.is_empty());
        }
        Some(&text[..text.len() - self.rest.len()])
    }

    /// Columns and rows, and pose of the next scan.
    fn header(&mut self) -> Result<([f64; 2], DMat4), Fault> {
        let mut matrix = [DVec4::ZERO; 4];
        let mut sides = [0.0; 2];
        for (index, expected) in HEADER_WIDTHS.into_iter().enumerate() {
            let line = loop {
                match self.next() {
                    Some([]) => {}
                    Some(line) => break line,
                    None => {
                        return Err(Fault::new(
                            Place::Line(self.number),
                            "the file ends within the ten lines before a scan: it is truncated",
                        ));
                    }
                }
            };
            let fault = |problem: String| Err(Fault::new(Place::Line(self.number - 1), problem));
            let numbers = rows::numbers_in(line, DIALECT).unwrap_or_default();
            let found = numbers.len();
            if found != expected {
                return fault(format!(
                    "found {found} numbers in line {} of the header of a scan, expected {expected}",
                    index + 1
                ));
            }
            if expected == 1 {
                if numbers[0] < 0.0 || numbers[0].fract() != 0.0 {
                    return fault(format!("found {} as a number of columns or rows", numbers[0]));
                }
                sides[index] = numbers[0];
            }
            if index >= MATRIX_LINE {
                // A row of a matrix for row vectors is a column of one for column vectors.
                matrix[index - MATRIX_LINE] = DVec4::from_slice(&numbers);
            }
        }
        let [x, y, z, w] = matrix;
        Ok((sides, DMat4::from_cols(x, y, z, w)))
    }
}
