//! The header of a PLY file: elements with typed properties, in the order of their rows.

use crate::io::columns::column::Scalar;
use crate::io::columns::numbers::quoted;
use crate::io::columns::unique_names::{UniqueNames, duplicate_warning};
use crate::io::error::{Fault, Place};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, ElementDef, Encoding, PropertyType, ScalarType};
use std::collections::HashSet;

/// Longer headers are not believed to be headers.
const MAX_HEADER_BYTES: usize = 1 << 20;

/// Parsed PLY header.
#[derive(Debug)]
pub(super) struct PlyHeader {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Bytes up to the payload.
    pub(super) byte_size: usize,
    /// Lines up to the payload.
    pub(super) line_count: usize,
    /// Names that were changed, a clause each with its line.
    pub(super) warnings: Vec<String>,
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
        let HeaderText { text, names, byte_size } = HeaderText::read(bytes)?;
        let mut reader = Reader::new(text.as_bytes());
        // The header only: for 100,000 points with normals and colours the crate builds maps in 404 ms or structs in 11
        // ms, where columns that stay in the file's bytes take 0.3 ms.
        let header = Parser::<DefaultElement>::new()
            .read_header(&mut reader)
            .map_err(|error| {
                let line = error.line().unwrap_or(1);
                let found = bytes_of_line(bytes, line);
                Fault::new(
                    Place::Line(line),
                    format!("the header is not understood: found {}", quoted(found)),
                )
            })?;
        let mut elements: Vec<Element> = header.elements.into_iter().map(|(_, element)| element.into()).collect();
        // The parser stores elements by name, so with two of the same name the rows of one would be read as the other.
        let is_element = |line: &&str| line.split_whitespace().next() == Some("element");
        let declared: Vec<&str> = text.lines().filter(is_element).collect();
        if declared.len() != elements.len() {
            return Err(Fault::header(same_name(&declared)));
        }
        let mut warnings = Vec::new();
        for element in &mut elements {
            element.restore_names(&names, &mut warnings);
        }
        Ok(Self {
            encoding: header.encoding,
            elements,
            byte_size,
            line_count: text.lines().count(),
            warnings,
        })
    }
}

/// Returns the message about two elements with the same name.
fn same_name(declared: &[&str]) -> String {
    let names = declared.iter().filter_map(|line| line.split_whitespace().nth(1));
    let mut seen = HashSet::new();
    let twice: Vec<&str> = names.filter(|name| !seen.insert(*name)).collect();
    format!(
        "two elements have the same name (`{}`): rename one of them, which rows belong to it is not known",
        twice.first().unwrap_or(&"")
    )
}

/// Line `number`, counted from 1, of a file.
fn bytes_of_line(bytes: &[u8], number: usize) -> &[u8] {
    let head = &bytes[..bytes.len().min(MAX_HEADER_BYTES)];
    let ending = if head[first_line(head).len()..].starts_with(b"\n") || head.contains(&b'\n') {
        b'\n'
    } else {
        b'\r'
    };
    let line = head.split(|&byte| byte == ending).nth(number.saturating_sub(1));
    line.unwrap_or_default().trim_ascii()
}

fn first_line(bytes: &[u8]) -> &[u8] {
    bytes
        .split(|&byte| byte == b'\n' || byte == b'\r')
        .next()
        .unwrap_or(bytes)
}

/// A property as the file has it.
struct Original {
    name: String,
    line: usize,
    /// The type of it or of its list items where the grammar does not know it: there it is a double.
    long: Option<Scalar>,
}

/// Whole numbers of eight bytes, which some writers add to the format.
fn long_type(word: &str) -> Option<Scalar> {
    match word {
        "int64" | "long" | "longlong" => Some(Scalar::I64),
        "uint64" | "ulong" | "ulonglong" => Some(Scalar::U64),
        _ => None,
    }
}

/// The lines up to `end_header` as the crate's grammar wants them.
struct HeaderText {
    text: String,
    /// Properties in the order of the file. In `text` the name of each is its place in this list: the grammar knows no
    /// signs in names, and keeps one of two properties of the same name.
    names: Vec<Original>,
    /// Bytes that the lines take in the file.
    byte_size: usize,
}

impl HeaderText {
    fn read(bytes: &[u8]) -> Result<Self, Fault> {
        const LAST_LINE: &str = "end_header";
        // Where lines end in `\r` alone, a `\n` after the last one is the first byte of the payload.
        let is_old_mac = bytes.get(first_line(bytes).len()) == Some(&b'\r')
            && bytes.get(first_line(bytes).len() + 1) != Some(&b'\n');
        let mut header = Self {
            text: String::new(),
            names: Vec::new(),
            byte_size: 0,
        };
        let mut number = 1;
        while header.byte_size < bytes.len().min(MAX_HEADER_BYTES) {
            let rest = &bytes[header.byte_size..];
            let length = first_line(rest).len();
            let ending = match rest[length..] {
                [b'\r', b'\n', ..] if !is_old_mac => 2,
                [] => 0,
                _ => 1,
            };
            let line = header.lenient_line(&rest[..length], number);
            header.byte_size += length + ending;
            header.text.push_str(&line);
            header.text.push('\n');
            if line == LAST_LINE {
                return Ok(header);
            }
            number += 1;
        }
        Err(Fault::header(
            "missing line `end_header`: the header is incomplete, the file may be truncated",
        ))
    }

