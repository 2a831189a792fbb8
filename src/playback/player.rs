//! Playback of an open sequence with its playhead: the frame that is due, the frame that is shown, and the frame that
//! is waited for.
//!
//! **How it works.** The clock determines the frame that is due. If that frame is in memory, or cannot be read, the
//! clock moves on; if not, the clock is stopped on that frame and continues from it when the loader has it.
//!
//! If there is no time for all points of the frames, fewer are shown: the loader receives the duration of a frame and
//! its render time, and reports the points it has. While paused, all points are shown. A disk that cannot even deliver
//! enough for that slows playback down, so that every frame is seen, and frames are *late*; a display that is too slow
//! even so *skips* frames. All of these are counted.

use super::attributes::FirstAttributes;
use super::marks::{MarkRun, runs};
use crate::composition::can_draw;
use crate::photos::ViewSet;
use crate::scene::{Scene, Style};
use crate::sequence::{FrameError, Loader, LoaderOptions, Needs, PreparedFrame, Sequence, SequenceError, Slot};
use crate::timeline::{Clock, Direction, LoopMode, PlayRange};
use std::collections::{HashSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

/// The rate that is held is measured over this time.
const RATE_WINDOW: Duration = Duration::from_secs(1);

/// Frames remembered for it: more than any screen shows in that time.
const MAX_RATE_SAMPLES: usize = 1024;

/// Plays one sequence.
#[derive(Debug)]
pub struct Player {
    sequence: Arc<Sequence>,
    loader: Loader,
    clock: Clock,
    shown: Option<Arc<PreparedFrame>>,
    failure: Option<Arc<FrameError>>,
    /// Frames whose failures or warnings were reported: a loop meets them again and again.
    told: HashSet<usize>,
    /// The frame at the playhead, while it is not there.
    waiting_for: Option<usize>,
    /// The frame shown lacks something that is being made.
    is_partial: bool,
    /// The stopped clock goes on when the frame at the playhead is there.
    play_on_arrival: bool,
    requested: Option<(usize, Direction, Needs)>,
    runs: Vec<MarkRun>,
    runs_revision: Option<u64>,
    shown_at: VecDeque<Duration>,
    frames_shown: u64,
    coarse_frames_shown: u64,
    late_frames: u64,
    follows_newest: bool,
    attributes: FirstAttributes,
    /// Changes of files that were taken notice of.
    known_changes: usize,
    /// Frames whose files changed since the last pass.
    reread: Vec<usize>,
}

/// Changes made by [`Player::update`].
#[derive(Debug, Clone, Default)]
pub struct PlayerChange {
    /// Another frame is shown, or the place of the playhead is another one.
    pub visible: bool,
    /// Something else than which frame is shown, and where the playhead is: playing has begun, ended or stopped, frames
    /// came, one failed.
    pub beyond_frame: bool,
    /// A frame at the playhead cannot be shown, and this is the first time that it was met.
    pub new_failure: Option<Arc<FrameError>>,
    /// Message for a frame that does not have the attributes of the first one.
    pub other_attributes: Option<String>,
    /// Warnings about unreadable parts of a frame that is shown for the first time.
    pub new_warnings: Vec<String>,
    /// Frames whose files changed: earlier reports on them may no longer be true.
    pub reread: Vec<usize>,
}

impl Player {
    /// Opens `sequence` at its first frame, paused unless `play`.
    pub fn new(sequence: Arc<Sequence>, options: LoaderOptions, play: bool) -> Result<Self, SequenceError> {
        let loader = Loader::new(sequence, options)?;
        Ok(Self::with_loader(loader, play))
    }

    pub(super) fn with_loader(loader: Loader, play: bool) -> Self {
        let sequence = Arc::clone(loader.sequence());
        let mut clock = Clock::new(sequence.len());
        clock.set_fps(sequence.fps(), Duration::ZERO);
        clock.set_pace(sequence.pace(), Duration::ZERO);
        Self {
            loader,
            clock,
            shown: None,
            failure: None,
            told: HashSet::new(),
            reread: Vec::new(),
            waiting_for: None,
            is_partial: false,
            play_on_arrival: play,
            requested: None,
            runs: Vec::new(),
            runs_revision: None,
            shown_at: VecDeque::new(),
            frames_shown: 0,
            coarse_frames_shown: 0,
            late_frames: 0,
            follows_newest: false,
            attributes: FirstAttributes::default(),
            known_changes: 0,
            sequence,
        }
    }

    /// The sequence.
    pub fn sequence(&self) -> &Arc<Sequence> {
        &self.sequence
    }

    /// Its loader.
    pub fn loader(&self) -> &Loader {
        &self.loader
    }

    /// Place and pace of the playhead.
    pub fn clock(&self) -> &Clock {
        &self.clock
    }

    /// Capture time of `frame`, seconds after the first one: from their time stamps, else from playing at speed 1.
    /// Precondition: the sequence has this frame.
    pub fn time_s(&self, frame: usize) -> f64 {
        let time = |frame| self.sequence.entry(frame).time;
        let stamped = || Some(time(frame)?.saturating_sub(time(0)?).as_secs_f64());
        let is_stamped = !self.clock.pace().is_even();
        let stamped = is_stamped.then(stamped).flatten();
        stamped.unwrap_or_else(|| frame as f64 / self.clock.fps())
    }

    /// The frame shown.
    pub fn shown(&self) -> Option<&Arc<PreparedFrame>> {
        self.shown.as_ref()
    }

    /// Returns the images of the shown frame, as far as they are known.
    pub fn posed_images(&self) -> Option<Arc<ViewSet>> {
        self.sequence().source().posed_images(self.shown()?.index)
    }

    /// The reason why the frame at the playhead is not shown, if it cannot be read.
    pub fn failure(&self) -> Option<&Arc<FrameError>> {
        self.failure.as_ref()
    }

    /// The frame that is waited for.
    pub fn waiting_for(&self) -> Option<usize> {
        self.waiting_for
    }

    /// Returns true if the shown frame is still loading: only some of its points are there, or all of them without
    /// estimated attributes.
    pub fn is_partial(&self) -> bool {
        self.is_partial
    }

    /// Has the first frame made before there is a window to show it in.
    pub fn begin(&mut self, style: &Style) {
        self.loader.set_interval(self.interval(&self.clock));
        let needs = Scene::needs(style);
        self.request(self.clock.frame(), self.clock.direction(), needs);
    }

    /// Returns the duration of a frame during playback. A single frame is at rest, at any requested speed.
    fn interval(&self, clock: &Clock) -> Option<Duration> {
        let plays = self.is_playing() && clock.frame_count() > 1;
        plays.then(|| clock.frame_interval())
    }

    /// True when playing, or waiting for a frame to play on. One frame alone does not play: it is at rest, with all its
    /// points.
    pub fn is_playing(&self) -> bool {
        self.clock.is_moving() || self.play_on_arrival
    }

    /// Runs of frames with the same state, as of the last `refresh_runs`.
    pub fn runs(&self) -> &[MarkRun] {
        &self.runs
    }

    /// Changes of the shown frame since the sequence was opened.
    pub fn frames_shown(&self) -> u64 {
        self.frames_shown
    }

    /// Returns the number of shown frames that first appeared with fewer points than their files have.
    pub fn coarse_frames_shown(&self) -> u64 {
        self.coarse_frames_shown
    }

    /// Frames that were not there when they were due while playing.
    pub fn late_frames(&self) -> u64 {
        self.late_frames
    }

    /// Records how long a frame with this number of points took to draw, milliseconds.
    pub fn note_picture_ms(&self, points: usize, picture_ms: f64) {
        self.loader.note_drawn(points, picture_ms);
    }

    /// Returns the frame rate recently achieved, in frames per second; `None` while paused or too early to determine.
    pub fn fps_held(&self) -> Option<f64> {
        let (first, last) = (self.shown_at.front()?, self.shown_at.back()?);
        let elapsed = last.checked_sub(*first)?.as_secs_f64();
        (self.is_playing() && elapsed > 0.0).then(|| (self.shown_at.len() - 1) as f64 / elapsed)
    }

    /// Returns true if playback follows the newest frame as it arrives.
    pub fn follows_newest(&self) -> bool {
        self.follows_newest
    }

    /// Goes to the newest frame, and to each that comes; or stays where it is.
    pub fn follow_newest(&mut self, follows: bool, now: Duration) {
        if follows {
            self.play_on_arrival = false;
            self.seek(usize::MAX, now);
            self.clock.pause(now);
        }
        self.follows_newest = follows;
    }

    /// Forgets frames whose files changed.
    fn forget_changed(&mut self) -> bool {
        let changed = self.sequence.changed_since(self.known_changes);
        if changed.is_empty() {
            return false;
        }
        self.known_changes += changed.len();
        if self.sequence.are_ranges_outdated() {
            let all: Vec<usize> = (0..self.sequence.len()).collect();
            self.loader.forget(&all);
        } else {
            self.loader.forget(&changed);
        }
        self.told.retain(|frame| !changed.contains(frame));
        let is_changed = |failure: &Arc<FrameError>| changed.contains(&failure.index());
        if self.failure.as_ref().is_some_and(is_changed) {
            self.failure = None;
        }
        self.reread.extend(changed);
        true
    }

    /// Takes the frames by which the sequence has grown; true if there are some.
    fn grow(&mut self, now: Duration) -> bool {
        let has_changed = self.forget_changed();
        let frames = self.sequence.frames();
        if frames.end <= self.clock.frame_count() {
            return has_changed;
        }
        self.loader.grow();
        self.clock.set_frames(frames, now);
        self.clock.set_pace(self.sequence.pace(), now);
        true
    }

    /// Goes to the newest frame, if newest ones are followed and the one that was gone to before is there: who always
    /// goes on to one that has only just come sees none where they come faster than they are made.
    fn go_to_newest(&mut self, now: Duration) {
        let frame = self.clock.frame();
        let has_failed = |failure: &Arc<FrameError>| failure.index() == frame;
        if self.follows_newest && (self.shows(frame) || self.failure.as_ref().is_some_and(has_failed)) {
            self.follow_newest(true, now);
        }
    }

    /// Play or pause.
    pub fn toggle(&mut self, now: Duration) {
        self.follows_newest = false;
        if self.waiting_for.is_some() || self.play_on_arrival {
            self.play_on_arrival ^= true;
        } else {
            self.clock.toggle(now);
        }
        self.shown_at.clear();
    }

    /// Goes to `frame`.
    pub fn seek(&mut self, frame: usize, now: Duration) {
        self.follows_newest = false;
        self.waiting_for = None;
        self.clock.seek(frame, now);
        self.shown_at.clear();
    }

    /// Pauses and goes `count` frames on.
    pub fn step(&mut self, count: i64, now: Duration) {
        self.follows_newest = false;
        self.waiting_for = None;
        self.play_on_arrival = false;
        self.clock.step(count, now);
    }

    /// Factor of the frame rate, negative for backward.
    pub fn set_speed(&mut self, speed: f64, now: Duration) {
        self.clock.set_speed(speed, now);
        self.shown_at.clear();
    }

    /// Sets the frame rate at speed 1, in frames per second.
    pub fn set_fps(&mut self, fps: f64, now: Duration) {
        self.clock.set_fps(fps, now);
        self.shown_at.clear();
    }

    /// Sets the loop mode, i.e. the behaviour at the ends of the range.
    pub fn set_loop_mode(&mut self, loop_mode: LoopMode, now: Duration) {
        self.clock.set_loop_mode(loop_mode, now);
        self.loader.set_loop_mode(loop_mode);
    }

    /// Sets the range of frames that play.
    pub fn set_range(&mut self, range: PlayRange, now: Duration) {
        self.clock.set_range(range, now);
        self.loader.set_range(range);
    }

    /// Time at which `update` has something to do by itself; `None` if only the loader can bring it.
    pub fn next_deadline(&self) -> Option<Duration> {
        self.clock.next_deadline()
    }

    /// Moves the playhead to where it is at `now` and shows its frame if it is there.
    pub fn update(&mut self, now: Duration, style: &Style) -> PlayerChange {
        self.update_with_companion(now, style, |_, _| true)
    }

    /// Variant of [`Player::update`] for playback together with something else on the same clock: `prepare` receives
    /// the next clock position and the playing state, and reports whether its frame for there is available. Playback
    /// waits for it.
    pub fn update_with_companion(
        &mut self,
        now: Duration,
        style: &Style,
        prepare: impl FnOnce(&Clock, bool) -> bool,
    ) -> PlayerChange {
        let has_grown = self.grow(now);
        self.go_to_newest(now);
        let needs = Scene::needs(style);
        let playhead_before = self.clock.frame();
        let playing_before = self.is_playing();
        let mut ahead = self.clock.clone();
        let target = ahead.advance(now);
        self.request(target, ahead.direction(), needs);
        self.loader.set_interval(self.interval(&ahead));
        let must_wait = !prepare(&ahead, playing_before) && playing_before;

        let mut change = PlayerChange {
            visible: has_grown,
            beyond_frame: has_grown,
            reread: std::mem::take(&mut self.reread),
            ..PlayerChange::default()
        };
        let slot = self.loader.get(target, &needs);
        self.is_partial = matches!(slot, Slot::Partial(_));
        let frame = match slot {
            Slot::Partial(frame) | Slot::Ready(frame) | Slot::Coarse(frame) => Some(frame),
            // An older version of the same frame is shown in the meantime; one that cannot be drawn as requested would
            // only flash.
            Slot::Stale(frame) if can_draw(&frame, style) || self.shows(target) => Some(frame),
            Slot::Stale(_) | Slot::Pending => None,
            Slot::Failed(error) => {
                self.arrive(ahead, now);
                if self.told.insert(target) {
                    change.new_failure = Some(Arc::clone(&error));
                }
                change.visible |= self.failure.as_ref().is_none_or(|known| known.index() != target);
                self.failure = Some(error);
                change.visible |= self.clock.frame() != playhead_before || self.is_playing() != playing_before;
                change.beyond_frame |= change.visible;
                return change;
            }
        };
        if let Some(frame) = frame.filter(|_| !must_wait) {
            self.arrive(ahead, now);
            // A live stream sends points with normals once it knows the view.
            if self.sequence().source().live().is_none() {
                change.other_attributes = self.attributes.note(frame.index, &frame.frame);
            }
            change.new_warnings = new_warnings(&frame, &mut self.told);
            change.beyond_frame |= self.failure.take().is_some();
            change.visible |= self.show(frame, now);
        } else if self.waiting_for != Some(target) {
            change.beyond_frame = true;
            self.wait(ahead, now);
        }
        change.beyond_frame |= self.is_playing() != playing_before;
        change.visible |= self.clock.frame() != playhead_before || change.beyond_frame;
        change
    }

    fn shows(&self, index: usize) -> bool {
        self.shown.as_ref().is_some_and(|shown| shown.index == index)
    }

    /// Stops on the frame that the clock has come to.
    fn wait(&mut self, ahead: Clock, now: Duration) {
        self.clock = ahead;
        // The clock waits: a disk too slow even for samples delays frames but drops none.
        self.waiting_for = Some(self.clock.frame());
        // The first image has no due time.
        self.late_frames += u64::from(self.clock.is_playing() && self.shown.is_some());
        self.play_on_arrival |= self.clock.is_playing();
        self.clock.pause(now);
    }

    /// The frame that the clock has come to is there, or never will be. It gets its whole time if it was waited for.
    fn arrive(&mut self, ahead: Clock, now: Duration) {
        self.clock = ahead;
        self.waiting_for = None;
        if std::mem::take(&mut self.play_on_arrival) {
            self.clock.seek(self.clock.frame(), now);
            let mut playing = self.clock.clone();
            playing.play(now);
            // At the end of a sequence that does not loop, playing means starting over: that was not requested here.
            if playing.frame() == self.clock.frame() {
                self.clock = playing;
            }
        }
    }

    /// True if the image differs from the one before.
    fn show(&mut self, frame: Arc<PreparedFrame>, now: Duration) -> bool {
        if self.shown.as_ref().is_some_and(|shown| Arc::ptr_eq(shown, &frame)) {
            return false;
        }
        if !self.shows(frame.index) {
            self.frames_shown += 1;
            self.coarse_frames_shown += u64::from(frame.is_sample() && !self.is_partial);
            self.shown_at.push_back(now);
            while self.shown_at.len() > MAX_RATE_SAMPLES
                || self
                    .shown_at
                    .front()
                    .is_some_and(|&first| now.saturating_sub(first) > RATE_WINDOW)
            {
                self.shown_at.pop_front();
            }
        }
        self.shown = Some(frame);
        true
    }

    fn request(&mut self, playhead: usize, direction: Direction, needs: Needs) {
        let request = (playhead, direction, needs);
        if self.requested != Some(request) {
            self.loader.request(playhead, direction, &needs);
            self.requested = Some(request);
        }
    }

    /// Queries the loader for the states of frames if they may have changed.
    pub fn refresh_runs(&mut self) {
        let revision = self.loader.revision();
        if self.runs_revision != Some(revision) {
            self.runs = runs(self.loader.states());
            self.runs_revision = Some(revision);
        }
    }

    /// True if `refresh_runs` would look again.
    pub fn runs_are_old(&self) -> bool {
        self.runs_revision != Some(self.loader.revision())
    }
}

/// The warnings of `frame` if nothing of it is in `told` yet.
pub(super) fn new_warnings(frame: &PreparedFrame, told: &mut HashSet<usize>) -> Vec<String> {
    let warnings = frame.frame.warnings();
    if warnings.is_empty() || !told.insert(frame.index) {
        return Vec::new();
    }
    warnings.to_vec()
}

#[cfg(test)]
#[path = "schedule_tests.rs"]
mod schedule_tests;

#[cfg(test)]
#[path = "stage_tests.rs"]
mod stage_tests;

#[cfg(test)]
#[path = "player_tests.rs"]
mod tests;
