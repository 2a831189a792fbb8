//! All that a person can ask for, found by its name: commands, values of settings, presets, benchmarks and panels.
//!
//! **How it works.** Each word of the query has to be in the name of an entry, letter after letter, or as it is in what
//! the entry does; a word that other programs use for the same thing (*screenshot*) is there where ours is (*picture*).
//! Entries that have the words as they are in their names come first.

mod entry;
mod in_window;
pub(in crate::app) mod panel;

pub(in crate::app) use entry::{Action, Entry};

use crate::app::command::Command;

/// Words of other programs, and ours for the same.
const SYNONYMS: &[(&str, &str)] = &[
    ("gif", "video"),
    ("mp4", "video"),
    ("movie", "video"),
    ("animation", "video"),
    ("record", "video"),
    ("render", "export"),
    ("sky", "background"),
    ("colour", "color"),
    ("color", "colour"),
    ("splats", "surfels"),
    ("cubes", "voxels"),
    ("octree", "cells"),
    ("shadow", "shadows"),
    ("edl", "eye-dome"),
    ("ssao", "occlusion"),
    ("ao", "occlusion"),
    ("performance", "benchmark"),
    ("crop", "clip"),
    ("section", "clip"),
    ("slice", "clip"),
    ("cut", "clip"),
    ("ghosts", "onion skin"),
    ("guesses", "assumptions"),
    ("guessed", "assumptions"),
    ("depth", "assumptions"),
    ("scale", "assumptions"),
    ("columns", "assumptions"),
    ("intrinsics", "assumptions"),
    ("no-data", "assumptions"),
    ("upside", "up axis"),
    ("orientation", "up axis"),
];

/// An open palette.
#[derive(Debug, Clone, Default)]
pub struct Palette {
    pub(in crate::app) query: String,
    /// Place of the chosen one among those found.
    pub(in crate::app) chosen: usize,
}

/// What `query` finds among `commands`, settings, and `presets` of this person.
pub(in crate::app) fn find(query: &str, presets: &[String], commands: &[Entry]) -> Vec<Entry> {
    let words: Vec<String> = query.split_whitespace().map(str::to_lowercase).collect();
    let all = commands.iter().cloned().chain(entry::entries(presets));
    let mut found: Vec<(usize, Entry)> = all
        .filter(|entry| !matches!(entry.action, Action::Run(Command::TOGGLE_PALETTE)))
        .filter_map(|entry| {
            let text = format!("{} {}", entry.text, entry.what).to_lowercase();
            let hint = entry.hint.to_lowercase();
            let distances = words.iter().map(|word| distance(word, &text, &hint, entry.synonyms));
            let distance = distances.sum::<Option<usize>>()?;
            Some((distance, entry))
        })
        .collect();
    found.sort_by_key(|&(distance, _)| distance);
    // Letters in their order are in many names by chance: they are for words that are found in no other way.
    if found.first().is_some_and(|&(distance, _)| distance < LETTERS) {
        found.retain(|&(distance, _)| distance < LETTERS);
    }
    found.into_iter().map(|(_, entry)| entry).collect()
}

/// The distance of a word that is in a name by its letters alone; beyond the sums of all others.
const LETTERS: usize = 1 << 16;

/// How far a word is from a name and what the thing of that name does; `None` if it is in neither.
fn distance(word: &str, text: &str, hint: &str, own_synonyms: &[&str]) -> Option<usize> {
    // A few letters may begin anything.
    let is_begun = |theirs: &str| word.len() >= 3 && theirs.starts_with(word) || theirs == word;
    let mut synonyms = SYNONYMS.iter().filter(|(theirs, _)| is_begun(theirs));
    if text.contains(word) {
        Some(0)
    } else if synonyms.any(|(_, ours)| text.contains(ours)) || own_synonyms.iter().any(|theirs| is_begun(theirs)) {
        Some(1)
    } else if word.len() >= 3 && hint.contains(word) {
        Some(2)
    } else if is_subsequence(word, text) {
        Some(LETTERS)
    } else {
        None
    }
}

/// Whether the letters of `word` are in `text` in their order.
fn is_subsequence(word: &str, text: &str) -> bool {
    let mut letters = text.chars();
    word.chars().all(|wanted| letters.any(|letter| letter == wanted))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{State, StateOptions};
    use crate::scene::Settings;
    use crate::scene::describe::Values;

    fn texts(query: &str) -> Vec<String> {
        let commands = in_window::commands_of(&State::new(StateOptions::default()));
        let found = find(query, &["Mine".to_owned()], &commands);
        found.into_iter().map(|entry| entry.text.into_owned()).collect()
    }

    #[test]
    fn words_are_found_by_their_letters() {
        assert!(is_subsequence("orth", "orthographic, perspective"));
        assert!(is_subsequence("ogc", "orthographic"));
        assert!(!is_subsequence("gog", "orthographic"));
        assert!(is_subsequence("", ""));
        assert_eq!(texts("next mark")[0], "Next marker");
        assert_eq!(texts("MARK next")[0], "Next marker");
        assert_eq!(texts("frme nxt")[0], "Next frame");
        assert!(texts("gif").iter().all(|text| text != "Relighting: Off"));
        assert_eq!(texts("no such thing at all"), [""; 0]);
        // As they are before letters scattered over the text.
        assert_eq!(texts("left")[0], "Left");
    }

    #[test]
    fn words_of_other_programs_find_ours() {
        for (query, expected) in [
            ("gif", "Export…"),
            ("movie", "Export…"),
            ("voxels", "Primitive: Voxels"),
            ("mine", "Preset: Mine"),
            ("clip", "Clip to a box or a plane…"),
            ("crop", "Clip to a box or a plane…"),
            ("up axis", "Up axis…"),
            ("shortc", "Keys and mouse"),
        ] {
            let found = texts(query);
            assert!(found.iter().take(4).any(|text| text == expected), "{query}: {found:?}");
        }
        assert_eq!(texts("background white")[0], "Background: White");
        assert!(texts("benchmark").len() >= crate::bench::suites::all().count());
    }

    #[test]
    fn every_value_of_every_setting_is_found_by_its_name() {
        for (described, _) in Settings::default().settings() {
            let names: Vec<&str> = match &described.values {
                Values::Words(words) => words.list.iter().map(|word| word.title).collect(),
                Values::Kinds(kinds) => kinds.iter().map(|kind| kind.title).collect(),
                Values::Switch(_) => vec!["on", "off"],
                Values::Background => continue,
                _ => vec![""],
            };
            for name in names {
                let found = texts(&format!("{} {name}", described.title));
                let is_it = |text: &String| text.starts_with(described.title) && text.ends_with(name);
                let is_field = |text: &String| name.is_empty() && text.starts_with(described.title);
                assert!(
                    found.iter().any(|text| is_it(text) || is_field(text)),
                    "{} {name}",
                    described.title
                );
            }
        }
    }
}
