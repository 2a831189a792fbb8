//! Playback clock: determines the frame that is due at a given time. Pure: time is passed in, nothing here reads a real
//! clock.
//!
//! **How it works.** The clock remembers an anchor: time, frame, direction and how much of that frame's duration had
//! passed. The frame due at time t is `floor(phase + (t − anchor) · fps · |speed|)` steps away from the anchor, or the
//! number of steps that [`Pace`] yields if frames have times of their own. Since t is compared with the anchor and
//! never added up, there is no drift however unevenly the clock is polled. Any change of pace or position (speed, rate,
//! seek, pause) sets a new anchor at the present position, fraction included.
//!
//! The last frame lasts like any other: with [`LoopMode::Off`] playback ends when its time is over.

use super::PlayRange;
use super::pace::Pace;
use super::travel::{Direction, LoopMode, Travel};
use std::ops::Range;
use std::time::Duration;

/// Default frame rate in frames per second, if nothing else is known: the rate of cinema and of the demo.
pub const DEFAULT_FPS: f64 = 24.0;

/// Slowest speed, as a factor of the frame rate.
pub const MIN_SPEED: f64 = 0.1;

/// Fastest speed, as a factor of the frame rate.
pub const MAX_SPEED: f64 = 10.0;

/// Frame rates the clock takes.
const FPS_RANGE: (f64, f64) = (0.1, 1000.0);

/// A step counts as due this fraction of a frame early: more than the rounding error of times in nanoseconds, so that
/// asking at [`Clock::next_deadline`] always moves on.
const TOLERANCE_FRAMES: f64 = 1e-4;

/// Playback clock: position and pace of a playhead. Times are durations since any fixed instant, the same for all
/// calls.
#[derive(Debug, Clone)]
pub struct Clock {
    travel: Travel,
    pace: Pace,
    fps: f64,
    speed: f64,
    playing: bool,
    anchor: Anchor,
    /// Steps from the anchor to the present frame.
    steps: u64,
    frame: usize,
    direction: Direction,
    skipped: u64,
}

#[derive(Debug, Clone, Copy)]
struct Anchor {
    time: Duration,
    frame: usize,
    direction: Direction,
    /// Elapsed time within the frame, in median frame durations.
    phase: f64,
}

impl Clock {
    /// A paused clock at frame 0 of `frame_count`, at [`DEFAULT_FPS`], speed 1, looping.
    pub fn new(frame_count: usize) -> Self {
        Self {
            travel: Travel::whole(frame_count, LoopMode::default()),
            pace: Pace::default(),
            fps: DEFAULT_FPS,
            speed: 1.0,
            playing: false,
            anchor: Anchor {
                time: Duration::ZERO,
                frame: 0,
                direction: Direction::Forward,
                phase: 0.0,
            },
            steps: 0,
            frame: 0,
            direction: Direction::Forward,
            skipped: 0,
        }
    }

    /// Moves to the frame that is due at `now` and returns it. A `now` before the last one changes nothing.
    ///
    /// Frames whose whole time has passed since the last call are counted by [`Clock::skipped`].
    pub fn advance(&mut self, now: Duration) -> usize {
        if self.playing {
            let due = self.steps_due(now).max(self.steps);
            let arrival = self.travel.after(self.anchor.frame, self.anchor.direction, due);
            let moved = arrival.steps - self.steps;
            if self.travel.frames().len() > 1 {
                self.skipped += moved.saturating_sub(1);
            }
            self.steps = arrival.steps;
            self.frame = arrival.index;
            self.direction = arrival.direction;
            if arrival.steps < due {
                self.playing = false;
                self.set_anchor(now, 0.0);
            }
        }
        self.frame
    }

    /// Starts playing. At the end of frames that do not loop it starts over.
    pub fn play(&mut self, now: Duration) {
        if self.playing {
            return;
        }
        self.playing = true;
        if self.travel.loop_mode == LoopMode::Off && self.travel.after(self.frame, self.direction, 1).steps == 0 {
            self.frame = self.travel.start(self.direction);
            self.anchor.phase = 0.0;
        }
        self.set_anchor(now, self.anchor.phase);
    }

