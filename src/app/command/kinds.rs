//! What keys, menus and panels ask for.

use crate::app::features::inspection::Tool;
use crate::app::open_panels::PanelId;
use crate::scene::ViewPreset;
use crate::source::Example;
use egui::ThemePreference;

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
    /// Move back until all points are seen, outliers and what is far away as well.
    FrameAll,
    /// Look from the sensor that took what is shown.
    LookFromSensor,
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
    /// Show or hide lines on the ground.
    ToggleGrid,
    /// Show or hide the scale bar.
    ToggleScaleBar,
    /// Smaller splats or points.
    Smaller,
    /// Larger splats or points.
    Larger,
    /// Open files with a dialog.
    OpenFiles,
    /// Open a folder with a dialog.
    OpenFolder,
    /// Open files beside the open sequence, with a dialog.
    CompareFiles,
    /// Open a folder beside the open sequence, with a dialog.
    CompareFolder,
    /// Back to one sequence and one way to draw.
    CloseComparison,
    /// Two sequences side by side, or with a line over the same view.
    NextLayout,
    /// Close the open sequence.
    CloseSequence,
    /// Open the demo sequence.
    OpenDemo,
    /// Open a built-in example.
    OpenExample(Example),
    /// Record what arrives of a live stream to a file chosen with a dialog, or end that.
    ToggleRecording,
    /// Write the picture to a new file.
    Screenshot,
    /// Write the picture to a file chosen with a dialog.
    SaveScreenshotAs,
    /// Choose what to export, or close that.
    ToggleExport,
    /// Choose how to export the camera path.
    ExportPath,
    /// Choose as what the sequence is saved, or close that.
    ToggleSave,
    /// Set a keyframe of what is shown.
    AddKeyframe,
    /// Play the camera path, or stop that.
    TogglePreview,
    /// Begin a new camera path.
    NewPath,
    /// Open a camera path with a dialog.
    OpenPath,
    /// Write the camera path to its file.
    SavePath,
    /// Write the camera path to a file chosen with a dialog.
    SavePathAs,
    /// Write the session to its file.
    SaveSession,
    /// Write the session to a file chosen with a dialog.
    SaveSessionAs,
    /// Begin the open document again from defaults.
    BeginAgain,
    /// Begin new documents with the look of the open one.
    UseAsDefaults,
    /// Full screen and back.
    FullScreen,
    /// Show or hide a panel.
    TogglePanel(PanelId),
    /// Show or hide the ways of the picked points.
    ToggleTrails,
    /// The window is light, dark, or as the system is.
    Theme(ThemePreference),
    /// Show or hide small pictures over the timeline.
    ToggleThumbnails,
    /// Make them anew.
    RedoThumbnails,
    /// Two ways to draw side by side, and back.
    ToggleComparison,
    /// Take back the last change of settings, camera path or labels.
    Undo,
    /// Make it again.
    Redo,
    /// Find commands by their names, or stop that.
    TogglePalette,
    /// Close what is open, or leave full screen.
    Escape,
    /// End the program.
    Quit,
}
