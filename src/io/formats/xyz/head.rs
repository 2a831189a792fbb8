//! The lines before the first row, and the shape of the rows.

use super::dialect::{Cell, Dialect, comment, hex_color, is_title, sample, seconds_of};
use super::rows::{Cells, Kind, trimmed};
use crate::io::columns::column_names::{Words, axes};
use crate::io::error::{Fault, Place};

/// Max columns of a table of points.
pub(super) const MAX_COLUMNS: usize = 4096;

/// Rows whose values tell the kinds of columns.
const SAMPLE_ROWS: usize = 256;

/// A line of names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    /// As they are written, without quotes.
    pub(super) names: Vec<String>,
    /// Counted from 1.
    pub(super) line: usize,
    pub(super) is_comment: bool,
}

/// Everything that is known before the rows are parsed.
#[derive(Debug)]
pub(super) struct Head {
    pub(super) dialect: Dialect,
    pub(super) header: Option<Header>,
    /// The last comment or title before the first row, and its line.
    pub(super) title: Option<(usize, String)>,
    /// Points by the lone number before the first one.
    pub(super) claimed: Option<usize>,
    /// Cells of a row; `None` if there are no rows.
    pub(super) width: Option<usize>,
    /// Cell kinds of the first rows.
    pub(super) kinds: Vec<Kind>,
    /// The numbers in the first rows, column by column; missing where there is none.
    pub(super) sample: Vec<Vec<f64>>,
    /// True if the first cells of the first rows are words, or count from 0 or 1.
    pub(super) first_is_index: bool,
    /// Byte offset of the first row.
    pub(super) byte_count: usize,
    pub(super) line_count: usize,
}

/// A number of points that fits into a memory.
pub(super) fn count_of_points(value: f64) -> Option<usize> {
    const MAX_POINTS: f64 = 1e12;
    (value.fract() == 0.0 && (0.0..=MAX_POINTS).contains(&value)).then_some(value as usize)
}

