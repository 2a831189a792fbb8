//! Text dialect: cell separators and number notation, determined from the first lines.

use crate::io::columns::numbers::parse_number;
use crate::io::files::timestamps::time_of_text;

/// Text dialect: the cell separator and the number notation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::io) struct Dialect {
    /// `1,5` is one and a half, not two numbers.
    pub(in crate::io) decimal_comma: bool,
    /// The sign between cells, which may have spaces in them or be empty. `None`: white space, commas and semicolons
    /// separate, in any mix.
    pub(in crate::io) mark: Option<u8>,
}

/// Signs that separate cells, the surest first: a comma may be a decimal one as well.
const MARKS: [u8; 4] = [b';', b'\t', b'|', b','];

/// Words for a value that is missing.
const MISSING: [&str; 16] = [
    "", "na", "n/a", "null", "none", "nil", "-", "--", "?", "#n/a", "#name?", "#div/0!", "#value!", "#ref!", "#num!",
    "#null!",
];

/// Number of examined bytes of a text.
pub(super) const SAMPLE_BYTES: usize = 64 << 10;

/// The beginning of `text`, whole lines of it.
pub(super) fn sample(text: &[u8]) -> &[u8] {
    let head = &text[..text.len().min(SAMPLE_BYTES)];
    // The last line may be truncated within a number.
    match head.iter().rposition(|&byte| byte == b'\n') {
        Some(end) if head.len() < text.len() => &head[..end],
        _ => head,
    }
}

/// Meaning of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cell<'a> {
    /// A number, or NaN where it is missing.
    Number(f64),
    /// Without quotes.
    Text(&'a [u8]),
}

impl Dialect {
    /// White space and marks in any mix.
    pub(in crate::io) const MIXED: Self = Self {
        decimal_comma: false,
        mark: None,
    };

    /// Determined from the first lines of `text`.
    pub(super) fn of(text: &[u8]) -> Self {
        let lines: Vec<&[u8]> = sample(text)
            .split(|&byte| byte == b'\n')
            .map(<[u8]>::trim_ascii)
            .filter(|line| !line.is_empty())
            .collect();
        let decimal_comma = has_decimal_commas(&lines);
        let is_mark = |mark: &u8| !(decimal_comma && *mark == b',') && separates(&lines, *mark);
        Self {
            decimal_comma,
            mark: MARKS.into_iter().find(is_mark),
        }
    }

    /// True for the signs between two cells even if one of them is empty.
    pub(super) fn is_mark(self, byte: u8) -> bool {
        match self.mark {
            Some(mark) => byte == mark,
            None => byte == b';' || (byte == b',' && !self.decimal_comma),
        }
    }

    /// True for white space that separates cells or surrounds them.
    pub(super) fn is_space(self, byte: u8) -> bool {
        matches!(byte, b' ' | b'\t' | b'\r' | 0x0b | 0x0c) && self.mark != Some(byte)
    }

    /// The meaning of the word in a cell.
    pub(super) fn meaning(self, word: &[u8]) -> Cell<'_> {
        match self.number_of(word) {
            Some(number) => Cell::Number(number),
            None => Cell::Text(word),
        }
    }

    /// A number with a decimal comma or with groups of thousands, or one that is missing; `None` of other words.
    pub(super) fn number_of(self, word: &[u8]) -> Option<f64> {
        /// Longer ones are not numbers.
        const MAX_DIGITS: usize = 64;
        if word.len() > MAX_DIGITS {
            return None;
        }
        let text = std::str::from_utf8(word).ok()?;
        if MISSING.iter().any(|missing| text.eq_ignore_ascii_case(missing)) {
            return Some(f64::NAN);
        }
        if let Some(number) = parse_number(word).or_else(|| of_fortran(text)) {
            return Some(number);
        }
        let (point, group) = if self.decimal_comma { (',', '.') } else { ('.', ',') };
        parse_number(without_groups(text, point, group)?.as_bytes())
    }
}

/// A number whose exponent Fortran marks as one of double precision: `1.5D-03`.
fn of_fortran(text: &str) -> Option<f64> {
    let (mantissa, exponent) = text.split_once(['D', 'd'])?;
    let starts_as_number = mantissa.ends_with(|sign: char| sign.is_ascii_digit() || sign == '.');
    starts_as_number.then(|| parse_number(format!("{mantissa}e{exponent}").as_bytes()))?
}

