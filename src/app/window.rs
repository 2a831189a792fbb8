//! The event loop: winit's events to egui, deadlines and wakes to redraws, redraws to the GPU.

mod accessibility;
mod lost;

use self::accessibility::Message;
use self::lost::EguiBefore;
use super::focus;
use super::graphics::Graphics;
use super::pacing::{Agenda, Sight};
use super::panels::window_ui;
use super::preferences::{Preferences, PreferencesFile};
use super::state::{State, StateOptions, WindowRequest};
use super::tasks::save_png;
use super::theme::apply_theme;
use crate::render::RenderError;
use crate::sequence::Sequence;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalSize};
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Fullscreen, Window, WindowId};

/// Size of a new window, logical pixels.
const DEFAULT_SIZE: LogicalSize<f64> = LogicalSize::new(1280.0, 800.0);

/// Below this the timeline does not fit, logical pixels.
const MIN_SIZE: LogicalSize<f64> = LogicalSize::new(720.0, 420.0);

/// News from workers that only move marks and figures are shown this often.
const NEWS_INTERVAL: Duration = Duration::from_millis(100);

/// How the window is opened.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// How the state begins. Its `wake` is replaced.
    pub state: StateOptions,
    /// What to show first; the demo if `None`.
    pub sequence: Option<Arc<Sequence>>,
    /// What to show beside it.
    pub compare: Option<Arc<Sequence>>,
    /// What the first was found by, for the list of recent files.
    pub inputs: Vec<PathBuf>,
    /// What went wrong before there was a window to say it in.
    pub warnings: Vec<String>,
    /// Where changes of settings are kept; nowhere by default.
    pub preferences_file: PreferencesFile,
    /// Size of the window in pixels, which goes before the preferred one.
    pub size_px: Option<[u32; 2]>,
    /// Write the 3-D picture to this file and end.
    pub screenshot: Option<PathBuf>,
    /// How many frames are shown before the screenshot; at least 1.
    pub after_frames: u64,
    /// End the GPU device after this many pictures, as a crashed driver would: for tests.
    pub lose_device_after: Option<u64>,
}

/// Why the window could not be opened or go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AppError {
    /// There is no display, or it refuses.
    #[error(
        "no window can be opened ({reason}); without a display use `pointreel render INPUT -o picture.png`"
    )]
    NoWindow {
        /// What the window system said.
        reason: String,
    },
    /// No adapter, or it was lost for good.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The screenshot that was asked for could not be made.
    #[error("{0}")]
    Screenshot(String),
}

/// Opens the window and returns when it is closed.
pub fn run(options: Options) -> Result<(), AppError> {
    let no_window = |reason: &dyn std::fmt::Display| AppError::NoWindow {
        reason: reason.to_string(),
    };
    let event_loop = EventLoop::<Message>::with_user_event()
        .build()
        .map_err(|error| no_window(&error))?;
    let mut app = App::new(options, &event_loop);
    event_loop
        .run_app(&mut app)
        .map_err(|error| no_window(&error))?;
    app.end
}

/// What exists while there is a window.
struct Screen {
    window: Arc<Window>,
    graphics: Graphics,
    egui: egui::Context,
    input: egui_winit::State,
    title: String,
}

struct App {
    state: State,
    options: Options,
    screen: Option<Screen>,
    messages: EventLoopProxy<Message>,
    /// A screen reader asks what is in the window.
    is_read_aloud: bool,
    begin: Instant,
    /// Set by the first wake since the last look, so that a busy loader does not fill the queue.
    wake_is_queued: Arc<AtomicBool>,
    woken: bool,
    sight: Sight,
    /// Something has been presented.
    has_been_shown: bool,
    /// When egui wants to be run again.
    repaint_at: Option<Duration>,
    /// When marks and figures that changed in the background are shown.
    news_at: Option<Duration>,
    last_redraw: Duration,
    /// The size of the window that was looked at last for the preferences.
    noted_size: Option<PhysicalSize<u32>>,
    rebuilt_at: Vec<Duration>,
    end: Result<(), AppError>,
}

/// What pictures are to be read back for.
#[derive(Default)]
struct Wanted {
    /// To be written to these files, or to new ones.
    files: Vec<Option<PathBuf>>,
    /// To compare the two sides.
    comparison: bool,
}

