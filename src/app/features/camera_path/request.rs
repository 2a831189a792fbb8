//! Requests of the camera path panel.

use crate::app::command::Command;

/// Request of the panel to the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::app) enum PathRequest {
    /// Do what keys and menus do as well.
    Run(Command),
    /// Put the time of the path here, seconds, and show what is there.
    GoTo(f64),
    /// Give this keyframe the view and the frame that are shown.
    Replace(usize),
}