/// Red, green, blue and alpha in hexadecimal digits: `#rrggbb` or `0xrrggbb`, with two digits more for alpha.
pub(super) fn hex_color(word: &[u8]) -> Option<[u8; 4]> {
    let digits = word
        .strip_prefix(b"#")
        .or_else(|| word.strip_prefix(b"0x"))
        .or_else(|| word.strip_prefix(b"0X"))?;
    let number = u32::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()?;
    match digits.len() {
        6 => Some((number << 8 | 0xff).to_be_bytes()),
        8 => Some(number.to_be_bytes()),
        _ => None,
    }
}

/// True for a line that names the block of rows behind it: `Frame 3`, `t = 0.5 s`, and `ZONE` of Tecplot.
pub(super) fn is_title(line: &[u8]) -> bool {
    const WORDS: [&str; 9] = [
        "frame",
        "step",
        "timestep",
        "time",
        "t",
        "scan",
        "sweep",
        "snapshot",
        "timestamp",
    ];
    /// Longer lines have more in them.
    const MAX_BYTES: usize = 64;
    let end = line
        .iter()
        .position(|byte| !byte.is_ascii_alphabetic())
        .unwrap_or(line.len());
    let (word, rest) = line.split_at(end);
    if word.eq_ignore_ascii_case(b"zone") {
        return rest.first().is_none_or(u8::is_ascii_whitespace);
    }
    if line.len() > MAX_BYTES || !WORDS.iter().any(|known| word.eq_ignore_ascii_case(known.as_bytes())) {
        return false;
    }
    let rest = String::from_utf8_lossy(rest);
    let rest = rest.trim_start_matches([' ', '\t', ':', '=', '#', '_', '-']);
    let mut words = rest.split_ascii_whitespace();
    let is_number = |word: &str| parse_number(word.trim_end_matches([':', 's']).as_bytes()).is_some();
    words.next().is_some_and(is_number) && words.next().is_none_or(|word| !is_number(word)) && words.next().is_none()
}

/// The number in `text` with a decimal point and without the signs that group its thousands; `None` where it is none.
fn without_groups(text: &str, point: char, group: char) -> Option<String> {
    const GROUP_DIGITS: usize = 3;
    let (whole, fraction) = match text.split_once(point) {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (text, None),
    };
    let unsigned = whole.trim_start_matches(['+', '-']);
    let is_group = |sign: char| sign == group || [' ', '\'', '\u{a0}', '\u{202f}', '’'].contains(&sign);
    let mut groups = unsigned.split(is_group);
    let first = groups.next()?;
    let is_digits = |digits: &str| digits.bytes().all(|byte| byte.is_ascii_digit());
    let groups: Vec<&str> = groups.collect();
    let is_grouped = groups
        .iter()
        .all(|digits| digits.len() == GROUP_DIGITS && is_digits(digits));
    let is_first = is_digits(first) && (groups.is_empty() || (1..=GROUP_DIGITS).contains(&first.len()));
    let has_digits = !first.is_empty() || fraction.is_some_and(|fraction| !fraction.is_empty());
    let is_fraction = fraction.is_none_or(|fraction| !fraction.contains(group));
    if !is_grouped || !is_first || !has_digits || !is_fraction {
        return None;
    }
    let sign = &whole[..whole.len() - unsigned.len()];
    let mut number = format!("{sign}{first}{}", groups.concat());
    if let Some(fraction) = fraction {
        number.push('.');
        number.push_str(fraction);
    }
    Some(number)
}

/// True where commas are decimal ones: three or more words of a line that are like numbers have one comma each, between
/// digits, and none has another comma or a point behind it.
fn has_decimal_commas(lines: &[&[u8]]) -> bool {
    let mut has_comma = false;
    for line in lines {
        let words = line
            .split(|byte| b" \t;|\"".contains(byte))
            .filter(|word| !word.is_empty());
        let is_number = |word: &&[u8]| word.iter().all(|byte| b"0123456789+-.,eE".contains(byte));
        let mut numbers = 0;
        let mut has_comma_here = false;
        for word in words.filter(is_number) {
            numbers += 1;
            let commas = word.split(|&byte| byte == b',').count() - 1;
            if commas == 0 {
                continue;
            }
            let text = std::str::from_utf8(word).unwrap_or("");
            let is_between_digits = word
                .windows(3)
                .any(|three| three[1] == b',' && three[0].is_ascii_digit() && three[2].is_ascii_digit());
            let number = without_groups(text, ',', '.');
            let is_decimal = number.is_some_and(|number| parse_number(number.as_bytes()).is_some());
            if commas > 1 || !is_between_digits || !is_decimal {
                return false;
            }
            has_comma_here = true;
        }
        if has_comma_here && numbers < 3 {
            return false;
        }
        has_comma |= has_comma_here;
    }
    has_comma
}

