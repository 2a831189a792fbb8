//! The event loop: winit's events to egui, deadlines and wakes to redraws.

mod accessibility;
mod egui_before;
mod lost;
mod message;
mod redraw;

use self::egui_before::EguiBefore;
use self::message::Message;
use super::pacing::{Agenda, Sight};
use super::preferences::{Preferences, PreferencesFile};
use super::present::{self, Presenter};
use super::present_choice::PresentChoice;
use super::script::{Script, ScriptError};
use super::state::{PictureStage, State, StateOptions, VisibleChange};
use super::theme::apply_theme;
use super::window_bench::WindowBench;
use crate::app::side::Side;
use crate::bench::{BenchOptions, Input, WindowAction};
use crate::document::ReadSession;
use crate::render::RenderError;
use crate::scene::{Choice, RendererChoice};
use crate::sequence::{OpenOptions, Sequence};
use crate::signals;
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

/// The smallest size that panels have a layout for, logical pixels.
const MIN_SIZE: LogicalSize<f64> = LogicalSize::new(320.0, 240.0);

/// Minimum redraw interval, as a fraction of the display's refresh interval, where presenting does not block: a mouse
/// reports its moves a thousand times per second. It is below 1, so that images which are due do not slip back little
/// by little.
const MIN_REDRAW_INTERVAL: f64 = 0.75;

/// Timeout for closing a window after a signal has requested it.
const PATIENCE: Duration = Duration::from_secs(5);

/// Refresh interval of a display that does not report one.
const DEFAULT_REFRESH_INTERVAL: Duration = Duration::from_micros(16_667);

/// News from workers that only move marks and figures are shown this often.
const NEWS_INTERVAL: Duration = Duration::from_millis(100);

/// Options for opening the window.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Initial state options. Their `wake` is replaced.
    pub state: StateOptions,
    /// Sequence to show first; if `None` the welcome view, or the demo for users without recent inputs.
    pub sequence: Option<Arc<Sequence>>,
    /// Sequence to show next to it for comparison.
    pub compare: Option<Arc<Sequence>>,
    /// Inputs by which the first sequence was found, for the list of recent files.
    pub inputs: Vec<PathBuf>,
    /// Inputs by which the first sequence was named, for sessions.
    pub named: Vec<PathBuf>,
    /// Options it was opened with, if they differ from those in the state's options.
    pub opened_with: Option<OpenOptions>,
    /// The session that the first is of.
    pub session: Option<Box<ReadSession>>,
    /// Warnings from before there was a window to show them in.
    pub warnings: Vec<String>,
    /// File in which changes of settings are stored; none by default.
    pub preferences_file: PreferencesFile,
    /// Size of the window in pixels, which takes precedence over the preferred one.
    pub size_px: Option<[u32; 2]>,
    /// Open the window in full screen.
    pub is_full_screen: bool,
    /// Write the 3-D image to this file and end.
    pub screenshot: Option<PathBuf>,
    /// Number of frames shown before the screenshot; at least 1.
    pub after_frames: u64,
    /// Commands that are run as if by the user.
    pub script: Option<Script>,
    /// End the GPU device after this many images, as a crashed driver would: for tests.
    pub lose_device_after: Option<u64>,
}

/// Errors of opening or running the window.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AppError {
    /// There is no display, or it refuses.
    #[error("no window can be opened ({reason}); without a display use `pointreel render INPUT -o image.png`")]
    NoWindow {
        /// Error message of the window system.
        reason: String,
    },
    /// No adapter, or it was lost for good.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A line of a script could not be run.
    #[error(transparent)]
    Script(#[from] ScriptError),
    /// The window was closed before it had measured itself.
    #[error("the window was closed before all was measured")]
    Closed,
    /// The requested screenshot could not be made.
    #[error("{0}")]
    Screenshot(String),
}

/// Opens the window and returns when it is closed.
pub fn run(options: Options) -> Result<(), AppError> {
    run_with(options, None).map(|_| ())
}

/// Opens a window that plays, orbits and scrubs `inputs` by itself, and returns its measurements.
pub fn bench_window(
    inputs: &[Input],
    bench: &BenchOptions,
    present: PresentChoice,
    renderer: Choice<RendererChoice>,
) -> Result<Vec<WindowAction>, AppError> {
    let options = Options {
        state: StateOptions {
            preferences: Preferences {
                present,
                ..Preferences::default()
            },
            budget_bytes: bench.budget_bytes,
            ..StateOptions::default()
        },
        sequence: inputs.first().map(|input| Arc::clone(&input.sequence)),
        size_px: Some(bench.viewport_px),
        ..Options::default()
    };
    run_with(options, Some(WindowBench::new(inputs, bench, renderer)))
}

