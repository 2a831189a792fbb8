//! The header of a PLY file: elements with typed properties, in the order of their rows.

use super::super::column::Scalar;
use super::super::error::{Fault, Place};
use super::super::numbers::quoted;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, ElementDef, Encoding, PropertyType, ScalarType};

/// Longer headers are not believed to be headers.
const MAX_HEADER_BYTES: usize = 1 << 20;

/// What the header says.
#[derive(Debug)]
pub(super) struct PlyHeader {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Bytes up to the payload.
    pub(super) byte_size: usize,
    /// Lines up to the payload.
    pub(super) line_count: usize,
}

/// A list of rows of one kind.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

/// A column of an element.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: PropertyKind,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum PropertyKind {
    Scalar(Scalar),
    List { length: Scalar, item: Scalar },
}

impl PlyHeader {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Fault> {
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
                    format!("the header is not understood: found {}", quoted(found.as_bytes())),
                )
            })?;
        let elements: Vec<Element> = header.elements.into_iter().map(|(_, element)| element.into()).collect();
        // The parser keeps elements and properties by name, so one of two with the same name would be lost and every
        // row read at a wrong stride.
        let properties: usize = elements.iter().map(|element| element.properties.len()).sum();
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

/// The lines up to `end_header` as the crate's grammar wants them, and the number of bytes that they take in the file.
fn header_text(bytes: &[u8]) -> Result<(String, usize), Fault> {
    const LAST_LINE: &str = "end_header";
    // Where lines end in `\r` alone, a `\n` behind the last one is the first byte of the payload.
    let is_old_mac =
        bytes.get(first_line(bytes).len()) == Some(&b'\r') && bytes.get(first_line(bytes).len() + 1) != Some(&b'\n');
    let mut text = String::new();
    let mut at = 0;
    let mut number = 1;
    while at < bytes.len().min(MAX_HEADER_BYTES) {
        let rest = &bytes[at..];
        let length = first_line(rest).len();
        let ending = match rest[length..] {
            [b'\r', b'\n', ..] if !is_old_mac => 2,
            [] => 0,
            _ => 1,
        };
        let line = lenient_line(&rest[..length], number);
        at += length + ending;
        text.push_str(&line);
        text.push('\n');
        if line == LAST_LINE {
            return Ok((text, at));
        }
        number += 1;
    }
    Err(Fault::header(
        "there is no line `end_header`: the header is incomplete, the file may be truncated",
    ))
}

/// A line without what the grammar does not know but writers write: space around it, empty lines, comments in any
/// encoding, and names with signs (`scalar_C2C_distances_(mm)`), which cannot mean anything to us.
fn lenient_line(line: &[u8], number: usize) -> String {
    let ascii = line
        .trim_ascii()
        .iter()
        .map(|&byte| if byte.is_ascii() { char::from(byte) } else { '?' });
    let line: String = ascii.collect();
    let mut words: Vec<&str> = line.split_ascii_whitespace().collect();
    let name_index = match words.as_slice() {
        [] => return "comment".to_owned(),
        ["element", ..] => 1,
        ["property", "list", ..] => 4,
        ["property", ..] => 2,
        _ => return line,
    };
    let substitute = format!("unnamed_{number}");
    if let Some(name) = words.get_mut(name_index)
        && !is_known_to_the_grammar(name)
    {
        *name = &substitute;
    }
    words.join(" ")
}

fn is_known_to_the_grammar(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
        && name
            .chars()
            .all(|sign| sign.is_ascii_alphanumeric() || sign == '_' || sign == '-')
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
                        PropertyType::Scalar(scalar) => PropertyKind::Scalar(scalar.into()),
                        PropertyType::List(length, item) => PropertyKind::List {
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
    pub(super) fn fixed_row_bytes(&self) -> Option<usize> {
        self.properties
            .iter()
            .map(|property| match property.kind {
                PropertyKind::Scalar(scalar) => Some(scalar.byte_size()),
                PropertyKind::List { .. } => None,
            })
            .sum()
    }

    /// The least bytes that a binary row takes: empty lists have a length.
    pub(super) fn least_row_bytes(&self) -> usize {
        self.properties
            .iter()
            .map(|property| match property.kind {
                PropertyKind::Scalar(scalar) => scalar.byte_size(),
                PropertyKind::List { length, .. } => length.byte_size(),
            })
            .sum()
    }

    /// Fails when `available` bytes cannot hold as many rows of `row_bytes` as the header claims.
    pub(super) fn check_claim(&self, row_bytes: usize, available: usize) -> Result<(), Fault> {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> PlyHeader {
        PlyHeader::parse(text.as_bytes()).unwrap_or_else(|fault| panic!("{text:?}: {fault:?}"))
    }

    #[test]
    fn elements_and_types_are_known_under_all_their_names() {
        let header = parse(
            "ply\nformat binary_big_endian 1.0\nelement a-b 3\nproperty list uint8 float32 l\nproperty char c\n\
             element vertex 7\nproperty int16 s\nproperty uint u\nproperty float64 d\nend_header\n",
        );
        assert_eq!(header.encoding, Encoding::BinaryBigEndian);
        let [first, vertex] = header.elements.as_slice() else {
            panic!("{:?}", header.elements)
        };
        assert_eq!((first.name.as_str(), first.count), ("a-b", 3));
        assert_eq!(first.fixed_row_bytes(), None);
        assert_eq!(first.least_row_bytes(), 1 + 1);
        assert_eq!((vertex.name.as_str(), vertex.count), ("vertex", 7));
        assert_eq!(vertex.fixed_row_bytes(), Some(2 + 4 + 8));
    }

    #[test]
    fn the_payload_begins_behind_the_line_ending_of_the_file() {
        let lines = "ply\nformat ascii 1.0\n  element vertex 1 \n\ncomment\nend_header\n";
        for ending in ["\n", "\r\n", "\r"] {
            let file = lines.replace('\n', ending) + "\n payload";
            let header = parse(&file);
            assert_eq!(&file[header.byte_size..], "\n payload", "{ending:?}");
            assert_eq!(header.line_count, 6, "{ending:?}");
        }
    }

    #[test]
    fn names_that_no_grammar_foresees_keep_their_columns() {
        let header = parse(
            "ply\nformat ascii 1.0\ncomment \u{e9}\nelement vertex 1\nproperty float scalar_C2C_(mm)\n\
             property float 2nd\nproperty list uchar int #\nproperty float x\nend_header\n",
        );
        let names: Vec<&str> = header.elements[0]
            .properties
            .iter()
            .map(|property| property.name.as_str())
            .collect();
        assert_eq!(names, ["unnamed_5", "unnamed_6", "unnamed_7", "x"]);
    }

    #[test]
    fn a_header_without_end_is_given_up() {
        let mut file = b"ply\nformat ascii 1.0\n".to_vec();
        file.resize(file.len() + 2 * MAX_HEADER_BYTES, b'\n');
        file.extend(b"end_header\n");
        let fault = PlyHeader::parse(&file).unwrap_err();
        assert!(fault.problem.contains("no line `end_header`"), "{}", fault.problem);
    }
}
