//! One redraw: panels, image, and both onto the screen.
//!
//! **How it works.** Each of the three is done only if it is due. Panels run after user input, when egui asks for it,
//! and while frames play often enough for the eye to follow the playhead; frames between replace the image alone. The
//! image is drawn if its packet differs from the last one. Presenting shows the results of both, if there are any.

use super::{App, AppError, NEWS_INTERVAL, OpenWindow};
use crate::app::focus;
use crate::app::meter::Redraw;
use crate::app::panels::window_ui;
use crate::app::present::Panels;
use crate::app::side::Side;
use crate::app::state::{PictureStage, VisibleChange, WindowRequest};
use crate::app::window_bench::Processor;
use crate::app::work::files::save_image;
use crate::render::RenderError;
use egui::FullOutput;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use winit::event_loop::ActiveEventLoop;
use winit::window::Fullscreen;

/// Update interval of the playhead on the timeline while frames play; the image follows the frame rate.
const PANELS_INTERVAL: Duration = Duration::from_millis(33);

/// Destinations of images to be read back.
#[derive(Default)]
struct ReadBack {
    /// To be written to these files, or to new ones.
    files: Vec<Option<PathBuf>>,
    /// To compare the two sides.
    comparison: bool,
}

impl App {
    /// Runs the panels, draws the image if it is another one, and shows both.
    pub(super) fn redraw(&mut self, event_loop: &ActiveEventLoop) {
        let Some(mut screen) = self.screen.take() else {
            return;
        };
        if screen.choice != self.state.appearance.present {
            self.screen = self.reopen(event_loop, screen);
            return;
        }
        let result = self.redraw_on(event_loop, &mut screen);
        self.screen = match result {
            Ok(()) => Some(screen),
            Err(error @ RenderError::DeviceLost { .. }) => self.rebuild(event_loop, screen, error),
            Err(
                error
                @ (RenderError::OutOfMemory { .. } | RenderError::NoAdapter { .. } | RenderError::NoDevice { .. }),
            ) if screen.presenter.was_drawn_by_gpu() => {
                self.go_on_without_gpu(&error);
                Some(screen)
            }
            Err(error) => {
                self.state.notices.error(error.to_string());
                Some(screen)
            }
        };
    }

    fn redraw_on(&mut self, event_loop: &ActiveEventLoop, screen: &mut OpenWindow) -> Result<(), RenderError> {
        let size = screen.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return Ok(());
        }
        let begin = Instant::now();
        let now = self.now();
        self.last_redraw = now;
        let change = self.state.update(now).max(std::mem::take(&mut self.change));
        let is_exposed = std::mem::take(&mut self.is_exposed);
        let mut output = self
            .are_panels_due(change, now)
            .then(|| self.run_panels(event_loop, screen, now));
        let panels_run = begin.elapsed();

