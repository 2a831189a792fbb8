//! The palette: all user commands, found by words: commands, the values that they take, values and rows of settings,
//! panels.
//!
//! **How it works.** Rows of commands, panels and settings bring their names, their synonyms and their offers
//! (`entry.rs`, `in_window.rs`); [`rank`] compares them with the query. Nothing is named here.

mod entry;
mod in_window;
pub(in crate::app) mod panel;
#[cfg(test)]
mod phrases;
mod rank;
mod words;

pub(in crate::app) use entry::{Action, Entry};

use crate::app::command::Command;
use rank::Text;

/// Recent commands that are listed, and their rank is raised.
const MAX_RECENT: usize = 8;

/// Most that a recent command is raised by.
const RECENT_BONUS: f32 = 0.05;

/// The palette of a window.
#[derive(Debug, Clone, Default)]
pub struct Palette {
    /// The query, while the palette is open.
    pub search: Option<Search>,
    /// Texts of the entries that were chosen, the last one first.
    pub(in crate::app) recent: Vec<String>,
}

/// An open palette.
#[derive(Debug, Clone, Default)]
pub struct Search {
    pub(in crate::app) query: String,
    /// Place of the chosen one among those found.
    pub(in crate::app) chosen: usize,
}

impl Search {
    /// The number in the query.
    fn number(&self) -> Option<f64> {
        words::words_of(&self.query).iter().find_map(|word| word.number)
    }
}

impl Palette {
    /// Remembers the entry that was chosen.
    fn remember(&mut self, text: &str) {
        self.recent.retain(|other| other != text);
        self.recent.insert(0, text.to_owned());
        self.recent.truncate(MAX_RECENT);
    }
}

/// Entries for `query` among `all`, best first; all of them, recent ones first, where nothing was typed.
pub(in crate::app) fn find(query: &str, all: Vec<Entry>, recent: &[String]) -> Vec<Entry> {
    let words = words::words_of(query);
    let age = |entry: &Entry| recent.iter().position(|text| *text == entry.text).unwrap_or(MAX_RECENT);
    let mut all = all;
    all.retain(|entry| !matches!(entry.action, Action::Run(Command::TOGGLE_PALETTE)));
    if words.is_empty() {
        all.sort_by_key(age);
        return all;
    }
    let bonus = |entry: &Entry| RECENT_BONUS * (1.0 - age(entry) as f32 / MAX_RECENT as f32);
    let texts: Vec<Text<'_>> = all.iter().map(|entry| entry.texts(bonus(entry))).collect();
    rank::rank(&words, &texts)
        .into_iter()
        .map(|place| all[place].clone())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{State, StateOptions};
    use crate::scene::Settings;
    use crate::scene::describe::Values;

    pub(super) fn texts_of(state: &State, query: &str) -> Vec<String> {
        let search = Search {
            query: query.to_owned(),
            chosen: 0,
        };
        let all = in_window::entries(state, search.number());
        let found = find(query, all, &state.features.palette.recent);
        found.into_iter().map(|entry| entry.text.into_owned()).collect()
    }

    fn texts(query: &str) -> Vec<String> {
        texts_of(&State::new(StateOptions::default()), query)
    }

    #[test]
    fn commands_are_found_by_partial_words() {
        assert_eq!(texts("next mark")[0], "Next marker");
        assert_eq!(texts("MARK next")[0], "Next marker");
        assert_eq!(texts("frme nxt")[0], "Next frame");
        assert_eq!(texts("no such thing at all"), [""; 0]);
        assert_eq!(texts("left")[0], "Left view");
        assert!(texts("benchmark").len() >= crate::bench::suites::all().count());
    }

    #[test]
    fn recent_commands_come_first() {
        let mut state = State::new(StateOptions::default());
        state.features.palette.remember("Background: White");
        state.features.palette.remember("Background: Sky");
        let recent = ["Background: Sky", "Background: White"];
        assert_eq!(texts_of(&state, "")[..2], recent);
        assert_eq!(texts_of(&state, "background")[..2], recent);
        assert_eq!(texts_of(&state, "background black")[0], "Background: Black");
    }

    #[test]
    fn every_value_of_every_setting_is_found_by_its_name() {
        for (described, _) in Settings::default().settings() {
            let names: Vec<&str> = match &described.values {
                Values::Words(words) => words.list.iter().map(|word| word.title).collect(),
                Values::Kinds(kinds) => kinds.iter().map(|kind| kind.title).collect(),
                Values::Switch(_) => vec!["on", "off"],
                Values::Background | Values::Colors => continue,
                _ => vec![""],
            };
            let title = described.name();
            for name in names {
                let found = texts(&format!("{title} {name}"));
                let is_it = |text: &String| text.starts_with(title) && (name.is_empty() || text.ends_with(name));
                assert!(found.iter().any(is_it), "{title} {name}: {found:?}");
            }
        }
    }
}
