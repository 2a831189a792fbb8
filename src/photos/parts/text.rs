//! Words of a text file, each with the line that it stands in.
//!
//! Formats of reconstructions are numbers with white space between them. Some mean lines by it and some do not, so one
//! reader offers both: the next word wherever it is, and the rest of a line. Nothing is allocated from claimed counts:
//! reading the claimed number of words reaches the end of the file first, which is reported.

use crate::photos::error::PhotosError;
use std::path::Path;
use std::str::FromStr;

/// A place in a text.
#[derive(Debug)]
pub(in crate::photos) struct Text<'a> {
    path: &'a Path,
    rest: &'a str,
    line: usize,
}

/// Longer words are cut where they are shown.
const MAX_SHOWN: usize = 40;

impl<'a> Text<'a> {
    /// `text`, the contents of the file `path`.
    pub(in crate::photos) fn new(path: &'a Path, text: &'a str) -> Self {
        // The byte order mark that some editors write.
        let rest = text.strip_prefix('\u{feff}').unwrap_or(text);
        Self { path, rest, line: 1 }
    }

    /// The next word, on whichever line; `what` names it.
    pub(in crate::photos) fn word(&mut self, what: &str) -> Result<&'a str, PhotosError> {
        self.skip_space();
        if self.rest.is_empty() {
            return Err(self.error(format!("the file ends where {what} was expected: it may have been cut")));
        }
        let end = self.rest.find(char::is_whitespace).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        Ok(word)
    }

    /// The next word as a number.
    pub(in crate::photos) fn number<T: FromStr>(&mut self, what: &str) -> Result<T, PhotosError> {
        let word = self.word(what)?;
        word.parse()
            .map_err(|_| self.error(format!("expected {what}, found {}", quoted(word))))
    }

    /// The next words as numbers, finite or not: a fault in one of many items costs only that item, and the caller has
    /// to check for it.
    pub(in crate::photos) fn numbers<const N: usize>(&mut self, what: &str) -> Result<[f64; N], PhotosError> {
        let mut numbers = [0.0_f64; N];
        for number in &mut numbers {
            *number = self.number(what)?;
        }
        Ok(numbers)
    }

    /// Returns the rest of the line, without white space around it; the position is the next line then.
    pub(in crate::photos) fn rest_of_line(&mut self) -> &'a str {
        let (line, rest) = self.rest.split_once('\n').unwrap_or((self.rest, ""));
        self.rest = rest;
        self.line += 1;
        line.trim()
    }

    /// Steps over white space, and over lines that begin with `#`.
    pub(in crate::photos) fn skip_comments(&mut self) {
        self.skip_space();
        while self.rest.starts_with('#') {
            self.rest_of_line();
            self.skip_space();
        }
    }

    /// Returns true if nothing but white space is left.
    pub(in crate::photos) fn is_at_end(&mut self) -> bool {
        self.skip_space();
        self.rest.is_empty()
    }

    /// Creates an error for the problem at this position.
    pub(in crate::photos) fn error(&self, problem: impl Into<String>) -> PhotosError {
        PhotosError::invalid(self.path, format!("line {}", self.line), problem)
    }

    fn skip_space(&mut self) {
        let rest = self.rest.trim_start();
        let skipped = &self.rest[..self.rest.len() - rest.len()];
        self.line += skipped.bytes().filter(|&byte| byte == b'\n').count();
        self.rest = rest;
    }
}

/// A word for a message.
pub(in crate::photos) fn quoted(word: &str) -> String {
    match word.char_indices().nth(MAX_SHOWN) {
        Some((end, _)) => format!("`{}…`", &word[..end]),
        None => format!("`{word}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_counted_per_line() {
        let mut text = Text::new(Path::new("a.txt"), "\u{feff}# note\n\n1 2.5\n  name of it \r\nx");
        text.skip_comments();
        assert_eq!(text.number::<u32>("a count").unwrap(), 1);
        assert_eq!(text.numbers("a length").unwrap(), [2.5]);
        text.rest_of_line();
        assert_eq!(text.rest_of_line(), "name of it");
        let error = text.number::<u32>("a count").unwrap_err().to_string();
        assert_eq!(error, "a.txt, line 5: expected a count, found `x`");
        assert!(text.is_at_end());
        let error = text.word("a name").unwrap_err().to_string();
        assert!(error.contains("line 5: the file ends where a name"), "{error}");
    }
}
