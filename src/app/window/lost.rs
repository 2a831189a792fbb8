//! Recovery from a lost GPU device, or one that has run out of memory.

use super::egui_before::EguiBefore;
use super::{App, OpenWindow};
use crate::app::notices::Severity;
use crate::app::present_choice::PresentChoice;
use crate::render::RenderError;
use std::sync::Arc;
use std::time::Duration;
use winit::event_loop::ActiveEventLoop;

/// A device that is lost again within this time will not come back.
const RELOSS_WINDOW: Duration = Duration::from_secs(10);

/// Attempts to rebuild a device within [`RELOSS_WINDOW`].
const MAX_REBUILDS: usize = 3;

impl App {
    /// Recovers from a lost device: reports it and opens another. If that was tried too often recently, the CPU
    /// presents.
    pub(super) fn rebuild(
        &mut self,
        event_loop: &ActiveEventLoop,
        screen: OpenWindow,
        error: RenderError,
    ) -> Option<OpenWindow> {
        let now = self.now();
        self.rebuilt_at.retain(|&at| now.saturating_sub(at) < RELOSS_WINDOW);
        let is_given_up = self.rebuilt_at.len() >= MAX_REBUILDS;
        if is_given_up && self.state.appearance.present == PresentChoice::Cpu {
            self.fail(event_loop, error.into());
            return None;
        }
        self.rebuilt_at.push(now);
        let what_now = if is_given_up {
            self.state.appearance.present = PresentChoice::Cpu;
            "The CPU paints the window now; choose another painter in the settings to try again"
        } else if screen.presenter.was_drawn_by_gpu() {
            // The new device is for the panels: the CPU draws the image until the user chooses a renderer again.
            self.state.draw_without_gpu();
            "The CPU draws now; choose a renderer in the settings to try again"
        } else {
            "It was opened again"
        };
        self.state
            .notices
            .post(Severity::Warning, format!("{error}. {what_now}; nothing is lost."));
        self.reopen(event_loop, screen)
    }

    /// Reopens the same window with another presenter.
    pub(super) fn reopen(&mut self, event_loop: &ActiveEventLoop, screen: OpenWindow) -> Option<OpenWindow> {
        let OpenWindow {
            window,
            presenter,
            choice,
            egui,
            input,
            ..
        } = screen;
        // A window can have only one surface at a time.
        drop(presenter);
        let mut before = Some(EguiBefore {
            context: egui,
            accessibility: input.accesskit,
        });
        let opened = match self.open_screen(event_loop, Arc::clone(&window), &mut before) {
            // The chosen presenter may not be available, but the previous one is.
            Err(error) if choice != self.state.appearance.present => {
                self.state.notices.error(error.to_string());
                self.state.appearance.present = choice;
                self.open_screen(event_loop, window, &mut before)
            }
            opened => opened,
        };
        match opened {
            Ok(screen) => Some(screen),
            Err(error) => {
                self.fail(event_loop, error);
                None
            }
        }
    }

    /// After an allocation that did not fit: the CPU draws, which needs none.
    pub(super) fn go_on_without_gpu(&mut self, error: &RenderError) {
        self.state.draw_without_gpu();
        self.state.notices.post(
            Severity::Warning,
            format!("{error}. The CPU draws now; choose a renderer in the settings to try again."),
        );
    }
}
