//! Everything that the window shows and a user can change, without a window: tests drive it with their own clock.

mod actions;
mod connection;
mod dialogs;
pub(in crate::app) mod document;
mod failed_opening;
mod files;
mod first_look;
mod intake;
mod keeper;
mod keeping;
mod live;
mod main_picture;
mod measured_way;
mod moving_camera;
mod opened;
mod opening;
mod opening_facts;
mod options;
mod outcome;
mod parts;
mod pictures;
mod proven;
mod reading;
mod session;
mod shared;
mod stored;

pub(in crate::app) use dialogs::Dialog;
pub use failed_opening::FailedOpening;
pub(in crate::app) use files::folder_of;
pub(in crate::app) use measured_way::MeasuredWay;
pub use opened::{SavedSession, SessionQuestion};
pub use opening_facts::OpeningFacts;
pub use options::{GivenStyle, StateOptions};
pub use outcome::FoundSequence;
pub(in crate::app) use outcome::NotFound;
pub use parts::{Counters, GraphicsInfo, Viewport, VisibleChange, WindowRequest};
pub(in crate::app) use reading::PictureStage;
pub use shared::Shared;
pub use stored::Stored;

use main_picture::MainPicture;

use crate::app::appearance::Appearance;
use crate::app::features::Features;
use crate::app::motion::CameraMotion;
use crate::app::notices::Notices;
use crate::app::open_panels::OpenPanels;
use crate::app::preferences::Preferences;
use crate::app::work::tasks::Wake;
use crate::cloud::LengthUnit;
use crate::document::{Document, History};
use crate::math::Aabb;
use crate::messages::grouped;
use crate::playback::{Player, PlayerChange};
use crate::scene::{Camera, SceneStats, ScreenStats, Settings};
use crate::timeline::Clock;
use glam::DVec3;
use std::sync::Arc;
use std::time::Duration;

/// The state of the window.
#[derive(Debug)]
pub struct State {
    /// The open sequence.
    pub player: Option<Player>,
    /// Facts about the opening of the sequence, and its known properties.
    pub opening: OpeningFacts,
    /// Camera of the view; retained across frames.
    pub camera: Camera,
    /// Source of camera motion.
    pub motion: CameraMotion,
    /// Render settings for requested images.
    pub style: Settings,
    /// Document: the open inputs and everything made around them. Notes, up axis and fields of other versions are
    /// stored only here; the working data of player, camera and features is synchronised once per pass.
    pub document: Document,
    /// Undo and redo of the document.
    pub(in crate::app) history: History,
    /// User features other than looking and playing.
    pub features: Features,
    /// Messages.
    pub notices: Notices,
    /// Open panels.
    pub panels: OpenPanels,
    /// Appearance of the window.
    pub appearance: Appearance,
    /// The rectangle of the image.
    pub viewport: Viewport,
    /// Known facts about the GPU.
    pub graphics: GraphicsInfo,
    /// The image of the open sequence.
    pub(in crate::app) main: MainPicture,
    /// Lists that persist between runs.
    pub stored: Stored,
    /// Clock, tasks, dialogs and requests.
    pub shared: Shared,
}

impl State {
    /// Nothing open.
    pub fn new(options: StateOptions) -> Self {
        let nothing = Aabb::EMPTY;
        let mut features = Features::default();
        features.thumbnails.is_on = options.preferences.thumbnails;
        Self {
            player: None,
            opening: OpeningFacts::default(),
            camera: Camera::framing(&nothing, DVec3::ZERO, options.up.unwrap_or_default()),
            motion: CameraMotion::default(),
            style: options.given.over(options.preferences.settings),
            document: Document::default(),
            history: History::default(),
            features,
            notices: Notices::default(),
            panels: options.preferences.panels.into(),
            appearance: Appearance::of(&options.preferences),
            viewport: Viewport::default(),
            graphics: GraphicsInfo::default(),
            main: MainPicture::default(),
            stored: Stored {
                recent: options.recent.clone(),
                reading_choices: options.reading_choices.clone(),
                presets: options.presets.clone(),
                preset_name: None,
            },
            shared: Shared::new(options),
        }
    }

    /// The time of the last [`State::update`].
    pub fn now(&self) -> Duration {
        self.shared.now
    }

    /// Returns the wake callback given in [`StateOptions`].
    pub(in crate::app) fn wake(&self) -> Wake {
        Arc::clone(&self.shared.options.wake)
    }

    /// Counters of the traversal.
    pub fn scene_stats(&self) -> SceneStats {
        self.main.drawing.stats()
    }

    /// Returns the statistics of the screen-space normals pass, if the last image has such normals.
    pub fn screen_stats(&self) -> Option<ScreenStats> {
        self.main.drawing.screen_stats().or(self.graphics.render.screen)
    }

    /// The unit of lengths in the open sequence, where its files say it.
    pub(in crate::app) fn length_unit(&self) -> Option<LengthUnit> {
        self.player.as_ref()?.shown()?.frame.unit()
    }

