//! The table of commands, called by keys, menus, the palette, tests and scripts.
//!
//! **How it works.** A command is a [`CommandRow`]: title, words, keys, a condition with the reason if it does not
//! apply, and its action. Commands of a feature are in its folder; the others are here. A panel that a menu opens is a
//! command without a row. [`State::run`] executes a command; one that does not apply reports so itself, or does
//! nothing.

mod colors;
pub(super) mod common;
mod dispatch;
mod file;
mod playing;
mod values;
mod view;
mod window;

pub(super) use dispatch::dispatch;
pub(super) use file::opens_example;

use super::command::{Act, Command, CommandRow};
use super::features::Features;
use super::features::feature::Feature;
use super::open_panels::PanelId;
use super::state::State;

/// All commands but the panels of menus.
pub fn commands() -> impl Iterator<Item = &'static CommandRow<State>> {
    let own = [
        playing::ROWS,
        view::ROWS,
        file::ROWS,
        window::ROWS,
        values::ROWS,
        colors::ROWS,
    ];
    let of_features = Features::rows::<State>().into_iter();
    let of_features = of_features.map(Feature::commands);
    own.into_iter().chain(of_features).flatten()
}

/// The row of a command; `None` of a panel that has none.
pub(super) fn row_of(command: Command) -> Option<&'static CommandRow<State>> {
    commands().find(|row| row.command == command)
}

/// The keys of `command` as display text, for menus and tooltips; empty without any.
pub(super) fn keys_of(command: Command) -> &'static str {
    row_of(command).map_or("", CommandRow::keys_text)
}

impl State {
    /// Executes a command of a key, a menu or a script.
    pub fn run(&mut self, command: Command) {
        match row_of(command).map(|row| &row.act) {
            Some(Act::Run(run)) => run(self),
            // See [`State::give`].
            Some(Act::Take(..)) => {}
            // A panel that needs no further action when it opens.
            None => self.panels.toggle(PanelId::new(command.word())),
        }
    }
}

impl State {
    /// Executes a command with a value.
    ///
    /// # Errors
    /// A sentence with the reason why it does not apply or the value is invalid.
    pub fn give(&mut self, command: Command, value: &str) -> Result<(), String> {
        let row = row_of(command).filter(|row| matches!(row.act, Act::Take(..)));
        let Some(CommandRow {
            act: Act::Take(_, take),
            ..
        }) = row
        else {
            return Err(format!("{} takes no value", command.word()));
        };
        if let Some(reason) = row.and_then(|row| row.why_not(self)) {
            return Err(reason.to_owned());
        }
        take(self, value)
    }

    /// [`State::give`], which reports errors to the user.
    pub(super) fn give_or_tell(&mut self, command: Command, value: &str) {
        if let Err(reason) = self.give(command, value) {
            self.notices.warn(reason);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn words_and_titles_are_unique() {
        let (mut words, mut titles) = (BTreeSet::new(), BTreeSet::new());
        for row in commands() {
            assert!(words.insert(row.command.word()), "{}", row.command.word());
            assert!(titles.insert(row.title.to_lowercase()), "{}", row.title);
        }
        assert!(words.len() > 80, "{}", words.len());
    }

    #[test]
    fn commands_that_do_not_apply_say_why() {
        let state = State::new(crate::app::StateOptions::default());
        let row = row_of(Command::SAVE_SESSION).unwrap();
        assert_eq!(row.why_not(&state), Some("Nothing is open yet"));
        assert_eq!(row_of(Command::TOGGLE_GRID).unwrap().why_not(&state), None);
    }
}