impl Head {
    pub(super) fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let mut head = Self {
            dialect: Dialect::of(bytes),
            header: None,
            title: None,
            claimed: None,
            width: None,
            kinds: Vec::new(),
            sample: Vec::new(),
            first_is_index: false,
            byte_count: 0,
            line_count: 0,
        };
        let mut candidates: Vec<Header> = Vec::new();
        for line in bytes.split_inclusive(|&byte| byte == b'\n') {
            let content = trimmed(line, head.dialect);
            if let Some(text) = comment(content).or_else(|| is_title(content).then_some(content)) {
                let title = String::from_utf8_lossy(text).trim().to_owned();
                head.title = Some((head.line_count + 1, title));
            }
            if let Some(comment) = comment(content) {
                candidates.extend(head.names(comment, true));
            } else if !content.is_empty() && !is_title(content) {
                let cells = Cells::new(head.dialect, content).all();
                if is_row(&cells) && !is_header(&head, content, &cells, &bytes[head.byte_count + line.len()..]) {
                    head.take_shape(&bytes[head.byte_count..]);
                    if head.width.is_some() {
                        head.header = head.choose(&candidates);
                        return Ok(head);
                    }
                }
                head.take_line(content, &cells, &mut candidates)?;
            }
            head.byte_count += line.len();
            head.line_count += 1;
        }
        head.header = head.choose(&candidates);
        Ok(head)
    }

    /// A line before the first row that is not a comment: names, a title, or a count of the points.
    fn take_line(&mut self, content: &[u8], cells: &[Cell<'_>], candidates: &mut Vec<Header>) -> Result<(), Fault> {
        let is_number = |cell: &Cell<'_>| matches!(cell, Cell::Number(number) if !number.is_nan());
        let numbers = cells.iter().filter(|cell| is_number(cell)).count();
        if let [Cell::Number(number)] = cells
            && self.claimed.is_none_or(|claimed| claimed == 0)
            && let Some(count) = count_of_points(*number)
        {
            self.claimed = Some(count);
            return Ok(());
        }
        let is_numeric = numbers > 0 && numbers == cells.len();
        if is_numeric && !is_range(cells) {
            return Err(Fault::new(
                Place::Line(self.line_count + 1),
                format!("found {numbers} numbers, expected x y z and what follows them"),
            ));
        }
        candidates.extend(self.names(content, false));
        Ok(())
    }

    fn names(&self, text: &[u8], is_comment: bool) -> Option<Header> {
        let names = match of_letters(text).filter(|_| is_comment) {
            Some(names) => names,
            None => names_in(without_key(text), self.dialect),
        };
        (!names.is_empty()).then(|| Header {
            names,
            line: self.line_count + 1,
            is_comment,
        })
    }

    /// The kinds of columns in the rows at the start of `rows`.
    fn take_shape(&mut self, rows: &[u8]) {
        let dialect = self.dialect;
        let lines = sample(rows)
            .split(|&byte| byte == b'\n')
            .map(|line| trimmed(line, dialect));
        let lines = lines.filter(|line| !line.is_empty() && comment(line).is_none());
        let rows: Vec<Vec<&[u8]>> = lines
            .take(SAMPLE_ROWS)
            .filter(|line| is_row(&Cells::new(dialect, line).all()))
            .map(|line| Cells::new(dialect, line).words())
            .collect();
        let Some(width) = usual_width(&rows) else { return };
        if !(3..=MAX_COLUMNS).contains(&width) {
            return;
        }
        let kind = |column: usize| {
            let words = rows.iter().filter(|row| row.len() >= width).map(|row| row[column]);
            let (mut numbers, mut times, mut others, mut colors) = (0, 0, 0, 0);
            for word in words.filter(|word| !word.is_empty()) {
                match dialect.number_of(word) {
                    Some(_) => numbers += 1,
                    None if seconds_of(word).is_some() => times += 1,
                    None if hex_color(word).is_some() => colors += 1,
                    None => others += 1,
                }
            }
            if colors > numbers + times + others {
                Kind::Hex
            } else if numbers >= times + others + colors {
                Kind::Number
            } else if times > others + colors {
                Kind::Time
            } else {
                Kind::Text
            }
        };
        self.width = Some(width);
        self.kinds = (0..width).map(kind).collect();
        let number = |row: &Vec<&[u8]>, column: usize| dialect.number_of(row[column]).unwrap_or(f64::NAN);
        let full = || rows.iter().filter(|row| row.len() >= width);
        self.sample = (0..width)
            .map(|column| full().map(|row| number(row, column)).collect())
            .collect();
        let first = |row: &Vec<&[u8]>| row.first().and_then(|word| dialect.number_of(word));
        let firsts: Vec<f64> = rows.iter().filter_map(first).collect();
        let start = firsts.first().copied().unwrap_or(f64::NAN);
        let counts = firsts
            .iter()
            .enumerate()
            .all(|(row, number)| *number == start + row as f64);
        self.first_is_index = self.kinds[0] == Kind::Text || (counts && (start == 0.0 || start == 1.0));
    }

    /// The line of names among those before the first row: the last one that has coordinates, else the last one that is
    /// not a comment and has one name per column.
    fn choose(&self, candidates: &[Header]) -> Option<Header> {
        let has_axes = |header: &&Header| axes(&strs(&header.names)).is_some();
        let fits = |header: &&Header| self.width.is_some_and(|width| names_fit(header.names.len(), width));
        let lines = candidates.iter().rev();
        let named = lines
            .clone()
            .filter(|header| self.width.is_none() || fits(header))
            .find(has_axes);
        let named = named.or_else(|| lines.clone().find(|header| has_axes(header) && !header.is_comment));
        let named = named.or_else(|| lines.clone().find(|header| !header.is_comment && fits(header)));
        // Names in a comment that are not coordinates: code that interprets them must not be overruled.
        let are_names = |header: &&Header| self.width == Some(header.names.len()) && are_names(&header.names);
        named.or_else(|| lines.clone().find(are_names)).cloned()
    }
}

