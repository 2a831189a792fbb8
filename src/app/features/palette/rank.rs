//! Ranking of texts by the words of a query.
//!
//! **How it works.** Each word of the query is compared with each word of an entry: equal, of the same stem, its
//! beginning, its letters in order, one typing error apart. The best of these counts, less where it is found in a
//! description than in a title. A word that no entry has lowers the rank of all and excludes none; entries below
//! [`MIN_SCORE`], or far below the best one, are not listed.

use super::words::{Word, is_mistyped, likeness, words_of};
use crate::app::command::NumberUse;

/// An entry with a lower score is unrelated to the query.
const MIN_SCORE: f32 = 0.4;

/// An entry below this fraction of the best score is not listed.
const MIN_OF_BEST: f32 = 0.6;

/// Weight of a word that no entry has.
const UNKNOWN_WEIGHT: f32 = 0.5;

/// Added to the score of an entry whose title is all found.
const COVERAGE_BONUS: f32 = 0.12;

/// Factors on the likeness of words of the fields of an entry.
const ALSO: f32 = 0.9;
const PART_OF_ALSO: f32 = 0.55;
const HINT: f32 = 0.42;

/// An entry that takes the number of a query whatever its other words are.
const BARE_NUMBER: f32 = 0.9;

/// The texts of an entry that a query is compared with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Text<'a> {
    /// As it is listed.
    pub(super) title: &'a str,
    /// Another title, which is not listed.
    pub(super) other_title: &'a str,
    /// Phrases of people and of other programs.
    pub(super) also: [&'a [&'a str]; 2],
    /// A sentence about it.
    pub(super) hint: &'a str,
    /// Its use of the number in the query.
    pub(super) number: NumberUse,
    /// Added to the score of related entries.
    pub(super) bonus: f32,
}

