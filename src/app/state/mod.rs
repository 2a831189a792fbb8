//! Everything the window shows and what a person can change, without a window: tests drive it with a clock of their
//! own.

mod actions;
mod assumptions;
mod camera_path;
mod clipping;
mod companion;
mod connection;
mod depth_filters;
mod dialogs;
mod document;
mod export;
mod failed_opening;
mod files;
mod first_look;
mod inspecting;
mod intake;
mod keeper;
mod keeping;
mod labels;
mod live;
mod main_picture;
mod measured_way;
mod measuring;
mod opened;
mod opening;
mod options;
mod outcome;
mod parts;
mod pictures;
mod proven;
mod reading;
mod save;
mod session;
mod steering;
mod timeline;

pub use dialogs::{DialogAnswer, DialogKind};
pub use failed_opening::FailedOpening;
pub use opened::{SavedSession, SessionQuestion};
pub use options::{GivenStyle, StateOptions};
pub use outcome::{FoundSequence, Outcome};
pub use parts::{Counters, GraphicsInfo, Viewport, VisibleChange, WindowRequest};
pub(in crate::app) use reading::PictureStage;

use connection::Connection;
use dialogs::Dialogs;
use failed_opening::Unproven;
use keeper::Keeper;
use main_picture::MainPicture;
use opened::Opened;

use crate::app::appearance::Appearance;
use crate::app::features::benchmark::Benchmark;
use crate::app::features::beside::Beside;
use crate::app::features::camera_path::PathEditor;
use crate::app::features::clipping::Clipping;
use crate::app::features::comparison::{Comparison, PicturePair};
use crate::app::features::export::Export;
use crate::app::features::inspection::Inspection;
use crate::app::features::labels::Labels;
use crate::app::features::palette::Palette;
use crate::app::features::photos::Photos;
use crate::app::features::quality::{MeasuredQuality, MeasuredWay};
use crate::app::features::save::{Estimates, Save};
use crate::app::features::temporal::Temporal;
use crate::app::features::thumbnails::Thumbnails;
use crate::app::features::timeline::Timeline;
use crate::app::features::trails::Trails;
use crate::app::first_look::SequenceLook;
use crate::app::motion::CameraMotion;
use crate::app::notices::Notices;
use crate::app::open_panels::OpenPanels;
use crate::app::preferences::Preferences;
use crate::app::presets::Presets;
use crate::app::reading_choices::ReadingChoices;
use crate::app::recent::Recent;
use crate::app::side::Side;
use crate::app::work::tasks::{Tasks, Wake};
use crate::app::work::works::Works;
use crate::cloud::LengthUnit;
use crate::document::History;
use crate::math::Aabb;
use crate::playback::{Player, PlayerChange};
use crate::scene::{Camera, SceneStats, ScreenStats, Settings, Style};
use crate::timeline::Clock;
use glam::DVec3;
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
    pub style: Settings,
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
    pub quality: MeasuredQuality,
    /// What was opened lately.
    pub recent: Recent,
    /// Options of reading that were chosen for inputs.
    pub reading_choices: ReadingChoices,
    /// What was to be opened last, and cannot be shown.
    pub failed: Option<FailedOpening>,
    /// The session that is not opened before somebody allows what it opens.
    pub session_question: Option<SessionQuestion>,
    /// Settings under names.
    pub presets: Presets,
    /// The name of the preset that is being saved.
    pub(in crate::app) preset_name: Option<String>,
    /// Free text of the document.
    pub notes: String,
    /// What can be undone of the document.
    pub(in crate::app) history: History,
    /// Commands by their names, while they are looked for.
    pub palette: Option<Palette>,
    /// Markers and curve of the open sequence.
    pub timeline: Timeline,
    /// What moves the camera.
    pub motion: CameraMotion,
    /// How the window looks.
    pub appearance: Appearance,
    /// The picture's place.
    pub viewport: Viewport,
    /// What is known of the graphics card.
    pub graphics: GraphicsInfo,
    /// The camera path that is being made.
    pub path: PathEditor,
    /// What a person would export.
    pub export: Export,
    /// As what a person would save the sequence.
    pub save: Save,
    /// What that comes to.
    pub estimates: Estimates,
    /// What other poses add to the picture.
    pub temporal: Temporal,
    /// Photographs of what is shown.
    pub photos: Photos,
    /// Small pictures of the frames.
    pub thumbnails: Thumbnails,
    /// The ways of points through time.
    pub trails: Trails,
    /// What is known of what is clipped.
    pub clipping: Clipping,
    /// What was clicked on.
    pub inspection: Inspection,
    /// Texts at points.
    pub labels: Labels,
    /// Work done.
    pub counters: Counters,
    pub(in crate::app) tasks: Tasks<Outcome>,
    dialogs: Dialogs,
    options: StateOptions,
    now: Duration,
    /// What is made of the open sequence.
    looked: SequenceLook,
    requests: Vec<WindowRequest>,
    /// How the open sequence was opened.
    opened: Opened,
    /// How its document is kept.
    keeper: Keeper,
    /// See [`State::prove`].
    unproven: Unproven,
    /// The way to draw that was measured and is used for the open sequence.
    measured_way: Option<MeasuredWay>,
    /// The picture of the open sequence.
    main: MainPicture,
    /// That of the open sequence, of live streams.
    connection: Connection,
}

