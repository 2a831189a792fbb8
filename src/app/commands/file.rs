//! Commands that open, save and close.

use super::common::{Row, group, needs_sequence, of_point_clouds};
use crate::app::command::{Chord, Command};
use crate::app::side::Side;
use crate::app::state::{Dialog, State, WindowRequest};
use crate::app::work::files::with_extension;
use crate::export::PictureFormat;
use crate::sequence::Sequence;
use crate::source::Example;
use egui::Key;
use std::sync::Arc;

pub(super) const ROWS: &[Row] = &[
    Row::new(Command::OPEN_FILES, "Open files…", |state| {
        state.ask(of_point_clouds(Dialog::files("Open point clouds", State::open_paths)));
    })
    .what("Open files…")
    .also(&["load", "import", "add data", "browse"])
    .keys(group::FILE, "Ctrl+O", &[Chord::ctrl(Key::O)]),
    Row::new(Command::OPEN_FOLDER, "Open folder…", |state| {
        state.ask(Dialog::folder(
            "Open a folder of frames",
            |state: &mut State, folder| {
                state.open_paths(vec![folder]);
            },
        ));
    })
    .what("Open a folder…")
    .also(&["load", "import", "directory", "image sequence", "dataset"]),
    Row::new(Command::OPEN_DEMO, "Demo", |state| {
        state.open(Arc::new(Sequence::demo()));
    })
    .what("Open the demo")
    .also(&["sample data", "example"]),
    Row::new(Command::EXAMPLE_LIDAR, "LiDAR survey", |state| {
        state.open_example(Example::Lidar);
    })
    .what("Open an example: LiDAR survey")
    .also(&["sample data"]),
    Row::new(Command::EXAMPLE_DEPTH, "Depth image", |state| {
        state.open_example(Example::Depth);
    })
    .what("Open an example: depth image")
    .also(&["sample data", "rgbd"]),
    Row::new(Command::EXAMPLE_MODEL, "Animated model", |state| {
        state.open_example(Example::Model);
    })
    .what("Open an example: animated model")
    .also(&["sample data", "mesh"]),
    Row::new(Command::SAVE_PRESET, "Save settings…", |state| {
        state.stored.preset_name = Some(String::new());
    })
    .what("Save settings as a preset…")
    .also(&["store look", "new preset"])
    .hint("Saves the current settings under a name"),
    Row::new(Command::CLOSE_SEQUENCE, "Close", |state| {
        state.end_comparison(Side::A);
        state.close_sequence();
    })
    .what("Close the sequence")
    .also(&["unload", "close file", "close all"])
    .applies(needs_sequence),
    Row::new(Command::SAVE_SESSION, "Save session…", |state| {
        state.save_session(false);
    })
    .what("Save the session…")
    .also(&["save project", "save workspace", "save state"])
    .hint("Files, view, settings, clip, measurements, labels, markers and camera path, as a text file")
    .keys(group::FILE, "Ctrl+S", &[Chord::ctrl(Key::S)])
    .applies(needs_sequence),
    Row::new(Command::SAVE_SESSION_AS, "Save session as…", |state| {
        state.save_session(true);
    })
    .what("Save the session as…")
    .also(&["save project", "save workspace"])
    .applies(needs_sequence),
    Row::new(Command::TOGGLE_RECORDING, "Record…", State::toggle_recording)
        .what("Record the live stream…")
        .also(&["capture"])
        .hint("Records the live stream to a file that opens like any other")
        .titled(|state| match state.is_recording() {
            Some(true) => "Stop recording".into(),
            _ => "Record…".into(),
        })
        .applies(|state| match state.is_recording() {
            Some(_) => Ok(()),
            None => Err("Only live streams (tcp://…) are recorded, and none is open"),
        }),
    Row::new(Command::SCREENSHOT, "Save image", |state| {
        state.request(WindowRequest::Screenshot(None));
    })
    .what("Save image (screenshot)")
    .also(&[
        "picture",
        "take picture",
        "image",
        "snapshot",
        "photo",
        "screen capture",
        "png",
        "render to file",
        "grab",
    ])
    .keys(group::FILE, "P", &[Chord::plain(Key::P)])
    .applies(needs_sequence),
    Row::new(Command::SAVE_SCREENSHOT_AS, "Save image as…", |state| {
        let name = format!("{}.png", state.picture_stem());
        state.ask(picture_dialog(name));
    })
    .what("Save image as…")
    .also(&["screenshot", "image", "snapshot", "png"])
    .applies(needs_sequence),
];

/// Asks for the file of the image.
fn picture_dialog(name: String) -> Dialog<State> {
    let save = |state: &mut State, file| {
        state.request(WindowRequest::Screenshot(Some(with_extension(file, "png"))));
    };
    let dialog = Dialog::new_file("Save the image", name, save)
        .without("Save image (P) needs no name, and Export… has a field for it");
    PictureFormat::filters().fold(dialog, |dialog, (name, extensions)| {
        dialog.filter(format!("{name} image"), extensions.iter().copied())
    })
}

/// The command that opens an example.
pub(in crate::app) fn opens_example(example: Example) -> Command {
    match example {
        Example::Lidar => Command::EXAMPLE_LIDAR,
        Example::Depth => Command::EXAMPLE_DEPTH,
        Example::Model => Command::EXAMPLE_MODEL,
    }
}

impl State {
    fn open_example(&mut self, example: Example) {
        self.open(Arc::new(Sequence::example(example)));
    }

    /// Returns `Some(true)` if the open live stream is being recorded; `None` if none is open.
    fn is_recording(&self) -> Option<bool> {
        let live = self.player.as_ref()?.sequence().source().live()?;
        Some(live.status().recording.is_some())
    }
}
