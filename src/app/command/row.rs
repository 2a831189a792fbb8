//! A command as menus, keys, the palette and scripts know it.

use super::keys::{Chord, Keys};
use super::kinds::Command;
use super::offer::Offer;
use std::borrow::Cow;

/// A menu that lists commands by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Menu {
    /// File menu: opening, saving and closing; at its end.
    File,
    /// Undo, copies; at its end.
    Edit,
    /// All of its items but panels.
    Tools,
}

/// Action of a command.
#[derive(Debug)]
pub(in crate::app) enum Act<S> {
    /// Something without a value.
    Run(fn(&mut S)),
    /// Something with a value that a script gives; the text names it. `Err` is a sentence for the user.
    Take(&'static str, fn(&mut S, &str) -> Result<(), String>),
}

/// Values that the palette offers, for a query with this number.
pub(in crate::app) type Offers<S> = fn(&S, Option<f64>) -> Vec<Offer>;

/// A row of the table of commands of a window with the state `S`.
#[derive(Debug)]
pub struct CommandRow<S: 'static> {
    /// Its name in the program, which is its word in scripts.
    pub command: Command,
    /// Its title in menus and in the palette.
    pub title: &'static str,
    /// Short description of the command, for the list of keys; found in the palette as well.
    pub what: &'static str,
    /// Hint: a one-sentence description of the command; empty where the title suffices.
    pub hint: &'static str,
    /// Words of other programs that find it.
    pub synonyms: &'static [&'static str],
    /// Its keys, if it has some.
    pub keys: Option<Keys>,
    /// The menu that lists it by itself.
    pub menu: Option<Menu>,
    pub(in crate::app) title_now: Option<fn(&S) -> Cow<'static, str>>,
    pub(in crate::app) is_on: Option<fn(&S) -> bool>,
    pub(in crate::app) applies: fn(&S) -> Result<(), &'static str>,
    /// The values that the palette offers, for a query with this number.
    pub(in crate::app) offers: Option<Offers<S>>,
    pub(in crate::app) act: Act<S>,
}

impl<S: 'static> CommandRow<S> {
    /// A command that does something, without keys, whenever it is called.
    pub(in crate::app) const fn new(command: Command, title: &'static str, run: fn(&mut S)) -> Self {
        Self::with(command, title, Act::Run(run))
    }

    /// A command of scripts, which takes the value that `value` names.
    pub(in crate::app) const fn taking(
        command: Command,
        title: &'static str,
        value: &'static str,
        take: fn(&mut S, &str) -> Result<(), String>,
    ) -> Self {
        Self::with(command, title, Act::Take(value, take))
    }

    const fn with(command: Command, title: &'static str, act: Act<S>) -> Self {
        Self {
            command,
            title,
            what: title,
            hint: "",
            synonyms: &[],
            keys: None,
            menu: None,
            title_now: None,
            is_on: None,
            applies: |_| Ok(()),
            offers: None,
            act,
        }
    }

    /// Sets the short description of the command.
    pub(in crate::app) const fn what(mut self, what: &'static str) -> Self {
        self.what = what;
        self
    }

    /// Sets the hint, a one-sentence description of the command.
    pub(in crate::app) const fn hint(mut self, hint: &'static str) -> Self {
        self.hint = hint;
        self
    }

    /// Adds synonyms from other programs.
    pub(in crate::app) const fn also(mut self, synonyms: &'static [&'static str]) -> Self {
        self.synonyms = synonyms;
        self
    }

    /// Adds values that the palette offers.
    pub(in crate::app) const fn offers(mut self, offers: Offers<S>) -> Self {
        self.offers = Some(offers);
        self
    }

    /// Adds key bindings, under a heading of the help window.
    pub(in crate::app) const fn keys(
        mut self,
        group: &'static str,
        text: &'static str,
        chords: &'static [Chord],
    ) -> Self {
        self.keys = Some(Keys {
            group,
            text,
            chords,
            repeats: false,
        });
        self
    }

    /// Makes the key bindings repeat the command while they are held; after [`CommandRow::keys`].
    pub(in crate::app) const fn repeating(mut self) -> Self {
        if let Some(keys) = &mut self.keys {
            keys.repeats = true;
        }
        self
    }

    /// Makes the row an item of a menu that lists its commands by itself.
    pub(in crate::app) const fn in_menu(mut self, menu: Menu) -> Self {
        self.menu = Some(menu);
        self
    }

    /// Sets a dynamic title that depends on the state.
    pub(in crate::app) const fn titled(mut self, title: fn(&S) -> Cow<'static, str>) -> Self {
        self.title_now = Some(title);
        self
    }

    /// Makes the row a toggle that is on or off.
    pub(in crate::app) const fn on_if(mut self, is_on: fn(&S) -> bool) -> Self {
        self.is_on = Some(is_on);
        self
    }

    /// Sets the availability check of the command; `Err` states why it does not apply.
    pub(in crate::app) const fn applies(mut self, applies: fn(&S) -> Result<(), &'static str>) -> Self {
        self.applies = applies;
        self
    }

    /// Its title in the current state.
    pub fn title(&self, state: &S) -> Cow<'static, str> {
        self.title_now.map_or(Cow::Borrowed(self.title), |title| title(state))
    }

    /// Why it does not apply; `None` if it does.
    pub fn why_not(&self, state: &S) -> Option<&'static str> {
        (self.applies)(state).err()
    }

    /// Its keys as display text; empty without any.
    pub(in crate::app) fn keys_text(&self) -> &'static str {
        self.keys.map_or("", |keys| keys.text)
    }
}
