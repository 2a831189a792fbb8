//! The header of a PCD file: lines of a keyword and its values, up to `DATA`.
//!
//! It is read here and not by the crate `pcd-rs`, whose errors lack the line, and which takes fields of no numbers for
//! fields of one. Additions of other programs to the format (lines of their own, fields of types without a name, wrong
//! counts of points) are skipped with a warning wherever the points can be read without it.

use crate::io::columns::column::Scalar;
use crate::io::columns::numbers::quoted;
use crate::io::columns::unique_names::{UniqueNames, duplicate_warning};
use crate::io::error::{Fault, Place};
use glam::DVec3;

/// Longer headers are not believed to be headers.
const MAX_HEADER_BYTES: usize = 1 << 20;

/// Max numbers of a point: more than the longest descriptors have.
const MAX_NUMBERS: usize = 4096;

/// The name of bytes that mean nothing.
const PADDING: &str = "_";

/// Encoding of the points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary,
    BinaryCompressed,
}

/// Parsed PCD header.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) fields: Vec<PcdField>,
    pub(super) width: u64,
    pub(super) height: u64,
    pub(super) points: u64,
    /// Position of the sensor.
    pub(super) viewpoint: DVec3,
    /// The quaternion of its rotation, real part first, if it is one.
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) encoding: Encoding,
    /// Bytes up to the points.
    pub(super) byte_size: usize,
    /// Warnings about skipped or renamed fields, one clause each with its line.
    pub(super) warnings: Vec<String>,
}

/// A field of every point.
#[derive(Debug, Clone)]
pub(super) struct PcdField {
    pub(super) name: String,
    /// `None` for padding, and fields skipped like it.
    pub(super) scalar: Option<Scalar>,
    /// Bytes of a number.
    pub(super) number_bytes: usize,
    /// Numbers of a point; may be 0 in the file, which old converters mean as 1.
    pub(super) count: usize,
}

/// The words of a line behind its keyword, and its number in the file.
#[derive(Debug, Default, Clone)]
struct Line {
    number: usize,
    words: Vec<String>,
}

/// The lines that are known.
#[derive(Debug, Default)]
struct Lines {
    fields: Option<Line>,
    sizes: Option<Line>,
    types: Option<Line>,
    counts: Option<Line>,
    width: Option<Line>,
    height: Option<Line>,
    points: Option<Line>,
    viewpoint: Option<Line>,
}

impl Header {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        // Not `pcd-rs`: it took 78 ms for a task of 0.4 ms here, allocated the sizes that a compressed block claims,
        // and its errors did not name the line.
        let mut lines = Lines::default();
        let mut warnings = Vec::new();
        let mut byte_size = 0;
        let head = &bytes[..bytes.len().min(MAX_HEADER_BYTES)];
        for (number, raw) in (1..).zip(head.split_inclusive(|&byte| byte == b'\n')) {
            byte_size += raw.len();
            let text = String::from_utf8_lossy(raw.trim_ascii());
            let mut words = text.split_ascii_whitespace();
            let Some(keyword) = words.next().filter(|word| !word.starts_with('#')) else {
                continue;
            };
            let words: Vec<String> = words.map(str::to_owned).collect();
            let line = Line { number, words };
            if keyword.eq_ignore_ascii_case("DATA") {
                return lines.header(encoding(&line)?, byte_size, warnings);
            }
            if !lines.take(keyword, line) {
                warnings.push(format!(
                    "line {number}: {} is not a keyword of PCD: the line is skipped",
                    quoted(keyword.as_bytes())
                ));
            }
        }
        Err(Fault::header(
            "missing line `DATA`: the header is incomplete, or this is not a PCD file",
        ))
    }

    /// Returns true if the header declares fields without a number.
    pub(super) fn has_empty_fields(&self) -> bool {
        self.fields.iter().any(|field| field.count == 0)
    }
}

impl PcdField {
    /// Bytes of a point; `None` where they cannot be counted.
    pub(super) fn bytes(&self) -> Option<usize> {
        self.number_bytes.checked_mul(self.count)
    }

