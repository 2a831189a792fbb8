//! Everything the window shows and what a person can change, without a window: tests drive it with a clock of their own.

use super::benchmark::{Benchmark, BenchmarkJob, benchmark_job};
use super::command::{self, Command};
use super::fly::Fly;
use super::notices::Notices;
use super::player::{Player, can_draw};
use super::recent::Recent;
use super::tasks::{DialogKind, Outcome, PicturePlace, Tasks, Wake};
use crate::bench::Suite;
use crate::render::RenderStats;
use crate::scene::{Camera, Primitive, Scene, ScenePacket, SceneStats, Settings, UpAxis};
use crate::sequence::{LoaderOptions, LoopMode, MAX_SPEED, MIN_SPEED, Sequence};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// The speeds that the keys step through.
const SPEEDS: [f64; 9] = [0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 10.0];

/// The keys change sizes by this factor.
const SIZE_STEP: f32 = 1.25;

/// Bounds of splat scale and of point size in pixels.
pub(super) const SPLAT_SCALE_RANGE: std::ops::RangeInclusive<f32> = 0.1..=10.0;
pub(super) const POINT_SIZE_RANGE_PX: std::ops::RangeInclusive<f32> = 1.0..=32.0;

/// How a [`State`] begins.
#[derive(Clone)]
pub struct StateOptions {
    /// How pictures are asked for.
    pub settings: Settings,
    /// Which axis is up; guessed for each sequence if `None`.
    pub up: Option<UpAxis>,
    /// Frames a second, where the sequence's own rate is not wanted.
    pub fps: Option<f64>,
    /// Do not play what is opened.
    pub paused: bool,
    /// Memory for prepared frames; the loader's default if `None`.
    pub budget_bytes: Option<usize>,
    /// What was opened lately.
    pub recent: Recent,
    /// Wakes the window from another thread.
    pub wake: Wake,
}

impl Default for StateOptions {
    fn default() -> Self {
        Self {
            settings: Settings::default(),
            up: None,
            fps: None,
            paused: false,
            budget_bytes: None,
            recent: Recent::default(),
            wake: Arc::new(|| {}),
        }
    }
}

impl std::fmt::Debug for StateOptions {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("StateOptions")
            .field("settings", &self.settings)
            .field("paused", &self.paused)
            .finish_non_exhaustive()
    }
}

/// Which panels and windows are open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a panel that is open or not, independent of the others"
)]
pub struct OpenPanels {
    /// The settings at the right.
    pub settings: bool,
    /// The statistics at the left.
    pub statistics: bool,
    /// The list of keys.
    pub help: bool,
    /// The benchmark window.
    pub benchmark: bool,
}

impl Default for OpenPanels {
    fn default() -> Self {
        Self {
            settings: true,
            statistics: false,
            help: false,
            benchmark: false,
        }
    }
}

/// What the window did. The proof that an idle one does nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Runs of the panels.
    pub ui_passes: u64,
    /// Packets that differed from the one before: pictures asked of the renderer.
    pub pictures: u64,
}

/// The picture on the screen.
#[derive(Debug, Clone, Copy)]
pub struct Viewport {
    /// Its place in the window, points.
    pub rect: egui::Rect,
    /// Its size in physical pixels.
    pub size_px: [u32; 2],
    /// The texture that holds it; `None` without a GPU.
    pub texture: Option<egui::TextureId>,
    /// Largest edge that the adapter can draw.
    pub max_edge_px: Option<u32>,
}

impl Default for Viewport {
    fn default() -> Self {
        Self {
            rect: egui::Rect::ZERO,
            size_px: [0; 2],
            texture: None,
            max_edge_px: None,
        }
    }
}

/// What the statistics panel says of the graphics card.
#[derive(Debug, Clone, Default)]
pub struct GraphicsInfo {
    /// Name, type and driver.
    pub adapter: String,
    /// Whether GPU time can be measured.
    pub has_timestamps: bool,
    /// Counters of the renderer.
    pub render: RenderStats,
    /// CPU time of the last redraw: panels, picture and painting, without waiting for the screen.
    pub frame_ms: f64,
}

/// What only the window itself can do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum WindowRequest {
    /// Read the picture back and write it to this file, or to a new one.
    Screenshot(Option<PathBuf>),
    /// Full screen and back.
    FullScreen,
    /// End the program.
    Quit,
}