    /// A line without variations of writers that the grammar does not know: space around it, empty lines, comments in
    /// any encoding, and names of properties with special characters and spaces (`scalar_C2C absolute distances (mm)`).
    fn lenient_line(&mut self, line: &[u8], number: usize) -> String {
        let text = String::from_utf8_lossy(line.trim_ascii());
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        let (retained, kind, name) = match words.as_slice() {
            [] => return "comment".to_owned(),
            ["property", "list", length, item, name @ ..] if !name.is_empty() => {
                (vec!["property", "list", length], *item, name)
            }
            ["property", kind, name @ ..] if !name.is_empty() && *kind != "list" => (vec!["property"], *kind, name),
            _ => {
                return text
                    .chars()
                    .map(|sign| if sign.is_ascii() { sign } else { '?' })
                    .collect();
            }
        };
        let long = long_type(kind);
        self.names.push(Original {
            name: name.join(" "),
            line: number,
            long,
        });
        let kind = if long.is_some() { "double" } else { kind };
        format!("{} {kind} p{}", retained.join(" "), self.names.len() - 1)
    }
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
    /// Gives the properties the names of the file, which the parser has seen as places in the list `names`. Of two of
    /// the same name the first keeps it.
    fn restore_names(&mut self, names: &[Original], warnings: &mut Vec<String>) {
        let original = |property: &Property| {
            let place: usize = property.name.strip_prefix('p')?.parse().ok()?;
            names.get(place)
        };
        let reserved = self
            .properties
            .iter()
            .filter_map(original)
            .map(|original| original.name.clone());
        let mut free = UniqueNames::reserving(reserved);
        let mut seen = HashSet::new();
        let mut duplicates = Vec::new();
        for property in &mut self.properties {
            let Some(Original { name, line, long }) = original(property) else {
                continue;
            };
            if let Some(long) = *long {
                match &mut property.kind {
                    PropertyKind::Scalar(scalar) | PropertyKind::List { item: scalar, .. } => *scalar = long,
                }
            }
            property.name = if seen.insert(name) {
                name.clone()
            } else {
                let new = free.numbered(name, str::to_owned);
                duplicates.push((*line, name.clone(), new.clone()));
                new
            };
        }
        let owner = format!("`{}` has a property", self.name);
        warnings.extend(duplicate_warning(&owner, &duplicates));
    }

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
    pub(super) fn min_row_bytes(&self) -> usize {
        self.properties
            .iter()
            .map(|property| match property.kind {
                PropertyKind::Scalar(scalar) => scalar.byte_size(),
                PropertyKind::List { length, .. } => length.byte_size(),
            })
            .sum()
    }

    /// Fails if `available` bytes cannot hold the claimed number of rows of `row_bytes`.
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
    fn elements_and_types_are_recognised_under_all_their_names() {
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
        assert_eq!(first.min_row_bytes(), 1 + 1);
        assert_eq!((vertex.name.as_str(), vertex.count), ("vertex", 7));
        assert_eq!(vertex.fixed_row_bytes(), Some(2 + 4 + 8));
    }

    #[test]
    fn the_payload_begins_after_the_line_ending_of_the_file() {
        let lines = "ply\nformat ascii 1.0\n  element vertex 1 \n\ncomment\nend_header\n";
        for ending in ["\n", "\r\n", "\r"] {
            let file = lines.replace('\n', ending) + "\n payload";
            let header = parse(&file);
            assert_eq!(&file[header.byte_size..], "\n payload", "{ending:?}");
            assert_eq!(header.line_count, 6, "{ending:?}");
        }
    }

    #[test]
    fn unusual_names_keep_their_columns() {
        let header = parse(
            "ply\nformat ascii 1.0\ncomment \u{e9}\nelement vertex 1\nproperty float scalar_C2C_(mm)\n\
             property float 2nd\nproperty list uchar int #\nproperty float x\nend_header\n",
        );
        assert_eq!(names(&header), ["scalar_C2C_(mm)", "2nd", "#", "x"]);
        let header = parse(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float C2C absolute  distances\n\
             property float p0\nproperty float h\u{f6}he\nproperty list uchar int a b\nend_header\n",
        );
        assert_eq!(names(&header), ["C2C absolute distances", "p0", "h\u{f6}he", "a b"]);
        assert!(header.warnings.is_empty());
    }

    fn names(header: &PlyHeader) -> Vec<&str> {
        let properties = header.elements[0].properties.iter();
        properties.map(|property| property.name.as_str()).collect()
    }

    #[test]
    fn whole_numbers_may_be_long() {
        let header = parse(
            "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty int64 id\n\
             property ulong t\nend_header\n",
        );
        let vertex = &header.elements[0];
        let scalar = |index: usize| match vertex.properties[index].kind {
            PropertyKind::Scalar(scalar) => Some(scalar),
            PropertyKind::List { .. } => None,
        };
        assert_eq!(names(&header), ["x", "id", "t"]);
        assert_eq!([scalar(1), scalar(2)], [Some(Scalar::I64), Some(Scalar::U64)]);
        assert_eq!(vertex.fixed_row_bytes(), Some(4 + 8 + 8));
    }

    #[test]
    fn the_first_of_several_equal_property_names_keeps_it() {
        let header = parse(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float q\nproperty int q\n\
             property float q_2\nproperty double q\nelement face 0\nproperty int q\nend_header\n",
        );
        assert_eq!(names(&header), ["x", "q", "q_3", "q_2", "q_4"]);
        let [warning] = header.warnings.as_slice() else {
            panic!("{:?}", header.warnings)
        };
        assert!(
            warning.contains("line 6") && warning.contains("`q` (now `q_3`)"),
            "{warning}"
        );
    }

    #[test]
    fn an_unterminated_header_is_rejected() {
        let mut file = b"ply\nformat ascii 1.0\n".to_vec();
        file.resize(file.len() + 2 * MAX_HEADER_BYTES, b'\n');
        file.extend(b"end_header\n");
        let fault = PlyHeader::parse(&file).unwrap_err();
        assert!(fault.problem.contains("missing line `end_header`"), "{}", fault.problem);
    }
}
