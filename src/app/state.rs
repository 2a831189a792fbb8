//! Everything the window shows and what a person can change, without a window: tests drive it with a clock of their
//! own.

mod actions;
mod companion;
mod first_look;
mod inspecting;
mod parts;
mod reading;

pub(super) use actions::{POINT_SIZE_RANGE_PX, SPLAT_SCALE_RANGE, picture_folder};
use first_look::Looked;
pub(super) use first_look::{Chosen, LookedAtMore};
pub use parts::{
    Change, Counters, GraphicsInfo, OpenPanels, StateOptions, Viewport, WindowRequest,
};
pub(super) use reading::PictureStage;

use super::benchmark::Benchmark;
use super::beside::Beside;
use super::camera_path::PathEditor;
use super::comparison::{Comparison, PicturePair, Side};
use super::drawing::{Drawing, DrawnFrame};
use super::export::Export;
use super::fly::Fly;
use super::grip::Grip;
use super::history::History;
use super::inspection::Inspection;
use super::meter::Redraw;
use super::motion::{Glide, Turntable};
use super::notices::Notices;
use super::palette::Palette;
use super::panels::QualityLimits;
use super::preferences::Preferences;
use super::present_choice::PresentChoice;
use super::presets::Presets;
use super::progress::{WorkKind, Works};
use super::recent::{Recent, entry_name};
use super::tasks::{Tasks, Wake};
use super::temporal::{Made, Temporal};
use super::thumbnails::Thumbnails;
use super::timeline::Timeline;
use super::trails::Trails;
use crate::bench::{Quality, QualityKey};
use crate::math::Aabb;
use crate::playback::Player;
use crate::render::RenderStats;
use crate::scene::{Camera, RendererChoice, ScenePacket, SceneStats, Settings};
use crate::sequence::{OpenOptions, Paint, PreparedFrame, Sequence, watch};
use crate::timeline::Clock;
use glam::DVec3;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

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
    /// Another way to draw beside the one of the settings.
    pub comparison: Option<Comparison>,
    /// Long work with a bar, but for the benchmark.
    pub works: Works,
    /// Another sequence beside the open one; never together with `comparison`.
    pub beside: Option<Beside>,
    /// The benchmark window's content.
    pub benchmark: Benchmark,
    /// What is known of the open sequence's ways to draw, from fast to exact.
    pub quality: Option<Quality>,
    /// What a person would spend at most.
    pub quality_limits: QualityLimits,
    /// What was opened lately.
    pub recent: Recent,
    /// Settings under names.
    pub presets: Presets,
    /// The name of the preset that is being saved.
    pub(super) preset_name: Option<String>,
    /// Undo and redo of settings and camera path.
    pub(super) history: History,
    /// Commands by their names, while they are looked for.
    pub palette: Option<Palette>,
    /// Markers and curve of the open sequence.
    pub timeline: Timeline,
    /// The picture's place.
    pub viewport: Viewport,
    /// What is known of the graphics card.
    pub graphics: GraphicsInfo,
    /// Keys that fly.
    pub fly: Fly,
    /// The camera on a turntable.
    pub turntable: Turntable,
    /// The camera path that is being made.
    pub path: PathEditor,
    /// What a person would export.
    pub export: Export,
    /// What other poses add to the picture.
    pub temporal: Temporal,
    /// Small pictures of the frames.
    pub thumbnails: Thumbnails,
    /// Whether the picture has a scale bar.
    pub shows_scale_bar: bool,
    /// Whether the window is light or dark.
    pub theme: egui::ThemePreference,
    /// Who paints the window.
    pub present: PresentChoice,
    /// The ways of points through time.
    pub trails: Trails,
    /// What was clicked on.
    pub inspection: Inspection,
    /// Work done.
    pub counters: Counters,
    /// True while the window fills the screen.
    pub full_screen: bool,
    /// The picture in the hand.
    pub(super) grip: Option<Grip>,
    /// True between the first and the last move of the playhead by the mouse.
    pub(super) scrubbing: Scrubbing,
    pub(super) tasks: Tasks,
    options: StateOptions,
    now: Duration,
    glide: Option<Glide>,
    /// What is made of the open sequence.
    looked: Looked,
    requests: Vec<WindowRequest>,
    drawing: Drawing,
    /// Who was chosen to draw when the graphics card's device was lost: the processor draws until that is chosen anew.
    without_gpu: Option<RendererChoice>,
    /// What the drawn frame was painted with when this was last looked at: the panels say it.
    painted_with: Option<Paint>,
    /// Where [`State::quality`] is kept; known once sequence and adapter are.
    quality_key: Option<QualityKey>,
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
        let nothing = Aabb::EMPTY;
        Self {
            player: None,
            camera: Camera::framing(&nothing, DVec3::ZERO, options.up.unwrap_or_default()),
            settings: options.preferences.settings,
            notices: Notices::default(),
            panels: options.preferences.panels,
            comparison: None,
            works: Works::default(),
            beside: None,
            benchmark: Benchmark::default(),
            quality: None,
            quality_limits: QualityLimits::default(),
            recent: options.recent.clone(),
            presets: options.presets.clone(),
            preset_name: None,
            history: History::default(),
            palette: None,
            timeline: Timeline::default(),
            viewport: Viewport::default(),
            graphics: GraphicsInfo::default(),
            fly: Fly::default(),
            turntable: Turntable::default(),
            path: PathEditor::default(),
            export: Export::default(),
            temporal: Temporal::default(),
            thumbnails: Thumbnails::new(options.preferences.thumbnails),
            shows_scale_bar: options.preferences.scale_bar,
            theme: options.preferences.theme,
            present: options.preferences.present,
            trails: Trails::default(),
            inspection: Inspection::default(),
            counters: Counters::default(),
            full_screen: false,
            grip: None,
            scrubbing: Scrubbing::default(),
            tasks: Tasks::new(Arc::clone(&options.wake)),
            now: Duration::ZERO,
            glide: None,
            looked: Looked::default(),
            requests: Vec::new(),
            drawing: Drawing::default(),
            without_gpu: None,
            painted_with: None,
            quality_key: None,
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
        self.drawing.stats()
    }

    /// What is kept between runs; the window adds its size.
    pub fn preferences(&self) -> Preferences {
        let clock = self.player.as_ref().map(Player::clock);
        Preferences {
            // The primitive is chosen for one sequence, and kept with it.
            settings: Settings {
                primitive: self.options.preferences.settings.primitive,
                ..self.settings
            },
            present: self.present,
            loop_mode: clock.map_or(self.options.preferences.loop_mode, Clock::loop_mode),
            // A sequence that was left while it played backward is not what the next one is to begin with.
            speed: clock
                .map_or(self.options.preferences.speed, Clock::speed)
                .abs(),
            panels: OpenPanels {
                settings: self.panels.settings,
                statistics: self.panels.statistics,
                legend: self.panels.legend,
                ..OpenPanels::default()
            },
            thumbnails: self.thumbnails.is_on,
            scale_bar: self.shows_scale_bar,
            theme: self.theme,
            window_size: None,
        }
    }

    /// Shows `sequence` in place of what was open. Settings, loop mode and speed stay: they are choices of the person,
    /// not of the sequence. What is beside it stays there.
    pub fn open(&mut self, sequence: Arc<Sequence>) {
        let loader_options = self.loader_options(self.budget_bytes());
        let mut player = match Player::new(sequence, loader_options, !self.options.paused) {
            Ok(player) => player,
            Err(error) => return self.notices.error(error.to_string()),
        };
        if let Err(error) = watch(player.sequence(), self.wake()) {
            self.notices.error(error.to_string());
        }
        for note in player.sequence().source().notes() {
            self.notices.warn(note.clone());
        }
        if self.options.follow || player.sequence().source().is_live() {
            player.follow_newest(true, self.now);
        }
        let (loop_mode, speed) = match &self.player {
            Some(before) => (before.clock().loop_mode(), before.clock().speed()),
            None => (
                self.options.preferences.loop_mode,
                self.options.preferences.speed,
            ),
        };
        player.set_loop_mode(loop_mode, self.now);
        player.set_speed(speed, self.now);
        // The window may take a while to open.
        player.begin(&self.settings);
        if let Some(before) = self.player.replace(player) {
            self.leave(before);
        }
        self.read_timeline(self.options.timelines.clone().as_ref());
        self.compare_again();
    }

    /// Shows `sequence` as a window does that has just been opened with it, playing or not.
    pub(super) fn open_fresh(&mut self, sequence: Arc<Sequence>, plays: bool) {
        self.options.paused = !plays;
        self.open(sequence);
    }

    /// Whether the picture is a coarse one because the camera moved.
    pub(super) fn is_picture_coarse(&self) -> bool {
        self.drawing.next_deadline().is_some()
    }

    /// Finds the frames of `inputs` on a thread and opens them.
    pub fn open_paths(&mut self, inputs: Vec<PathBuf>) {
        self.open_with_topic(inputs, None);
    }

    /// Opens the open recording again, with the point clouds of another topic.
    pub fn open_topic(&mut self, topic: &str) {
        if let Some(player) = &self.player {
            let inputs = player.sequence().source().inputs().to_vec();
            self.open_with_topic(inputs, Some(topic.into()));
        }
    }

    /// A topic is a choice for one recording: what is opened next has others.
    fn open_with_topic(&mut self, inputs: Vec<PathBuf>, topic: Option<Arc<str>>) {
        let open = self.options.open.clone();
        self.find(inputs, OpenOptions { topic, ..open }, Side::A);
    }

    /// Finds the frames of `inputs` on a thread.
    fn find(&mut self, inputs: Vec<PathBuf>, open: OpenOptions, side: Side) {
        if inputs.is_empty() {
            return;
        }
        // What was asked for last is what is wanted.
        self.works.cancel(WorkKind::Open);
        let name = format!("Opening {}", entry_name(&inputs));
        let progress = self.works.begin(WorkKind::Open, name, self.now);
        self.tasks.find(inputs, open, side, progress);
    }

    /// Sets the memory for prepared frames, now and for what is opened later.
    pub fn set_budget_bytes(&mut self, budget_bytes: usize) {
        self.options.budget_bytes = Some(budget_bytes);
        self.share_budget();
    }

    /// Moves on to `now`: takes in what threads finished, moves the playhead. Says what can be seen to change.
    pub fn update(&mut self, now: Duration) -> Change {
        let before = std::mem::replace(&mut self.now, now);
        let outcomes = self.tasks.take();
        let mut visible = !outcomes.is_empty();
        for outcome in outcomes {
            self.take_in(outcome);
        }
        visible |= self.follow_readings();
        visible |= self.works.look(before, now);
        if let Benchmark::Running(running) = &mut self.benchmark {
            running.work.look(now);
        }
        visible |= self.notices.expire(now);
        visible |= self.look_for_quality();
        visible |= self.move_camera_on();
        if self.pictures_mut().is_some_and(|pair| pair.is_due(now)) {
            self.requests.push(WindowRequest::Compare);
            visible = true;
        }
        self.keep_primitive();
        let settings = self.drawn_settings();
        let Some(player) = &mut self.player else {
            return Change::of_panels(visible);
        };
        let (change, of_b) = match &mut self.beside {
            Some(beside) => {
                let [of_a, of_b] = beside.update(player, now, &settings);
                (of_a, Some(of_b))
            }
            None => (player.update(now, &settings), None),
        };
        let is_another_frame = change.visible;
        visible |= change.beyond_frame;
        if let Some(failure) = change.new_failure {
            let place = failure.index() + 1;
            let count = player.sequence().len();
            self.notices
                .error(format!("Frame {place} of {count} is left out. {failure}"));
        }
        for text in change
            .other_attributes
            .into_iter()
            .chain(change.new_warnings)
        {
            self.notices.warn(text);
        }
        visible |= self.temporal.follow(player, &settings, &self.tasks, now);
        if let Some(frame) = player.shown() {
            self.inspection
                .follow(Side::A, frame, player.sequence().origin());
            visible |= self.trails.follow(player, &self.inspection, &self.tasks);
            if self.looked.is_empty() {
                let frame = Arc::clone(frame);
                self.look_first(&frame);
                visible = true;
            }
        }
        let paint = self.drawn_frame().map(|frame| *frame.paint());
        if self.painted_with != paint {
            self.painted_with = paint;
            visible = true;
        }
        self.follow_thumbnails();
        if let Some(of_b) = of_b {
            visible |= self.follow_beside(of_b);
        }
        let of_frame = match is_another_frame {
            true if self.panels_show_frame() => Change::Panels,
            true => Change::Frame,
            false if self.is_picture_due() => Change::Picture,
            false => Change::Nothing,
        };
        Change::of_panels(visible).max(of_frame)
    }

    /// The frame that is drawn: the shown one, or what other poses made of it.
    pub(super) fn drawn_frame(&self) -> Option<&Arc<PreparedFrame>> {
        let made = self.temporal.shown().map(Made::frame);
        made.or_else(|| self.player.as_ref()?.shown())
    }

    /// Whether a picture that is coarse because the camera moved is to be drawn as a whole.
    fn is_picture_due(&self) -> bool {
        let of_b = self.beside.as_ref().map(|beside| &beside.drawing);
        let drawings = [Some(&self.drawing), of_b];
        let mut deadlines = drawings
            .into_iter()
            .flatten()
            .filter_map(Drawing::next_deadline);
        deadlines.any(|deadline| deadline <= self.now)
    }

    /// Whether panels show more of the playing frame than its place on the timeline, so that they have to keep step
    /// with it.
    fn panels_show_frame(&self) -> bool {
        let is_playing = self.player.as_ref().is_some_and(Player::is_playing);
        !is_playing
            || self.pictures().is_some()
            || self.inspection.picked().next().is_some()
            || self.trails.are_shown()
            || self.temporal.change.is_on
            || self.temporal.onion.is_on
    }

    /// Begins the next small picture if there is time for it.
    pub(super) fn follow_thumbnails(&mut self) {
        // The first picture goes first.
        let look = self.looked.look().filter(|_| self.has_looked());
        let Some((player, look)) = self.player.as_ref().zip(look) else {
            return;
        };
        let settings = self.settings.resolved(&look);
        let key = (self.camera.up, settings.colors, settings.color_hints);
        let is_measured = matches!(self.benchmark, Benchmark::Running(_));
        self.thumbnails
            .follow(player, &look, key, is_measured, &self.tasks, self.now);
    }

    /// Takes in at once what the panels have changed about other poses.
    pub(super) fn follow_poses(&mut self) {
        let settings = self.drawn_settings();
        if let Some(player) = &self.player {
            self.temporal
                .follow(player, &settings, &self.tasks, self.now);
            self.trails.follow(player, &self.inspection, &self.tasks);
        }
    }

    /// True if something that is not the picture may have changed: marks on the timeline, progress.
    pub fn has_news(&self) -> bool {
        matches!(self.benchmark, Benchmark::Running(_))
            || self.works.list().iter().any(|work| work.is_long(self.now))
            || self.trails.progress().is_some()
            || self.player.as_ref().is_some_and(Player::runs_are_old)
    }

    /// What only the window can do, in the order in which it was asked for.
    pub fn take_requests(&mut self) -> Vec<WindowRequest> {
        std::mem::take(&mut self.requests)
    }

    /// The packet to draw, if it differs from the last one.
    pub fn next_packet(&mut self) -> Option<ScenePacket> {
        let player = self.player.as_ref()?;
        let pose = player.shown()?;
        let made = self.temporal.shown();
        let frame = made.map_or(pose, Made::frame);
        if self.viewport.size_px.contains(&0) {
            return None;
        }
        let origin = player.sequence().origin();
        let drawn = DrawnFrame {
            frame: Arc::clone(frame),
            pose: Arc::clone(made.map_or(pose, Made::pose)),
            origin,
        };
        let mut settings = self.drawn_settings();
        if self.without_gpu == Some(settings.renderer) {
            settings.renderer = RendererChoice::Cpu;
        } else {
            // Somebody has chosen anew.
            self.without_gpu = None;
        }
        let size_px = self.viewport.size_px;
        let packet = self
            .drawing
            .next_packet(drawn, &self.camera, &settings, size_px, self.now)?;
        self.counters.pictures += 1;
        self.note_picture();
        Some(packet)
    }

    /// Takes notice of how long a redraw took, whose picture is on the screen now.
    pub fn note_redraw(&mut self, redraw: Redraw, frame_ms: f64, render: RenderStats) {
        self.graphics.redraw = redraw;
        self.graphics.frame_ms = frame_ms;
        self.graphics.render = render;
        let draw_ms = self.graphics.picture_ms();
        let settings = self.drawn_settings();
        let Some(player) = &self.player else { return };
        let noted = self.drawing.note_draw_ms(draw_ms);
        // What stands for a frame that is on its way says nothing about its picture, and levels of it would be in its
        // way.
        let is_partial = player.is_partial();
        if let Some(points) = noted.filter(|_| !is_partial) {
            player.note_picture_ms(points, draw_ms);
        }
        let is_at_rest = !player.is_playing() && !is_partial;
        let (tasks, now) = (&self.tasks, self.now);
        self.drawing.prepare(&settings, is_at_rest, tasks, now);
        if let Some(beside) = &mut self.beside {
            if let Some(points) = beside.drawing.note_draw_ms(draw_ms) {
                beside.companion.note_picture_ms(points, draw_ms);
            }
            beside.drawing.prepare(&settings, is_at_rest, tasks, now);
        }
    }

    /// The packet of the other side of a comparison, or of the other sequence, if it differs from the last one. To be
    /// asked for after [`State::next_packet`].
    pub fn next_other_packet(&mut self) -> Option<ScenePacket> {
        if self.beside.is_some() {
            return self.next_packet_beside();
        }
        let look = self.looked.look();
        let comparison = self.comparison.as_mut()?;
        let player = self.player.as_ref()?;
        let frame = player.shown()?;
        if self.viewport.size_px.contains(&0) {
            return None;
        }
        let origin = player.sequence().origin();
        let size_px = self.viewport.size_px;
        comparison.other.clip = self.settings.clip;
        let packet =
            comparison.next_packet(frame, origin, &self.camera, look.as_deref(), size_px)?;
        comparison.pictures.note_change(self.now);
        Some(packet)
    }

    /// Forgets what was drawn: after a new GPU device everything is drawn again.
    pub fn forget_picture(&mut self) {
        self.drawing.forget_picture();
        self.thumbnails.forget_textures();
        if let Some(comparison) = &mut self.comparison {
            comparison.forget_picture();
        }
        if let Some(beside) = &mut self.beside {
            beside.drawing.forget_picture();
        }
    }

    /// The two pictures beside each other, if there are two.
    pub fn pictures(&self) -> Option<&PicturePair> {
        let beside = self.beside.as_ref().map(|beside| &beside.pictures);
        let comparison = self.comparison.as_ref();
        beside.or(comparison.map(|comparison| &comparison.pictures))
    }

    pub(super) fn pictures_mut(&mut self) -> Option<&mut PicturePair> {
        let beside = self.beside.as_mut().map(|beside| &mut beside.pictures);
        let comparison = self.comparison.as_mut();
        beside.or(comparison.map(|comparison| &mut comparison.pictures))
    }

    /// When [`State::update`] has something to do by itself.
    pub fn next_deadline(&self) -> Option<Duration> {
        let player = self.player.as_ref().and_then(Player::next_deadline);
        let pictures = self.pictures().and_then(PicturePair::next_deadline);
        let camera = self.camera_moves().then_some(self.now);
        let held = self.temporal.next_deadline();
        [
            player,
            self.notices.next_deadline(),
            self.works.next_deadline(self.now),
            self.next_look_at_readings(),
            pictures,
            camera,
            held,
            self.drawing.next_deadline(),
            self.beside
                .as_ref()
                .and_then(|beside| beside.drawing.next_deadline()),
        ]
        .into_iter()
        .flatten()
        .min()
    }
}