/// Runs the window; returns its measurements, if it drives itself.
fn run_with(options: Options, window_bench: Option<WindowBench>) -> Result<Vec<WindowAction>, AppError> {
    let no_window = |reason: &dyn std::fmt::Display| AppError::NoWindow {
        reason: reason.to_string(),
    };
    let event_loop = EventLoop::<Message>::with_user_event()
        .build()
        .map_err(|error| no_window(&error))?;
    let mut app = App::new(options, &event_loop);
    let proxy = event_loop.create_proxy();
    let end = move || {
        // If the event loop is gone, it has already ended.
        let _ = proxy.send_event(Message::End);
    };
    let _ends_well = signals::on_first(end, Some(PATIENCE));
    app.window_bench = window_bench;
    event_loop.run_app(&mut app).map_err(|error| no_window(&error))?;
    app.end?;
    match app.window_bench {
        Some(mut window_bench) => window_bench.result().ok_or(AppError::Closed),
        None => Ok(Vec::new()),
    }
}

/// Objects that exist while there is a window.
struct OpenWindow {
    window: Arc<Window>,
    presenter: Box<dyn Presenter>,
    /// Chosen presentation backend.
    choice: PresentChoice,
    egui: egui::Context,
    input: egui_winit::State,
    title: String,
}

#[expect(
    clippy::struct_excessive_bools,
    reason = "each is something that has or has not happened, independent of the others"
)]
struct App {
    state: State,
    options: Options,
    screen: Option<OpenWindow>,
    messages: EventLoopProxy<Message>,
    /// A screen reader is active.
    is_read_aloud: bool,
    begin: Instant,
    /// Set by the first wake since the last look, so that a busy loader does not fill the queue.
    wake_is_queued: Arc<AtomicBool>,
    woken: bool,
    sight: Sight,
    /// Something has been presented.
    has_been_shown: bool,
    /// Completeness of its frame in the last presented image.
    stage_shown: Option<PictureStage>,
    /// Visible change since the last redraw.
    change: VisibleChange,
    /// The window system has lost the window's contents.
    is_exposed: bool,
    /// A redraw was requested.
    is_redraw_queued: bool,
    /// When egui wants to be run again.
    repaint_at: Option<Duration>,
    /// When marks and figures that changed in the background are shown.
    news_at: Option<Duration>,
    last_redraw: Duration,
    /// When egui was run last.
    last_panels: Duration,
    /// Refresh interval of the screen.
    refresh_interval: Duration,
    /// The last checked size of the window, for the preferences.
    noted_size: Option<PhysicalSize<u32>>,
    rebuilt_at: Vec<Duration>,
    /// Benchmark that drives the window.
    window_bench: Option<WindowBench>,
    end: Result<(), AppError>,
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
        // Users with recent inputs are offered these; new users see an animation. The window waits for the first frame
        // of a followed folder.
        let is_waited_for = options.sequence.is_none() && !options.inputs.is_empty();
        let offers_demo = state.stored.recent.entries().is_empty() && !is_waited_for;
        let demo = || offers_demo.then(|| Arc::new(Sequence::demo()));
        if let Some(sequence) = options.sequence.take().or_else(demo) {
            if let Some(session) = options.session.take() {
                state.open_session(sequence, *session);
            } else {
                state.open(sequence);
                state.note_opened(options.named.clone(), options.opened_with.take());
            }
        }
        if let Some(sequence) = options.compare.take() {
            state.compare_with(sequence);
        }
        if is_waited_for {
            state.open_paths(options.inputs.clone());
        } else {
            state.prove(options.inputs.clone(), Side::A);
        }
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
            stage_shown: None,
            change: VisibleChange::Panels,
            is_exposed: false,
            is_redraw_queued: false,
            repaint_at: None,
            news_at: None,
            last_redraw: Duration::ZERO,
            last_panels: Duration::ZERO,
            refresh_interval: DEFAULT_REFRESH_INTERVAL,
            noted_size: None,
            rebuilt_at: Vec::new(),
            window_bench: None,
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
            // Screen readers have to know about a window before it becomes visible.
            .with_visible(false)
            // An alpha visual stays black on software adapters under a bare X server.
            .with_transparent(false);
        #[cfg(all(unix, not(target_os = "macos")))]
        let attributes = {
            use winit::platform::wayland::WindowAttributesExtWayland as _;
            // Desktops use this to find its icon and to group its windows, also under X11.
            attributes.with_name("pointreel", "pointreel")
        };
        let left = self.options.state.preferences.window_size.map(LogicalSize::<f64>::from);
        let attributes = match self.options.size_px {
            Some([width, height]) => attributes.with_inner_size(PhysicalSize::new(width, height)),
            None => attributes.with_inner_size(within_screen(event_loop, left.unwrap_or(DEFAULT_SIZE))),
        };
        let full_screen = self.options.is_full_screen.then_some(Fullscreen::Borderless(None));
        event_loop
            .create_window(attributes.with_fullscreen(full_screen))
            .map(Arc::new)
            .map_err(|error| AppError::NoWindow {
                reason: error.to_string(),
            })
    }

    /// The presenter's side and egui's for `window`; the state of egui stays as it was in `before`.
    fn open_screen(
        &mut self,
        event_loop: &ActiveEventLoop,
        window: Arc<Window>,
        before: &mut Option<EguiBefore>,
    ) -> Result<OpenWindow, AppError> {
        self.state.appearance.full_screen = window.fullscreen().is_some();
        let choice = self.state.appearance.present;
        let presenter = present::open(choice, &window)?;
        let egui = egui::Context::default();
        apply_theme(&egui);
        egui.set_theme(self.state.appearance.theme);
        if let Some(before) = before {
            let memory = before.context.memory(Clone::clone);
            egui.memory_mut(|new| *new = memory);
        }
        if self.is_read_aloud {
            egui.enable_accesskit();
        }
        let info = presenter.info();
        let max_edge_px = info.max_edge_px;
        let mut input = egui_winit::State::new(
            egui.clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            window.theme(),
            Some(max_edge_px as usize),
        );
        match before.take() {
            None => input.init_accesskit(event_loop, &window, self.messages.clone()),
            Some(before) => input.accesskit = before.accessibility,
        }
        window.set_visible(true);
        self.state.viewport.texture = presenter.texture(Side::A);
        self.state.viewport.other_texture = None;
        self.state.viewport.max_edge_px = Some(max_edge_px);
        self.state.graphics.adapter = info.adapter;
        self.state.graphics.is_software = info.is_software;
        self.state.graphics.paints_on_processor = info.paints_on_processor;
        self.state.forget_picture();
        self.change = VisibleChange::Panels;
        self.note_refresh_rate(&window);
        Ok(OpenWindow {
            window,
            presenter,
            choice,
            egui,
            input,
            title: String::new(),
        })
    }

    /// Records the refresh rate of the window's screen.
    fn note_refresh_rate(&mut self, window: &Window) {
        let monitor = window.current_monitor();
        let millihertz = monitor.and_then(|monitor| monitor.refresh_rate_millihertz());
        self.refresh_interval = millihertz
            .filter(|&millihertz| millihertz > 0)
            .map_or(DEFAULT_REFRESH_INTERVAL, |millihertz| {
                Duration::from_secs_f64(1000.0 / f64::from(millihertz))
            });
    }

    /// Runs the due steps of a benchmark; returns the time of the next one.
    fn advance_window_bench(&mut self, event_loop: &ActiveEventLoop, now: Duration) -> Option<Duration> {
        let (window_bench, screen) = self.window_bench.as_mut().zip(self.screen.as_mut())?;
        // After the first redraw, which determines the layout.
        if !self.has_been_shown {
            return None;
        }
        let events = window_bench.advance(now, &mut self.state);
        if !events.is_empty() {
            screen.input.egui_input_mut().events.extend(events);
            self.change = VisibleChange::Panels;
        }
        let deadline = window_bench.next_deadline();
        if deadline.is_none() {
            event_loop.exit();
        }
        deadline
    }

    /// Runs the due lines of a script; returns the time of the next one.
    fn advance_script(&mut self, event_loop: &ActiveEventLoop, now: Duration) -> Option<Duration> {
        // After the first redraw, which determines the layout.
        let script = self.options.script.as_mut().filter(|_| self.has_been_shown)?;
        match script.advance(&mut self.state, now) {
            Ok(true) => self.change = VisibleChange::Panels,
            Ok(false) => {}
            Err(error) => {
                self.options.script = None;
                self.fail(event_loop, error.into());
                return None;
            }
        }
        self.options.script.as_ref()?.next_deadline(now)
    }

    fn fail(&mut self, event_loop: &ActiveEventLoop, error: AppError) {
        self.end = Err(error);
        event_loop.exit();
    }

    /// Records the preferences to be stored.
    fn note_preferences(&mut self, window: &Window) {
        let size = window.inner_size();
        // Querying whether it is maximised is a request to the window system: only done when the answer may have
        // changed.
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

    fn set_title(&self, screen: &mut OpenWindow) {
        let title = match self.state.sequence_name() {
            Some(name) if self.state.is_unsaved() => format!("*{name} – pointreel"),
            Some(name) => format!("{name} – pointreel"),
            None => "pointreel".to_owned(),
        };
        if screen.title != title {
            screen.window.set_title(&title);
            screen.title = title;
        }
    }
}

