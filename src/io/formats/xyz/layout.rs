//! Rows of cells, stripped of decorations by some programs.
//!
//! Brackets around rows (`[1, 2, 3]`, `(1, 2, 3)`, `{1, 2, 3},`), line breaks in quoted cells, and commas that are both
//! decimal marks and separators (`1,5, 2,5, 3,5`) are rewritten before further parsing. Lists of points of COLMAP end
//! in tracks of any length, which are cut off.

use super::dialect::{comment, sample};
use super::encoding::utf8;
use std::borrow::Cow;

/// Plain text of a file, and notes on skipped parts, one clause each.
pub(super) struct Plain<'a> {
    pub(super) text: Cow<'a, [u8]>,
    pub(super) notes: Vec<&'static str>,
}

/// The rows of the file `bytes`.
pub(super) fn plain(bytes: &[u8]) -> Plain<'_> {
    let mut text = utf8(bytes);
    let mut notes = Vec::new();
    if let Some(joined) = with_joined_cells(&text) {
        text = Cow::Owned(joined);
    }
    if has_bracketed_rows(&text) {
        text = Cow::Owned(without_brackets(&text));
    }
    if has_commas_of_both_kinds(&text) {
        text = Cow::Owned(with_semicolons(&text));
    }
    if let Some(points) = colmap_points(&text) {
        text = Cow::Owned(points);
        notes.push("the tracks behind the eighth column (TRACK[], images that see a point) are not read");
    }
    Plain { text, notes }
}

/// Lines of the beginning that hold digits and are not comments.
fn rows_of_sample(text: &[u8]) -> Vec<&[u8]> {
    let lines = sample(text).split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let is_row = |line: &&[u8]| comment(line).is_none() && line.iter().any(u8::is_ascii_digit);
    lines.filter(is_row).collect()
}

/// Nine of ten.
fn are_max(count: usize, all: usize) -> bool {
    count > 0 && count * 10 >= all * 9
}

/// Returns the text with spaces instead of the line breaks in quoted cells; `None` where there are none.
fn with_joined_cells(text: &[u8]) -> Option<Vec<u8>> {
    /// Longer cells are a quote that is not closed.
    const MAX_CELL_BYTES: usize = 4096;
    let is_open = |line: &[u8]| line.split(|&byte| byte == b'"').count() % 2 == 0;
    if !sample(text).split(|&byte| byte == b'\n').any(is_open) {
        return None;
    }
    let mut joined = text.to_vec();
    let mut start = None;
    for (place, byte) in joined.iter_mut().enumerate() {
        match (*byte, start) {
            (b'"', None) => start = Some(place),
            (b'"', Some(_)) => start = None,
            (_, Some(start)) if place - start > MAX_CELL_BYTES => return None,
            (b'\n' | b'\r', Some(_)) => *byte = b' ',
            _ => {}
        }
    }
    start.is_none().then_some(joined)
}

fn is_bracketed(line: &[u8]) -> bool {
    let inside = line.trim_ascii_start();
    let (Some((first, rest)), true) = (inside.split_first(), inside.len() > 1) else {
        return false;
    };
    let next = rest.trim_ascii_start().first();
    b"[({".contains(first) && next.is_some_and(|byte| byte.is_ascii_digit() || b"+-.[({".contains(byte))
}

fn has_bracketed_rows(text: &[u8]) -> bool {
    let rows = rows_of_sample(text);
    let bracketed = rows.iter().filter(|line| is_bracketed(line)).count();
    are_max(bracketed, rows.len())
}

/// Returns the text with spaces instead of brackets, and instead of the comma or semicolon after the last of them.
fn without_brackets(text: &[u8]) -> Vec<u8> {
    let mut plain = Vec::with_capacity(text.len());
    for line in text.split_inclusive(|&byte| byte == b'\n') {
        let start = plain.len();
        plain.extend(line);
        let trimmed = line.trim_ascii();
        let is_alone = !trimmed.is_empty() && trimmed.iter().all(|byte| b"[](){},; ".contains(byte));
        if !is_bracketed(line) && !is_alone {
            continue;
        }
        let end = line
            .iter()
            .rposition(|byte| b")]}".contains(byte))
            .unwrap_or(line.len());
        for (place, byte) in plain[start..].iter_mut().enumerate() {
            let is_behind = place > end && b",;".contains(byte);
            if b"[](){}".contains(byte) || is_behind {
                *byte = b' ';
            }
        }
    }
    plain
}

