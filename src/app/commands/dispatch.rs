//! Keys become commands.

use super::commands;
use crate::app::command::Command;
use egui::{Context, Event, Key, Modifiers, Popup};

/// The command of a key by its letter, else by its place, and whether holding the key repeats it.
fn find(key: Key, physical_key: Option<Key>, modifiers: Modifiers) -> Option<(Command, bool)> {
    let by_key = |key: Key| {
        let mut rows = commands().filter_map(|row| Some((row.command, row.keys?)));
        let found = rows.find(|(_, keys)| keys.chords.iter().any(|chord| chord.matches(key, modifiers)));
        found.map(|(command, keys)| (command, keys.repeats))
    };
    by_key(key).or_else(|| physical_key.and_then(by_key))
}

/// Takes the keys that are commands out of egui's input and returns the commands.
///
/// From a text field, only keys that no text needs are taken (F keys, Ctrl combinations). A button or slider that was
/// reached with Tab keeps the keys that move or press it. A command by key closes open menus.
pub(in crate::app) fn dispatch(ctx: &Context) -> Vec<Command> {
    let focus = if ctx.text_edit_focused() {
        Focus::TextField
    } else if ctx.egui_wants_keyboard_input() {
        Focus::Widget
    } else {
        Focus::None
    };
    // Popups of the last pass: nothing of this one is laid out yet.
    let popup_is_open = Popup::is_any_open(ctx);
    let mut found = Vec::new();
    ctx.input_mut(|input| {
        input.events.retain(|event| {
            let Event::Key {
                key,
                physical_key,
                pressed: true,
                repeat,
                modifiers,
            } = *event
            else {
                return true;
            };
            let Some((command, repeats)) = find(key, physical_key, modifiers) else {
                return true;
            };
            // Escape closes an open menu first.
            let closes_popup = popup_is_open && key == Key::Escape;
            if closes_popup || focus.keeps(key, modifiers) {
                return true;
            }
            if !repeat || repeats {
                found.push(command);
            }
            false
        });
    });
    if !found.is_empty() {
        Popup::close_all(ctx);
    }
    found
}

/// Holder of keyboard focus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Focus {
    None,
    /// A button or slider, reached with Tab.
    Widget,
    TextField,
}

impl Focus {
    /// True if the focused widget needs this key.
    fn keeps(self, key: Key, modifiers: Modifiers) -> bool {
        let function_key = key.name().len() > 1 && key.name().starts_with('F');
        if modifiers.ctrl || modifiers.command || function_key {
            // Typing is undone in the field itself.
            return self == Self::TextField && matches!(key, Key::Z | Key::Y);
        }
        match self {
            Self::None => false,
            Self::TextField => true,
            Self::Widget => matches!(
                key,
                Key::Space | Key::Escape | Key::Home | Key::End | Key::ArrowLeft | Key::ArrowRight
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_combination_is_bound_twice() {
        let bound: Vec<_> = commands().filter_map(|row| row.keys).collect();
        assert!(bound.len() > 50);
        for (index, keys) in bound.iter().enumerate() {
            for chord in keys.chords {
                for shift in [false, true] {
                    if chord.shift == Some(!shift) {
                        continue;
                    }
                    let modifiers = Modifiers {
                        shift,
                        command: chord.command,
                        ..Modifiers::NONE
                    };
                    let found = bound
                        .iter()
                        .position(|other| other.chords.iter().any(|chord2| chord2.matches(chord.key, modifiers)));
                    assert_eq!(found, Some(index), "{} with {modifiers:?}", keys.text);
                }
            }
        }
    }

    #[test]
    fn letters_take_precedence_over_key_positions() {
        // On a German keyboard the key to the right of P is ü, which is bound by its position: the bracket of a US
        // keyboard.
        let found = |key, place, modifiers| find(key, place, modifiers).map(|(command, _)| command);
        assert_eq!(
            found(Key::Backtick, Some(Key::OpenBracket), Modifiers::NONE),
            Some(Command::SLOWER)
        );
        // Dvorak's P is where R is on QWERTY: the letter decides.
        assert_eq!(found(Key::P, Some(Key::R), Modifiers::NONE), Some(Command::SCREENSHOT));
        assert_eq!(found(Key::O, Some(Key::O), Modifiers::CTRL), Some(Command::OPEN_FILES));
        assert_eq!(found(Key::J, Some(Key::J), Modifiers::NONE), None);
        assert_eq!(found(Key::Space, None, Modifiers::ALT), None);
    }

    #[test]
    fn text_fields_receive_the_keys_they_need() {
        assert!(Focus::TextField.keeps(Key::L, Modifiers::NONE));
        assert!(Focus::TextField.keeps(Key::F, Modifiers::NONE));
        assert!(!Focus::None.keeps(Key::F, Modifiers::NONE));
        assert!(!Focus::TextField.keeps(Key::F1, Modifiers::NONE));
        assert!(!Focus::TextField.keeps(Key::O, Modifiers::CTRL));
        assert!(Focus::TextField.keeps(Key::Z, Modifiers::CTRL));
        assert!(!Focus::Widget.keeps(Key::Z, Modifiers::CTRL));
        assert!(Focus::Widget.keeps(Key::Space, Modifiers::NONE));
        assert!(!Focus::Widget.keeps(Key::L, Modifiers::NONE));
        assert!(!Focus::None.keeps(Key::Space, Modifiers::NONE));
    }
}