/// Places of the related ones among `texts`, best first; of equal ones the first comes first.
pub(super) fn rank(query: &[Word], texts: &[Text<'_>]) -> Vec<usize> {
    let likenesses: Vec<_> = texts.iter().map(|text| Likeness::of(query, text)).collect();
    let is_known = |place: usize| likenesses.iter().any(|likeness| likeness.words[place] > 0.0);
    let weights: Vec<f32> = query
        .iter()
        .enumerate()
        .map(|(place, word)| {
            if is_known(place) {
                word.weight
            } else {
                word.weight * UNKNOWN_WEIGHT
            }
        })
        .collect();
    let total: f32 = weights.iter().sum();
    let mut scored: Vec<(usize, f32)> = Vec::new();
    for (place, (likeness, text)) in likenesses.iter().zip(texts).enumerate() {
        let products = likeness.words.iter().zip(&weights).map(|(word, weight)| word * weight);
        let score = products.sum::<f32>() / total.max(f32::MIN_POSITIVE);
        if score >= MIN_SCORE {
            scored.push((place, score + COVERAGE_BONUS * likeness.coverage + text.bonus));
        }
    }
    scored.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    let best = scored.first().map_or(0.0, |&(_, score)| score);
    scored.retain(|&(_, score)| score >= MIN_OF_BEST * best);
    scored.into_iter().map(|(place, _)| place).collect()
}

/// The likeness of an entry to each word of a query.
#[derive(Debug)]
struct Likeness {
    words: Vec<f32>,
    /// Fraction of the title's words that are like a word of the query.
    coverage: f32,
}

impl Likeness {
    fn of(query: &[Word], text: &Text<'_>) -> Self {
        let mut words = vec![0.0; query.len()];
        let title = words_of(text.title);
        let in_title = phrase_likeness(query, &title);
        raise(&mut words, &in_title, 1.0);
        raise(&mut words, &phrase_likeness(query, &words_of(text.other_title)), 1.0);
        for phrase in text.also.into_iter().flatten() {
            let phrase = words_of(phrase);
            let likeness = phrase_likeness(query, &phrase);
            let is_whole = phrase.len() == 1 || uncovered(query, &phrase) == 0;
            raise(&mut words, &likeness, if is_whole { ALSO } else { PART_OF_ALSO });
        }
        let in_hint = exact_likeness(query, &words_of(text.hint));
        raise(&mut words, &in_hint, HINT);
        take_number(query, text.number, &mut words);
        let found = title.len() - uncovered(query, &title);
        Self {
            words,
            coverage: found as f32 / title.len().max(1) as f32,
        }
    }
}

/// Matches a number with an entry that takes one, if all other words of the query are found there too.
fn take_number(query: &[Word], number: NumberUse, words: &mut [f32]) {
    if number == NumberUse::None || query.iter().all(|word| word.number.is_none()) {
        return;
    }
    let mut others = query.iter().zip(&*words).filter(|(word, _)| word.number.is_none());
    let has_others = others.clone().next().is_some();
    let are_found = others.any(|(_, likeness)| *likeness >= MIN_SCORE);
    for (word, likeness) in query.iter().zip(words) {
        if word.number.is_some() {
            *likeness = match (number, has_others) {
                (_, true) if are_found => 1.0,
                (NumberUse::Alone, false) => BARE_NUMBER,
                _ => 0.0,
            };
        }
    }
}

fn raise(words: &mut [f32], others: &[f32], factor: f32) {
    for (word, other) in words.iter_mut().zip(others) {
        *word = word.max(other * factor);
    }
}

/// Likeness of each word of the query to the nearest word of a phrase, or to two of its consecutive words that may be
/// written as one (full screen), and vice versa.
fn phrase_likeness(query: &[Word], phrase: &[Word]) -> Vec<f32> {
    let mut words: Vec<f32> = query
        .iter()
        .map(|word| {
            let single = phrase.iter().map(|other| likeness(word, other));
            let joined = phrase.windows(2).map(|pair| joined_likeness(word, pair));
            single.chain(joined).fold(0.0, f32::max)
        })
        .collect();
    for (place, pair) in query.windows(2).enumerate() {
        let joined = phrase.iter().map(|word| pair_likeness(pair, word)).fold(0.0, f32::max);
        words[place] = words[place].max(joined);
        words[place + 1] = words[place + 1].max(joined);
    }
    words
}

/// As [`phrase_likeness`], but only of equal words and of words of the same stem.
fn exact_likeness(query: &[Word], phrase: &[Word]) -> Vec<f32> {
    let is_in = |word: &Word| phrase.iter().any(|other| other.stem == word.stem);
    query.iter().map(|word| f32::from(is_in(word))).collect()
}

/// Likeness of two words of a query to one word.
fn pair_likeness(pair: &[Word], word: &Word) -> f32 {
    let [first, second] = pair else { return 0.0 };
    let length = first.text.len() + second.text.len();
    if word.text.len().abs_diff(length) > 1 {
        return 0.0;
    }
    let joined = format!("{}{}", first.text, second.text);
    if joined == word.text {
        0.95
    } else if is_mistyped(&joined, &word.text) {
        0.5
    } else {
        0.0
    }
}

fn joined_likeness(word: &Word, pair: &[Word]) -> f32 {
    let [first, second] = pair else { return 0.0 };
    match word.text.strip_prefix(first.text.as_str()) {
        Some(rest) if rest == second.text => 1.0,
        Some(rest) if rest.len() >= 2 && second.text.starts_with(rest) => 0.8,
        _ => 0.0,
    }
}

/// Number of words of a phrase that no word of the query is like.
fn uncovered(query: &[Word], phrase: &[Word]) -> usize {
    let is_covered = |other: &&Word| {
        let single = query.iter().any(|word| likeness(word, other) > 0.0);
        let joined = |pair: &[Word]| pair_likeness(pair, other) > 0.0;
        single || query.windows(2).any(joined)
    };
    let of_pairs = phrase.windows(2);
    let pairs = of_pairs.filter(|pair| query.iter().any(|word| joined_likeness(word, pair) > 0.0));
    let covered = phrase.iter().filter(is_covered).count() + 2 * pairs.count();
    phrase.len().saturating_sub(covered)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(title: &str) -> Text<'_> {
        Text {
            title,
            other_title: "",
            also: [&[], &[]],
            hint: "",
            number: NumberUse::None,
            bonus: 0.0,
        }
    }

    fn ranked<'a>(query: &str, titles: &[&'a str]) -> Vec<&'a str> {
        let texts: Vec<_> = titles.iter().map(|title| text(title)).collect();
        let places = rank(&words_of(query), &texts);
        places.into_iter().map(|place| titles[place]).collect()
    }

    #[test]
    fn entries_with_all_words_come_first() {
        let titles = ["Background: Black", "Background: White", "White balance"];
        assert_eq!(ranked("background white", &titles)[0], "Background: White");
        assert_eq!(ranked("white background", &titles)[0], "Background: White");
        assert_eq!(ranked("white", &titles), ["Background: White", "White balance"]);
        assert_eq!(ranked("wihte backgrounds", &titles)[0], "Background: White");
    }

    #[test]
    fn unknown_words_lower_the_rank_and_exclude_nothing() {
        let titles = ["Save image", "Close"];
        assert_eq!(ranked("take image", &titles), ["Save image"]);
        assert_eq!(ranked("take", &titles), [""; 0]);
        assert_eq!(ranked("nothing of this image exists here", &titles), [""; 0]);
    }

    #[test]
    fn compound_words_match_joined_or_split() {
        assert_eq!(ranked("fullscreen", &["Full screen"]), ["Full screen"]);
        assert_eq!(ranked("time line", &["Timeline"]), ["Timeline"]);
        assert_eq!(ranked("colormap", &["Colour map: Turbo"]), ["Colour map: Turbo"]);
    }

    #[test]
    fn letters_must_all_match_within_one_word() {
        assert_eq!(ranked("shdws", &["Shadows"]), ["Shadows"]);
        assert_eq!(ranked("delete", &["Describe level of the octree"]), [""; 0]);
        assert_eq!(ranked("gif", &["Relighting: Off"]), [""; 0]);
        assert_eq!(ranked("ring", &["Rendering"]), [""; 0]);
    }

    #[test]
    fn numbers_match_entries_that_take_them() {
        let takes = |title, number| Text { number, ..text(title) };
        let texts = [
            takes("Set point size to 4", NumberUse::WithWords),
            takes("Go to frame 4", NumberUse::Alone),
            takes("Next frame", NumberUse::None),
        ];
        assert_eq!(rank(&words_of("point size 4"), &texts), [0]);
        assert_eq!(rank(&words_of("4"), &texts), [1]);
        assert_eq!(rank(&words_of("frame 4"), &texts)[0], 1);
    }

    #[test]
    fn complete_phrases_rank_higher() {
        let clip: &[&str] = &["bounding box"];
        let texts = [
            Text {
                also: [clip, &[]],
                ..text("Clip")
            },
            text("Kernel: Box"),
        ];
        assert_eq!(rank(&words_of("bounding box"), &texts)[0], 0);
        assert_eq!(rank(&words_of("box"), &texts)[0], 1);
    }
}