    /// Stops at the frame due at `now`; playing goes on from the same fraction of its duration.
    pub fn pause(&mut self, now: Duration) {
        self.reanchor(now);
        self.playing = false;
    }

    /// [`Clock::play`] or [`Clock::pause`].
    pub fn toggle(&mut self, now: Duration) {
        // If a due frame ends playback, the button means play.
        self.advance(now);
        if self.playing {
            self.pause(now);
        } else {
            self.play(now);
        }
    }

    /// Goes to `frame`, or to the last one if there are fewer; playing goes on from there, or from the beginning of the
    /// range if that is elsewhere.
    pub fn seek(&mut self, frame: usize, now: Duration) {
        self.advance(now);
        self.frame = frame.min(self.last());
        self.set_anchor(now, 0.0);
    }

    /// Pauses and goes `count` frames on, or back if it is negative: around the ends of the sequence if the mode is
    /// [`LoopMode::Loop`], else as far as the end. The range is for playing alone.
    pub fn step(&mut self, count: i64, now: Duration) {
        self.pause(now);
        let direction = if count < 0 {
            Direction::Backward
        } else {
            Direction::Forward
        };
        let ends = match self.travel.loop_mode {
            LoopMode::Loop => LoopMode::Loop,
            LoopMode::Off | LoopMode::PingPong => LoopMode::Off,
        };
        let travel = Travel {
            first: self.travel.first,
            ..Travel::whole(self.travel.frame_count, ends)
        };
        let target = travel.after(self.frame, direction, count.unsigned_abs());
        self.seek(target.index, now);
    }

    /// Plays at `speed` times the frame rate, backward if it is negative; its size is held between [`MIN_SPEED`] and
    /// [`MAX_SPEED`]. Zero and NaN change nothing.
    pub fn set_speed(&mut self, speed: f64, now: Duration) {
        if speed == 0.0 || speed.is_nan() {
            return;
        }
        self.reanchor(now);
        let turned = speed.is_sign_negative() != self.speed.is_sign_negative();
        self.speed = speed.abs().clamp(MIN_SPEED, MAX_SPEED).copysign(speed);
        if turned {
            // The elapsed part of the frame is the remaining part in the opposite direction.
            self.direction = self.direction.reversed();
            let duration = self.pace.duration(self.frame);
            let phase = duration - self.anchor.phase;
            self.set_anchor(now, if phase < duration { phase } else { 0.0 });
        }
    }

    /// Sets the frame rate, held between 0.1 and 1000; the position stays, fraction included. NaN changes nothing.
    pub fn set_fps(&mut self, fps: f64, now: Duration) {
        if !fps.is_nan() {
            self.reanchor(now);
            self.fps = fps.clamp(FPS_RANGE.0, FPS_RANGE.1);
        }
    }

    /// Sets the duration of each frame; the present one restarts.
    pub fn set_pace(&mut self, pace: Pace, now: Duration) {
        if self.pace != pace {
            self.advance(now);
            self.pace = pace;
            self.set_anchor(now, 0.0);
        }
    }

    /// Sets the present frames: more of them, or a later first one. The position stays; frames that are gone do not
    /// play.
    pub fn set_frames(&mut self, frames: Range<usize>, now: Duration) {
        self.reanchor(now);
        (self.travel.first, self.travel.frame_count) = (frames.start, frames.end);
        self.frame = self.frame.min(self.last());
        self.set_anchor(now, self.anchor.phase);
    }

    /// Sets the frames that play; the position stays. A playhead elsewhere goes to their beginning when it plays on.
    pub fn set_range(&mut self, range: PlayRange, now: Duration) {
        self.reanchor(now);
        self.travel.range = range;
        self.set_anchor(now, self.anchor.phase);
    }

    /// Sets the behaviour at the ends. The direction becomes the speed's again.
    pub fn set_loop_mode(&mut self, loop_mode: LoopMode, now: Duration) {
        self.reanchor(now);
        self.travel.loop_mode = loop_mode;
        let direction = self.speed_direction();
        if self.direction != direction {
            self.direction = direction;
            self.set_anchor(now, 0.0);
        }
    }

