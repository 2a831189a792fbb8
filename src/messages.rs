//! Messages of one kind: a hundred frames with the same fault are one message, not a hundred.
//!
//! Messages are made where something is found, throughout the code, and name the file, the place in it and its content.
//! Two of them are of one kind if they differ only in numbers, names of files and quotes from a file.

use std::fmt::Display;

/// Formats the frame number for user-facing messages: the position among all frames, as in the timeline, "frame 3 of
/// 24". Options, names of files and JSON use its index, which counts from 0.
pub(crate) fn frame_place(index: usize, count: usize) -> String {
    format!("frame {} of {}", grouped(index + 1), grouped(count))
}

/// Formats the frame number together with the index, for users who may have to type it: "frame 3 of 24 (index 2)".
pub(crate) fn frame_with_index(index: usize, count: usize) -> String {
    format!("{} (index {index})", frame_place(index, count))
}

/// Formats the frame number of a sequence that is unknown or growing: "frame 3 (index 2)".
pub(crate) fn frame_by_index(index: usize) -> String {
    // Options, file names and JSON count from 0: counting from 1 everywhere would have shifted every script by one.
    format!("frame {} (index {index})", grouped(index + 1))
}

/// Frames from one to another, both included: "frames 3 to 5 (indices 2 to 4)".
pub(crate) fn frames_with_indices(first: usize, last: usize) -> String {
    let [from, to] = [first, last].map(|index| grouped(index + 1));
    format!("frames {from} to {to} (indices {first} to {last})")
}

/// The error for frames `first..=last` requested by `option` from a sequence of `count` frames; `None` if all of them
/// exist. Common to all commands: a range is never cut silently.
pub(crate) fn missing_frames(option: &str, first: usize, last: usize, count: usize) -> Option<String> {
    let end = count.checked_sub(1);
    if end.is_some_and(|end| last <= end) {
        return None;
    }
    let Some(end) = end else {
        return Some(format!(
            "frame {first} does not exist: the sequence has 0 frames ({option})"
        ));
    };
    let missing = first.max(count);
    let frames = if count == 1 { "frame" } else { "frames" };
    let text = format!("frame {missing} does not exist: the sequence has {count} {frames}, 0..{end}");
    Some(if first <= end {
        format!("{text} (of {option} {first}..{last} it has {first}..{end})")
    } else {
        format!("{text} ({option} counts from 0)")
    })
}

