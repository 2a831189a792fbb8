//! Shared parts of command rows.

use crate::app::command::CommandRow;
use crate::app::state::{Dialog, State};
use crate::document::EXTENSION;
use crate::source;

/// A row of the table of commands.
pub(in crate::app) type Row = CommandRow<State>;

/// Headings of the list of keys.
pub(in crate::app) mod group {
    /// Playback.
    pub(in crate::app) const PLAYING: &str = "Playing";
    /// The image and the panels.
    pub(in crate::app) const VIEW: &str = "View";
    /// Heading of the actions of clicks on points.
    pub(in crate::app) const POINTS: &str = "Points";
    /// Files, undo and the window.
    pub(in crate::app) const FILE: &str = "File and window";
}

/// Availability check of commands that need an open sequence.
pub(in crate::app) fn needs_sequence(state: &State) -> Result<(), &'static str> {
    match state.player {
        Some(_) => Ok(()),
        None => Err("Nothing is open yet"),
    }
}

/// The dialog with files that can be opened.
pub(in crate::app) fn of_point_clouds(dialog: Dialog<State>) -> Dialog<State> {
    let extensions = source::supported_extensions().chain([EXTENSION]);
    dialog
        .filter("Point clouds and sessions", extensions)
        .filter("All files", ["*"])
}
