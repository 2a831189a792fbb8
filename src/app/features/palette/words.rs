//! Words of a query and of entries: spelling, stems, typing errors and numbers.

use crate::spelling::{british, edit_distance};

/// A normalised word.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Word {
    pub(super) text: String,
    /// The word without ending.
    pub(super) stem: String,
    /// Its value, if it is a number.
    pub(super) number: Option<f64>,
    /// Weight among the words of a query.
    pub(super) weight: f32,
}

/// Words that say little; their weight is [`FILLER_WEIGHT`].
const FILLERS: &[&str] = &[
    "a", "an", "and", "as", "at", "by", "do", "for", "from", "how", "i", "in", "is", "it", "me", "my", "of", "on",
    "or", "please", "the", "this", "to", "with",
];
const FILLER_WEIGHT: f32 = 0.1;

/// Length of the shortest word in which one letter may be wrong.
const MIN_MISTYPED: usize = 5;

/// Units after numbers.
const UNITS: &[&str] = &["px", "x", "×", "%", "°", "fps", "s", "ms", "deg"];

/// Bytes of a letter in UTF-8.
const MAX_BYTES_OF_LETTER: usize = 4;

/// Endings that words of the same stem differ in.
const ENDINGS: &[&str] = &["ions", "ings", "ing", "ion", "ies", "ed", "es", "e", "s", "y"];

/// The words of a text.
pub(super) fn words_of(text: &str) -> Vec<Word> {
    let is_apart = |letter: char| !(letter.is_alphanumeric() || "./%°×".contains(letter));
    let parts = text.split(is_apart);
    let parts = parts.map(|part| part.trim_matches('/').trim_end_matches('.').to_lowercase());
    let mut words = Vec::new();
    for part in parts.filter(|part| !part.is_empty()) {
        match number_of(&part) {
            Some(number) => words.push(Word::number(part, number)),
            None => words.extend(
                part.split(|letter: char| !letter.is_alphanumeric())
                    .filter(|part| !part.is_empty())
                    .map(Word::new),
            ),
        }
    }
    words
}

impl Word {
    fn new(text: &str) -> Self {
        let text = british(text);
        let weight = if FILLERS.contains(&text.as_str()) {
            FILLER_WEIGHT
        } else {
            1.0
        };
        Self {
            stem: stem(&text).to_owned(),
            text,
            number: None,
            weight,
        }
    }

    fn number(text: String, number: f64) -> Self {
        Self {
            stem: text.clone(),
            text,
            number: Some(number),
            weight: 1.0,
        }
    }
}

/// A number as people write it: `12`, `0.5`, `1/2`, `50%`, `4px`, `2x`, `x2`.
fn number_of(text: &str) -> Option<f64> {
    let unit = UNITS.iter().find_map(|unit| text.strip_suffix(unit));
    let digits = unit.or_else(|| text.strip_prefix(['x', '×'])).unwrap_or(text);
    let begins = digits.starts_with(|letter: char| letter.is_ascii_digit() || letter == '.');
    if !begins {
        return None;
    }
    let number = match digits.split_once('/') {
        Some((above, below)) => above.parse::<f64>().ok()? / below.parse::<f64>().ok()?,
        None => digits.parse().ok()?,
    };
    let number = if text.ends_with('%') { number / 100.0 } else { number };
    number.is_finite().then_some(number)
}

fn stem(text: &str) -> &str {
    let shortened = ENDINGS.iter().find_map(|ending| {
        let rest = text.strip_suffix(ending)?;
        let is_double_s = *ending == "s" && rest.ends_with('s');
        (rest.chars().count() >= 3 && !is_double_s).then_some(rest)
    });
    let Some(rest) = shortened else { return text };
    // clipping, clip
    let mut last = rest.char_indices().rev();
    match (last.next(), last.next()) {
        (Some((at, last)), Some((_, before))) if last == before && at >= 3 => &rest[..at],
        _ => rest,
    }
}