/// True for the number of names of rows of `width` cells: R has none for the names of rows, others a separator more.
pub(super) fn names_fit(names: usize, width: usize) -> bool {
    names == width || names + 1 == width || names == width + 1
}

/// Names as `&str`.
pub(super) fn strs(names: &[String]) -> Vec<&str> {
    names.iter().map(String::as_str).collect()
}

/// A list of names without Tecplot's prefix, `VARIABLES = "X", "Y"`.
fn without_key(text: &[u8]) -> &[u8] {
    const KEY: &[u8] = b"variables";
    let begin = text.trim_ascii_start();
    let has_key = begin
        .get(..KEY.len())
        .is_some_and(|word| word.eq_ignore_ascii_case(KEY));
    let list = begin.get(KEY.len()..).map(<[u8]>::trim_ascii_start).unwrap_or_default();
    list.strip_prefix(b"=").filter(|_| has_key).unwrap_or(text)
}

/// Words typical of sentences.
const SENTENCE_WORDS: [&str; 32] = [
    "are",
    "is",
    "was",
    "the",
    "of",
    "a",
    "an",
    "by",
    "with",
    "for",
    "from",
    "in",
    "on",
    "to",
    "and",
    "this",
    "that",
    "here",
    "made",
    "created",
    "exported",
    "generated",
    "written",
    "file",
    "version",
    "date",
    "number",
    "points",
    "total",
    "using",
    "data",
    "as",
];

/// Words of columns, other than coordinates.
const COLUMN_WORDS: [&str; 54] = [
    "x",
    "y",
    "z",
    "tx",
    "ty",
    "tz",
    "qx",
    "qy",
    "qz",
    "qw",
    "vx",
    "vy",
    "vz",
    "nx",
    "ny",
    "nz",
    "r",
    "g",
    "b",
    "red",
    "green",
    "blue",
    "range",
    "azimuth",
    "elevation",
    "inclination",
    "distance",
    "angle",
    "theta",
    "phi",
    "rho",
    "power",
    "snr",
    "rcs",
    "doppler",
    "velocity",
    "speed",
    "intensity",
    "reflectivity",
    "amplitude",
    "time",
    "timestamp",
    "t",
    "frame",
    "id",
    "index",
    "label",
    "class",
    "ring",
    "row",
    "col",
    "roll",
    "pitch",
    "yaw",
];

/// True if most words are names of columns and none is typical of a sentence.
fn are_names(names: &[String]) -> bool {
    let words: Vec<Vec<String>> = names.iter().map(|name| Words::of(name).words).collect();
    let has = |words: &[String], known: &[&str]| words.iter().any(|word| known.contains(&word.as_str()));
    let known = words.iter().filter(|words| has(words, &COLUMN_WORDS)).count();
    let is_sentence = words.iter().any(|words| has(words, &SENTENCE_WORDS));
    let begins_as_name = |name: &String| name.starts_with(|sign: char| sign.is_alphabetic() || sign == '"');
    known * 2 >= names.len().max(4) && !is_sentence && names.iter().all(begins_as_name)
}

/// The names of columns that the letters of `LAStools` stand for, as in `% xyziRGB`; `None` of another word.
fn of_letters(text: &[u8]) -> Option<Vec<String>> {
    const LETTERS: [(u8, &str); 16] = [
        (b'x', "x"),
        (b'y', "y"),
        (b'z', "z"),
        (b'i', "intensity"),
        (b'a', "scan_angle"),
        (b'r', "return_number"),
        (b'n', "number_of_returns"),
        (b'c', "classification"),
        (b'u', "user_data"),
        (b'p', "point_source_id"),
        (b't', "gps_time"),
        (b'e', "edge_of_flight_line"),
        (b'd', "scan_direction"),
        (b'R', "red"),
        (b'G', "green"),
        (b'B', "blue"),
    ];
    let word = text.trim_ascii();
    let name = |letter: &u8| LETTERS.iter().find(|(known, _)| known == letter);
    let names: Option<Vec<String>> = word.iter().map(|letter| Some(name(letter)?.1.to_owned())).collect();
    names.filter(|names| {
        ["x", "y", "z"]
            .iter()
            .all(|axis| names.iter().filter(|name| name == axis).count() == 1)
    })
}

