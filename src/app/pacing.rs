//! When the event loop draws and how long it sleeps: one decision, made each time all events are handled.

use std::time::Duration;

/// Why a window may not be seen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Sight {
    /// Other windows cover it, or it is on another desktop.
    pub(super) is_occluded: bool,
    /// It is minimised.
    pub(super) has_no_area: bool,
}

impl Sight {
    /// True while the window is not visible.
    pub(super) fn is_hidden(self) -> bool {
        self.is_occluded || self.has_no_area
    }

    /// Takes notice of the window's size, pixels.
    pub(super) fn note_size(&mut self, size_px: [u32; 2]) {
        self.has_no_area = size_px.contains(&0);
    }
}

/// Agenda of work that may be due.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Agenda {
    /// Something that can be seen has changed.
    pub(super) is_changed: bool,
    /// Time at which the image or a panel has to be drawn next.
    pub(super) draw_at: Option<Duration>,
    /// Time before which the screen is not ready for another image.
    pub(super) not_before: Duration,
    /// When something is to be done that is not seen.
    pub(super) unseen_at: Option<Duration>,
    /// The window is covered or minimised.
    pub(super) is_hidden: bool,
}

/// Work to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pace {
    /// Draw now.
    pub(super) redraw: bool,
    /// Sleep until then at the latest; until an event if `None`.
    pub(super) wake_at: Option<Duration>,
}

impl Agenda {
    /// Decides at `now`. A hidden window draws nothing, and nothing of it is waited for: it is drawn when it is seen
    /// again.
    pub(super) fn pace(&self, now: Duration) -> Pace {
        let draw_at = if self.is_changed {
            Some(self.not_before)
        } else {
            self.draw_at.map(|due| due.max(self.not_before))
        };
        let draw_at = draw_at.filter(|_| !self.is_hidden);
        let redraw = draw_at.is_some_and(|due| due <= now);
        let draw_at = draw_at.filter(|_| !redraw);
        Pace {
            redraw,
            wake_at: [draw_at, self.unseen_at].into_iter().flatten().min(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    #[test]
    fn a_window_at_rest_sleeps_until_an_event() {
        let pace = Agenda::default().pace(at(5));
        assert_eq!((pace.redraw, pace.wake_at), (false, None));
    }

    #[test]
    fn due_frames_are_drawn_and_others_are_waited_for() {
        let due = |seconds| Agenda {
            draw_at: Some(at(seconds)),
            ..Agenda::default()
        };
        let early = due(7).pace(at(5));
        assert_eq!((early.redraw, early.wake_at), (false, Some(at(7))));
        // Drawing again determines when to draw next.
        let late = due(5).pace(at(5));
        assert_eq!((late.redraw, late.wake_at), (true, None));
        let changed = Agenda {
            is_changed: true,
            ..due(7)
        };
        assert!(changed.pace(at(5)).redraw);
    }

    #[test]
    fn redraws_too_early_for_the_screen_wait() {
        let agenda = |is_changed, draw_at| Agenda {
            is_changed,
            draw_at,
            not_before: at(6),
            ..Agenda::default()
        };
        for early in [agenda(true, None), agenda(false, Some(at(4)))] {
            let pace = early.pace(at(5));
            assert_eq!((pace.redraw, pace.wake_at), (false, Some(at(6))));
            assert!(early.pace(at(6)).redraw);
        }
        let later = agenda(false, Some(at(9))).pace(at(5));
        assert_eq!((later.redraw, later.wake_at), (false, Some(at(9))));
        // With nothing to draw, there is no wait.
        assert_eq!(agenda(false, None).pace(at(5)).wake_at, None);
    }

    #[test]
    fn a_window_is_visible_when_neither_covered_nor_minimised() {
        let mut sight = Sight::default();
        assert!(!sight.is_hidden());
        sight.note_size([0, 0]);
        sight.is_occluded = true;
        assert!(sight.is_hidden());
        sight.note_size([640, 480]);
        assert!(sight.is_hidden(), "still covered");
        sight.is_occluded = false;
        assert!(!sight.is_hidden());
    }

    #[test]
    fn a_hidden_window_neither_draws_nor_wakes_up() {
        let hidden = Agenda {
            is_changed: true,
            draw_at: Some(at(1)),
            is_hidden: true,
            ..Agenda::default()
        };
        let pace = hidden.pace(at(5));
        assert_eq!((pace.redraw, pace.wake_at), (false, None), "it would spin");
        // Settings are still saved.
        let unseen = Agenda {
            unseen_at: Some(at(6)),
            ..hidden
        };
        assert_eq!(unseen.pace(at(5)).wake_at, Some(at(6)));
    }
}