/// The state of the window.
#[derive(Debug)]
pub struct State {
    /// The open sequence.
    pub player: Option<Player>,
    /// Where the picture is seen from; kept across frames.
    pub camera: Camera,
    /// How pictures are asked for.
    pub settings: Settings,
    /// Messages.
    pub notices: Notices,
    /// Open panels.
    pub panels: OpenPanels,
    /// The benchmark window's content.
    pub benchmark: Benchmark,
    /// What was opened lately.
    pub recent: Recent,
    /// The picture's place.
    pub viewport: Viewport,
    /// What is known of the graphics card.
    pub graphics: GraphicsInfo,
    /// Keys that fly.
    pub fly: Fly,
    /// Work done.
    pub counters: Counters,
    /// True while the window fills the screen.
    pub full_screen: bool,
    /// True between the first and the last move of the playhead by the mouse.
    pub(super) scrubbing: Scrubbing,
    pub(super) tasks: Tasks,
    options: StateOptions,
    now: Duration,
    /// True once the camera was set for the open sequence.
    framed: bool,
    requests: Vec<WindowRequest>,
    scene: Scene,
    packet: Option<ScenePacket>,
    drawn_primitive: Primitive,
}

/// The playhead in the hand.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Scrubbing {
    /// Plays on when it is let go.
    pub(super) resume: bool,
}

impl State {
    /// Nothing open.
    pub fn new(options: StateOptions) -> Self {
        let nothing = crate::math::Aabb::EMPTY;
        Self {
            player: None,
            camera: Camera::framing(&nothing, glam::DVec3::ZERO, options.up.unwrap_or_default()),
            settings: options.settings,
            notices: Notices::default(),
            panels: OpenPanels::default(),
            benchmark: Benchmark::default(),
            recent: options.recent.clone(),
            viewport: Viewport::default(),
            graphics: GraphicsInfo::default(),
            fly: Fly::default(),
            counters: Counters::default(),
            full_screen: false,
            scrubbing: Scrubbing::default(),
            tasks: Tasks::new(Arc::clone(&options.wake)),
            now: Duration::ZERO,
            framed: false,
            requests: Vec::new(),
            scene: Scene::default(),
            packet: None,
            drawn_primitive: Primitive::Point,
            options,
        }
    }

    /// The time of the last [`State::update`].
    pub fn now(&self) -> Duration {
        self.now
    }

    /// What [`StateOptions`] said about waking.
    pub(super) fn wake(&self) -> Wake {
        Arc::clone(&self.options.wake)
    }

    /// Counters of the traversal.
    pub fn scene_stats(&self) -> SceneStats {
        self.scene.stats()
    }

    /// Shows `sequence` in place of what was open. Settings stay.
    pub fn open(&mut self, sequence: Arc<Sequence>) {
        let mut loader_options = LoaderOptions {
            wake: self.wake(),
            ..LoaderOptions::default()
        };
        if let Some(budget_bytes) = self.options.budget_bytes {
            loader_options.budget_bytes = budget_bytes;
        }
        let mut player = match Player::new(sequence, loader_options, !self.options.paused) {
            Ok(player) => player,
            Err(error) => return self.notices.error(error.to_string()),
        };
        if let Some(fps) = self.options.fps {
            player.set_fps(fps, self.now);
        }
        if let Some(before) = self.player.replace(player) {
            player_settings_kept(&before, self.player.as_mut(), self.now);
            // Its threads end after the frame they are on; nobody waits for that here.
            self.tasks.close(before);
        }
        self.framed = false;
        self.scrubbing = Scrubbing::default();
    }

    /// Finds the frames of `inputs` on a thread and opens them.
    pub fn open_paths(&mut self, inputs: Vec<PathBuf>) {
        if !inputs.is_empty() {
            self.tasks.find(inputs);
        }
    }

    /// Sets the memory for prepared frames, now and for what is opened later.
    pub fn set_budget_bytes(&mut self, budget_bytes: usize) {
        self.options.budget_bytes = Some(budget_bytes);
        if let Some(player) = &self.player {
            player.loader().set_budget_bytes(budget_bytes);
        }
    }