    /// Returns the preferences that persist between runs; the window adds its size.
    pub fn preferences(&self) -> Preferences {
        let clock = self.player.as_ref().map(Player::clock);
        Preferences {
            settings: self.new_style(),
            present: self.appearance.present,
            loop_mode: clock.map_or(self.shared.options.preferences.loop_mode, Clock::loop_mode),
            // If a sequence was closed while playing backward, the next one does not start that way.
            speed: clock.map_or(self.shared.options.preferences.speed, Clock::speed).abs(),
            panels: self.panels.remembered(),
            thumbnails: self.features.thumbnails.is_on,
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

    /// Advances to `now`: takes in results of threads, moves the playhead. Returns the visible change.
    pub fn update(&mut self, now: Duration) -> VisibleChange {
        let before = std::mem::replace(&mut self.shared.now, now);
        let outcomes = self.shared.tasks.take();
        let mut visible = !outcomes.is_empty();
        for outcome in outcomes {
            self.take_in(outcome);
        }
        visible |= self.follow_readings();
        visible |= self.shared.works.look(before, now);
        visible |= self.notices.expire(now);
        visible |= self.follow_connection();
        for feature in Features::rows::<Self>() {
            visible |= feature.update(self);
        }
        visible |= self.move_camera_on();
        let style = self.drawn_style();
        let Some(player) = &mut self.player else {
            return VisibleChange::of_panels(visible);
        };
        let (change, of_b) = if let Some(split_view) = &mut self.features.split_view {
            let [of_a, of_b] = split_view.update(player, now, &style);
            (of_a, Some(of_b))
        } else {
            let sequence = Arc::clone(player.sequence());
            let (photos, source) = (&self.features.photos, &**sequence.source());
            let prepare = |clock: &Clock, _: bool| photos.are_there(source, clock.frame(), &style);
            (player.update_with_companion(now, &style, prepare), None)
        };
        let is_another_frame = change.visible;
        visible |= change.beyond_frame;
        let count = player.sequence().len();
        if self.close_if_broken() {
            return VisibleChange::Panels;
        }
        self.note_proven();
        self.tell_of_frames(change, count);
        visible |= self.follow_shown();
        self.tell_view();
        if let Some(of_b) = of_b {
            visible |= self.follow_second(of_b);
        }
        let of_frame = match is_another_frame {
            true if self.panels_show_frame() => VisibleChange::Panels,
            true => VisibleChange::Frame,
            false if self.is_picture_due() => VisibleChange::Picture,
            false => VisibleChange::Nothing,
        };
        VisibleChange::of_panels(visible).max(of_frame)
    }

    /// Reports news about frames that were read, of `count`.
    fn tell_of_frames(&mut self, change: PlayerChange, count: usize) {
        for &frame in &change.reread {
            for feature in Features::rows::<Self>() {
                feature.forget_frame(self, frame);
            }
            self.notices
                .dismiss_begun(&format!("Frame {} of ", grouped(frame + 1)), " is skipped.");
            self.opening.looked.is_outdated |= self.opening.looked.first.is_some_and(|(index, _)| index == frame);
        }
        if let Some(failure) = change.new_failure {
            let [place, count] = [failure.index() + 1, count].map(grouped);
            self.notices
                .error(format!("Frame {place} of {count} is skipped. {failure}"));
        }
        let texts = change.other_attributes.into_iter();
        for text in texts.chain(change.new_warnings) {
            self.notices.warn(text);
        }
    }

    /// Starts the features' work on the shown frame. True if there is a visible change.
    fn follow_shown(&mut self) -> bool {
        let mut visible = false;
        for feature in Features::rows::<Self>() {
            visible |= feature.follow_frame(self);
        }
        if let Some(frame) = self.player.as_ref().and_then(Player::shown)
            && (self.opening.looked.is_empty() || self.opening.looked.is_mended_by(frame.index, frame.id))
        {
            let frame = Arc::clone(frame);
            self.look_first(&frame);
            visible = true;
        }
        for feature in Features::rows::<Self>() {
            feature.follow(self);
        }
        let paint = self.drawn_frame().map(|frame| *frame.paint());
        visible | (std::mem::replace(&mut self.main.painted_with, paint) != paint)
    }

    /// Returns true if panels show more of the playing frame than its position on the timeline, so that they must stay
    /// in sync with it.
    fn panels_show_frame(&self) -> bool {
        let is_playing = self.player.as_ref().is_some_and(Player::is_playing);
        !is_playing || Features::rows::<Self>().iter().any(|feature| feature.shows_frame(self))
    }

    /// Has features apply changes by the panels at once.
    pub(in crate::app) fn follow_panels(&mut self) {
        for feature in Features::rows::<Self>() {
            feature.follow_panels(self);
        }
    }

    /// True if something other than the image may have changed: marks on the timeline, progress.
    pub fn has_news(&self) -> bool {
        let mut works = self.shared.works.list().iter();
        works.any(|work| work.is_long(self.shared.now))
            || Features::rows::<Self>().iter().any(|feature| feature.has_news(self))
            || self.player.as_ref().is_some_and(Player::runs_are_old)
    }

    /// Takes the requests that only the window can serve, in the order in which they were made.
    pub fn take_requests(&mut self) -> Vec<WindowRequest> {
        std::mem::take(&mut self.shared.requests)
    }

    /// Time at which [`State::update`] has something to do without input.
    pub fn next_deadline(&self) -> Option<Duration> {
        let own = [
            self.player.as_ref().and_then(Player::next_deadline),
            self.notices.next_deadline(),
            self.shared.works.next_deadline(self.shared.now),
            self.next_look_at_readings(),
            self.camera_moves().then_some(self.shared.now),
            self.main.drawing.next_deadline(),
        ];
        let features = Features::rows::<Self>().into_iter();
        let features = features.map(|feature| feature.next_deadline(self));
        own.into_iter().chain(features).flatten().min()
    }
}