impl State {
    /// Nothing open.
    pub fn new(options: StateOptions) -> Self {
        let nothing = Aabb::EMPTY;
        Self {
            player: None,
            camera: Camera::framing(&nothing, DVec3::ZERO, options.up.unwrap_or_default()),
            style: options.given.over(options.preferences.settings),
            notices: Notices::default(),
            panels: options.preferences.panels.into(),
            comparison: None,
            works: Works::default(),
            beside: None,
            benchmark: Benchmark::default(),
            quality: MeasuredQuality::default(),
            recent: options.recent.clone(),
            reading_choices: options.reading_choices.clone(),
            failed: None,
            session_question: None,
            opened: Opened::default(),
            keeper: Keeper::default(),
            unproven: Unproven::default(),
            measured_way: None,
            presets: options.presets.clone(),
            preset_name: None,
            notes: String::new(),
            history: History::default(),
            palette: None,
            timeline: Timeline::default(),
            motion: CameraMotion::default(),
            appearance: Appearance::of(&options.preferences),
            viewport: Viewport::default(),
            graphics: GraphicsInfo::default(),
            path: PathEditor::default(),
            export: Export::default(),
            save: Save::default(),
            estimates: Estimates::default(),
            temporal: Temporal::default(),
            photos: Photos::default(),
            thumbnails: Thumbnails::new(options.preferences.thumbnails),
            trails: Trails::default(),
            clipping: Clipping::default(),
            inspection: Inspection::default(),
            labels: Labels::default(),
            counters: Counters::default(),
            dialogs: Dialogs::default(),
            tasks: Tasks::new(Arc::clone(&options.wake)),
            now: Duration::ZERO,
            looked: SequenceLook::default(),
            requests: Vec::new(),
            main: MainPicture::default(),
            connection: Connection::default(),
            options,
        }
    }

    /// The time of the last [`State::update`].
    pub fn now(&self) -> Duration {
        self.now
    }

    /// What [`StateOptions`] said about waking.
    pub(in crate::app) fn wake(&self) -> Wake {
        Arc::clone(&self.options.wake)
    }

    /// Counters of the traversal.
    pub fn scene_stats(&self) -> SceneStats {
        self.main.drawing.stats()
    }

    /// What was done for normals of the screen, if the last picture has such.
    pub fn screen_stats(&self) -> Option<ScreenStats> {
        self.main.drawing.screen_stats().or(self.graphics.render.screen)
    }

    /// The unit of lengths in the open sequence, where its files say it.
    pub(in crate::app) fn length_unit(&self) -> Option<LengthUnit> {
        self.player.as_ref()?.shown()?.frame.unit()
    }

    /// What is kept between runs; the window adds its size.
    pub fn preferences(&self) -> Preferences {
        let clock = self.player.as_ref().map(Player::clock);
        Preferences {
            settings: self.new_style(),
            present: self.appearance.present,
            loop_mode: clock.map_or(self.options.preferences.loop_mode, Clock::loop_mode),
            // A sequence that was left while it played backward is not what the next one is to begin with.
            speed: clock.map_or(self.options.preferences.speed, Clock::speed).abs(),
            panels: self.panels.remembered(),
            thumbnails: self.thumbnails.is_on,
            scale_bar: self.appearance.shows_scale_bar,
            advanced: self.appearance.shows_advanced,
            theme: self.appearance.theme,
            window_size: None,
            benchmark_place: self.appearance.benchmark_place.map(|place| {
                let (min, max) = (place.min.round(), place.max.round());
                [min.x, min.y, max.x, max.y]
            }),
        }
    }