/// True where nearly every line has the same number of `mark`s, which separate cells.
fn separates(lines: &[&[u8]], mark: u8) -> bool {
    /// Marks of a line, and one less where the last of them ends it.
    fn counts(line: &[u8], mark: u8) -> [usize; 2] {
        let mut is_quoted = false;
        let mut count = 0;
        for &byte in line {
            is_quoted ^= byte == b'"';
            count += usize::from(byte == mark && !is_quoted);
        }
        [count, count - usize::from(line.last() == Some(&mark) && count > 0)]
    }
    const MIN_MARKS: usize = 2;
    let lines = lines.iter().filter(|line| comment(line).is_none());
    let counted: Vec<(&[u8], [usize; 2])> = lines.map(|line| (*line, counts(line, mark))).collect();
    // Lines of text before and after the table, and a point count, are not evidence.
    let of_rows = |(line, [all, _]): &&(&[u8], [usize; 2])| {
        *all >= MIN_MARKS || line.iter().filter(|byte| byte.is_ascii_digit()).count() > 2
    };
    let rows: Vec<&(&[u8], [usize; 2])> = counted.iter().filter(of_rows).collect();
    let mut numbers: Vec<usize> = rows.iter().map(|(_, [all, _])| *all).collect();
    numbers.sort_unstable();
    let Some(&usual) = numbers.get(numbers.len() / 2).filter(|&&usual| usual >= MIN_MARKS) else {
        return false;
    };
    let fits = |(_, counts): &&&(&[u8], [usize; 2])| counts.contains(&usual) || counts[0] + 1 == usual;
    let fitting: Vec<&&(&[u8], [usize; 2])> = rows.iter().filter(fits).collect();
    // Nine out of ten lines.
    if fitting.len() * 10 < rows.len() * 9 {
        return false;
    }
    // Where tabs and spaces align columns, there are columns that are empty in every line.
    let is_empty_in_all = |column: usize| {
        let mut cells = fitting
            .iter()
            .map(|(line, _)| line.split(|&byte| byte == mark).nth(column));
        cells.all(|cell| cell.is_some_and(|cell| cell.trim_ascii().is_empty()))
    };
    if mark == b'\t' && (0..usual).any(is_empty_in_all) {
        return false;
    }
    // Several numbers between two separators: the separator groups cells.
    let is_list = |cell: &[u8]| {
        let words = cell.split(u8::is_ascii_whitespace);
        let words: Vec<&[u8]> = words.filter(|word| !word.is_empty()).collect();
        let text = String::from_utf8_lossy(cell.trim_ascii());
        words.len() > 1
            && words.iter().all(|word| parse_number(word).is_some())
            && without_groups(&text, '.', ',').is_none()
    };
    let lists = fitting
        .iter()
        .filter(|(line, _)| line.split(|&byte| byte == mark).any(is_list))
        .count();
    lists * 10 < fitting.len()
}

/// A time of day, or a date with one, in seconds.
pub(super) fn seconds_of(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    let starts_with_digit = text.bytes().next().is_some_and(|byte| byte.is_ascii_digit());
    if !starts_with_digit || !text.contains(':') {
        return None;
    }
    time_of_text(text).map(|time| time.as_secs_f64())
}

/// The text behind the mark of a comment.
pub(super) fn comment(line: &[u8]) -> Option<&[u8]> {
    match line {
        // Spreadsheets write errors like this: the first cell is missing.
        [b'#', ..] if begins_with_error(line) => None,
        [b'/', b'/', rest @ ..] | [b'#' | b'%' | b'!', rest @ ..] => Some(rest),
        // Where semicolons separate cells, the first one may be empty.
        [b';', rest @ ..] if !rest.contains(&b';') => Some(rest),
        _ => None,
    }
}