    /// The name of number `place` of a point. A coordinate with several numbers is the first of them, as in PCL.
    pub(super) fn number_name(&self, place: usize) -> String {
        let is_coordinate = ["x", "y", "z"].iter().any(|axis| self.name.eq_ignore_ascii_case(axis));
        if self.count <= 1 || (is_coordinate && place == 0) {
            self.name.clone()
        } else {
            format!("{}_{place}", self.name)
        }
    }
}

fn encoding(line: &Line) -> Result<Encoding, Fault> {
    let word = line.words.first().map_or("", String::as_str);
    match word.to_ascii_lowercase().as_str() {
        "ascii" => Ok(Encoding::Ascii),
        "binary" => Ok(Encoding::Binary),
        "binary_compressed" => Ok(Encoding::BinaryCompressed),
        _ => Err(line.fault(format!(
            "DATA is {}, expected ascii, binary or binary_compressed",
            quoted(word.as_bytes())
        ))),
    }
}

impl Line {
    fn fault(&self, problem: impl Into<String>) -> Fault {
        Fault::new(Place::Line(self.number), problem)
    }

    /// The only value of the line.
    fn count(&self, keyword: &str) -> Result<u64, Fault> {
        let word = self.words.first().map_or("", String::as_str);
        word.parse().map_err(|_| {
            self.fault(format!(
                "{keyword} is {}, expected a whole number",
                quoted(word.as_bytes())
            ))
        })
    }

    /// Fails unless there is one value per entry of `fields`.
    fn check_length(&self, keyword: &str, fields: &Line) -> Result<(), Fault> {
        let (found, expected) = (self.words.len(), fields.words.len());
        if found == expected {
            return Ok(());
        }
        Err(self.fault(format!(
            "{keyword} has {found} values, expected {expected}, one for each of the FIELDS in line {}: {}",
            fields.number,
            shortened(&fields.words)
        )))
    }
}

/// The first few of the names.
fn shortened(names: &[String]) -> String {
    const MAX: usize = 32;
    let more = if names.len() > MAX { " …" } else { "" };
    format!("{}{more}", names[..names.len().min(MAX)].join(" "))
}

impl Lines {
    /// False where the keyword is not known.
    fn take(&mut self, keyword: &str, line: Line) -> bool {
        let place = match keyword.to_ascii_uppercase().as_str() {
            // The versions differ only in lines that may be absent.
            "VERSION" => return true,
            "FIELDS" | "COLUMNS" => &mut self.fields,
            "SIZE" => &mut self.sizes,
            "TYPE" => &mut self.types,
            "COUNT" => &mut self.counts,
            "WIDTH" => &mut self.width,
            "HEIGHT" => &mut self.height,
            "POINTS" => &mut self.points,
            "VIEWPOINT" => &mut self.viewpoint,
            _ => return false,
        };
        *place = Some(line);
        true
    }

    fn header(self, encoding: Encoding, byte_size: usize, mut warnings: Vec<String>) -> Result<Header, Fault> {
        let fields = self.fields(&mut warnings)?;
        let count = |line: &Option<Line>, keyword: &str| line.as_ref().map(|line| line.count(keyword)).transpose();
        let (width, height) = (count(&self.width, "WIDTH")?, count(&self.height, "HEIGHT")?);
        let points = count(&self.points, "POINTS")?;
        let in_grid = width.and_then(|width| width.checked_mul(height.unwrap_or(1)));
        let Some(points) = points.or(in_grid) else {
            return Err(Fault::header(
                "neither a line `POINTS` nor `WIDTH` and `HEIGHT` says how many points there are",
            ));
        };
        if in_grid.is_some_and(|in_grid| in_grid != points) {
            let number = self.points.as_ref().map_or(0, |line| line.number);
            warnings.push(format!(
                "line {number}: POINTS is {points}, but WIDTH times HEIGHT is not: POINTS is taken"
            ));
        }
        Ok(Header {
            fields,
            width: width.unwrap_or(points),
            height: height.unwrap_or(1),
            points,
            rotation: self.rotation(),
            viewpoint: self.viewpoint(&mut warnings),
            encoding,
            byte_size,
            warnings,
        })
    }