/// The cells of a line of names. In the white space of names that have units behind them, `X (m)`, these belong to the
/// name before.
pub(super) fn names_in(text: &[u8], dialect: Dialect) -> Vec<String> {
    let text = text.trim_ascii_end();
    let text = if dialect.mark == Some(b'\t') {
        text
    } else {
        text.trim_ascii()
    };
    // Names may be separated by other characters than the cells are: `# x, y, z`.
    let has = |mark: u8| text.split(|&byte| byte == mark).count() > 2;
    let own = dialect.mark.filter(|mark| text.contains(mark));
    let mark = own.or_else(|| [b';', b'\t', b','].into_iter().find(|mark| has(*mark)));
    let words = Cells::new(
        Dialect {
            mark,
            decimal_comma: false,
        },
        text,
    )
    .words();
    let mut names: Vec<String> = Vec::new();
    for word in words.into_iter().take(MAX_COLUMNS) {
        let word = String::from_utf8_lossy(word);
        let word = word.trim().trim_matches(['"', '\'']).trim();
        match names.last_mut() {
            Some(last) if mark.is_none() && word.starts_with(['(', '[']) => {
                last.push(' ');
                last.push_str(word);
            }
            _ => names.push(word.to_owned()),
        }
    }
    while names.len() > 3 && names.last().is_some_and(String::is_empty) {
        names.pop();
    }
    names
}

/// True for a line with a number in three or more cells, or with cells for them.
fn is_row(cells: &[Cell<'_>]) -> bool {
    let number = |cell: &Cell<'_>| match cell {
        Cell::Number(number) => Some(*number),
        Cell::Text(_) => None,
    };
    let numbers: Vec<f64> = cells.iter().filter_map(number).collect();
    let known = numbers.iter().filter(|number| !number.is_nan()).count();
    numbers.len() >= 3 && (known > 0 || numbers.len() == cells.len() && cells.len() >= 3)
}

