//! What keys and menus ask for, and the one table of keys: the dispatcher and the help window both read [`BINDINGS`].

use super::inspection::Tool;
use crate::scene::ViewPreset;
use egui::{Context, Event, Key, Modifiers};

/// Something a person asks for without a value to set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Play or pause.
    TogglePlay,
    /// Pause and go this many frames on, or back.
    Step(i64),
    /// Go to the first frame.
    First,
    /// Go to the last frame.
    Last,
    /// Show the newest frame of a folder as it comes, or stop that.
    ToggleFollow,
    /// Off, loop, ping-pong.
    NextLoopMode,
    /// Play at the next lower speed.
    Slower,
    /// Play at the next higher speed.
    Faster,
    /// Play the other way.
    Reverse,
    /// Play from the frame at the playhead.
    SetIn,
    /// Play to the frame at the playhead.
    SetOut,
    /// Play the whole sequence.
    ClearRange,
    /// Put a marker at the playhead, or take it away.
    ToggleMarker,
    /// Go to the next marker.
    NextMarker,
    /// Go to the marker before.
    PreviousMarker,
    /// The camera as it was when the sequence was opened.
    ResetView,
    /// Look along an axis.
    Look(ViewPreset),
    /// Parallel rays and back.
    ToggleOrthographic,
    /// The camera turns by itself, or stops.
    ToggleTurntable,
    /// What the pointer is over comes into the middle.
    Focus,
    /// Put the view on the clipboard as text.
    CopyView,
    /// Take the view from the text on the clipboard.
    PasteView,
    /// Choose what a click on the picture does, or put that away.
    ToggleTool(Tool),
    /// Smaller splats or points.
    Smaller,
    /// Larger splats or points.
    Larger,
    /// Open files with a dialog.
    OpenFiles,
    /// Open a folder with a dialog.
    OpenFolder,
    /// Open the demo sequence.
    OpenDemo,
    /// Write the picture to a new file.
    Screenshot,
    /// Write the picture to a file chosen with a dialog.
    SaveScreenshotAs,
    /// Full screen and back.
    FullScreen,
    /// Show or hide the settings.
    ToggleSettings,
    /// Show or hide the statistics.
    ToggleStatistics,
    /// Two ways to draw side by side, and back.
    ToggleComparison,
    /// Take back the last change of the settings.
    Undo,
    /// Make it again.
    Redo,
    /// Find commands by their names, or stop that.
    TogglePalette,
    /// Show or hide the keys.
    ToggleHelp,
    /// Close what is open, or leave full screen.
    Escape,
    /// End the program.
    Quit,
}

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
    const fn plain(key: Key) -> Self {
        Self {
            key,
            command: false,
            shift: Some(false),
        }
    }

    const fn shift(key: Key) -> Self {
        Self {
            shift: Some(true),
            ..Self::plain(key)
        }
    }

    const fn any_shift(key: Key) -> Self {
        Self {
            shift: None,
            ..Self::plain(key)
        }
    }

    const fn ctrl(key: Key) -> Self {
        Self {
            command: true,
            ..Self::plain(key)
        }
    }

    const fn ctrl_shift(key: Key) -> Self {
        Self {
            shift: Some(true),
            ..Self::ctrl(key)
        }
    }

    fn matches(self, key: Key, modifiers: Modifiers) -> bool {
        self.key == key
            && self.command == (modifiers.command || modifiers.ctrl)
            && self.shift.is_none_or(|shift| shift == modifiers.shift)
            && !modifiers.alt
    }
}

/// A row of the table.
#[derive(Debug, Clone, Copy)]
pub struct Binding {
    /// Heading in the help window.
    pub group: &'static str,
    /// The keys as a person reads them.
    pub keys: &'static str,
    /// What they do.
    pub text: &'static str,
    /// What is dispatched.
    pub command: Command,
    /// The combinations.
    pub chords: &'static [Chord],
    /// True if holding the key repeats the command.
    pub repeats: bool,
}

const fn binding(
    group: &'static str,
    keys: &'static str,
    text: &'static str,
    command: Command,
    chords: &'static [Chord],
) -> Binding {
    Binding {
        group,
        keys,
        text,
        command,
        chords,
        repeats: false,
    }
}