    /// Moves on to `now`: takes in what threads finished, moves the playhead. Says what can be seen to change.
    pub fn update(&mut self, now: Duration) -> VisibleChange {
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
        visible |= self.follow_connection();
        visible |= self.look_for_quality();
        self.follow_save();
        visible |= self.move_camera_on();
        if self.pictures_mut().is_some_and(|pair| pair.is_due(now)) {
            self.requests.push(WindowRequest::Compare);
            visible = true;
        }
        let style = self.drawn_style();
        let Some(player) = &mut self.player else {
            return VisibleChange::of_panels(visible);
        };
        let (change, of_b) = if let Some(beside) = &mut self.beside {
            let [of_a, of_b] = beside.update(player, now, &style);
            (of_a, Some(of_b))
        } else {
            let sequence = Arc::clone(player.sequence());
            let (photos, source) = (&self.photos, &**sequence.source());
            let prepare = |clock: &Clock, _: bool| photos.are_there(source, clock.frame(), &style);
            (player.update_beside(now, &style, prepare), None)
        };
        let is_another_frame = change.visible;
        visible |= change.beyond_frame;
        let count = player.sequence().len();
        if self.close_if_broken() {
            return VisibleChange::Panels;
        }
        self.note_proven();
        self.tell_of_frames(change, count);
        visible |= self.follow_shown(&style);
        self.tell_view();
        self.follow_thumbnails();
        if let Some(of_b) = of_b {
            visible |= self.follow_beside(of_b);
        }
        let of_frame = match is_another_frame {
            true if self.panels_show_frame() => VisibleChange::Panels,
            true => VisibleChange::Frame,
            false if self.is_picture_due() => VisibleChange::Picture,
            false => VisibleChange::Nothing,
        };
        VisibleChange::of_panels(visible).max(of_frame)
    }

    /// Says what is new about frames that were read, of `count`.
    fn tell_of_frames(&mut self, change: PlayerChange, count: usize) {
        for &frame in &change.reread {
            self.thumbnails.forget_frame(frame);
            self.notices
                .dismiss_begun(&format!("Frame {} of ", frame + 1), " is left out.");
            self.looked.is_outdated |= self.looked.first.is_some_and(|(index, _)| index == frame);
        }
        if let Some(failure) = change.new_failure {
            let place = failure.index() + 1;
            self.notices
                .error(format!("Frame {place} of {count} is left out. {failure}"));
        }
        let texts = change.other_attributes.into_iter();
        for text in texts.chain(change.new_warnings) {
            self.notices.warn(text);
        }
    }

    /// Has what features make of the shown frame made. True if something can be seen to change.
    fn follow_shown(&mut self, style: &Style) -> bool {
        let Some(player) = &self.player else {
            return false;
        };
        let mut visible = self.temporal.follow(player, style, &self.tasks, self.now);
        self.photos.follow(player, style, &self.tasks);
        if let Some(frame) = player.shown() {
            self.inspection.follow(Side::A, frame, player.sequence().origin());
            visible |= self.trails.follow(player, &self.inspection, &self.tasks);
            if self.looked.is_empty() || self.looked.is_mended_by(frame.index, frame.id) {
                let frame = Arc::clone(frame);
                self.look_first(&frame);
                visible = true;
            }
        }
        self.follow_clip();
        let paint = self.drawn_frame().map(|frame| *frame.paint());
        visible | (std::mem::replace(&mut self.main.painted_with, paint) != paint)
    }

    /// Whether panels show more of the playing frame than its place on the timeline, so that they have to keep step
    /// with it.
    fn panels_show_frame(&self) -> bool {
        let is_playing = self.player.as_ref().is_some_and(Player::is_playing);
        !is_playing
            || self.pictures().is_some()
            || self.inspection.picked().next().is_some()
            || self.trails.are_shown()
            || self.labels.are_shown()
            || self.temporal.change.is_on
            || self.temporal.onion.is_on
    }

    /// Begins the next small picture if there is time for it.
    pub(in crate::app) fn follow_thumbnails(&mut self) {
        // The first picture goes first.
        let look = self.looked.look().filter(|_| self.has_looked());
        let Some((player, look)) = self.player.as_ref().zip(look) else {
            return;
        };
        let style = self.style.resolved(&look);
        let hints = style.of_sequence.color_hints;
        let key = (self.camera.up, style.colors, hints);
        let is_measured = matches!(self.benchmark, Benchmark::Running(_));
        self.thumbnails
            .follow(player, &look, key, is_measured, &self.tasks, self.now);
    }

    /// Takes in at once what the panels have changed about other poses.
    pub(in crate::app) fn follow_poses(&mut self) {
        let style = self.drawn_style();
        if let Some(player) = &self.player {
            self.temporal.follow(player, &style, &self.tasks, self.now);
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
            self.estimates.next_deadline(),
            self.main.drawing.next_deadline(),
            self.beside.as_ref().and_then(|beside| beside.drawing.next_deadline()),
        ]
        .into_iter()
        .flatten()
        .min()
    }
}
