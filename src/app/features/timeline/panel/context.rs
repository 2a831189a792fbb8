//! Context of the timeline: the state it shows and changes.

use crate::app::command::Command;
use crate::app::features::thumbnails::Thumbnails;
use crate::app::features::timeline::Timeline;
use crate::playback::Player;
use crate::sequence::Needs;
use std::time::Duration;

/// The parts of the window that the timeline is about.
#[derive(Debug)]
pub(in crate::app) struct TimelineContext<'a> {
    pub(in crate::app) player: Option<&'a mut Player>,
    pub(in crate::app) timeline: &'a mut Timeline,
    pub(in crate::app) thumbnails: &'a mut Thumbnails,
    /// Frame data that the image needs.
    pub(in crate::app) needs: Needs,
    pub(in crate::app) now: Duration,
}

/// Request of the timeline to the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::app) enum TimelineRequest {
    /// Run a command, as keys and menus do.
    Run(Command),
    /// The marks are other ones: keep them.
    Keep,
}

impl TimelineContext<'_> {
    /// Goes to a frame.
    pub(super) fn seek(&mut self, frame: usize) {
        if let Some(player) = &mut self.player {
            player.seek(frame, self.now);
        }
    }
}