const fn repeating(binding: Binding) -> Binding {
    Binding {
        repeats: true,
        ..binding
    }
}

const PLAY: &str = "Playing";
const VIEW: &str = "View";
const POINTS: &str = "Points";
const FILE: &str = "File and window";

/// Every key, grouped.
pub const BINDINGS: &[Binding] = &[
    binding(
        PLAY,
        "Space",
        "Play or pause",
        Command::TogglePlay,
        &[Chord::plain(Key::Space)],
    ),
    repeating(binding(
        PLAY,
        "Right",
        "Next frame",
        Command::Step(1),
        &[Chord::plain(Key::ArrowRight)],
    )),
    repeating(binding(
        PLAY,
        "Left",
        "Previous frame",
        Command::Step(-1),
        &[Chord::plain(Key::ArrowLeft)],
    )),
    repeating(binding(
        PLAY,
        "Shift+Right",
        "Ten frames on",
        Command::Step(10),
        &[Chord::shift(Key::ArrowRight)],
    )),
    repeating(binding(
        PLAY,
        "Shift+Left",
        "Ten frames back",
        Command::Step(-10),
        &[Chord::shift(Key::ArrowLeft)],
    )),
    binding(
        PLAY,
        "Home",
        "First frame",
        Command::First,
        &[Chord::plain(Key::Home)],
    ),
    binding(
        PLAY,
        "End",
        "Last frame",
        Command::Last,
        &[Chord::plain(Key::End)],
    ),
    binding(
        PLAY,
        "Shift+End",
        "Follow the newest frame of a folder that grows",
        Command::ToggleFollow,
        &[Chord::shift(Key::End)],
    ),
    binding(
        PLAY,
        "L",
        "Loop mode: off, loop, ping-pong",
        Command::NextLoopMode,
        &[Chord::plain(Key::L)],
    ),
    repeating(binding(
        PLAY,
        "[",
        "Slower",
        Command::Slower,
        &[Chord::any_shift(Key::OpenBracket)],
    )),
    repeating(binding(
        PLAY,
        "]",
        "Faster",
        Command::Faster,
        &[Chord::any_shift(Key::CloseBracket)],
    )),
    binding(
        PLAY,
        "Backspace",
        "Play the other way",
        Command::Reverse,
        &[Chord::plain(Key::Backspace)],
    ),
    binding(
        PLAY,
        "Shift+I",
        "In point: play from here",
        Command::SetIn,
        &[Chord::shift(Key::I)],
    ),
    binding(
        PLAY,
        "Shift+O",
        "Out point: play to here",
        Command::SetOut,
        &[Chord::shift(Key::O)],
    ),
    binding(
        PLAY,
        "Shift+X",
        "Clear in and out point",
        Command::ClearRange,
        &[Chord::shift(Key::X)],
    ),
    binding(
        PLAY,
        "Ctrl+M",
        "Add or remove a marker",
        Command::ToggleMarker,
        &[Chord::ctrl(Key::M)],
    ),
    binding(
        PLAY,
        "Shift+M",
        "Next marker",
        Command::NextMarker,
        &[Chord::shift(Key::M)],
    ),
    binding(
        PLAY,
        "Ctrl+Shift+M",
        "Previous marker",
        Command::PreviousMarker,
        &[Chord::ctrl_shift(Key::M)],
    ),
    binding(
        VIEW,
        "R",
        "Reset the view",
        Command::ResetView,
        &[Chord::plain(Key::R)],
    ),
    binding(
        VIEW,
        "1",
        "Front",
        Command::Look(ViewPreset::Front),
        &[Chord::plain(Key::Num1)],
    ),
    binding(
        VIEW,
        "2",
        "Back",
        Command::Look(ViewPreset::Back),
        &[Chord::plain(Key::Num2)],
    ),
    binding(
        VIEW,
        "3",
        "Left",
        Command::Look(ViewPreset::Left),
        &[Chord::plain(Key::Num3)],
    ),
    binding(
        VIEW,
        "4",
        "Right",
        Command::Look(ViewPreset::Right),
        &[Chord::plain(Key::Num4)],
    ),
    binding(
        VIEW,
        "5",
        "Top",
        Command::Look(ViewPreset::Top),
        &[Chord::plain(Key::Num5)],
    ),
    binding(
        VIEW,
        "6",
        "Bottom",
        Command::Look(ViewPreset::Bottom),
        &[Chord::plain(Key::Num6)],
    ),
    binding(
        VIEW,
        "O",
        "Orthographic, perspective",
        Command::ToggleOrthographic,
        &[Chord::plain(Key::O)],
    ),
    binding(
        VIEW,
        "T",
        "Turntable",
        Command::ToggleTurntable,
        &[Chord::plain(Key::T)],
    ),
    binding(
        VIEW,
        "F",
        "Focus on what the pointer is over",
        Command::Focus,
        &[Chord::plain(Key::F)],
    ),
    binding(
        VIEW,
        "Ctrl+C",
        "Copy the view as text",
        Command::CopyView,
        &[Chord::ctrl(Key::C)],
    ),
    binding(
        VIEW,
        "Ctrl+V",
        "Paste a view",
        Command::PasteView,
        &[Chord::ctrl(Key::V)],
    ),
    repeating(binding(
        VIEW,
        "+",
        "Larger splats or points",
        Command::Larger,
        &[Chord::any_shift(Key::Plus), Chord::any_shift(Key::Equals)],
    )),
    repeating(binding(
        VIEW,
        "-",
        "Smaller splats or points",
        Command::Smaller,
        &[Chord::any_shift(Key::Minus)],
    )),
    binding(
        VIEW,
        "C",
        "Compare two ways to draw",
        Command::ToggleComparison,
        &[Chord::plain(Key::C)],
    ),
    binding(
        VIEW,
        "F2",
        "Settings",
        Command::ToggleSettings,
        &[Chord::plain(Key::F2)],
    ),
    binding(
        VIEW,
        "F3",
        "Statistics",
        Command::ToggleStatistics,
        &[Chord::plain(Key::F3)],
    ),
    binding(
        VIEW,
        "F11",
        "Full screen",
        Command::FullScreen,
        &[Chord::plain(Key::F11)],
    ),
    binding(
        POINTS,
        "I",
        "Show the values of points",
        Command::ToggleTool(Tool::Point),
        &[Chord::plain(Key::I)],
    ),
    binding(
        POINTS,
        "M",
        "Measure",
        Command::ToggleTool(Tool::Measure),
        &[Chord::plain(Key::M)],
    ),
    binding(
        FILE,
        "Ctrl+O",
        "Open files",
        Command::OpenFiles,
        &[Chord::ctrl(Key::O)],
    ),
    binding(
        FILE,
        "P",
        "Save a picture",
        Command::Screenshot,
        &[Chord::plain(Key::P)],
    ),
    binding(
        FILE,
        "Ctrl+Z",
        "Undo the last change of settings",
        Command::Undo,
        &[Chord::ctrl(Key::Z)],
    ),
    binding(
        FILE,
        "Ctrl+Y, Ctrl+Shift+Z",
        "Redo it",
        Command::Redo,
        &[Chord::ctrl(Key::Y), Chord::ctrl_shift(Key::Z)],
    ),
    binding(
        FILE,
        "Ctrl+P",
        "Find a command by its name",
        Command::TogglePalette,
        &[Chord::ctrl(Key::P)],
    ),
    binding(
        FILE,
        "F1",
        "This list",
        Command::ToggleHelp,
        &[Chord::plain(Key::F1)],
    ),
    binding(
        FILE,
        "Esc",
        "Close this list, clear points, leave full screen",
        Command::Escape,
        &[Chord::plain(Key::Escape)],
    ),
    binding(
        FILE,
        "Ctrl+Q",
        "Quit",
        Command::Quit,
        &[Chord::ctrl(Key::Q)],
    ),
];

