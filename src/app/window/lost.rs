//! A graphics card that is lost, or has no memory left.

use super::{App, Screen};
use crate::app::notices::Severity;
use crate::render::RenderError;
use egui_winit::accesskit_winit;
use std::sync::Arc;
use std::time::Duration;
use winit::event_loop::ActiveEventLoop;

/// A device that is lost again within this time will not come back.
const RELOSS_WINDOW: Duration = Duration::from_secs(10);

/// Attempts to rebuild a device within [`RELOSS_WINDOW`].
const MAX_REBUILDS: usize = 3;

/// What stays of egui when a device is lost.
pub(super) struct EguiBefore {
    pub(super) context: egui::Context,
    /// The window's, which has one for good.
    pub(super) accessibility: Option<accesskit_winit::Adapter>,
}

impl App {
    /// After a lost device: says so and opens another, unless that was tried too often lately.
    pub(super) fn rebuild(
        &mut self,
        event_loop: &ActiveEventLoop,
        screen: Screen,
        error: RenderError,
    ) -> Option<Screen> {
        let now = self.now();
        self.rebuilt_at
            .retain(|&at| now.saturating_sub(at) < RELOSS_WINDOW);
        if self.rebuilt_at.len() >= MAX_REBUILDS {
            self.fail(event_loop, error.into());
            return None;
        }
        self.rebuilt_at.push(now);
        let what_now = if screen.graphics.was_drawn_by_gpu() {
            self.state.draw_without_gpu();
            "The processor draws now; choose a renderer in the settings to try again"
        } else {
            "It was opened again"
        };
        self.state.notices.post(
            Severity::Warning,
            format!("{error}. {what_now}; nothing is lost."),
        );
        let Screen {
            window,
            graphics,
            egui,
            input,
            ..
        } = screen;
        // The window can have one surface at a time.
        drop(graphics);
        let before = EguiBefore {
            context: egui,
            accessibility: input.accesskit,
        };
        match self.open_screen(event_loop, Arc::clone(&window), Some(before)) {
            Ok(screen) => {
                window.request_redraw();
                Some(screen)
            }
            Err(error) => {
                self.fail(event_loop, error);
                None
            }
        }
    }

    /// After an allocation that did not fit: the processor draws, which needs none.
    pub(super) fn go_on_without_gpu(&mut self, error: &RenderError) {
        self.state.draw_without_gpu();
        self.state.notices.post(
            Severity::Warning,
            format!(
                "{error}. The processor draws now; choose a renderer in the settings to try again."
            ),
        );
    }
}
