//! Requests of the camera path panel.

use crate::app::command::Command;

/// Request of the panel to the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::app) enum PathRequest {
    /// Run a command, as keys and menus do.
    Run(Command),
    /// Move the time of the path here, seconds, and show its view.
    GoTo(f64),
    /// Give this keyframe the view and the frame that are shown.
    Replace(usize),
}
