//! Styles and words that are short for several of their settings.

use super::Settings;
use super::describe::{Shorthand, Value};

impl Settings {
    /// Returns true if this style has all the values that a shorthand stands for.
    pub fn has_all_of(&self, shorthand: &Shorthand) -> bool {
        let settings = self.settings();
        let has = |&(key, given): &(&str, Value)| settings.iter().any(|(it, value)| it.key == key && *value == given);
        shorthand.given.iter().all(has)
    }

    /// Takes the values that a word is short for.
    pub fn take(&mut self, shorthand: &Shorthand) {
        self.change_each(shorthand, |given, _| given);
    }

    /// Resets the settings other than the word's own to their defaults, if it has all values that it is short for.
    pub fn take_back(&mut self, shorthand: &Shorthand) {
        if self.has_all_of(shorthand) {
            let own = shorthand.given.first().map(|(key, _)| *key);
            let usual = Self::default().settings();
            let usual = |key| usual.iter().find(|(it, _)| it.key == key).map(|(_, value)| *value);
            self.change_each(shorthand, |given, key| {
                usual(key).filter(|_| Some(key) != own).unwrap_or(given)
            });
        }
    }

    fn change_each(&mut self, shorthand: &Shorthand, change: impl Fn(Value, &'static str) -> Value) {
        self.edit(&mut |described, value| {
            let given = shorthand.given.iter().find(|(key, _)| *key == described.key);
            given.map_or(value, |&(key, given)| change(given, key))
        });
    }
}