/// True for a line of names with some numbers among them, and for one that numbers the columns.
fn is_header(head: &Head, content: &[u8], cells: &[Cell<'_>], behind: &[u8]) -> bool {
    let has_words = cells.iter().any(|cell| matches!(cell, Cell::Text(_)));
    if has_words {
        return axes(&strs(&names_in(content, head.dialect))).is_some();
    }
    // pandas numbers columns without names: 0, 1, 2, and values with fractions follow.
    let next = behind
        .split(|&byte| byte == b'\n')
        .map(|line| trimmed(line, head.dialect));
    let has_fraction = |line: &[u8]| {
        let is_fraction = |cell: &Cell<'_>| matches!(cell, Cell::Number(number) if number.fract() != 0.0);
        Cells::new(head.dialect, line).all().iter().any(is_fraction)
    };
    head.dialect.mark.is_some() && head.line_count == 0 && is_range(cells) && next.take(1).any(has_fraction)
}

/// True for 0, 1, 2 and so on, an empty cell before them or not.
fn is_range(cells: &[Cell<'_>]) -> bool {
    let cells = match cells {
        [Cell::Number(number), rest @ ..] if number.is_nan() => rest,
        cells => cells,
    };
    let mut numbered = cells.iter().enumerate();
    cells.len() >= 3 && numbered.all(|(index, cell)| *cell == Cell::Number(index as f64))
}

/// The number of cells that most rows have, without one that is empty in all of them behind the last mark.
fn usual_width(rows: &[Vec<&[u8]>]) -> Option<usize> {
    let mut widths: Vec<usize> = rows.iter().map(Vec::len).collect();
    let first = *widths.first()?;
    widths.sort_unstable();
    let median = widths[widths.len() / 2];
    // With only two rows, the first one is right.
    let width = if widths.len() < 3 { first } else { median };
    let mut last = rows
        .iter()
        .filter(|row| row.len() == width)
        .filter_map(|row| row.last());
    let is_empty = width > 3 && last.all(|word| word.is_empty());
    Some(if is_empty { width - 1 } else { width })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(text: &str) -> Head {
        Head::read(text.as_bytes()).unwrap_or_else(|fault| panic!("{text:?}: {fault:?}"))
    }

    #[test]
    fn headers_are_found_before_the_rows() {
        for (text, names, width) in [
            ("x y z\n1 2 3\n", "x|y|z", 3),
            ("# made by a scanner\n# x, y, z\n1 2 3\n", "x|y|z", 3),
            ("//X Y Z Rf\n1 2 3 4\n", "X|Y|Z|Rf", 4),
            ("% x y z\n1 2 3\n", "x|y|z", 3),
            ("; x y z\n1 2 3\n", "x|y|z", 3),
            (",x,y,z\n0,1.5,2,3\n1,2.5,3,4\n", "|x|y|z", 4),
            ("\"x\" \"y\" \"z\"\n\"1\" 1 2 3\n\"2\" 1 2 3\n", "x|y|z", 4),
            ("X (m) Y (m) Z (m)\n1 2 3\n", "X (m)|Y (m)|Z (m)", 3),
            ("My survey of 2024\nx;y;z\n1;2;3\n4;5;6\n", "x|y|z", 3),
            ("x,y,z,450,500,550\n1,2,3,4,5,6\n1,2,3,4,5,6\n", "x|y|z|450|500|550", 6),
            ("a,b,c\n1,2,3\n1,2,3\n", "a|b|c", 3),
            (",0,1,2\n0,0.5,1.5,2.5\n1,0.5,1.5,2.5\n", "|0|1|2", 4),
            (
                "# range azimuth elevation power\n1 2 3 4\n",
                "range|azimuth|elevation|power",
                4,
            ),
            (
                "# timestamp tx ty tz qx qy qz qw\n9 1 2 3 0 0 0 1\n",
                "timestamp|tx|ty|tz|qx|qy|qz|qw",
                8,
            ),
            (
                "% scale 0.01\n% xyziRGB\n1 2 3 4 5 6 7\n",
                "x|y|z|intensity|red|green|blue",
                7,
            ),
            ("VARIABLES = \"X\", \"Y\", \"Z\"\nZONE I=2\n1 2 3\n", "X|Y|Z", 3),
        ] {
            let head = head(text);
            let header = head.header.unwrap_or_else(|| panic!("{text:?}: no names"));
            assert_eq!(
                (header.names.join("|").as_str(), head.width),
                (names, Some(width)),
                "{text:?}"
            );
        }
        for text in [
            "1 2 3\n",
            "# four words are here\n1 2 3 4\n",
            "0 1 2\n3 4 5\n",
            "2\n1 2 3\n4 5 6\n",
            "Frame 0\n1 2 3\n4 5 6\n",
            "# x of y\n1 2 3\n4 5 6\n",
        ] {
            assert_eq!(head(text).header, None, "{text:?}");
        }
    }

    #[test]
    fn column_kinds_are_those_of_most_rows() {
        let head = head("t,x,y,z,label,s\n10:00:00,1,2,3,car,1\n10:00:01,1,2,,bus,\n10:00:02,1,2,3,,1\n");
        assert_eq!(
            head.kinds,
            [
                Kind::Time,
                Kind::Number,
                Kind::Number,
                Kind::Number,
                Kind::Text,
                Kind::Number
            ]
        );
    }
}