impl ApplicationHandler<Message> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.screen.is_some() {
            return;
        }
        let opened = self
            .open_window(event_loop)
            .and_then(|window| self.open_screen(event_loop, window, &mut None));
        match opened {
            Ok(screen) => self.screen = Some(screen),
            Err(error) => self.fail(event_loop, error),
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, message: Message) {
        match message {
            Message::End => event_loop.exit(),
            Message::Wake => {
                self.wake_is_queued.store(false, Ordering::Release);
                self.woken = true;
            }
            Message::Accessibility(event) => self.serve_screen_reader(event.window_event),
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _window: WindowId, event: WindowEvent) {
        if matches!(event, WindowEvent::RedrawRequested) {
            // A redraw that was not requested here comes from the window system, which has lost the contents.
            self.is_exposed |= !std::mem::take(&mut self.is_redraw_queued);
            self.redraw(event_loop);
            return;
        }
        let Some(screen) = &mut self.screen else {
            return;
        };
        let response = screen.input.on_window_event(&screen.window, &event);
        let mut is_changed = response.repaint;
        match event {
            WindowEvent::CloseRequested if !self.state.may_close() => is_changed = true,
            WindowEvent::CloseRequested | WindowEvent::Destroyed => event_loop.exit(),
            WindowEvent::Resized(size) => {
                self.sight.note_size(size.into());
                screen.presenter.resize();
                is_changed = true;
            }
            WindowEvent::ScaleFactorChanged { .. } => {
                screen.presenter.resize();
                is_changed = true;
            }
            WindowEvent::Moved(_) => {
                let window = Arc::clone(&screen.window);
                self.note_refresh_rate(&window);
            }
            WindowEvent::Occluded(is_occluded) => {
                self.sight.is_occluded = is_occluded;
                is_changed |= !is_occluded;
                self.is_exposed |= !is_occluded;
            }
            _ => {}
        }
        if is_changed {
            self.change = VisibleChange::Panels;
        }
    }

    /// Sleeps until something is due.
    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = self.now();
        if std::mem::take(&mut self.woken) {
            let change = self.state.update(now);
            self.change = self.change.max(change);
            if !change.is_visible() && self.state.has_news() {
                self.news_at.get_or_insert(self.last_redraw + NEWS_INTERVAL);
            }
        }
        self.options.preferences_file.write_if_due(now);
        self.state.keep_if_due(now);
        let window_bench_at = self.advance_window_bench(event_loop, now);
        let script_at = self.advance_script(event_loop, now);
        let draw_at = [self.state.next_deadline(), self.repaint_at, self.news_at];
        let waits_for_screen = self
            .screen
            .as_ref()
            .is_none_or(|screen| screen.presenter.info().waits_for_screen);
        let agenda = Agenda {
            is_changed: self.change.is_visible(),
            draw_at: draw_at.into_iter().flatten().min(),
            not_before: if waits_for_screen {
                Duration::ZERO
            } else {
                self.last_redraw + self.refresh_interval.mul_f64(MIN_REDRAW_INTERVAL)
            },
            unseen_at: [
                self.options.preferences_file.next_deadline(),
                self.state.keeping_deadline(),
                window_bench_at,
                script_at,
            ]
            .into_iter()
            .flatten()
            .min(),
            is_hidden: self.sight.is_hidden(),
        };
        let pace = agenda.pace(now);
        event_loop.set_control_flow(
            pace.wake_at
                .map_or(ControlFlow::Wait, |due| ControlFlow::WaitUntil(self.begin + due)),
        );
        if let Some(screen) = self.screen.as_ref().filter(|_| pace.redraw) {
            self.is_redraw_queued = true;
            screen.window.request_redraw();
        }
    }

    fn exiting(&mut self, _event_loop: &ActiveEventLoop) {
        self.options.preferences_file.write();
        self.state.keep_document();
        self.state.end_exports();
        // The surface must be dropped before the connection to the window system, which ends with the event loop.
        self.screen = None;
    }
}

/// A size that fits the screen: not every window manager ensures that. With several screens, or an unknown one, the
/// largest decides.
fn within_screen(event_loop: &ActiveEventLoop, size: LogicalSize<f64>) -> LogicalSize<f64> {
    let screens = event_loop.available_monitors();
    let rooms = screens.map(|screen| screen.size().to_logical::<f64>(screen.scale_factor()));
    let largest = rooms.max_by(|a, b| (a.width * a.height).total_cmp(&(b.width * b.height)));
    // Some systems report a screen without a size until a window is on it.
    match largest.filter(|space| space.width > 0.0 && space.height > 0.0) {
        Some(space) => LogicalSize::new(size.width.min(space.width), size.height.min(space.height)),
        None => size,
    }
}