    /// The position of the viewpoint; an unintelligible one is ignored.
    fn viewpoint(&self, warnings: &mut Vec<String>) -> DVec3 {
        let Some(line) = &self.viewpoint else {
            return DVec3::ZERO;
        };
        let numbers: Vec<f64> = line.words.iter().map_while(|word| word.parse().ok()).collect();
        if let [x, y, z, ..] = numbers[..]
            && numbers.len() >= 7
        {
            return DVec3::new(x, y, z);
        }
        warnings.push(format!(
            "line {}: VIEWPOINT is not understood, expected 7 numbers (position and quaternion): it is skipped",
            line.number
        ));
        DVec3::ZERO
    }

    /// The quaternion of the viewpoint, unless it is the identity.
    fn rotation(&self) -> Option<[f64; 4]> {
        let words = &self.viewpoint.as_ref()?.words;
        let numbers: Vec<f64> = words.iter().map_while(|word| word.parse().ok()).collect();
        let rotation: [f64; 4] = numbers.get(3..7)?.try_into().ok()?;
        let turns = rotation[1..].iter().any(|&part| part != 0.0);
        turns.then_some(rotation)
    }

    fn fields(&self, warnings: &mut Vec<String>) -> Result<Vec<PcdField>, Fault> {
        let needed = |line: &Option<Line>, keyword: &str| {
            let missing = || Fault::header(format!("missing line `{keyword}`"));
            line.clone().ok_or_else(missing)
        };
        let names = needed(&self.fields, "FIELDS")?;
        if names.words.is_empty() {
            return Err(names.fault("FIELDS has no names, expected x y z and what else a point has"));
        }
        let (sizes, types) = (needed(&self.sizes, "SIZE")?, needed(&self.types, "TYPE")?);
        sizes.check_length("SIZE", &names)?;
        types.check_length("TYPE", &names)?;
        if let Some(counts) = &self.counts {
            counts.check_length("COUNT", &names)?;
        }
        let mut fields = Vec::new();
        for (place, name) in names.words.iter().enumerate() {
            let number_bytes: usize = sizes.words[place].parse().map_err(|_| {
                sizes.fault(format!(
                    "the SIZE of field `{name}` is {}, expected a count of bytes",
                    quoted(sizes.words[place].as_bytes())
                ))
            })?;
            let count = match &self.counts {
                Some(counts) => counts.words[place].parse().map_err(|_| {
                    counts.fault(format!(
                        "the COUNT of field `{name}` is {}, expected a whole number",
                        quoted(counts.words[place].as_bytes())
                    ))
                })?,
                None => 1,
            };
            let kind = &types.words[place];
            let scalar = if name == PADDING {
                None
            } else {
                scalar(kind, number_bytes)
            };
            if is_no_float(kind, number_bytes) && name != PADDING {
                return Err(sizes.fault(format!(
                    "the SIZE of field `{name}` is {number_bytes}, but its TYPE in line {} is F: floating-point \
                     numbers take 4 or 8 bytes, and where the others of a point are is not known",
                    types.number
                )));
            }
            if scalar.is_none() && name != PADDING {
                warnings.push(format!(
                    "line {}: field `{name}` is of type {} with {number_bytes} bytes, which is not a type of PCD: it \
                     is skipped",
                    types.number,
                    quoted(kind.as_bytes())
                ));
            }
            fields.push(PcdField {
                name: name.clone(),
                scalar,
                number_bytes,
                count,
            });
        }
        rename_duplicates(&mut fields, names.number, warnings);
        skip_too_many(&mut fields, names.number, warnings);
        Ok(fields)
    }
}

/// Returns true if no machine has floating-point numbers of that size: the header is wrong. Other sizes (halves, `long
/// double`) are skipped.
fn is_no_float(kind: &str, number_bytes: usize) -> bool {
    let is_float = ["f", "float"].iter().any(|name| kind.eq_ignore_ascii_case(name));
    is_float && ![2, 4, 8, 10, 12, 16].contains(&number_bytes)
}