impl App {
    fn new(mut options: Options, event_loop: &EventLoop<Message>) -> Self {
        let messages = event_loop.create_proxy();
        let proxy = messages.clone();
        let wake_is_queued = Arc::new(AtomicBool::new(false));
        let queued = Arc::clone(&wake_is_queued);
        options.state.wake = Arc::new(move || {
            if !queued.swap(true, Ordering::AcqRel) && proxy.send_event(Message::Wake).is_err() {
                log::debug!("a wake after the window was closed");
            }
        });
        let mut state = State::new(options.state.clone());
        let demo = || Arc::new(Sequence::demo());
        state.open(options.sequence.take().unwrap_or_else(demo));
        if let Some(sequence) = options.compare.take() {
            state.compare_with(sequence);
        }
        options
            .warnings
            .extend(state.recent.add(&options.inputs).err());
        for warning in options.warnings.drain(..) {
            state.notices.warn(warning);
        }
        Self {
            state,
            options,
            screen: None,
            messages,
            is_read_aloud: false,
            begin: Instant::now(),
            wake_is_queued,
            woken: false,
            sight: Sight::default(),
            has_been_shown: false,
            repaint_at: None,
            news_at: None,
            last_redraw: Duration::ZERO,
            noted_size: None,
            rebuilt_at: Vec::new(),
            end: Ok(()),
        }
    }

    fn now(&self) -> Duration {
        self.begin.elapsed()
    }

    fn open_window(&self, event_loop: &ActiveEventLoop) -> Result<Arc<Window>, AppError> {
        let attributes = Window::default_attributes()
            .with_title("pointreel")
            .with_min_inner_size(MIN_SIZE)
            // Screen readers have to know of a window before it is seen.
            .with_visible(false)
            // An alpha visual stays black on software adapters under a bare X server.
            .with_transparent(false);
        let left = self
            .options
            .state
            .preferences
            .window_size
            .map(LogicalSize::<f64>::from);
        let attributes = match self.options.size_px {
            Some([width, height]) => attributes.with_inner_size(PhysicalSize::new(width, height)),
            None => attributes.with_inner_size(left.unwrap_or(DEFAULT_SIZE)),
        };
        event_loop
            .create_window(attributes)
            .map(Arc::new)
            .map_err(|error| AppError::NoWindow {
                reason: error.to_string(),
            })
    }

    /// The GPU's side and egui's for `window`; what is open in egui stays as it was in `before`.
    fn open_screen(
        &mut self,
        event_loop: &ActiveEventLoop,
        window: Arc<Window>,
        before: Option<EguiBefore>,
    ) -> Result<Screen, AppError> {
        let graphics = Graphics::new(Arc::clone(&window))?;
        let egui = egui::Context::default();
        apply_theme(&egui);
        egui.set_theme(self.state.theme);
        if let Some(before) = &before {
            let memory = before.context.memory(Clone::clone);
            egui.memory_mut(|new| *new = memory);
        }
        if self.is_read_aloud {
            egui.enable_accesskit();
        }
        let max_edge_px = graphics.context().max_edge_px();
        let mut input = egui_winit::State::new(
            egui.clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            window.theme(),
            Some(max_edge_px as usize),
        );
        match before {
            None => input.init_accesskit(event_loop, &window, self.messages.clone()),
            Some(before) => input.accesskit = before.accessibility,
        }
        window.set_visible(true);
        self.state.viewport.texture = Some(graphics.texture());
        self.state.viewport.other_texture = None;
        self.state.viewport.max_edge_px = Some(max_edge_px);
        self.state.graphics.adapter = graphics.context().adapter_summary();
        self.state.graphics.is_software = graphics.context().is_software();
        self.state.graphics.has_timestamps = graphics.context().has_timestamps;
        self.state.forget_picture();
        Ok(Screen {
            window,
            graphics,
            egui,
            input,
            title: String::new(),
        })
    }

    fn fail(&mut self, event_loop: &ActiveEventLoop, error: AppError) {
        self.end = Err(error);
        event_loop.exit();
    }

    /// Runs the panels, draws the picture if it is another one, and shows both.
    fn redraw(&mut self, event_loop: &ActiveEventLoop) {
        let Some(mut screen) = self.screen.take() else {
            return;
        };
        let result = self.redraw_on(event_loop, &mut screen);
        self.screen = match result {
            Ok(()) => Some(screen),
            Err(error @ RenderError::DeviceLost { .. }) => self.rebuild(event_loop, screen, error),
            Err(error @ RenderError::OutOfMemory { .. }) if screen.graphics.was_drawn_by_gpu() => {
                self.go_on_without_gpu(&error);
                Some(screen)
            }
            Err(error) => {
                self.state.notices.error(error.to_string());
                Some(screen)
            }
        };
    }

    fn redraw_on(
        &mut self,
        event_loop: &ActiveEventLoop,
        screen: &mut Screen,
    ) -> Result<(), RenderError> {
        let size = screen.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return Ok(());
        }
        let begin = Instant::now();
        let now = self.now();
        self.last_redraw = now;
        self.news_at = None;
        self.state.update(now);

