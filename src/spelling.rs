//! British and American spelling, singular and plural, errors of typing: one word, however it is typed.

/// American spellings and the British ones: parts of words.
const SPELLINGS: [(&str, &str); 7] = [
    ("color", "colour"),
    ("center", "centre"),
    ("gray", "grey"),
    ("meter", "metre"),
    ("neighbor", "neighbour"),
    ("iz", "is"),
    ("yz", "ys"),
];

/// A lower-case word in British spelling.
pub(crate) fn british(word: &str) -> String {
    let mut word = word.to_owned();
    for (american, british) in SPELLINGS {
        // Most words contain none of them, and replacing makes a copy.
        if word.contains(american) {
            word = word.replace(american, british);
        }
    }
    word
}

/// True if two words differ at most in case, in `_` for `-`, in British for American spelling, or in a plural `s`.
pub(crate) fn is_same_word(left: &str, right: &str) -> bool {
    left == right || folded(left) == folded(right)
}

/// The canonical spelling of a word.
fn folded(word: &str) -> String {
    let folded = british(&word.to_ascii_lowercase().replace('_', "-"));
    let parts = folded.split('-').map(|part| match part.strip_suffix('s') {
        Some(singular) if singular.len() > 2 => singular,
        _ => part,
    });
    parts.collect::<Vec<_>>().join("-")
}

/// Letters to insert, to remove, to replace or to swap with the next one (Damerau and Levenshtein, restricted).
pub(crate) fn edit_distance(left: &str, right: &str) -> usize {
    let (left, right): (Vec<char>, Vec<char>) = (left.chars().collect(), right.chars().collect());
    let mut rows = vec![(0..=right.len()).collect::<Vec<_>>()];
    for (i, letter) in left.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, other) in right.iter().enumerate() {
            let replaced = rows[i][j] + usize::from(letter != other);
            let mut best = replaced.min(rows[i][j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && *letter == right[j - 1] && left[i - 1] == *other {
                best = best.min(rows[i - 1][j - 1] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[left.len()][right.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_one_word_are_equal() {
        for (left, right) in [
            ("grey", "gray"),
            ("colour-map", "color-map"),
            ("colours", "color"),
            ("Neighbors", "neighbours"),
            ("point_sizes", "point-size"),
        ] {
            assert!(is_same_word(left, right), "{left} {right}");
        }
        for (left, right) in [("hat", "box"), ("ao", "a"), ("is", "i"), ("up", "ups-up")] {
            assert!(!is_same_word(left, right), "{left} {right}");
        }
    }
}
