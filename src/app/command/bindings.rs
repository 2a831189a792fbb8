//! The table of keys.

use super::kinds::Command;
use crate::app::features::inspection::Tool;
use crate::app::open_panels::PanelId;
use crate::scene::ViewPreset;
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

    pub(super) fn matches(self, key: Key, modifiers: Modifiers) -> bool {
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

const fn repeating(binding: Binding) -> Binding {
    Binding {
        repeats: true,
        ..binding
    }
}

/// Writes the table once: for each group its keys as a person reads them, their combinations, the command, and what it
/// does.
macro_rules! bindings {
    ($($group:literal {
        $($($repeating:ident)? $keys:literal [$($chord:ident $key:ident),+] => $command:expr, $text:literal;)+
    })+) => {
        &[$($($($repeating)?(Binding {
            group: $group,
            keys: $keys,
            text: $text,
            command: $command,
            chords: &[$(Chord::$chord(Key::$key)),+],
            repeats: false,
        }),)+)+]
    };
}

/// Every key, grouped.
pub const BINDINGS: &[Binding] = bindings! {
    "Playing" {
        "Space" [plain Space] => Command::TogglePlay, "Play or pause";
        repeating "Right" [plain ArrowRight] => Command::Step(1), "Next frame";
        repeating "Left" [plain ArrowLeft] => Command::Step(-1), "Previous frame";
        repeating "Shift+Right" [shift ArrowRight] => Command::Step(10), "Ten frames on";
        repeating "Shift+Left" [shift ArrowLeft] => Command::Step(-10), "Ten frames back";
        "Home" [plain Home] => Command::First, "First frame";
        "End" [plain End] => Command::Last, "Last frame";
        "Shift+End" [shift End] => Command::ToggleFollow, "Follow the newest frame of a folder that grows";
        "L" [plain L] => Command::NextLoopMode, "Loop mode: off, loop, ping-pong";
        repeating "[" [any_shift OpenBracket] => Command::Slower, "Slower";
        repeating "]" [any_shift CloseBracket] => Command::Faster, "Faster";
        "Backspace" [plain Backspace] => Command::Reverse, "Play the other way";
        "Shift+I" [shift I] => Command::SetIn, "In point: play from here";
        "Shift+O" [shift O] => Command::SetOut, "Out point: play to here";
        "Shift+X" [shift X] => Command::ClearRange, "Clear in and out point";
        "Ctrl+M" [ctrl M] => Command::ToggleMarker, "Add or remove a marker";
        "Shift+M" [shift M] => Command::NextMarker, "Next marker";
        "Ctrl+Shift+M" [ctrl_shift M] => Command::PreviousMarker, "Previous marker";
    }
    "View" {
        "R" [plain R] => Command::ResetView, "Reset the view";
        "Shift+R" [shift R] => Command::FrameAll, "Frame everything";
        "1" [plain Num1] => Command::Look(ViewPreset::Front), "Front";
        "2" [plain Num2] => Command::Look(ViewPreset::Back), "Back";
        "3" [plain Num3] => Command::Look(ViewPreset::Left), "Left";
        "4" [plain Num4] => Command::Look(ViewPreset::Right), "Right";
        "5" [plain Num5] => Command::Look(ViewPreset::Top), "Top";
        "6" [plain Num6] => Command::Look(ViewPreset::Bottom), "Bottom";
        "O" [plain O] => Command::ToggleOrthographic, "Orthographic, perspective";
        "T" [plain T] => Command::ToggleTurntable, "Turntable";
        "G" [plain G] => Command::ToggleGrid, "Grid on the ground";
        "F" [plain F] => Command::Focus, "Focus on what the pointer is over";
        "Ctrl+C" [ctrl C] => Command::CopyView, "Copy the view as text";
        "Ctrl+V" [ctrl V] => Command::PasteView, "Paste a view";
        repeating "+" [any_shift Plus, any_shift Equals] => Command::Larger, "Larger splats or points";
        repeating "-" [any_shift Minus] => Command::Smaller, "Smaller splats or points";
        "C" [plain C] => Command::ToggleComparison, "Compare two ways to draw";
        "Shift+C" [shift C] => Command::NextLayout, "Two sequences: side by side, or a line over the same view";
        "F2" [plain F2] => Command::TogglePanel(PanelId::SETTINGS), "Settings";
        "F3" [plain F3] => Command::TogglePanel(PanelId::STATISTICS), "Statistics";
        "F4" [plain F4] => Command::TogglePanel(PanelId::CAMERA_PATH), "Camera path";
        "K" [plain K] => Command::AddKeyframe, "Add a keyframe of what is shown";
        "Shift+K" [shift K] => Command::TogglePreview, "Play the camera path, or stop";
        "F11" [plain F11] => Command::FullScreen, "Full screen";
    }
    "Points" {
        "I" [plain I] => Command::ToggleTool(Tool::Point), "Show the values of points";
        "M" [plain M] => Command::ToggleTool(Tool::Measure), "Measure";
        "N" [plain N] => Command::ToggleTool(Tool::Label), "Put labels at points";
        "Shift+T" [shift T] => Command::ToggleTrails, "Trails of the picked points";
    }
    "File and window" {
        "Ctrl+O" [ctrl O] => Command::OpenFiles, "Open files";
        "Ctrl+Shift+O" [ctrl_shift O] => Command::CompareFiles, "Compare with files";
        "Ctrl+S" [ctrl S] => Command::SaveSession, "Save the session: files, view, settings, labels";
        "Ctrl+Shift+S" [ctrl_shift S] => Command::ToggleSave, "Save the sequence as a file or a folder";
        "P" [plain P] => Command::Screenshot, "Save a picture";
        "Shift+P" [shift P] => Command::ToggleExport, "Export a picture or a video";
        "Ctrl+Z" [ctrl Z] => Command::Undo, "Undo the last change of settings, path or labels";
        "Ctrl+Y, Ctrl+Shift+Z" [ctrl Y, ctrl_shift Z] => Command::Redo, "Redo it";
        "Ctrl+P" [ctrl P] => Command::TogglePalette, "Find a command by its name";
        "F1" [plain F1] => Command::TogglePanel(PanelId::HELP), "This list of keys";
        "Esc" [plain Escape] => Command::Escape, "Stop, close this list, clear points, leave full screen";
        "Ctrl+Q" [ctrl Q] => Command::Quit, "Quit";
    }
};

/// What the mouse and the fly keys do, for the help window.
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
