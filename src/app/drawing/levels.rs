//! Levels of detail while the camera moves, for frames at rest that take long to draw.
//!
//! **How it works.** A frame whose image of all points took too long for smooth motion is recorded, and gets an octree
//! on a thread if it has none. While the camera moves, the number of drawn cells fits the time ([`in_cells`]); once it
//! has rested, all points are drawn. Frames that play have fewer points instead (`sequence/effort`): an octree for each
//! would take the time of the points that it saves.

use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::composition::{Coarse, can_draw, has_moving_levels, in_cells};
use crate::scene::{Camera, Scene, Style};
use crate::sequence::{Needs, PrepareCounters, PreparedFrame, complete};
use std::sync::Arc;
use std::time::Duration;

/// Max time of a moving image, panels included: 30 fps, with some time to spare.
const SMOOTH_MS: f32 = 28.0;

/// A camera that has not moved for so long rests: longer than the pauses in a slow drag, short enough to be waited for.
pub(in crate::app) const REST: Duration = Duration::from_millis(50);

/// Levels of detail that make the rendered images of one frame coarser while the camera moves.
#[derive(Debug, Default)]
pub(in crate::app) struct Levels {
    /// The frame whose image took that long, and its time.
    whole_ms: Option<(u64, f64)>,
    /// The frame for which levels are being made.
    asked_for: Option<u64>,
    made: Option<Arc<PreparedFrame>>,
    camera: Option<Camera>,
    /// When the camera moved last.
    moved_at: Option<Duration>,
    /// The last image was a coarse one.
    are_drawn: bool,
}

/// A frame that has got levels of detail.
#[derive(Debug)]
pub(in crate::app) struct FrameWithLevels(pub(in crate::app) Arc<PreparedFrame>);

impl Levels {
    /// Returns true if the last image was drawn at a coarse level of detail.
    pub(in crate::app) fn are_drawn(&self) -> bool {
        self.are_drawn
    }

    /// Records the time of the image of all points of `frame`.
    pub(in crate::app) fn note_whole_picture(&mut self, frame: &PreparedFrame, draw_ms: f64) {
        self.whole_ms = Some((frame.id, draw_ms));
    }

    /// Starts to build levels for `frame`, if its image takes long and it has none.
    pub(in crate::app) fn prepare<T: TaskOutcome + From<FrameWithLevels>>(
        &mut self,
        frame: &Arc<PreparedFrame>,
        style: &Style,
        tasks: &Tasks<T>,
    ) {
        let needs = Scene::needs(&in_cells(style, SMOOTH_MS));
        let has_levels = frame.satisfies(&needs) || self.made_for(frame, &needs).is_some();
        if !self.is_slow(frame)
            || has_levels
            || self.asked_for == Some(frame.id)
            || !has_moving_levels(style)
            || style.draws_codes()
            // Missing data are being prepared, or not needed.
            || !can_draw(frame, style)
        {
            return;
        }
        self.asked_for = Some(frame.id);
        let frame = Arc::clone(frame);
        tasks.start("levels", move || {
            let made = complete(&frame, &needs, &PrepareCounters::default());
            FrameWithLevels(Arc::new(made))
        });
    }

    /// Takes levels that were made.
    pub(in crate::app) fn take(&mut self, made: &Arc<PreparedFrame>) {
        if self.asked_for == Some(made.id) {
            self.asked_for = None;
            self.made = Some(Arc::clone(made));
        }
    }

    /// Time at which the camera has rested and the full image is due.
    pub(in crate::app) fn next_deadline(&self) -> Option<Duration> {
        self.moved_at.filter(|_| self.are_drawn).map(|moved_at| moved_at + REST)
    }

    /// Chooses the levels of detail to draw instead of `frame` from `camera` at `now`, while it moves.
    pub(in crate::app) fn choose(
        &mut self,
        frame: &Arc<PreparedFrame>,
        camera: &Camera,
        style: &Style,
        now: Duration,
    ) -> Option<Coarse> {
        if self.camera.replace(*camera).is_some_and(|before| before != *camera) {
            self.moved_at = Some(now);
        }
        let is_moving = self
            .moved_at
            .is_some_and(|moved_at| now.saturating_sub(moved_at) < REST);
        self.are_drawn = false;
        if !is_moving || !self.is_slow(frame) || !has_moving_levels(style) {
            return None;
        }
        let style = in_cells(style, SMOOTH_MS);
        let needs = Scene::needs(&style);
        let made = self.made_for(frame, &needs);
        let made = made.or_else(|| frame.satisfies(&needs).then_some(frame))?;
        let frame = Arc::clone(made);
        self.are_drawn = true;
        Some(Coarse { frame, style })
    }

