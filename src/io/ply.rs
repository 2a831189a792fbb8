//! PLY: a header of elements with typed properties, then their rows as text or binary.
//!
//! The header's lines are read by `ply-rs-bw`; of the payload only the columns of the `vertex` element are kept, all else
//! is stepped over without being stored.

use super::attributes;
use super::column::{Column, Scalar, Values};
use super::error::{Fault, Place};
use super::numbers::{Tokens, parse_number, quoted};
use crate::cloud::RawCloud;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, ElementDef, Encoding, PropertyType, ScalarType};

/// Longer headers are not believed to be headers.
const MAX_HEADER_BYTES: usize = 1 << 20;

/// The element whose rows are points.
const POINTS: &str = "vertex";

pub(super) fn decode(bytes: &[u8]) -> Result<RawCloud, Fault> {
    let header = Header::parse(bytes)?;
    let Some(position) = header
        .elements
        .iter()
        .position(|element| element.name == POINTS)
    else {
        return Err(Fault::header(
            "there is no element `vertex`: a point cloud keeps its points there",
        ));
    };
    let (before, after) = header.elements.split_at(position);
    let vertex = &after[0];
    let columns = match header.encoding {
        Encoding::Ascii => ascii_columns(bytes, &header, before, vertex)?,
        Encoding::BinaryLittleEndian | Encoding::BinaryBigEndian => {
            let big_endian = header.encoding == Encoding::BinaryBigEndian;
            let mut rest = Cursor {
                bytes,
                at: header.byte_size,
                big_endian,
            };
            for element in before {
                rest.skip(element)?;
            }
            binary_columns(&mut rest, vertex)?
        }
    };
    attributes::cloud(&columns, vertex.count)
}

struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Bytes up to the payload.
    byte_size: usize,
    /// Lines up to the payload.
    line_count: usize,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

struct Property {
    name: String,
    kind: Kind,
}

#[derive(Clone, Copy)]
enum Kind {
    Scalar(Scalar),
    List { length: Scalar, item: Scalar },
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        if !bytes.starts_with(b"ply") {
            return Err(Fault::new(
                Place::Line(1),
                format!("expected `ply`, found {}", quoted(first_line(bytes))),
            ));
        }
        let (text, byte_size) = header_text(bytes)?;
        let mut reader = Reader::new(text.as_bytes());
        let header = Parser::<DefaultElement>::new()
            .read_header(&mut reader)
            .map_err(|error| {
                let line = error.line().unwrap_or(1);
                let found = text.lines().nth(line.saturating_sub(1)).unwrap_or("");
                Fault::new(
                    Place::Line(line),
                    format!(
                        "the header is not understood: found {}",
                        quoted(found.as_bytes())
                    ),
                )
            })?;
        let elements: Vec<Element> = header
            .elements
            .into_iter()
            .map(|(_, element)| element.into())
            .collect();
        // The parser keeps elements and properties by name, so one of two with the same name would be lost and every
        // row read at a wrong stride.
        let properties: usize = elements
            .iter()
            .map(|element| element.properties.len())
            .sum();
        let lines_of = |keyword: &str| {
            text.lines()
                .filter(|line| line.split_whitespace().next() == Some(keyword))
                .count()
        };
        if lines_of("property") != properties || lines_of("element") != elements.len() {
            return Err(Fault::header(
                "two elements or two properties of an element have the same name",
            ));
        }
        Ok(Self {
            encoding: header.encoding,
            elements,
            byte_size,
            line_count: text.lines().count(),
        })
    }
}

fn first_line(bytes: &[u8]) -> &[u8] {
    bytes
        .split(|&byte| byte == b'\n' || byte == b'\r')
        .next()
        .unwrap_or(bytes)
}

/// The lines up to `end_header`, ended by `\n` and free of what is not ASCII (comments may hold anything), and the
/// number of bytes that they take in the file.
fn header_text(bytes: &[u8]) -> Result<(String, usize), Fault> {
    const LAST_LINE: &[u8] = b"end_header";
    let mut text = String::new();
    let mut at = 0;
    while at < bytes.len().min(MAX_HEADER_BYTES) {
        let rest = &bytes[at..];
        let length = rest
            .iter()
            .position(|&byte| byte == b'\n' || byte == b'\r')
            .unwrap_or(rest.len());
        let ending = if rest[length..].starts_with(b"\r\n") {
            2
        } else {
            1
        };
        let line = rest[..length].trim_ascii_end();
        at += (length + ending).min(rest.len());
        if !line.is_empty() {
            text.extend(line.iter().map(|&byte| {
                if byte.is_ascii() {
                    char::from(byte)
                } else {
                    '?'
                }
            }));
        }
        text.push('\n');
        if line == LAST_LINE {
            return Ok((text, at));
        }
    }
    Err(Fault::header(
        "there is no line `end_header`: the header is incomplete, the file may be truncated",
    ))
}