/// What the mouse and the fly keys do, for the help window.
pub const GESTURES: &[(&str, &str)] = &[
    ("Left drag", "Orbit"),
    ("Middle or right drag, Shift + left drag", "Pan"),
    ("Ctrl + left drag", "Look around"),
    ("Wheel, pinch", "Zoom"),
    ("Double click", "Focus on a point, or frame the cloud"),
    ("W A S D", "Fly forward, left, back, right"),
    ("E Q", "Fly up, down"),
    ("Shift, Ctrl while flying", "Faster, slower"),
    ("Ctrl and +, -, 0", "Size of text and buttons"),
];

/// The keys of `command` as a person reads them, for menus and tooltips; empty without any.
pub(super) fn keys_of(command: Command) -> &'static str {
    BINDINGS
        .iter()
        .find(|binding| binding.command == command)
        .map_or("", |binding| binding.keys)
}

/// The binding of a key by its letter, else by its place.
fn find(key: Key, physical_key: Option<Key>, modifiers: Modifiers) -> Option<&'static Binding> {
    let by_key = |key: Key| {
        BINDINGS.iter().find(|binding| {
            binding
                .chords
                .iter()
                .any(|chord| chord.matches(key, modifiers))
        })
    };
    by_key(key).or_else(|| physical_key.and_then(by_key))
}

