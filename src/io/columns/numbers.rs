//! Numbers written as text, token by token, without allocation.

use crate::io::error::Fault;
use crate::progress::Progress;

/// The tokens of a text, with the line each is on.
#[derive(Debug, Clone)]
pub(in crate::io) struct Tokens<'a> {
    bytes: &'a [u8],
    position: usize,
    /// Counted from 1.
    line: usize,
}

impl<'a> Tokens<'a> {
    /// Tokens of `bytes`, whose first line is number `line`.
    pub(in crate::io) fn new(bytes: &'a [u8], line: usize) -> Self {
        Self {
            bytes,
            position: 0,
            line,
        }
    }

    /// Goes behind the end of the line that the last token was on.
    pub(in crate::io) fn skip_line(&mut self) {
        while let Some(&byte) = self.bytes.get(self.position)
            && byte != b'\n'
        {
            self.position += 1;
        }
    }

    /// The next token as a number, in one pass over its bytes; `None` behind the last one, the token itself where it is
    /// not a number.
    #[inline]
    pub(in crate::io) fn next_number(&mut self) -> Option<Result<f64, &'a [u8]>> {
        let mut start = self.position;
        while let Some(&byte) = self.bytes.get(start)
            && separates(byte)
        {
            self.line += usize::from(byte == b'\n');
            start += 1;
        }
        self.position = start;
        // Works on bytes; the standard library needs validated UTF-8 first: an ASCII PLY of 100,000 points took 41 ms,
        // not 29.
        if let Ok((value, length)) = fast_float2::parse_partial::<f64, _>(&self.bytes[start..])
            && self.bytes.get(start + length).is_none_or(|&byte| separates(byte))
        {
            self.position = start + length;
            return Some(Ok(value));
        }
        let token = self.next()?;
        Some(parse_number(token).ok_or(token))
    }

    /// Number of non-empty lines after the one of the last token.
    pub(in crate::io) fn lines_behind(&self) -> usize {
        let mut rest = self.clone();
        rest.skip_line();
        let lines = rest.bytes[rest.position..].split(|&byte| byte == b'\n');
        lines.filter(|line| !line.trim_ascii().is_empty()).count()
    }

    /// The line that the last token was on.
    pub(in crate::io) fn line(&self) -> usize {
        self.line
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let mut start = self.position;
        while let Some(&byte) = self.bytes.get(start)
            && separates(byte)
        {
            self.line += usize::from(byte == b'\n');
            start += 1;
        }
        let mut end = start;
        while let Some(&byte) = self.bytes.get(end)
            && !separates(byte)
        {
            end += 1;
        }
        self.position = end;
        (end > start).then(|| &self.bytes[start..end])
    }
}

/// Returns `text` with decimal points instead of decimal commas, if the first of its `rows` have them: `numbers` words
/// of one comma at most, which is between digits.
pub(in crate::io) fn with_decimal_points(text: &[u8], numbers: usize, rows: usize) -> Option<Vec<u8>> {
    const LOOKED_AT_ROWS: usize = 16;
    let is_between_digits = |word: &[u8]| {
        word.windows(3)
            .any(|three| three[1] == b',' && three[0].is_ascii_digit() && three[2].is_ascii_digit())
    };
    let commas = |word: &[u8]| word.split(|&byte| byte == b',').count() - 1;
    let lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let mut has_comma = false;
    for row in lines.filter(|line| !line.is_empty()).take(LOOKED_AT_ROWS.min(rows)) {
        let words = row.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let words: Vec<&[u8]> = words.collect();
        let fits = |word: &&[u8]| commas(word) == 0 || (commas(word) == 1 && is_between_digits(word));
        if words.len() != numbers || !words.iter().all(fits) {
            return None;
        }
        has_comma |= words.iter().any(|word| commas(word) == 1);
    }
    let point = |&byte: &u8| if byte == b',' { b'.' } else { byte };
    has_comma.then(|| text.iter().map(point).collect())
}

/// Number of line endings.
pub(in crate::io) fn line_endings(bytes: &[u8]) -> usize {
    bytes.split(|&byte| byte == b'\n').count() - 1
}

/// White space, and the comma that some writers put between numbers.
#[inline]
fn separates(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == b','
}

/// A number as C and its descendants print it, `nan` and `1.#QNAN` included.
pub(in crate::io) fn parse_number(token: &[u8]) -> Option<f64> {
    if let Ok(value) = fast_float2::parse(token) {
        return Some(value);
    }
    let text = std::str::from_utf8(token).ok()?;
    let lower = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
    // NaN and infinity as printed by the runtimes of Microsoft and others.
    if lower.starts_with("nan") || lower.starts_with("1.#") {
        return Some(f64::NAN);
    }
    None
}

/// The start of a token for an error message.
pub(in crate::io) fn quoted(token: &[u8]) -> String {
    const SHOWN_BYTES: usize = 24;
    let shown = String::from_utf8_lossy(&token[..token.len().min(SHOWN_BYTES)]);
    format!(
        "`{}{}`",
        shown.escape_default(),
        if token.len() > SHOWN_BYTES { "…" } else { "" }
    )
}

/// Rows of text between two checks for cancellation.
const ROWS_AT_ONCE: usize = 1 << 14;

/// Tells `progress` now and then, and when they are, that the first `row` of `rows` are read; fails once they are not
/// wanted any more.
pub(in crate::io) fn note_row(row: usize, rows: usize, progress: &Progress) -> Result<(), Fault> {
    if row.is_multiple_of(ROWS_AT_ONCE) || row == rows {
        if progress.is_cancelled() {
            return Err(Fault::cancelled());
        }
        progress.set(row, rows);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_report_their_line() {
        let mut tokens = Tokens::new(b"a b\r\n\n  c\n", 7);
        let mut seen = Vec::new();
        while let Some(token) = tokens.next() {
            seen.push((token, tokens.line()));
        }
        assert_eq!(seen, [(b"a".as_slice(), 7), (b"b", 7), (b"c", 9)]);
    }

    #[test]
    fn commas_are_decimal_where_the_word_count_matches() {
        let of = |text: &str, numbers| with_decimal_points(text.as_bytes(), numbers, 2);
        assert_eq!(
            of("2,5 -1,25 3\n4,5 1 2\n", 3),
            Some(b"2.5 -1.25 3\n4.5 1 2\n".to_vec())
        );
        for (text, numbers) in [("2,5 1,25 3\n", 5), ("1,2,3\n", 3), ("1, 2, 3\n", 3), ("1 2 3\n", 3)] {
            assert_eq!(of(text, numbers), None, "{text}");
        }
    }

    #[test]
    fn number_spellings_of_all_runtimes_are_read() {
        assert_eq!(parse_number(b"-1.5e3"), Some(-1500.0));
        for not_a_number in [b"nan".as_slice(), b"NaN", b"-nan", b"-nan(ind)", b"1.#QNAN", b"-1.#IND"] {
            assert!(parse_number(not_a_number).unwrap().is_nan(), "{}", quoted(not_a_number));
        }
        assert_eq!(parse_number(b"-inf"), Some(f64::NEG_INFINITY));
        for wrong in [b"".as_slice(), b"x", b"1,5", b"\xff", b"0x10"] {
            assert_eq!(parse_number(wrong), None, "{}", quoted(wrong));
        }
    }
}