/// A whole number with commas between groups of three digits: `1234567` → `1,234,567`. Not for numbers that users may
/// type again.
pub(crate) fn grouped(number: impl Display) -> String {
    let digits = number.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.char_indices() {
        let is_inner = index > 0 && !text.ends_with('-');
        if is_inner && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A count with its noun: `1 frame`, `-3 frames`, `1,000 frames`.
pub(crate) fn counted(count: i64, noun: &str) -> String {
    let plural = if count.abs() == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", grouped(count))
}

/// Names with commas between them and `last` before the last.
pub(crate) fn listed(names: &[String], last: &str) -> String {
    match names {
        [but_last @ .., name] if !but_last.is_empty() => {
            format!("{} {last} {name}", but_last.join(", "))
        }
        _ => names.concat(),
    }
}

/// Returns the kind of `message`: its text apart from numbers, file names and anything between grave accents. Messages
/// of one kind have the same.
pub(crate) fn kind_of(message: &str) -> String {
    let mut kind = String::with_capacity(message.len());
    for (place, part) in message.split('`').enumerate() {
        // Every second part is between two backticks.
        if place % 2 == 1 {
            kind.push_str("``");
            continue;
        }
        for word in part.split_inclusive(char::is_whitespace) {
            push_kind_of_word(word, &mut kind);
        }
    }
    kind
}

fn push_kind_of_word(word: &str, kind: &mut String) {
    let is_bracket = |c: char| c.is_whitespace() || "()[]{},;:.!?\"'".contains(c);
    let bare = word.trim_matches(is_bracket);
    let (before, after) = match word.find(bare) {
        Some(start) => (&word[..start], &word[start + bare.len()..]),
        None => ("", word),
    };
    kind.push_str(before);
    if bare.replace(',', "").parse::<f64>().is_ok() {
        kind.push('#');
    } else if names_a_file(bare) {
        kind.push('/');
    } else {
        let mut was_digit = false;
        for c in bare.chars() {
            let is_digit = c.is_ascii_digit();
            if !is_digit {
                kind.push(c);
            } else if !was_digit {
                kind.push('#');
            }
            was_digit = is_digit;
        }
    }
    kind.push_str(after);
}

/// Returns true if a word is a path, or ends like a file name.
fn names_a_file(word: &str) -> bool {
    let has_extension = word.rsplit_once('.').is_some_and(|(stem, extension)| {
        !stem.is_empty() && (1..=4).contains(&extension.len()) && extension.chars().all(|c| c.is_ascii_alphanumeric())
    });
    has_extension || word.contains(['/', '\\'])
}

/// Messages in the order in which their kinds came up: the first one of each kind, and how many more there are.
pub(crate) fn by_kind<'a>(messages: impl IntoIterator<Item = &'a str>) -> Vec<(&'a str, usize)> {
    let mut kinds: Vec<(String, &str, usize)> = Vec::new();
    for message in messages {
        let kind = kind_of(message);
        match kinds.iter_mut().find(|(known, _, _)| *known == kind) {
            Some((_, _, more)) => *more += 1,
            None => kinds.push((kind, message, 0)),
        }
    }
    let without_kind = |(_, first, more)| (first, more);
    kinds.into_iter().map(without_kind).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_have_a_number_for_display_and_an_index_for_options() {
        assert_eq!(frame_place(2, 24), "frame 3 of 24");
        assert_eq!(frame_with_index(2, 24), "frame 3 of 24 (index 2)");
        assert_eq!(frame_by_index(2), "frame 3 (index 2)");
        let kinds = [frame_with_index(2, 24), frame_with_index(13, 24)].map(|text| kind_of(&text));
        assert_eq!(kinds[0], kinds[1]);
        let many = frame_with_index(1233, 12_000);
        assert_eq!(many, "frame 1,234 of 12,000 (index 1233)");
        assert_eq!(kind_of(&many), kinds[0], "separators make no other kind");
    }

    #[test]
    fn thousands_have_separators() {
        for (number, text) in [(0, "0"), (999, "999"), (1_000, "1,000"), (12_345_678, "12,345,678")] {
            assert_eq!(grouped(number), text);
        }
        for (number, text) in [(-100, "-100"), (-1_000, "-1,000"), (-123_456, "-123,456")] {
            assert_eq!(grouped(number), text);
        }
        assert_eq!(counted(4_321, "frame"), "4,321 frames");
    }

    #[test]
    fn frames_beyond_the_last_are_rejected_naming_the_valid_ones() {
        for (first, last, count) in [(0, 0, 1), (0, 11, 12), (11, 11, 12), (3, 7, 12)] {
            assert_eq!(missing_frames("--frames", first, last, count), None, "{first}..{last}");
        }
        for (first, last, count, said) in [
            (
                20,
                30,
                12,
                "frame 20 does not exist: the sequence has 12 frames, 0..11 (--frames counts from 0)",
            ),
            (
                12,
                12,
                12,
                "frame 12 does not exist: the sequence has 12 frames, 0..11 (--frames counts from 0)",
            ),
            (
                8,
                30,
                12,
                "frame 12 does not exist: the sequence has 12 frames, 0..11 (of --frames 8..30 it has 8..11)",
            ),
            (
                0,
                1,
                1,
                "frame 1 does not exist: the sequence has 1 frame, 0..0 (of --frames 0..1 it has 0..0)",
            ),
            (0, 3, 0, "frame 0 does not exist: the sequence has 0 frames (--frames)"),
        ] {
            assert_eq!(missing_frames("--frames", first, last, count).as_deref(), Some(said));
        }
    }

    #[test]
    fn numbers_files_and_quotes_do_not_distinguish_messages() {
        for (one, other) in [
            (
                "/data/a_1.ply, vertex 12: the file ends here (ply file)",
                "/data/a_10.ply, vertex 7: the file ends here (ply file)",
            ),
            (
                "my scans/left.ply is empty (0 bytes)",
                "my scans/right.ply is empty (0 bytes)",
            ),
            ("it names vertex -1.5e3, expected", "it names vertex NaN, expected"),
            (
                "line 3: property `y` of vertex 0 is `two`",
                "line 4: property `z` of vertex 1 is `1 oops`",
            ),
            ("frame3 breaks off", "frame12 breaks off"),
        ] {
            assert_eq!(kind_of(one), kind_of(other));
        }
    }

    #[test]
    fn wording_distinguishes_messages() {
        for (one, other) in [
            ("a.ply is empty", "a.ply cannot be read"),
            ("a.ply, vertex 1: the file ends", "a.ply, face 1: the file ends"),
            ("3 frames", "3 points"),
            ("", "3"),
        ] {
            assert_ne!(kind_of(one), kind_of(other));
        }
    }

    #[test]
    fn the_first_of_each_kind_is_retained_in_order() {
        let messages = ["b 1", "a 1", "b 2", "c", "b 3", "a 2"];
        assert_eq!(by_kind(messages), [("b 1", 2), ("a 1", 1), ("c", 0)]);
        assert_eq!(by_kind([]), []);
    }

    #[test]
    fn nouns_follow_their_counts() {
        assert_eq!(counted(1, "frame"), "1 frame");
        assert_eq!(counted(-1, "frame"), "-1 frame");
        assert_eq!(counted(0, "frame"), "0 frames");
    }

    #[test]
    fn a_list_reads_as_a_sentence() {
        let names = ["one", "two", "three"].map(str::to_owned);
        assert_eq!(listed(&names, "or"), "one, two or three");
        assert_eq!(listed(&names[..2], "and"), "one and two");
        assert_eq!(listed(&names[..1], "and"), "one");
        assert_eq!(listed(&[], "and"), "");
    }
}