    /// Moves on to `now`: takes in what threads finished, moves the playhead. True if something can be seen to change.
    pub fn update(&mut self, now: Duration) -> bool {
        self.now = now;
        let outcomes = self.tasks.take();
        let mut visible = !outcomes.is_empty();
        for outcome in outcomes {
            self.take_in(outcome);
        }
        visible |= self.notices.expire(now);
        let Some(player) = &mut self.player else {
            return visible;
        };
        let change = player.update(now, &self.settings);
        visible |= change.visible;
        if let Some(failure) = change.new_failure {
            let place = failure.index() + 1;
            let count = player.sequence().len();
            self.notices
                .error(format!("Frame {place} of {count} is left out. {failure}"));
        }
        if !self.framed && player.shown().is_some() {
            self.frame_cloud();
            self.framed = true;
        }
        visible
    }

    fn take_in(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Found { inputs, sequence } => match sequence {
                Ok(sequence) => {
                    self.open(sequence);
                    if let Err(problem) = self.recent.add(&inputs) {
                        self.notices.warn(problem);
                    }
                }
                Err(error) => self.notices.error(error.to_string()),
            },
            Outcome::Chosen { dialog, paths } => self.chosen(dialog, paths),
            Outcome::Cancelled => {}
            Outcome::NoDialog => self.notices.error(
                "No file dialog could be opened: on Linux one needs xdg-desktop-portal or zenity. \
                 Drop files or a folder on the window, or name them on the command line: pointreel view FOLDER",
            ),
            Outcome::Saved(path) => self.notices.info(format!("Saved {}", path.display())),
            Outcome::Benchmark(result) => self.benchmark.finish(result),
            Outcome::Failed(text) => self.notices.error(text),
        }
    }

    fn chosen(&mut self, dialog: DialogKind, mut paths: Vec<PathBuf>) {
        let first = paths[0].clone();
        match dialog {
            DialogKind::OpenFiles | DialogKind::OpenFolder => {
                self.open_paths(std::mem::take(&mut paths))
            }
            DialogKind::SavePicture => {
                self.requests
                    .push(WindowRequest::Screenshot(Some(with_extension(
                        first, "png",
                    ))))
            }
            DialogKind::SaveJson | DialogKind::SaveCsv => {
                let Benchmark::Done(table) = &self.benchmark else {
                    return;
                };
                let (extension, text) = match dialog {
                    DialogKind::SaveJson => ("json", &table.json),
                    _ => ("csv", &table.csv),
                };
                self.tasks
                    .save(with_extension(first, extension), text.clone().into_bytes());
            }
        }
    }

    /// Puts the camera so that all of the shown frame is seen, keeping its direction once the person has chosen one.
    pub fn frame_cloud(&mut self) {
        let Some(player) = &self.player else { return };
        let Some(frame) = player.shown() else { return };
        let bounds = frame.frame.bounds();
        let origin = player.sequence().origin();
        if self.framed {
            self.camera.frame_bounds(&bounds, origin);
        } else {
            let up = self
                .options
                .up
                .unwrap_or_else(|| UpAxis::guess(&frame.frame));
            self.camera = Camera::framing(&bounds, origin, up);
        }
    }

    /// Does what a key or menu asks for.
    pub fn run(&mut self, command: Command) {
        match command {
            Command::TogglePlay => self.play_with(Player::toggle),
            Command::Step(count) => self.play_with(|player, now| player.step(count, now)),
            Command::First => self.play_with(|player, now| player.seek(0, now)),
            Command::Last => self.play_with(|player, now| player.seek(usize::MAX, now)),
            Command::NextLoopMode => self.play_with(|player, now| {
                let next = next_loop_mode(player.clock().loop_mode());
                player.set_loop_mode(next, now);
            }),
            Command::Slower => {
                self.change_speed(|speed| SPEEDS.iter().rev().copied().find(|&s| s < speed - 1e-9))
            }
            Command::Faster => {
                self.change_speed(|speed| SPEEDS.iter().copied().find(|&s| s > speed + 1e-9))
            }
            Command::Reverse => {
                self.play_with(|player, now| player.set_speed(-player.clock().speed(), now))
            }
            Command::ResetView => self.reset_view(),
            Command::Look(preset) => self.camera.look_from(preset),
            Command::Smaller => self.scale_size(1.0 / SIZE_STEP),
            Command::Larger => self.scale_size(SIZE_STEP),
            Command::OpenFiles => self.tasks.ask(DialogKind::OpenFiles, None),
            Command::OpenFolder => self.tasks.ask(DialogKind::OpenFolder, None),
            Command::OpenDemo => self.open(Arc::new(Sequence::demo())),
            Command::Screenshot => self.requests.push(WindowRequest::Screenshot(None)),
            Command::SaveScreenshotAs => {
                let name = format!("{}.png", self.picture_stem());
                self.tasks.ask(DialogKind::SavePicture, Some(name));
            }
            Command::FullScreen => self.requests.push(WindowRequest::FullScreen),
            Command::ToggleSettings => self.panels.settings ^= true,
            Command::ToggleStatistics => self.panels.statistics ^= true,
            Command::ToggleHelp => self.panels.help ^= true,
            Command::Escape => self.escape(),
            Command::Quit => self.requests.push(WindowRequest::Quit),
        }
    }

    /// The camera as for a sequence that was just opened; the up axis stays as it was chosen.
    fn reset_view(&mut self) {
        let up = self.camera.up;
        self.framed = false;
        self.frame_cloud();
        self.framed = self
            .player
            .as_ref()
            .is_some_and(|player| player.shown().is_some());
        self.camera.up = up;
    }

    fn escape(&mut self) {
        let running = matches!(self.benchmark, Benchmark::Running(_));
        if self.panels.help {
            self.panels.help = false;
        } else if self.panels.benchmark && !running {
            self.panels.benchmark = false;
        } else if self.full_screen {
            self.requests.push(WindowRequest::FullScreen);
        }
    }

    /// Changes the player, if there is one, at the present time.
    pub(super) fn play_with(&mut self, change: impl FnOnce(&mut Player, Duration)) {
        if let Some(player) = &mut self.player {
            change(player, self.now);
        }
    }

    /// Takes the playhead in the hand, or lets it go: meanwhile playing rests.
    pub(super) fn play_with_scrubbing(&mut self, begin: bool) {
        let Some(player) = &mut self.player else {
            return;
        };
        if begin {
            self.scrubbing.resume = player.is_playing();
            if self.scrubbing.resume {
                player.toggle(self.now);
            }
        } else if std::mem::take(&mut self.scrubbing.resume) && !player.is_playing() {
            player.toggle(self.now);
        }
    }

    /// Measures the open sequence on a thread; playing rests, it would disturb the measurement.
    pub fn start_benchmark(&mut self, suite: Suite) {
        let Some(player) = &mut self.player else {
            return;
        };
        if player.is_playing() {
            player.toggle(self.now);
        }
        let sequence = Arc::clone(player.sequence());
        let name = self.sequence_name().unwrap_or_default();
        self.start_benchmark_job(suite.name(), benchmark_job(suite, name, sequence));
    }

    /// Shows the benchmark window and runs `job` in it.
    pub fn start_benchmark_job(&mut self, suite: &str, job: BenchmarkJob) {
        self.panels.benchmark = true;
        let wake = self.wake();
        self.benchmark.start(suite, job, &self.tasks, wake);
    }

    /// Asks where to write the benchmark's result.
    pub(super) fn ask_for_export(&mut self, dialog: DialogKind) {
        let Benchmark::Done(table) = &self.benchmark else {
            return;
        };
        let extension = if dialog == DialogKind::SaveJson {
            "json"
        } else {
            "csv"
        };
        let name = format!("pointreel-{}.{extension}", table.suite);
        self.tasks.ask(dialog, Some(name));
    }

    /// True if something that is not the picture may have changed: marks on the timeline, progress.
    pub(super) fn has_news(&self) -> bool {
        matches!(self.benchmark, Benchmark::Running(_))
            || self.player.as_ref().is_some_and(Player::runs_are_old)
    }

    fn change_speed(&mut self, next: impl Fn(f64) -> Option<f64>) {
        self.play_with(|player, now| {
            let speed = player.clock().speed();
            if let Some(size) = next(speed.abs()) {
                player.set_speed(size.clamp(MIN_SPEED, MAX_SPEED).copysign(speed), now);
            }
        });
    }

    fn scale_size(&mut self, factor: f32) {
        let (size, range) = match self.settings.primitive {
            Primitive::Point => (&mut self.settings.point_size_px, POINT_SIZE_RANGE_PX),
            Primitive::Surfel | Primitive::Voxel => {
                (&mut self.settings.splat_scale, SPLAT_SCALE_RANGE)
            }
        };
        *size = (*size * factor).clamp(*range.start(), *range.end());
    }

    /// Takes the keys out of egui's input and does what they ask for. Call before the panels.
    pub fn handle_keys(&mut self, ctx: &egui::Context) {
        let typing = ctx.text_edit_focused();
        let (events, modifiers, now_secs) =
            ctx.input(|input| (input.raw.events.clone(), input.modifiers, input.time));
        self.fly.note(&events, typing);
        for command in command::dispatch(ctx) {
            self.run(command);
        }
        if self.fly.is_flying() {
            self.fly.step(
                &mut self.camera,
                now_secs,
                modifiers.shift,
                modifiers.command || modifiers.ctrl,
            );
            ctx.request_repaint();
        }
    }

    /// What only the window can do, in the order in which it was asked for.
    pub fn take_requests(&mut self) -> Vec<WindowRequest> {
        std::mem::take(&mut self.requests)
    }

    /// The packet to draw, if it differs from the last one.
    pub fn next_packet(&mut self) -> Option<ScenePacket> {
        let player = self.player.as_ref()?;
        let frame = player.shown()?;
        if self.viewport.size_px.contains(&0) {
            return None;
        }
        let mut settings = self.settings;
        // Until the frame has what the primitive needs, it is shown as before.
        if !can_draw(frame, settings.primitive) {
            settings.primitive = if can_draw(frame, self.drawn_primitive) {
                self.drawn_primitive
            } else {
                Primitive::Point
            };
        }
        let origin = player.sequence().origin();
        let packet = self.scene.packet(
            frame,
            origin,
            &self.camera,
            &settings,
            self.viewport.size_px,
        );
        if self.packet.as_ref() == Some(&packet) {
            return None;
        }
        self.drawn_primitive = settings.primitive;
        self.packet = Some(packet.clone());
        self.counters.pictures += 1;
        Some(packet)
    }

    /// Forgets what was drawn: after a new GPU device everything is drawn again.
    pub fn forget_picture(&mut self) {
        self.packet = None;
    }

    /// When [`State::update`] has something to do by itself.
    pub fn next_deadline(&self) -> Option<Duration> {
        let player = self.player.as_ref().and_then(Player::next_deadline);
        [player, self.notices.next_deadline()]
            .into_iter()
            .flatten()
            .min()
    }

    /// What is open, for the title and for names of files.
    pub fn sequence_name(&self) -> Option<String> {
        let source = self.player.as_ref()?.sequence().sources().first()?;
        let folder = source.path.parent().and_then(|folder| folder.file_name());
        Some(match folder {
            Some(folder)
                if self
                    .player
                    .as_ref()
                    .is_some_and(|player| player.sequence().len() > 1) =>
            {
                folder.to_string_lossy().into_owned()
            }
            _ => source.name.clone(),
        })
    }

    fn picture_stem(&self) -> String {
        let frame = self
            .player
            .as_ref()
            .and_then(Player::shown)
            .map_or(0, |frame| frame.index + 1);
        let name = self.sequence_name().unwrap_or_else(|| "empty".to_owned());
        let name = name
            .rsplit_once('.')
            .map_or(name.as_str(), |(stem, _)| stem);
        format!("pointreel-{name}-{frame:04}")
    }

    /// Writes `image` to `path`, or to a new file in the folder of pictures.
    pub fn save_picture(&mut self, image: image::RgbaImage, path: Option<PathBuf>) {
        let place = match path {
            Some(path) => PicturePlace::File(path),
            None => PicturePlace::New {
                folder: picture_folder(),
                stem: self.picture_stem(),
            },
        };
        self.tasks.save_picture(image, place);
    }
}

/// Off, loop, ping-pong, off …
fn next_loop_mode(mode: LoopMode) -> LoopMode {
    let index = LoopMode::ALL
        .iter()
        .position(|&other| other == mode)
        .unwrap_or(0);
    LoopMode::ALL[(index + 1) % LoopMode::ALL.len()]
}

/// Loop mode and speed are choices of the person, not of the sequence.
fn player_settings_kept(before: &Player, player: Option<&mut Player>, now: Duration) {
    if let Some(player) = player {
        player.set_loop_mode(before.clock().loop_mode(), now);
        player.set_speed(before.clock().speed(), now);
    }
}

fn with_extension(path: PathBuf, extension: &str) -> PathBuf {
    if path.extension().is_some() {
        path
    } else {
        path.with_extension(extension)
    }
}

/// The person's folder of pictures if the system has one, else where the program was started.
fn picture_folder() -> PathBuf {
    directories::UserDirs::new()
        .and_then(|folders| folders.picture_dir().map(PathBuf::from))
        .filter(|folder| folder.is_dir())
        .or_else(|| std::env::current_dir().ok())
        .unwrap_or_default()
}