    /// The frame at the last [`Clock::advance`] or change.
    pub fn frame(&self) -> usize {
        self.frame
    }

    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        self.travel.frame_count
    }

    /// In and out point.
    pub fn range(&self) -> PlayRange {
        self.travel.range
    }

    /// True until paused or, without looping, until the last frame's time is over.
    pub fn is_playing(&self) -> bool {
        self.playing
    }

    /// Returns true if the clock is playing and there is another frame to play than the current one.
    pub fn is_moving(&self) -> bool {
        let frames = self.travel.frames();
        self.playing && (frames.len() > 1 || (frames.len() == 1 && !frames.contains(&self.frame)))
    }

    /// Returns the playback direction; it reverses by itself in [`LoopMode::PingPong`].
    pub fn direction(&self) -> Direction {
        self.direction
    }

    /// Factor of the frame rate; negative plays backward.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Returns the pace: the duration of each frame.
    pub fn pace(&self) -> &Pace {
        &self.pace
    }

    /// Returns the frame rate in frames per second at speed 1.
    pub fn fps(&self) -> f64 {
        self.fps
    }

    /// Wall time that most frames last at the present speed.
    pub fn frame_interval(&self) -> Duration {
        Duration::from_secs_f64(1.0 / self.rate())
    }

    /// Returns the loop mode: the behaviour at the ends.
    pub fn loop_mode(&self) -> LoopMode {
        self.travel.loop_mode
    }

    /// Returns the number of frames that passed between two calls of [`Clock::advance`] without being returned by one.
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Time at which [`Clock::advance`] will next change something; `None` if it never will by itself.
    pub fn next_deadline(&self) -> Option<Duration> {
        let ends = self.playing && self.travel.loop_mode == LoopMode::Off;
        if !self.is_moving() && !ends {
            return None;
        }
        let frames = self.elapsed_at(self.steps + 1) - self.anchor.phase;
        // Duration::MAX is 10^11 years: no sum of a session's times comes near it, but a hostile `now` could.
        Duration::try_from_secs_f64(frames / self.rate())
            .ok()
            .and_then(|wait| self.anchor.time.checked_add(wait))
    }

    /// Returns the playback rate in frames per second of wall time.
    fn rate(&self) -> f64 {
        self.fps * self.speed.abs()
    }

    fn speed_direction(&self) -> Direction {
        if self.speed < 0.0 {
            Direction::Backward
        } else {
            Direction::Forward
        }
    }

    fn last(&self) -> usize {
        self.travel.frame_count.saturating_sub(1)
    }

    /// Median frames from the beginning of the anchor's frame until `steps` are made.
    fn elapsed_at(&self, steps: u64) -> f64 {
        let Anchor { frame, direction, .. } = self.anchor;
        self.pace.elapsed_at(&self.travel, frame, direction, steps)
    }

    /// Median frames since the anchor's frame began, with fraction.
    fn frames_since_anchor(&self, now: Duration) -> f64 {
        let elapsed_secs = now.saturating_sub(self.anchor.time).as_secs_f64();
        self.anchor.phase + elapsed_secs * self.rate()
    }

    fn steps_due(&self, now: Duration) -> u64 {
        let elapsed = self.frames_since_anchor(now) + TOLERANCE_FRAMES;
        let Anchor { frame, direction, .. } = self.anchor;
        self.pace.steps_within(&self.travel, frame, direction, elapsed)
    }

    /// Advances, then makes the present position the anchor.
    fn reanchor(&mut self, now: Duration) {
        self.advance(now);
        if self.playing {
            let phase = self.frames_since_anchor(now) - self.elapsed_at(self.steps);
            let max = (self.pace.duration(self.frame) - TOLERANCE_FRAMES).max(0.0);
            self.set_anchor(now, phase.clamp(0.0, max));
        }
    }

    /// Anchors the present frame and direction at `now`.
    fn set_anchor(&mut self, now: Duration, phase: f64) {
        self.anchor = Anchor {
            // A change made with an older time must not turn the clock back.
            time: now.max(self.anchor.time),
            frame: self.frame,
            direction: self.direction,
            phase,
        };
        self.steps = 0;
    }
}

#[cfg(test)]
#[path = "clock_tests.rs"]
mod tests;