    /// Returns true if rendering the whole frame takes longer than a smooth motion allows.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Outcome;
    use crate::cloud::{Frame, Positions, RawCloud};
    use crate::math::Aabb;
    use crate::scene::{Primitive, UpAxis};
    use crate::sequence::prepare;
    use glam::{DVec3, Vec3};
    use std::sync::mpsc::sync_channel;

    /// A square of points with the attributes of surfels, and no octree.
    fn square() -> Arc<PreparedFrame> {
        let positions = (0..400_u16).map(|index| [index % 20, index / 20, 0].map(f32::from));
        let raw = RawCloud::from_positions(Positions::F32(positions.collect()));
        let frame = Arc::new(Frame::from_raw(raw, DVec3::ZERO).unwrap());
        let needs = Scene::needs(&Style::default());
        let counters = PrepareCounters::default();
        Arc::new(prepare(0, frame, 0.0, &needs, &counters))
    }

    /// The camera at step `step` of a motion.
    fn camera(step: u32) -> Camera {
        let edge = Vec3::splat(20.0 + step as f32);
        Camera::framing(&Aabb::from_points(&[Vec3::ZERO, edge]), DVec3::ZERO, UpAxis::Z)
    }

    /// Starts building levels, if they are needed, and takes them.
    fn make(levels: &mut Levels, frame: &Arc<PreparedFrame>, style: &Style) -> bool {
        let (woken, wakes) = sync_channel(1);
        let mut tasks = Tasks::<Outcome>::new(Arc::new(move || woken.send(()).unwrap()));
        levels.prepare(frame, style, &tasks);
        if levels.asked_for.is_none() {
            return false;
        }
        wakes.recv_timeout(Duration::from_secs(30)).unwrap();
        for outcome in tasks.take() {
            outcome.give(|FrameWithLevels(made)| levels.take(&made)).unwrap();
        }
        true
    }

    #[test]
    fn a_slow_frame_is_coarse_while_the_camera_moves_and_complete_at_rest() {
        let frame = square();
        let style = Style::default();
        let mut levels = Levels::default();
        let ms = Duration::from_millis;
        assert!(levels.choose(&frame, &camera(0), &style, ms(0)).is_none());
        levels.note_whole_picture(&frame, 60.0);
        // Levels are built once.
        assert!(make(&mut levels, &frame, &style));
        assert!(!make(&mut levels, &frame, &style));

        let coarse = levels.choose(&frame, &camera(1), &style, ms(100)).unwrap();
        assert!(coarse.frame.levels.octree().is_some() && coarse.frame.id == frame.id);
        assert_eq!(coarse.style, in_cells(&style, SMOOTH_MS));
        assert!(levels.are_drawn());
        // The image of all points is due once the camera has stopped, and no sooner.
        assert_eq!(levels.next_deadline(), Some(ms(100) + REST));
        let still_coarse = levels.choose(&frame, &camera(1), &style, ms(149)).unwrap();
        assert_eq!(still_coarse.style, in_cells(&style, SMOOTH_MS));
        assert!(levels.choose(&frame, &camera(1), &style, ms(150)).is_none());
        assert_eq!(levels.next_deadline(), None);
    }

    #[test]
    fn frames_drawn_in_time_get_no_levels_of_detail() {
        let frame = square();
        let points = Style {
            primitive: Primitive::Point,
            ..Style::default()
        };
        let cases = [
            ("fast", Style::default(), 27.0),
            // Point primitives have no levels of detail.
            ("points", points, 60.0),
        ];
        for (name, style, whole_ms) in cases {
            let mut levels = Levels::default();
            levels.note_whole_picture(&frame, whole_ms);
            assert!(!make(&mut levels, &frame, &style), "{name}");
            for step in 0..3 {
                let now = Duration::from_millis(10 * u64::from(step));
                assert!(levels.choose(&frame, &camera(step), &style, now).is_none(), "{name}");
            }
        }
    }

    #[test]
    fn levels_of_a_frame_are_not_used_for_the_next() {
        let [before, next] = [square(), square()];
        let style = Style::default();
        let mut levels = Levels::default();
        levels.note_whole_picture(&before, 60.0);
        assert!(make(&mut levels, &before, &style));
        levels.note_whole_picture(&next, 60.0);
        levels.choose(&next, &camera(0), &style, Duration::ZERO);
        assert!(levels.choose(&next, &camera(1), &style, Duration::ZERO).is_none());
    }
}