        let raw_input = screen.input.take_egui_input(&screen.window);
        let mut output = screen
            .egui
            .run_ui(raw_input, |ui| window_ui(ui, &mut self.state));
        screen.input.handle_platform_output_with_event_loop(
            &screen.window,
            event_loop,
            output.platform_output,
        );
        let delay = output
            .viewport_output
            .get(&egui::ViewportId::ROOT)
            .map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        self.repaint_at = now.checked_add(delay);

        let drawn = self.draw_picture(screen);
        let Wanted { files, comparison } = self.requests(event_loop, screen);
        let primitives = screen
            .egui
            .tessellate(output.shapes, output.pixels_per_point);
        let painted = screen.graphics.paint(
            &primitives,
            &mut output.textures_delta,
            output.pixels_per_point,
        );
        drawn?;
        let painted = painted?;
        if painted.presented && !std::mem::replace(&mut self.has_been_shown, true) {
            focus::take_if_unmanaged(&screen.window);
        }
        if !painted.presented && !self.sight.is_occluded {
            self.repaint_at = Some(now + NEWS_INTERVAL);
        }
        if comparison
            && let Some(other) = screen
                .graphics
                .read_other_picture(self.state.viewport.other_size_px)?
        {
            let edited = screen.graphics.read_picture(self.state.viewport.size_px)?;
            self.state.compare_pictures(edited, other);
        }
        for path in files {
            let image = self.read_joined(screen)?;
            self.state.save_picture(image, path);
        }
        self.set_title(screen);
        self.note_preferences(&screen.window);
        self.state.graphics.render = screen.graphics.stats();
        self.state.graphics.frame_ms =
            begin.elapsed().saturating_sub(painted.waited).as_secs_f64() * 1e3;
        self.take_screenshot_if_due(event_loop, screen)
    }

    fn draw_picture(&mut self, screen: &mut Screen) -> Result<(), RenderError> {
        let budget_bytes = self.state.graphics.budget_bytes;
        screen.graphics.set_resident_budget_bytes(budget_bytes);
        if let Some(packet) = self.state.next_packet() {
            if self.options.lose_device_after == Some(self.state.counters.pictures) {
                screen.graphics.context().simulate_loss();
            }
            screen.graphics.draw(&packet)?;
        }
        if let Some(packet) = self.state.next_other_packet() {
            screen.graphics.draw_other(&packet)?;
            let texture = screen.graphics.other_texture();
            if std::mem::replace(&mut self.state.viewport.other_texture, texture) != texture {
                // The panels did not know it yet.
                self.repaint_at = Some(self.last_redraw);
            }
        }
        Ok(())
    }

    /// What is seen of the 3-D pictures.
    fn read_joined(&self, screen: &mut Screen) -> Result<image::RgbaImage, RenderError> {
        let viewport = &self.state.viewport;
        let image = screen.graphics.read_picture(viewport.size_px)?;
        let other = match self.state.beside {
            Some(_) => screen.graphics.read_other_picture(viewport.other_size_px)?,
            None => None,
        };
        Ok(self.state.joined(image, other))
    }

    /// Does what only the window can do; returns what pictures are to be read back for.
    fn requests(&mut self, event_loop: &ActiveEventLoop, screen: &mut Screen) -> Wanted {
        let mut wanted = Wanted::default();
        for request in self.state.take_requests() {
            match request {
                WindowRequest::Quit => event_loop.exit(),
                WindowRequest::Screenshot(path) => wanted.files.push(path),
                WindowRequest::Compare => wanted.comparison = true,
                WindowRequest::Copy(text) => screen.input.set_clipboard_text(text),
                WindowRequest::PasteView => match screen.input.clipboard_text() {
                    Some(text) => self.state.paste_view(&text),
                    None => self.state.notices.warn("There is no text to paste"),
                },
                WindowRequest::FullScreen => {
                    // The window system may have ended it meanwhile: the window itself knows.
                    let full = screen.window.fullscreen().is_none();
                    let full_screen = full.then_some(Fullscreen::Borderless(None));
                    screen.window.set_fullscreen(full_screen);
                    self.state.full_screen = full;
                }
            }
        }
        wanted
    }

    /// Takes notice of what is to be kept.
    fn note_preferences(&mut self, window: &Window) {
        let size = window.inner_size();
        // Being maximised is asked of the window system: only when it may be another answer.
        if self.noted_size != Some(size) {
            self.noted_size = Some(size);
            if window.fullscreen().is_none() && !window.is_maximized() {
                let size: LogicalSize<f64> = size.to_logical(window.scale_factor());
                self.options.state.preferences.window_size = Some(size.into());
            }
        }
        let preferences = Preferences {
            window_size: self.options.state.preferences.window_size,
            ..self.state.preferences()
        };
        let now = self.now();
        self.options.preferences_file.note(preferences, now);
    }

    fn set_title(&self, screen: &mut Screen) {
        let title = match self.state.sequence_name() {
            Some(name) => format!("{name} – pointreel"),
            None => "pointreel".to_owned(),
        };
        if screen.title != title {
            screen.window.set_title(&title);
            screen.title = title;
        }
    }

    /// `--screenshot`: writes the picture after enough frames and ends.
    fn take_screenshot_if_due(
        &mut self,
        event_loop: &ActiveEventLoop,
        screen: &mut Screen,
    ) -> Result<(), RenderError> {
        let (Some(path), Some(player)) = (&self.options.screenshot, &self.state.player) else {
            return Ok(());
        };
        // Without playing there is no second frame to wait for.
        let wanted = if player.is_playing() {
            self.options.after_frames
        } else {
            1
        };
        if player.shown().is_some() && player.frames_shown() >= wanted && self.state.is_drawn() {
            let image = self.read_joined(screen)?;
            self.end = save_png(&image, path).map_err(AppError::Screenshot);
            event_loop.exit();
        } else if let Some(failure) = player.failure()
            && (!player.is_playing()
                || player.loader().stats().failed_frames == player.sequence().len())
        {
            let why = failure.to_string();
            self.fail(event_loop, AppError::Screenshot(why));
        }
        Ok(())
    }
}