/// Renames duplicate fields: of two fields of the same name the first keeps it.
fn rename_duplicates(fields: &mut [PcdField], line: usize, warnings: &mut Vec<String>) {
    let named = fields.iter_mut().filter(|field| field.name != PADDING);
    let named: Vec<&mut PcdField> = named.collect();
    let mut names = UniqueNames::reserving(named.iter().map(|field| field.name.clone()));
    let mut seen = std::collections::HashSet::new();
    let mut duplicates = Vec::new();
    for field in named {
        if !seen.insert(field.name.clone()) {
            let new = names.numbered(&field.name, str::to_owned);
            duplicates.push((line, std::mem::replace(&mut field.name, new.clone()), new));
        }
    }
    warnings.extend(duplicate_warning("FIELDS has a name", &duplicates));
}

/// Keeps the fields whose numbers come to no more than a point may have.
fn skip_too_many(fields: &mut [PcdField], line: usize, warnings: &mut Vec<String>) {
    let mut retained = 0usize;
    let mut skipped = Vec::new();
    for field in fields.iter_mut().filter(|field| field.scalar.is_some()) {
        let numbers = retained.saturating_add(field.count.max(1));
        if numbers <= MAX_NUMBERS {
            retained = numbers;
        } else {
            field.scalar = None;
            skipped.push(field.name.clone());
        }
    }
    if !skipped.is_empty() {
        warnings.push(format!(
            "line {line}: a point has more than {MAX_NUMBERS} numbers; these fields are skipped: {}",
            shortened(&skipped)
        ));
    }
}