/// True where the first cell is `#N/A` or another error of a spreadsheet.
fn begins_with_error(line: &[u8]) -> bool {
    let end = line
        .iter()
        .position(|byte| b",;\t| ".contains(byte))
        .unwrap_or(line.len());
    let is_error = |word: &&str| word.starts_with('#') && line[..end].eq_ignore_ascii_case(word.as_bytes());
    MISSING.iter().any(is_error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreadsheet_errors_are_not_comments() {
        assert_eq!(comment(b"#N/A,#N/A,1"), None);
        assert_eq!(comment(b"#DIV/0!;1;2"), None);
        assert_eq!(comment(b"# N/A means missing"), Some(b" N/A means missing".as_slice()));
        assert_eq!(comment(b"#name x y z"), Some(b"name x y z".as_slice()));
        assert!(Dialect::MIXED.number_of(b"#N/A").is_some_and(f64::is_nan));
    }

    #[test]
    fn blocks_may_have_titles() {
        for title in [
            "Frame 0",
            "frame: 12",
            "t = 0.5",
            "Time=0.5 ps",
            "TIMESTEP 3",
            "scan_7",
            "ZONE I=3, F=POINT",
        ] {
            assert!(is_title(title.as_bytes()), "{title}");
        }
        for other in [
            "frame,x,y,z",
            "t 1 2 3",
            "time x y z",
            "frame 1 2",
            "zones",
            "1 2 3",
            "framework 3",
        ] {
            assert!(!is_title(other.as_bytes()), "{other}");
        }
    }

    #[test]
    fn colors_may_be_hexadecimal() {
        assert_eq!(hex_color(b"#5add76"), Some([0x5a, 0xdd, 0x76, 255]));
        assert_eq!(hex_color(b"0x5ADD7680"), Some([0x5a, 0xdd, 0x76, 0x80]));
        for other in [b"5add76".as_slice(), b"#5add7", b"#gggggg", b"0x12"] {
            assert_eq!(hex_color(other), None);
        }
        assert_eq!(Dialect::MIXED.number_of(b"-1.5D-03"), Some(-0.0015));
        assert_eq!(Dialect::MIXED.number_of(b"3D"), None);
    }

    #[test]
    fn commas_and_decimal_marks_are_determined_by_their_neighbours() {
        for (text, decimal_comma, mark) in [
            ("1,5;2,5;3,5\n", true, Some(b';')),
            ("1,5 2,5 3,5\n", true, None),
            ("1\t2\t3,25\n", true, Some(b'\t')),
            ("x;y;z\n1,5;2,5;3,5\n", true, Some(b';')),
            ("car;1,5;2,5;3,5\n", true, Some(b';')),
            ("1.234,5;2.345,25;3,5\n", true, Some(b';')),
            ("1,234.5;2,345.25;3.5\n", false, Some(b';')),
            ("1,2,3\n", false, Some(b',')),
            ("1, 2, 3\n", false, Some(b',')),
            ("1.5 2.5 3.5\n", false, None),
            ("1,2,3 4,5,6 7,8,9\n", false, None),
            ("1.5,2;3;4\n", false, Some(b';')),
            ("x,y,z,label\n1,2,3,a b\n1,2,3,\n", false, Some(b',')),
            ("x,y,z\n1.5,2.5,3.5,\n", false, Some(b',')),
            ("1\t\t2\t\t3\n4\t\t5\t\t6\n", false, None),
            (
                "2024-05-01 10:00:00,1,2,3\n2024-05-01 10:00:01,1,2,3\n",
                false,
                Some(b','),
            ),
        ] {
            let dialect = Dialect { decimal_comma, mark };
            assert_eq!(Dialect::of(text.as_bytes()), dialect, "{text:?}");
        }
    }

    #[test]
    fn numbers_may_have_groups_of_thousands() {
        let point = Dialect {
            mark: Some(b';'),
            ..Dialect::MIXED
        };
        let comma = Dialect {
            decimal_comma: true,
            ..point
        };
        for (text, by_point, by_comma) in [
            ("1,234.5", Some(1234.5), None),
            ("1.234,5", None, Some(1234.5)),
            ("-1'234'567.25", Some(-1_234_567.25), None),
            ("1 234,25", None, Some(1234.25)),
            ("1,5", None, Some(1.5)),
            ("12,34.5", None, None),
            ("car", None, None),
            ("", Some(f64::NAN), Some(f64::NAN)),
            ("N/A", Some(f64::NAN), Some(f64::NAN)),
        ] {
            let bits = |number: Option<f64>| number.map(f64::to_bits);
            assert_eq!(bits(point.number_of(text.as_bytes())), bits(by_point), "{text}");
            assert_eq!(bits(comma.number_of(text.as_bytes())), bits(by_comma), "{text}");
        }
    }

    #[test]
    fn times_are_seconds() {
        assert_eq!(seconds_of(b"1970-01-02T00:00:01.5"), Some(86_401.5));
        assert_eq!(seconds_of(b"1970-01-01 00:01:00Z"), Some(60.0));
        assert_eq!(seconds_of(b"10:00:00.25"), Some(36_000.25));
        for text in ["car", "2024-05-01", "a10:00:00", "1:2"] {
            assert_eq!(seconds_of(text.as_bytes()), None, "{text}");
        }
    }
}