impl From<ElementDef> for Element {
    fn from(element: ElementDef) -> Self {
        Self {
            name: element.name,
            count: element.count,
            properties: element
                .properties
                .into_iter()
                .map(|(_, property)| Property {
                    name: property.name,
                    kind: match property.data_type {
                        PropertyType::Scalar(scalar) => Kind::Scalar(scalar.into()),
                        PropertyType::List(length, item) => Kind::List {
                            length: length.into(),
                            item: item.into(),
                        },
                    },
                })
                .collect(),
        }
    }
}

impl From<ScalarType> for Scalar {
    fn from(scalar: ScalarType) -> Self {
        match scalar {
            ScalarType::Char => Self::I8,
            ScalarType::UChar => Self::U8,
            ScalarType::Short => Self::I16,
            ScalarType::UShort => Self::U16,
            ScalarType::Int => Self::I32,
            ScalarType::UInt => Self::U32,
            ScalarType::Float => Self::F32,
            ScalarType::Double => Self::F64,
        }
    }
}

impl Element {
    /// Bytes of a row without lists.
    fn fixed_row_bytes(&self) -> Option<usize> {
        self.properties
            .iter()
            .map(|property| match property.kind {
                Kind::Scalar(scalar) => Some(scalar.byte_size()),
                Kind::List { .. } => None,
            })
            .sum()
    }

    /// The least bytes that a binary row takes: empty lists have a length.
    fn least_row_bytes(&self) -> usize {
        self.properties
            .iter()
            .map(|property| match property.kind {
                Kind::Scalar(scalar) => scalar.byte_size(),
                Kind::List { length, .. } => length.byte_size(),
            })
            .sum()
    }

    /// Fails when `available` bytes cannot hold as many rows of `row_bytes` as the header claims.
    fn check_claim(&self, row_bytes: usize, available: usize) -> Result<(), Fault> {
        match self.count.checked_mul(row_bytes) {
            Some(needed) if needed <= available => Ok(()),
            _ => Err(Fault::entry(
                &self.name,
                available.checked_div(row_bytes).unwrap_or(0),
                format!(
                    "the file ends here, but its header claims {} of at least {row_bytes} bytes each: it is truncated, \
                     or its header is wrong",
                    self.count
                ),
            )),
        }
    }
}

/// A place in a binary payload.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Cursor<'a> {
    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at.min(self.bytes.len())..]
    }

    /// Steps over all rows of an element.
    fn skip(&mut self, element: &Element) -> Result<(), Fault> {
        if let Some(row_bytes) = element.fixed_row_bytes() {
            element.check_claim(row_bytes, self.rest().len())?;
            self.at += element.count * row_bytes;
            return Ok(());
        }
        element.check_claim(element.least_row_bytes(), self.rest().len())?;
        for row in 0..element.count {
            for property in &element.properties {
                self.step(property, &element.name, row)?;
            }
        }
        Ok(())
    }

    /// Steps over a property of a row; the value, if it is no list.
    fn step(&mut self, property: &Property, list: &str, row: usize) -> Result<Option<f64>, Fault> {
        match property.kind {
            Kind::Scalar(scalar) => self.number(scalar, list, row).map(Some),
            Kind::List { length, item } => {
                let length = self.number(length, list, row)?;
                if length < 0.0 || length.fract() != 0.0 {
                    return Err(Fault::entry(
                        list,
                        row,
                        format!("a list cannot have {length} items"),
                    ));
                }
                let bytes = (length as usize)
                    .checked_mul(item.byte_size())
                    .filter(|&bytes| bytes <= self.rest().len());
                self.at += bytes.ok_or_else(|| {
                    Fault::entry(
                        list,
                        row,
                        format!("a list of {length} items goes beyond the end of the file"),
                    )
                })?;
                Ok(None)
            }
        }
    }

    fn number(&mut self, scalar: Scalar, list: &str, row: usize) -> Result<f64, Fault> {
        let rest = self.rest();
        if rest.len() < scalar.byte_size() {
            return Err(Fault::entry(
                list,
                row,
                "the file ends here: it is truncated, or its header is wrong",
            ));
        }
        self.at += scalar.byte_size();
        Ok(scalar.read(rest, self.big_endian))
    }
}

fn binary_columns<'a>(cursor: &mut Cursor<'a>, vertex: &Element) -> Result<Vec<Column<'a>>, Fault> {
    let Some(row_bytes) = vertex.fixed_row_bytes() else {
        return walked_columns(cursor, vertex);
    };
    vertex.check_claim(row_bytes, cursor.rest().len())?;
    let mut start = 0;
    let mut columns = Vec::with_capacity(vertex.properties.len());
    for property in &vertex.properties {
        if let Kind::Scalar(scalar) = property.kind {
            columns.push(Column {
                name: property.name.clone(),
                scalar,
                values: Values::Packed {
                    bytes: cursor.rest(),
                    start,
                    step: row_bytes,
                    big_endian: cursor.big_endian,
                },
            });
            start += scalar.byte_size();
        }
    }
    Ok(columns)
}