/// The type of a number by the word for it and its size: the letters of PCL, or the names that others write.
fn scalar(kind: &str, bytes: usize) -> Option<Scalar> {
    let letters = kind
        .trim_end_matches(|sign: char| sign.is_ascii_digit())
        .to_ascii_lowercase();
    Some(match (letters.as_str(), bytes) {
        ("u" | "uint" | "uchar" | "ushort", 1) => Scalar::U8,
        ("u" | "uint" | "ushort", 2) => Scalar::U16,
        ("u" | "uint", 4) => Scalar::U32,
        ("u" | "uint" | "ulong", 8) => Scalar::U64,
        ("i" | "int" | "char", 1) => Scalar::I8,
        ("i" | "int" | "short", 2) => Scalar::I16,
        ("i" | "int", 4) => Scalar::I32,
        ("i" | "int" | "long", 8) => Scalar::I64,
        ("f" | "float", 4) => Scalar::F32,
        ("f" | "d" | "float" | "double", 8) => Scalar::F64,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(lines: &str) -> Vec<u8> {
        format!("# a comment\nVERSION .7\n{lines}").into_bytes()
    }

    fn parse(lines: &str) -> Header {
        Header::parse(&text(lines)).unwrap_or_else(|fault| panic!("{lines:?}: {fault:?}"))
    }

    fn fault(lines: &str) -> Fault {
        Header::parse(&text(lines)).unwrap_err()
    }

    const FIELDS: &str = "FIELDS x y z a\nSIZE 4 4 4 1\nTYPE F F F U\n";

    #[test]
    fn header_lines_with_too_few_entries_are_reported() {
        let rest = "WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n";
        for (lines, line, keyword) in [
            ("FIELDS x y z a\nSIZE 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n", 4, "SIZE"),
            ("FIELDS x y z a\nSIZE 4 4 4 1\nTYPE F F F\nCOUNT 1 1 1 1\n", 5, "TYPE"),
            ("FIELDS x y z a\nSIZE 4 4 4 1\nTYPE F F F U\nCOUNT 1 1 1\n", 6, "COUNT"),
            ("FIELDS x y z\nSIZE 4 4 4 1\nTYPE F F F\nCOUNT 1 1 1\n", 4, "SIZE"),
            ("FIELDS x y z a\nSIZE\nTYPE F F F U\n", 4, "SIZE"),
        ] {
            let fault = fault(&format!("{lines}{rest}"));
            assert_eq!(fault.place, Place::Line(line), "{lines}");
            assert!(fault.problem.starts_with(keyword), "{}", fault.problem);
            assert!(
                fault.problem.contains("x y z") && fault.problem.contains("line 3"),
                "{}",
                fault.problem
            );
        }
        let odd = fault("FIELDS x y z a\nSIZE 4 4 4 3\nTYPE F F F F\nPOINTS 1\nDATA binary\n");
        assert!(
            odd.place == Place::Line(4) && odd.problem.contains("`a` is 3"),
            "{odd:?}"
        );
        for (lines, line) in [
            ("WIDTH x\nDATA ascii\n", 6),
            ("POINTS -1\nDATA ascii\n", 6),
            ("POINTS 1\nDATA base64\n", 7),
        ] {
            assert_eq!(fault(&format!("{FIELDS}{lines}")).place, Place::Line(line), "{lines}");
        }
        for lines in ["DATA ascii\n", "POINTS 1\n"] {
            assert_eq!(fault(&format!("{FIELDS}{lines}")).place, Place::Header, "{lines}");
        }
    }

    #[test]
    fn unknown_lines_are_skipped_with_a_warning() {
        let header = parse(&format!(
            "{FIELDS}COORDINATES utm 32N\nWIDTH 3\nHEIGHT 1\nVIEWPOINT 0 0 0\nPOINTS 2\nDATA Binary\n"
        ));
        assert_eq!((header.points, header.encoding), (2, Encoding::Binary));
        let [unknown, viewpoint, points] = [0, 1, 2].map(|place: usize| header.warnings[place].as_str());
        assert!(
            unknown.contains("line 6") && unknown.contains("COORDINATES"),
            "{unknown}"
        );
        assert!(points.contains("VIEWPOINT") || viewpoint.contains("VIEWPOINT"));
        assert!(
            header
                .warnings
                .iter()
                .any(|warning| warning.contains("line 10: POINTS is 2"))
        );
    }

    #[test]
    fn types_are_recognised_by_letter_and_name() {
        let header = parse(
            "FIELDS x y z a b c d e\nSIZE 4 8 8 1 8 2 2 3\nTYPE F double float64 UINT8 INT64 u F U\nPOINTS 1\n\
             DATA binary\n",
        );
        let scalars: Vec<Option<Scalar>> = header.fields.iter().map(|field| field.scalar).collect();
        let known = [
            Scalar::F32,
            Scalar::F64,
            Scalar::F64,
            Scalar::U8,
            Scalar::I64,
            Scalar::U16,
        ];
        assert_eq!(scalars[..6], known.map(Some));
        assert_eq!(scalars[6..], [None, None]);
        assert!(header.warnings.iter().any(|warning| warning.contains("`d`")));
    }

    #[test]
    fn duplicate_names_and_excessive_counts_are_handled() {
        let header = parse("FIELDS x y z q q _ _\nSIZE 4 4 4 4 4 1 1\nTYPE F F F F F U U\nPOINTS 1\nDATA ascii\n");
        let names: Vec<&str> = header.fields.iter().map(|field| field.name.as_str()).collect();
        assert_eq!(names, ["x", "y", "z", "q", "q_2", "_", "_"]);
        assert!(header.warnings[0].contains("line 3") && header.warnings[0].contains("`q`"));
        let header = parse(
            "FIELDS x y z d e\nSIZE 4 4 4 4 4\nTYPE F F F F F\nCOUNT 1 1 1 4294967295 33\nPOINTS 0\nDATA binary\n",
        );
        assert_eq!(header.fields[3].scalar, None);
        assert_eq!(header.fields[4].number_name(32), "e_32");
        assert!(header.warnings[0].contains("skipped: d"), "{:?}", header.warnings);
        let header = parse("FIELDS x y z\nSIZE 4 1 4\nTYPE F U I\nCOUNT 1 3 1\nPOINTS 0\nDATA ascii\n");
        assert_eq!(
            [0, 1, 2].map(|place| header.fields[1].number_name(place)),
            ["y", "y_1", "y_2"]
        );
    }
}
