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
    binding(PLAY, "Home", "First frame", Command::First, &[Chord::plain(Key::Home)]),
    binding(PLAY, "End", "Last frame", Command::Last, &[Chord::plain(Key::End)]),
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
    binding(VIEW, "R", "Reset the view", Command::ResetView, &[Chord::plain(Key::R)]),
    binding(
        VIEW,
        "Shift+R",
        "Frame everything",
        Command::FrameAll,
        &[Chord::shift(Key::R)],
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
        "G",
        "Grid on the ground",
        Command::ToggleGrid,
        &[Chord::plain(Key::G)],
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
        "Shift+C",
        "Two sequences: side by side, or a line over the same view",
        Command::NextLayout,
        &[Chord::shift(Key::C)],
    ),
    binding(
        VIEW,
        "F2",
        "Settings",
        Command::TogglePanel(PanelId::SETTINGS),
        &[Chord::plain(Key::F2)],
    ),
    binding(
        VIEW,
        "F3",
        "Statistics",
        Command::TogglePanel(PanelId::STATISTICS),
        &[Chord::plain(Key::F3)],
    ),
    binding(
        VIEW,
        "F4",
        "Camera path",
        Command::TogglePanel(PanelId::CAMERA_PATH),
        &[Chord::plain(Key::F4)],
    ),
    binding(
        VIEW,
        "K",
        "Add a keyframe of what is shown",
        Command::AddKeyframe,
        &[Chord::plain(Key::K)],
    ),
    binding(
        VIEW,
        "Shift+K",
        "Play the camera path, or stop",
        Command::TogglePreview,
        &[Chord::shift(Key::K)],
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
        POINTS,
        "Shift+T",
        "Trails of the picked points",
        Command::ToggleTrails,
        &[Chord::shift(Key::T)],
    ),
    binding(FILE, "Ctrl+O", "Open files", Command::OpenFiles, &[Chord::ctrl(Key::O)]),
    binding(
        FILE,
        "Ctrl+Shift+O",
        "Compare with files",
        Command::CompareFiles,
        &[Chord::ctrl_shift(Key::O)],
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
        "Shift+P",
        "Export a picture or a video",
        Command::ToggleExport,
        &[Chord::shift(Key::P)],
    ),
    binding(
        FILE,
        "Ctrl+Z",
        "Undo the last change of settings or path",
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
        Command::TogglePanel(PanelId::HELP),
        &[Chord::plain(Key::F1)],
    ),
    binding(
        FILE,
        "Esc",
        "Stop, close this list, clear points, leave full screen",
        Command::Escape,
        &[Chord::plain(Key::Escape)],
    ),
    binding(FILE, "Ctrl+Q", "Quit", Command::Quit, &[Chord::ctrl(Key::Q)]),
];

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
