//! Key combinations and mouse gestures.

use egui::{Key, Modifiers};

/// One combination of keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Chord {
    /// By its letter; where no binding has the letter, by its place on a US keyboard.
    pub key: Key,
    /// Ctrl (Command on a Mac).
    pub command: bool,
    /// `None`: with and without.
    pub shift: Option<bool>,
}

impl Chord {
    pub(in crate::app) const fn plain(key: Key) -> Self {
        Self {
            key,
            command: false,
            shift: Some(false),
        }
    }

    pub(in crate::app) const fn shift(key: Key) -> Self {
        Self {
            shift: Some(true),
            ..Self::plain(key)
        }
    }

    pub(in crate::app) const fn any_shift(key: Key) -> Self {
        Self {
            shift: None,
            ..Self::plain(key)
        }
    }

    pub(in crate::app) const fn ctrl(key: Key) -> Self {
        Self {
            command: true,
            ..Self::plain(key)
        }
    }

    pub(in crate::app) const fn ctrl_shift(key: Key) -> Self {
        Self {
            shift: Some(true),
            ..Self::ctrl(key)
        }
    }

    pub(in crate::app) fn matches(self, key: Key, modifiers: Modifiers) -> bool {
        self.key == key
            && self.command == (modifiers.command || modifiers.ctrl)
            && self.shift.is_none_or(|shift| shift == modifiers.shift)
            && !modifiers.alt
    }
}

/// The keys of a command.
#[derive(Debug, Clone, Copy)]
pub struct Keys {
    /// Heading in the help window.
    pub group: &'static str,
    /// Display text.
    pub text: &'static str,
    /// The combinations.
    pub chords: &'static [Chord],
    /// True if holding the key repeats the command.
    pub repeats: bool,
}

/// Actions of the mouse and the fly keys, for the help window.
pub const GESTURES: &[(&str, &str)] = &[
    ("Left drag", "Orbit"),
    ("Middle or right drag, Shift + left drag", "Pan"),
    ("Ctrl + left drag", "Look around"),
    ("Wheel, pinch", "Zoom"),
    ("Drop files or a folder", "Open them; with Shift, compare with them"),
    ("Double click", "Focus on a point, or frame the cloud"),
    ("W A S D", "Fly forward, left, back, right"),
    ("E Q", "Fly up, down"),
    ("Shift, Ctrl while flying", "Faster, slower"),
    ("Ctrl and +, -, 0", "Size of text and buttons"),
];