/// Computes the similarity of a query word to another word, from 0 to 1.
pub(super) fn likeness(word: &Word, other: &Word) -> f32 {
    let (typed, other_text) = (word.text.as_str(), other.text.as_str());
    let (length, other_length) = (typed.chars().count(), other_text.chars().count());
    let fraction = length as f32 / other_length.max(1) as f32;
    if typed == other_text {
        1.0
    } else if word.number.is_some() || other.number.is_some() || length < 2 {
        0.0
    } else if word.stem == other.stem {
        0.92
    } else if other_text.starts_with(typed) {
        0.5 + 0.35 * fraction
    } else if other_length >= 4 && fraction < 1.8 && typed.starts_with(other_text) {
        0.55
    } else if length >= MIN_MISTYPED && is_mistyped(typed, other_text) {
        0.5
    } else if is_abbreviated(typed, other_text) {
        // Three of four letters match almost any short word: further words have to match too.
        if other_length < MIN_MISTYPED { 0.38 } else { 0.45 }
    } else {
        0.0
    }
}

/// Returns true if one letter is wrong, missing or too many, or two are swapped (a typo). The first letter is right.
pub(super) fn is_mistyped(typed: &str, other: &str) -> bool {
    let is_near = typed.len().abs_diff(other.len()) <= MAX_BYTES_OF_LETTER;
    is_near && typed.chars().next() == other.chars().next() && edit_distance(typed, other) == 1
}

/// Abbreviation test: returns true if the letters of `typed` are in `other` in their order, from its first one: either
/// only vowels are missing (`frm`), or most of the word is there.
fn is_abbreviated(typed: &str, other: &str) -> bool {
    if typed.len() < 3 || typed.chars().next() != other.chars().next() {
        return false;
    }
    let mut letters = typed.chars().peekable();
    let mut skipped = Vec::new();
    for letter in other.chars() {
        if letters.peek() == Some(&letter) {
            letters.next();
        } else {
            skipped.push(letter);
        }
    }
    let has_consonants = skipped.iter().all(|letter| "aeiouy".contains(*letter));
    let is_long = typed.len() >= 4 && 5 * typed.len() >= 3 * other.len();
    letters.peek().is_none() && (has_consonants || is_long)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(typed: &str, other: &str) -> f32 {
        likeness(&words_of(typed)[0], &words_of(other)[0])
    }

    #[test]
    fn words_match_by_spelling_stem_prefix_and_typos() {
        for (typed, other) in [
            ("color", "colours"),
            ("gray", "Grey"),
            ("visualize", "visualise"),
            ("clipping", "clip"),
            ("rotation", "rotate"),
            ("shadow", "Shadows"),
            ("boxes", "box"),
        ] {
            assert!(of(typed, other) >= 0.92, "{typed} {other}: {}", of(typed, other));
        }
        for (typed, other) in [
            ("screen", "screenshot"),
            ("turntabel", "turntable"),
            ("orthograpic", "orthographic"),
            ("frm", "frame"),
            ("bckgrnd", "background"),
            ("measurement", "measure"),
        ] {
            assert!(
                (0.4..0.92).contains(&of(typed, other)),
                "{typed} {other}: {}",
                of(typed, other)
            );
        }
        for (typed, other) in [
            ("ring", "rendering"),
            ("gog", "orthographic"),
            ("gps", "gpu"),
            ("top", "stop"),
            ("12", "120"),
            ("class", "glass"),
        ] {
            assert!(of(typed, other) == 0.0, "{typed} {other}: {}", of(typed, other));
        }
    }

    #[test]
    fn numbers_are_read_as_people_write_them() {
        let number = |text: &str| words_of(text).last().unwrap().number;
        for (text, expected) in [
            ("frame 12", 12.0),
            ("speed 0.5", 0.5),
            ("1/2", 0.5),
            ("resolution 50%", 0.5),
            ("point size 4px", 4.0),
            ("2x", 2.0),
            ("x2", 2.0),
            (".5", 0.5),
        ] {
            assert_eq!(number(text), Some(expected), "{text}");
        }
        for text in ["mp4", "3d", "1/0", "v1.2.3", "4k", "x"] {
            assert_eq!(number(text), None, "{text}");
        }
    }

    #[test]
    fn text_is_split_into_words_without_punctuation() {
        let texts = |text: &str| -> Vec<String> { words_of(text).into_iter().map(|word| word.text).collect() };
        assert_eq!(texts("Eye-dome lighting (EDL)…"), ["eye", "dome", "lighting", "edl"]);
        assert_eq!(texts("Compare A/B"), ["compare", "a", "b"]);
        assert_eq!(texts(" … "), [""; 0]);
    }
}