impl ApplicationHandler<Message> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.screen.is_some() {
            return;
        }
        let opened = self
            .open_window(event_loop)
            .and_then(|window| self.open_screen(event_loop, window, None));
        match opened {
            Ok(screen) => {
                screen.window.request_redraw();
                self.screen = Some(screen);
            }
            Err(error) => self.fail(event_loop, error),
        }
    }

    fn user_event(&mut self, _event_loop: &ActiveEventLoop, message: Message) {
        match message {
            Message::Wake => {
                self.wake_is_queued.store(false, Ordering::Release);
                self.woken = true;
            }
            Message::Accessibility(event) => self.serve_screen_reader(event.window_event),
        }
    }

    fn window_event(
        &mut self,
        event_loop: &ActiveEventLoop,
        _window: WindowId,
        event: WindowEvent,
    ) {
        if matches!(event, WindowEvent::RedrawRequested) {
            self.redraw(event_loop);
            return;
        }
        let Some(screen) = &mut self.screen else {
            return;
        };
        let response = screen.input.on_window_event(&screen.window, &event);
        match event {
            WindowEvent::CloseRequested if !self.state.may_close() => {
                screen.window.request_redraw();
            }
            WindowEvent::CloseRequested | WindowEvent::Destroyed => event_loop.exit(),
            WindowEvent::Resized(size) => {
                self.sight.note_size(size.into());
                screen.graphics.resize();
                screen.window.request_redraw();
            }
            WindowEvent::ScaleFactorChanged { .. } => {
                screen.graphics.resize();
                screen.window.request_redraw();
            }
            WindowEvent::Occluded(is_occluded) => {
                self.sight.is_occluded = is_occluded;
                if !is_occluded {
                    screen.window.request_redraw();
                }
            }
            _ if response.repaint => screen.window.request_redraw(),
            _ => {}
        }
    }

    /// Sleeps until something is due.
    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = self.now();
        let mut is_changed = false;
        if std::mem::take(&mut self.woken) {
            is_changed = self.state.update(now);
            if !is_changed && self.state.has_news() {
                self.news_at.get_or_insert(self.last_redraw + NEWS_INTERVAL);
            }
        }
        self.options.preferences_file.write_if_due(now);
        let draw_at = [self.state.next_deadline(), self.repaint_at, self.news_at];
        let agenda = Agenda {
            is_changed,
            draw_at: draw_at.into_iter().flatten().min(),
            unseen_at: self.options.preferences_file.next_deadline(),
            is_hidden: self.sight.is_hidden(),
        };
        let pace = agenda.pace(now);
        event_loop.set_control_flow(pace.wake_at.map_or(ControlFlow::Wait, |due| {
            ControlFlow::WaitUntil(self.begin + due)
        }));
        if let Some(screen) = self.screen.as_ref().filter(|_| pace.redraw) {
            screen.window.request_redraw();
        }
    }

    fn exiting(&mut self, _event_loop: &ActiveEventLoop) {
        self.options.preferences_file.write();
        self.state.end_exports();
    }
}
