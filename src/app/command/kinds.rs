//! The names of commands.

use crate::app::open_panels::PanelId;

/// A user command, by its name in the table of commands. Only those named outside of their rows are listed here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Command(&'static str);

impl Command {
    /// Play or pause.
    pub const TOGGLE_PLAY: Self = Self("play");
    /// Pause and go to the next frame.
    pub const NEXT_FRAME: Self = Self("next frame");
    /// Pause and go to the frame before.
    pub const PREVIOUS_FRAME: Self = Self("previous frame");
    /// Go to the first frame.
    pub const FIRST: Self = Self("first frame");
    /// Go to the last frame.
    pub const LAST: Self = Self("last frame");
    /// Play at the next lower speed.
    pub const SLOWER: Self = Self("slower");
    /// Play at the next higher speed.
    pub const FASTER: Self = Self("faster");
    /// Reverse the playing direction.
    pub const REVERSE: Self = Self("reverse");
    /// Off, loop, ping-pong.
    pub const NEXT_LOOP_MODE: Self = Self("loop mode");
    /// Play from the frame at the playhead.
    pub const SET_IN: Self = Self("in point");
    /// Play to the frame at the playhead.
    pub const SET_OUT: Self = Self("out point");
    /// Play the whole sequence.
    pub const CLEAR_RANGE: Self = Self("clear range");
    /// Put a marker at the playhead, or take it away.
    pub const TOGGLE_MARKER: Self = Self("marker");
    /// Go to the next marker.
    pub const NEXT_MARKER: Self = Self("next marker");
    /// Go to the marker before.
    pub const PREVIOUS_MARKER: Self = Self("previous marker");
    /// The camera as it was when the sequence was opened.
    pub const RESET_VIEW: Self = Self("reset view");
    /// Move back until all points are visible, including outliers and far ones.
    pub const FRAME_ALL: Self = Self("frame all");
    /// Look from the sensor that recorded the shown frame.
    pub const LOOK_FROM_SENSOR: Self = Self("look from sensor");
    /// Look along an axis.
    pub const FRONT: Self = Self("front");
    /// Look along an axis.
    pub const BACK: Self = Self("back");
    /// Look along an axis.
    pub const LEFT: Self = Self("left");
    /// Look along an axis.
    pub const RIGHT: Self = Self("right");
    /// Look along an axis.
    pub const TOP: Self = Self("top");
    /// Look along an axis.
    pub const BOTTOM: Self = Self("bottom");
    /// Parallel rays and back.
    pub const TOGGLE_ORTHOGRAPHIC: Self = Self("orthographic");
    /// Start or stop the turntable.
    pub const TOGGLE_TURNTABLE: Self = Self("turntable");
    /// Put the view on the clipboard as text.
    pub const COPY_VIEW: Self = Self("copy view");
    /// Take the view from the text on the clipboard.
    pub const PASTE_VIEW: Self = Self("paste view");
    /// Show or hide lines on the ground.
    pub const TOGGLE_GRID: Self = Self("grid");
    /// Show or hide the scale bar.
    pub const TOGGLE_SCALE_BAR: Self = Self("scale bar");
    /// Open files with a dialog.
    pub const OPEN_FILES: Self = Self("open files");
    /// Open a folder with a dialog.
    pub const OPEN_FOLDER: Self = Self("open folder");
    /// Open the demo sequence.
    pub const OPEN_DEMO: Self = Self("demo");
    /// Open a built-in example.
    pub const EXAMPLE_LIDAR: Self = Self("example lidar");
    /// Open a built-in example.
    pub const EXAMPLE_DEPTH: Self = Self("example depth");
    /// Open a built-in example.
    pub const EXAMPLE_MODEL: Self = Self("example model");
    /// Close the open sequence.
    pub const CLOSE_SEQUENCE: Self = Self("close");
    /// Open files next to the open sequence for comparison, with a dialog.
    pub const COMPARE_FILES: Self = Self("compare files");
    /// Open a folder next to the open sequence for comparison, with a dialog.
    pub const COMPARE_FOLDER: Self = Self("compare folder");
    /// Close the comparison: back to one sequence and one render mode.
    pub const CLOSE_COMPARISON: Self = Self("close comparison");
    /// Two sequences side by side, or with a line over the same view.
    pub const NEXT_LAYOUT: Self = Self("layout");
    /// Compare two render modes side by side, and back.
    pub const TOGGLE_COMPARISON: Self = Self("compare settings");
    /// Record a live stream to a file chosen with a dialog, or end the recording.
    pub const TOGGLE_RECORDING: Self = Self("record");
    /// Write the image to a new file.
    pub const SCREENSHOT: Self = Self("save picture");
    /// Write the image to a file chosen with a dialog.
    pub const SAVE_SCREENSHOT_AS: Self = Self("save picture as");
    /// Open or close the export panel.
    pub const TOGGLE_EXPORT: Self = Self("export");
    /// Open or close the panel for saving the sequence.
    pub const TOGGLE_SAVE: Self = Self("save");
    /// Set a keyframe of the current view and frame.
    pub const ADD_KEYFRAME: Self = Self("keyframe");
    /// Play the camera path, or stop that.
    pub const TOGGLE_PREVIEW: Self = Self("play path");
    /// Begin a new camera path.
    pub const NEW_PATH: Self = Self("new path");
    /// Open a camera path with a dialog.
    pub const OPEN_PATH: Self = Self("open path");
    /// Write the camera path to its file.
    pub const SAVE_PATH: Self = Self("save path");
    /// Write the camera path to a file chosen with a dialog.
    pub const SAVE_PATH_AS: Self = Self("save path as");
    /// Choose how to export the camera path.
    pub const EXPORT_PATH: Self = Self("export path");
    /// Write the session to its file.
    pub const SAVE_SESSION: Self = Self("save session");
    /// Write the session to a file chosen with a dialog.
    pub const SAVE_SESSION_AS: Self = Self("save session as");
    /// The open session as it was saved.
    pub const REVERT_SESSION: Self = Self("revert session");
    /// Begin the open document again from defaults.
    pub const BEGIN_AGAIN: Self = Self("begin again");
    /// Begin new documents with the look of the open one.
    pub const USE_AS_DEFAULTS: Self = Self("use as defaults");
    /// Draw with a named preset of this user, or a built-in one.
    pub const PRESET: Self = Self("preset");
    /// Draw as the built-in preset of a name.
    pub const BUILT_IN_PRESET: Self = Self("built-in-preset");
    /// Keep the present settings under a name.
    pub const SAVE_PRESET: Self = Self("save settings");
    /// Delete the preset of a name.
    pub const DELETE_PRESET: Self = Self("delete-preset");
    /// Open the start dialog of the benchmark suite of a name.
    pub const SET_UP_BENCHMARK: Self = Self("set-up-benchmark");
    /// Run the benchmark suite of a name with its default options.
    pub const RUN_BENCHMARK: Self = Self("run-benchmark");
    /// Full screen and back.
    pub const FULL_SCREEN: Self = Self("full screen");
    /// Show or hide thumbnails over the timeline.
    pub const TOGGLE_THUMBNAILS: Self = Self("thumbnails");
    /// Regenerate the thumbnails.
    pub const REDO_THUMBNAILS: Self = Self("redo thumbnails");
    /// A click shows the values of a point, or no longer.
    pub const PICK_POINTS: Self = Self("point values");
    /// Clicks measure, or no longer.
    pub const MEASURE: Self = Self("measure");
    /// Clicks put labels, or no longer.
    pub const PUT_LABELS: Self = Self("label");
    /// Take back the last change of settings, camera path or labels.
    pub const UNDO: Self = Self("undo");
    /// Make it again.
    pub const REDO: Self = Self("redo");
    /// Find commands by their names, or stop that.
    pub const TOGGLE_PALETTE: Self = Self("commands");
    /// Close the topmost panel or tool, or leave full screen.
    pub const ESCAPE: Self = Self("escape");
    /// End the program.
    pub const QUIT: Self = Self("quit");
    /// The window is light or dark as the system is.
    pub const THEME_OF_SYSTEM: Self = Self("theme system");
    /// The window is light.
    pub const LIGHT_THEME: Self = Self("theme light");
    /// The window is dark.
    pub const DARK_THEME: Self = Self("theme dark");

    /// A command that only its row names.
    pub const fn new(word: &'static str) -> Self {
        Self(word)
    }

    /// Shows or hides a panel.
    pub const fn panel(id: PanelId) -> Self {
        Self(id.name())
    }

    /// Its word in scripts.
    pub const fn word(self) -> &'static str {
        self.0
    }
}
