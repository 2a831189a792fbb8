//! British and American spelling, singular and plural: one word, however it is typed.

/// True if two words differ at most in case, in `_` for `-`, in British for American spelling, or in a plural `s`.
pub(crate) fn is_same_word(left: &str, right: &str) -> bool {
    left == right || folded(left) == folded(right)
}

/// The spelling that stands for all spellings of a word.
fn folded(word: &str) -> String {
    const AMERICAN: [(&str, &str); 5] = [
        ("_", "-"),
        ("colour", "color"),
        ("grey", "gray"),
        ("neighbour", "neighbor"),
        ("centre", "center"),
    ];
    let lower = word.to_ascii_lowercase();
    let folded = AMERICAN
        .iter()
        .fold(lower, |word, (british, american)| word.replace(british, american));
    let parts = folded.split('-').map(|part| match part.strip_suffix('s') {
        Some(singular) if singular.len() > 2 => singular,
        _ => part,
    });
    parts.collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_one_word_are_the_same() {
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