/// Points that own lists have rows of different lengths: they are walked one by one.
fn walked_columns<'a>(cursor: &mut Cursor<'a>, vertex: &Element) -> Result<Vec<Column<'a>>, Fault> {
    vertex.check_claim(vertex.least_row_bytes(), cursor.rest().len())?;
    let mut kept = KeptColumns::new(vertex);
    for row in 0..vertex.count {
        for (index, property) in vertex.properties.iter().enumerate() {
            if let Some(value) = cursor.step(property, POINTS, row)? {
                kept.push(index, value);
            }
        }
    }
    Ok(kept.columns)
}

/// Parsed columns of the properties that a cloud has a use for.
struct KeptColumns {
    columns: Vec<Column<'static>>,
    /// Column of each property.
    column_of: Vec<Option<usize>>,
}

impl KeptColumns {
    fn new(vertex: &Element) -> Self {
        let mut kept = Self {
            columns: Vec::new(),
            column_of: Vec::new(),
        };
        for property in &vertex.properties {
            let scalar = match property.kind {
                Kind::Scalar(scalar) if attributes::is_used(&property.name) => Some(scalar),
                _ => None,
            };
            kept.column_of.push(scalar.map(|_| kept.columns.len()));
            kept.columns.extend(scalar.map(|scalar| Column {
                name: property.name.clone(),
                scalar,
                values: Values::Parsed(Vec::with_capacity(vertex.count)),
            }));
        }
        kept
    }

    fn push(&mut self, property: usize, value: f64) {
        if let Some(column) = self.column_of[property]
            && let Values::Parsed(values) = &mut self.columns[column].values
        {
            values.push(value);
        }
    }
}

fn ascii_columns(
    bytes: &[u8],
    header: &Header,
    before: &[Element],
    vertex: &Element,
) -> Result<Vec<Column<'static>>, Fault> {
    let payload = &bytes[header.byte_size..];
    let mut tokens = Tokens::new(payload, header.line_count + 1);
    for element in before {
        check_ascii_claim(element, payload)?;
        // Rows of nothing take no time, however many are claimed.
        let rows = if element.properties.is_empty() {
            0
        } else {
            element.count
        };
        for row in 0..rows {
            for property in &element.properties {
                ascii_step(&mut tokens, property, &element.name, row)?;
            }
        }
    }
    check_ascii_claim(vertex, payload)?;
    let mut kept = KeptColumns::new(vertex);
    if kept.columns.is_empty() {
        // Nothing is kept of these points, so there is no cloud to be made of them.
        return Ok(kept.columns);
    }
    for row in 0..vertex.count {
        for (index, property) in vertex.properties.iter().enumerate() {
            if let Some(value) = ascii_step(&mut tokens, property, POINTS, row)? {
                kept.push(index, value);
            }
        }
    }
    Ok(kept.columns)
}

/// A number as text takes a digit and what separates it from the next.
fn check_ascii_claim(element: &Element, payload: &[u8]) -> Result<(), Fault> {
    const LEAST_NUMBER_BYTES: usize = 2;
    // The last number need not be followed by anything.
    element.check_claim(
        element.properties.len() * LEAST_NUMBER_BYTES,
        payload.len() + 1,
    )
}

fn ascii_step(
    tokens: &mut Tokens<'_>,
    property: &Property,
    list: &str,
    row: usize,
) -> Result<Option<f64>, Fault> {
    match property.kind {
        Kind::Scalar(_) => ascii_number(tokens, property, list, row).map(Some),
        Kind::List { .. } => {
            let length = ascii_number(tokens, property, list, row)?;
            if length < 0.0 || length.fract() != 0.0 {
                return Err(Fault::new(
                    Place::Line(tokens.line()),
                    format!("a list cannot have {length} items"),
                ));
            }
            let mut left = length;
            while left > 0.0 {
                ascii_number(tokens, property, list, row)?;
                left -= 1.0;
            }
            Ok(None)
        }
    }
}

fn ascii_number(
    tokens: &mut Tokens<'_>,
    property: &Property,
    list: &str,
    row: usize,
) -> Result<f64, Fault> {
    let Some(token) = tokens.next() else {
        return Err(Fault::entry(
            list,
            row,
            format!(
                "the file ends before property `{}`: it is truncated, or its header is wrong",
                property.name
            ),
        ));
    };
    parse_number(token).ok_or_else(|| {
        Fault::new(
            Place::Line(tokens.line()),
            format!(
                "property `{}` of {list} {row} is {}, expected a number",
                property.name,
                quoted(token)
            ),
        )
    })
}