        let drawn = self.draw_picture(screen);
        let picture_drawn = begin.elapsed();
        let wanted = self.requests(event_loop, screen);
        let panels = output.as_mut().map(|output| Panels {
            egui: &screen.egui,
            shapes: std::mem::take(&mut output.shapes),
            textures: &mut output.textures_delta,
            pixels_per_point: output.pixels_per_point,
        });
        let painted = screen.presenter.paint(panels, is_exposed);
        drawn?;
        let painted = painted?;
        if painted.presented && !std::mem::replace(&mut self.has_been_shown, true) {
            focus::take_if_unmanaged(&screen.window);
        }
        if painted.presented {
            self.tell_of_stage();
        }
        if !painted.presented && !self.sight.is_occluded {
            self.change = VisibleChange::Panels;
            self.repaint_at = Some(now + NEWS_INTERVAL);
        }
        self.read_back(screen, wanted)?;
        self.set_title(screen);
        self.note_preferences(&screen.window);
        let redraw = Redraw {
            panels: panels_run,
            drawing: picture_drawn.saturating_sub(panels_run),
            painting: painted.painting,
            presenting: painted.presenting,
            waiting: painted.waited,
            whole: begin.elapsed(),
            painted_px: painted.repainted_px,
            gpu: painted.gpu,
        };
        self.note_redraw(screen, redraw, painted.presented);
        self.take_screenshot_if_due(event_loop, screen)
    }

    /// Reads images back and hands them to their consumers.
    fn read_back(&mut self, screen: &mut OpenWindow, wanted: ReadBack) -> Result<(), RenderError> {
        if wanted.comparison
            && let Some(other) = screen.presenter.read(Side::B, self.state.viewport.other_size_px)?
            && let Some(edited) = screen.presenter.read(Side::A, self.state.viewport.size_px)?
        {
            self.state.compare_pictures(edited, other);
        }
        for path in wanted.files {
            if let Some(image) = self.read_joined(screen)? {
                self.state.save_picture(image, path);
            }
        }
        Ok(())
    }

    /// Takes notice of how long a redraw took.
    fn note_redraw(&mut self, screen: &OpenWindow, redraw: Redraw, is_shown: bool) {
        // Waiting for the next refresh of the screen costs nothing; anything longer is a driver, or a window system,
        // that lags behind.
        let idle = redraw.waiting.min(self.refresh_interval);
        let frame_ms = redraw.whole.saturating_sub(idle).as_secs_f64() * 1e3;
        self.state.note_redraw(redraw, frame_ms, screen.presenter.stats());
        if let Some(window_bench) = &mut self.window_bench {
            let is_presented = is_shown && redraw.painted_px > 0;
            let is_due = window_bench.note(&redraw, is_presented, self.begin.elapsed(), &self.state);
            if is_due {
                self.change = VisibleChange::Panels;
            }
        }
    }

    /// Logs when the program first shows an image, and later stages of its frame.
    fn tell_of_stage(&mut self) {
        let stage = self.state.picture_stage();
        if stage != self.stage_shown
            && let Some(shown) = stage
            && self.stage_shown.is_none_or(|before| before < shown)
        {
            let since_start = Processor::since_start().unwrap_or_else(|| self.now());
            log::info!(
                "{} after {:.3} s",
                match shown {
                    PictureStage::SomePoints => "some points are shown",
                    PictureStage::AllPoints => "all points are shown",
                    PictureStage::SurfelsInView => "surfels of the visible part are shown",
                    PictureStage::Whole => "the frame is shown as it is to be",
                },
                since_start.as_secs_f64()
            );
            self.stage_shown = stage;
        }
    }

    /// Returns true if egui is due to run.
    fn are_panels_due(&self, change: VisibleChange, now: Duration) -> bool {
        let is_due = |at: Option<Duration>| at.is_some_and(|at| at <= now);
        match change {
            VisibleChange::Panels => true,
            // A new frame between two runs of the panels only changes the image.
            VisibleChange::Frame if now.saturating_sub(self.last_panels) >= PANELS_INTERVAL => true,
            VisibleChange::Frame | VisibleChange::Picture | VisibleChange::Nothing => {
                is_due(self.repaint_at) || is_due(self.news_at)
            }
        }
    }

    fn run_panels(&mut self, event_loop: &ActiveEventLoop, screen: &mut OpenWindow, now: Duration) -> FullOutput {
        self.last_panels = now;
        self.news_at = None;
        let raw_input = screen.input.take_egui_input(&screen.window);
        let mut output = screen.egui.run_ui(raw_input, |ui| window_ui(ui, &mut self.state));
        screen.input.handle_platform_output_with_event_loop(
            &screen.window,
            event_loop,
            std::mem::take(&mut output.platform_output),
        );
        let delay = output
            .viewport_output
            .get(&egui::ViewportId::ROOT)
            .map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        self.repaint_at = now.checked_add(delay);
        output
    }

    fn draw_picture(&mut self, screen: &mut OpenWindow) -> Result<(), RenderError> {
        let budget_bytes = self.state.graphics.budget_bytes;
        screen.presenter.set_resident_budget_bytes(budget_bytes);
        if let Some(packet) = self.state.next_packet() {
            if self.options.lose_device_after == Some(self.state.shared.counters.pictures) {
                screen.presenter.simulate_loss();
            }
            screen.presenter.draw(Side::A, &packet)?;
        }
        if let Some(packet) = self.state.next_other_packet() {
            screen.presenter.draw(Side::B, &packet)?;
            let texture = screen.presenter.texture(Side::B);
            if std::mem::replace(&mut self.state.viewport.other_texture, texture) != texture {
                // The panels have not seen it yet.
                self.repaint_at = Some(self.last_redraw);
            }
        }
        Ok(())
    }

    /// Reads back the visible 3-D views, joined into one image.
    fn read_joined(&self, screen: &mut OpenWindow) -> Result<Option<image::RgbaImage>, RenderError> {
        let viewport = &self.state.viewport;
        let Some(image) = screen.presenter.read(Side::A, viewport.size_px)? else {
            return Ok(None);
        };
        let other = match self.state.features.split_view {
            Some(_) => screen.presenter.read(Side::B, viewport.other_size_px)?,
            None => None,
        };
        Ok(Some(self.state.joined(image, other)))
    }

    /// Handles requests that only the window can; returns the purpose of images to be read back.
    fn requests(&mut self, event_loop: &ActiveEventLoop, screen: &mut OpenWindow) -> ReadBack {
        let mut wanted = ReadBack::default();
        for request in self.state.take_requests() {
            match request {
                WindowRequest::Quit => event_loop.exit(),
                WindowRequest::Screenshot(path) => wanted.files.push(path),
                WindowRequest::Compare => wanted.comparison = true,
                WindowRequest::Copy(text) => screen.input.set_clipboard_text(text),
                WindowRequest::PasteView => match screen.input.clipboard_text() {
                    Some(text) => self.state.paste_view(&text),
                    None => self.state.notices.warn("No text to paste"),
                },
                WindowRequest::FullScreen => {
                    // The window system may have ended full screen in the meantime: ask the window itself.
                    let full = screen.window.fullscreen().is_none();
                    let full_screen = full.then_some(Fullscreen::Borderless(None));
                    screen.window.set_fullscreen(full_screen);
                    self.state.appearance.full_screen = full;
                }
            }
        }
        wanted
    }

    /// `--screenshot`: writes the image after enough frames and ends.
    fn take_screenshot_if_due(
        &mut self,
        event_loop: &ActiveEventLoop,
        screen: &mut OpenWindow,
    ) -> Result<(), RenderError> {
        let Some(path) = &self.options.screenshot else {
            return Ok(());
        };
        if let Some(failed) = &self.state.opening.failed {
            let why = failed.reason.clone();
            self.fail(event_loop, AppError::Screenshot(why));
            return Ok(());
        }
        let Some(player) = &self.state.player else {
            return Ok(());
        };
        // When not playing there is no other frame to wait for.
        let wanted = if player.is_playing() {
            self.options.after_frames
        } else {
            1
        };
        let is_whole = player.shown().is_some() && !player.is_partial();
        if is_whole && player.frames_shown() >= wanted && self.state.is_drawn() {
            let Some(image) = self.read_joined(screen)? else {
                return Ok(());
            };
            self.end = save_image(&image, path).map_err(AppError::Screenshot);
            event_loop.exit();
        } else if let Some(failure) = player.failure()
            && (!player.is_playing() || player.loader().stats().failed_frames == player.sequence().len())
        {
            let why = failure.to_string();
            self.fail(event_loop, AppError::Screenshot(why));
        }
        Ok(())
    }
}