/// Takes the keys that are commands out of egui's input and returns what they ask for.
///
/// Nothing is taken from a text field but what no text needs (F keys, Ctrl combinations). A button or slider that
/// was reached with Tab keeps the keys that move or press it.
pub(super) fn dispatch(ctx: &Context) -> Vec<Command> {
    let focus = if ctx.text_edit_focused() {
        Focus::TextField
    } else if ctx.egui_wants_keyboard_input() {
        Focus::Widget
    } else {
        Focus::None
    };
    let popup_is_open = ctx.any_popup_open();
    let mut commands = Vec::new();
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
            let Some(binding) = find(key, physical_key, modifiers) else {
                return true;
            };
            // An open menu is what Escape closes first.
            let closes_popup = popup_is_open && key == Key::Escape;
            if closes_popup || focus.keeps(key, modifiers) {
                return true;
            }
            if !repeat || binding.repeats {
                commands.push(binding.command);
            }
            false
        });
    });
    commands
}

/// What has the keyboard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Focus {
    None,
    /// A button or slider, reached with Tab.
    Widget,
    TextField,
}

impl Focus {
    /// True if what has the keyboard needs this key.
    fn keeps(self, key: Key, modifiers: Modifiers) -> bool {
        let function_key = key.name().len() > 1 && key.name().starts_with('F');
        if modifiers.ctrl || modifiers.command || function_key {
            // What is typed is undone where it is typed.
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
    fn no_combination_is_bound_twice() {
        for (index, binding) in BINDINGS.iter().enumerate() {
            for chord in binding.chords {
                for shift in [false, true] {
                    if chord.shift == Some(!shift) {
                        continue;
                    }
                    let modifiers = Modifiers {
                        shift,
                        command: chord.command,
                        ..Modifiers::NONE
                    };
                    let found = BINDINGS.iter().position(|other| {
                        other
                            .chords
                            .iter()
                            .any(|chord2| chord2.matches(chord.key, modifiers))
                    });
                    assert_eq!(found, Some(index), "{} with {modifiers:?}", binding.keys);
                }
            }
        }
    }

    #[test]
    fn letters_go_before_places() {
        // On a German keyboard the key right of P is ü, which is bound by its place: the bracket of a US keyboard.
        let found =
            |key, place, modifiers| find(key, place, modifiers).map(|binding| binding.command);
        assert_eq!(
            found(Key::Backtick, Some(Key::OpenBracket), Modifiers::NONE),
            Some(Command::Slower)
        );
        // Dvorak's P is where R is: the letter decides.
        assert_eq!(
            found(Key::P, Some(Key::R), Modifiers::NONE),
            Some(Command::Screenshot)
        );
        assert_eq!(
            found(Key::O, Some(Key::O), Modifiers::CTRL),
            Some(Command::OpenFiles)
        );
        assert_eq!(found(Key::K, Some(Key::K), Modifiers::NONE), None);
        assert_eq!(found(Key::Space, None, Modifiers::ALT), None);
    }

    #[test]
    fn text_fields_keep_what_they_need() {
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
