//! Levels of detail while the camera moves, for frames at rest that take long to draw.
//!
//! **How it works.** A picture of all points that took longer than a smooth motion allows is remembered with its frame, which then gets an
//! octree on a thread if it has none. While the camera moves, as many cells are drawn as there is time for
//! ([`Lod::FrameTimeMs`]); once it has rested, all points. Frames that play have fewer points instead (`sequence/effort.rs`): an octree for
//! each would take the time of the points that it saves.

use super::tasks::{Outcome, Tasks};
use crate::scene::{Camera, Lod, Primitive, Scene, Settings};
use crate::sequence::{Needs, PrepareCounters, PreparedFrame, complete};
use std::sync::Arc;
use std::time::Duration;

/// A moving picture takes no longer, panels included: 30 a second, and some time to spare.
const SMOOTH_MS: f32 = 28.0;

/// A camera that has not moved for so long rests: longer than the pauses in a slow drag, short enough to be waited for.
const REST: Duration = Duration::from_millis(50);

/// What makes the pictures of one frame coarser while the camera moves.
#[derive(Debug, Default)]
pub(super) struct Levels {
    /// The frame whose picture took so long, and how long.
    whole_ms: Option<(u64, f64)>,
    /// The frame for which levels are being made.
    asked_for: Option<u64>,
    made: Option<Arc<PreparedFrame>>,
    camera: Option<Camera>,
    /// When the camera moved last.
    moved_at: Option<Duration>,
    /// The last picture was a coarse one.
    are_drawn: bool,
}

impl Levels {
    /// Whether the last picture was a coarse one.
    pub(super) fn are_drawn(&self) -> bool {
        self.are_drawn
    }

    /// Takes notice of how long the picture of all points of `frame` took.
    pub(super) fn note_whole_picture(&mut self, frame: &PreparedFrame, draw_ms: f64) {
        self.whole_ms = Some((frame.id, draw_ms));
    }

    /// Has levels made for `frame`, if its picture takes long and it has none.
    pub(super) fn prepare(
        &mut self,
        frame: &Arc<PreparedFrame>,
        settings: &Settings,
        tasks: &Tasks,
    ) {
        let needs = Scene::needs(&in_cells(settings));
        let has_levels = frame.satisfies(&needs) || self.made_for(frame, &needs).is_some();
        if !self.is_slow(frame)
            || has_levels
            || self.asked_for == Some(frame.id)
            || settings.primitive == Primitive::Point
            || settings.draws_codes()
        {
            return;
        }
        self.asked_for = Some(frame.id);
        let frame = Arc::clone(frame);
        tasks.start("levels", move || {
            let made = complete(&frame, &needs, &PrepareCounters::default());
            Outcome::Levels(Arc::new(made))
        });
    }

    /// Takes levels that were made.
    pub(super) fn take(&mut self, made: &Arc<PreparedFrame>) {
        if self.asked_for == Some(made.id) {
            self.asked_for = None;
            self.made = Some(Arc::clone(made));
        }
    }

    /// When the camera will have rested and the whole picture is due.
    pub(super) fn next_deadline(&self) -> Option<Duration> {
        self.moved_at
            .filter(|_| self.are_drawn)
            .map(|moved_at| moved_at + REST)
    }

    /// The frame and the settings to draw with from `camera` at `now`: those that are given, or coarser ones while it moves.
    pub(super) fn choose(
        &mut self,
        frame: &Arc<PreparedFrame>,
        camera: &Camera,
        settings: &Settings,
        now: Duration,
    ) -> (Arc<PreparedFrame>, Settings) {
        if self
            .camera
            .replace(*camera)
            .is_some_and(|before| before != *camera)
        {
            self.moved_at = Some(now);
        }
        let is_moving = self
            .moved_at
            .is_some_and(|moved_at| now.saturating_sub(moved_at) < REST);
        self.are_drawn = false;
        if is_moving && self.is_slow(frame) && settings.primitive != Primitive::Point {
            let coarse = in_cells(settings);
            let needs = Scene::needs(&coarse);
            let made = self.made_for(frame, &needs);
            let made = made.or_else(|| frame.satisfies(&needs).then_some(frame));
            if let Some(made) = made {
                let made = Arc::clone(made);
                self.are_drawn = true;
                return (made, coarse);
            }
        }
        (Arc::clone(frame), *settings)
    }

    /// Whether the whole picture of a frame takes longer than a smooth motion allows.
    fn is_slow(&self, frame: &PreparedFrame) -> bool {
        self.whole_ms
            .is_some_and(|(id, whole_ms)| id == frame.id && whole_ms > f64::from(SMOOTH_MS))
    }

    fn made_for(&self, frame: &PreparedFrame, needs: &Needs) -> Option<&Arc<PreparedFrame>> {
        self.made
            .as_ref()
            .filter(|made| made.id == frame.id && made.satisfies(needs))
    }
}

/// The same settings, by as many cells of the octree as can be drawn in time.
fn in_cells(settings: &Settings) -> Settings {
    Settings {
        surfel_lod: true,
        lod: Lod::FrameTimeMs(SMOOTH_MS),
        ..*settings
    }
}