/// Returns true if rows are numbers with decimal commas and a comma after each but the last.
fn has_commas_of_both_kinds(text: &[u8]) -> bool {
    let is_number = |word: &[u8]| {
        let digits = word.strip_prefix(b"-").or(word.strip_prefix(b"+")).unwrap_or(word);
        let mut parts = digits.split(|&byte| byte == b',');
        let all_digits = |part: &[u8]| !part.is_empty() && part.iter().all(u8::is_ascii_digit);
        parts.clone().count() <= 2 && parts.all(all_digits)
    };
    let fits = |line: &&&[u8]| {
        let words: Vec<&[u8]> = line
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty())
            .collect();
        let cells = words
            .iter()
            .enumerate()
            .map(|(index, word)| match word.strip_suffix(b",") {
                Some(cell) if index + 1 < words.len() => Some(cell),
                None if index + 1 == words.len() => Some(*word),
                _ => None,
            });
        let cells: Option<Vec<&[u8]>> = cells.collect();
        let has_comma = |cells: &Vec<&[u8]>| cells.iter().any(|cell| cell.contains(&b','));
        let cells = cells.filter(|cells| cells.len() >= 3 && has_comma(cells));
        cells.is_some_and(|cells| cells.iter().all(|cell| is_number(cell)))
    };
    let rows = rows_of_sample(text);
    are_max(rows.iter().filter(fits).count(), rows.len())
}

/// Returns the text with semicolons instead of commas before white space.
fn with_semicolons(text: &[u8]) -> Vec<u8> {
    let mut plain = text.to_vec();
    for place in 0..plain.len().saturating_sub(1) {
        if plain[place] == b',' && b" \t".contains(&plain[place + 1]) {
            plain[place] = b';';
        }
    }
    plain
}

/// The rows of a `points3D.txt` of COLMAP up to the error; `None` of other text.
fn colmap_points(text: &[u8]) -> Option<Vec<u8>> {
    const NAMES: &[u8] = b"# POINT3D_ID, X, Y, Z, R, G, B, ERROR\n";
    const COLUMNS: usize = 8;
    const HEAD_BYTES: usize = 4096;
    let is_names = |line: &[u8]| {
        let has = |words: &[u8]| line.windows(words.len()).any(|window| window == words);
        comment(line.trim_ascii()).is_some() && has(b"POINT3D_ID") && has(b"TRACK[]")
    };
    let head = &text[..text.len().min(HEAD_BYTES)];
    if !head.split(|&byte| byte == b'\n').any(is_names) {
        return None;
    }
    let mut rows = Vec::with_capacity(text.len());
    for line in text.split_inclusive(|&byte| byte == b'\n') {
        if is_names(line) {
            rows.extend(NAMES);
        } else if comment(line.trim_ascii()).is_some() {
            rows.extend(line);
        } else {
            let words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
            let words: Vec<&[u8]> = words.take(COLUMNS).collect();
            rows.extend(words.join(&b' '));
            rows.push(b'\n');
        }
    }
    Some(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_around_rows_are_removed() {
        for (text, expected) in [
            ("[1, 2, 3]\n[4, 5, 6]\n", " 1, 2, 3 \n 4, 5, 6 \n"),
            ("x,y,z\n(1,2,3)\n", "x,y,z\n 1,2,3 \n"),
            ("{1, -2, 3},\n{.4, 5, 6},\n", " 1, -2, 3  \n .4, 5, 6  \n"),
            ("[\n[1, 2, 3],\n[4, 5, 6]\n]\n", " \n 1, 2, 3  \n 4, 5, 6 \n \n"),
            ("a,x,y,z\n\"b\nc\",1,2,3\n", "a,x,y,z\n\"b c\",1,2,3\n"),
            ("1,5, 2,25, 3\n-4,5, 5,5, 6,0\n", "1,5; 2,25; 3\n-4,5; 5,5; 6,0\n"),
        ] {
            assert_eq!(plain(text.as_bytes()).text, expected.as_bytes(), "{text:?}");
        }
        for text in [
            "1, 2, 3\n4, 5, 6\n",
            "1 2 3\n",
            "x (m),y (m),z (m)\n1,2,3\n",
            "6\",1,2,3\n",
            "{\"x\":1}\n",
        ] {
            assert_eq!(plain(text.as_bytes()).text, text.as_bytes(), "{text:?}");
        }
    }

    #[test]
    fn colmap_tracks_are_cut_off() {
        let text = "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n\
                    1 5.5 9 1 255 0 0 0.5 1 2\n7 6 8 2 255 0 0 0.5 1 2 3 4\n";
        let plain = plain(text.as_bytes());
        let expected = "# POINT3D_ID, X, Y, Z, R, G, B, ERROR\n1 5.5 9 1 255 0 0 0.5\n7 6 8 2 255 0 0 0.5\n";
        assert_eq!(String::from_utf8_lossy(&plain.text), expected);
        assert_eq!(plain.notes.len(), 1);
    }
}
