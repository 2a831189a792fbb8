//! Surfels of the visible part, for a large static cloud whose own are not available: they are being estimated, or do
//! not fit the machine's memory.
//!
//! **How it works.** When camera and frame have been the same for a short time, a thread selects the visible points, at
//! most one per pixel ([`ViewOfFrame`]), and estimates the surface of these alone. Their image replaces the one of all
//! points until the view changes, or the surfels of all points are available.

use super::levels::REST;
use crate::analysis::MAX_JOINED;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::composition::{PictureView, ViewOfFrame};
use crate::scene::Style;
use crate::sequence::PreparedFrame;
use std::sync::Arc;
use std::time::Duration;

/// A frame whose surfels are needed and missing.
#[derive(Debug)]
struct WantedView {
    key: ViewOfFrame,
    frame: Arc<PreparedFrame>,
    since: Duration,
}

/// Surfels of a view that were estimated; `None` where nothing is seen.
#[derive(Debug)]
pub struct InView {
    key: ViewOfFrame,
    part: Option<Arc<PreparedFrame>>,
}

/// The surfels in view of one image.
#[derive(Debug)]
pub(in crate::app) struct SurfelsInView {
    /// Minimum point count: surfels of frames of fewer points are ready before they are needed.
    min_points: usize,
    wanted: Option<WantedView>,
    asked_for: Option<ViewOfFrame>,
    made: Option<Arc<InView>>,
}

impl Default for SurfelsInView {
    fn default() -> Self {
        Self {
            min_points: MAX_JOINED,
            wanted: None,
            asked_for: None,
            made: None,
        }
    }
}

impl SurfelsInView {
    /// Returns the surfels to draw instead of `frame` at `now`, if these are wanted and available.
    pub(in crate::app) fn choose(
        &mut self,
        frame: &Arc<PreparedFrame>,
        view: &PictureView<'_>,
        style: &Style,
        now: Duration,
    ) -> Option<Arc<PreparedFrame>> {
        let is_large = frame.points.len() >= self.min_points;
        let Some(key) = ViewOfFrame::without_surfels(frame, view, style).filter(|_| is_large) else {
            self.wanted = None;
            self.made = None;
            return None;
        };
        if self.wanted.as_ref().is_none_or(|wanted| wanted.key != key) {
            self.wanted = Some(WantedView {
                key,
                frame: Arc::clone(frame),
                since: now,
            });
        }
        self.made_as_wanted()?.part.clone()
    }

    fn made_as_wanted(&self) -> Option<&InView> {
        let wanted = self.wanted.as_ref()?;
        let made = self.made.as_deref();
        made.filter(|made| made.key == wanted.key)
    }

    /// Starts the needed task, once the view rests.
    pub(in crate::app) fn prepare<T: TaskOutcome + From<Arc<InView>>>(&mut self, tasks: &Tasks<T>, now: Duration) {
        if self.next_deadline().is_none_or(|deadline| now < deadline) {
            return;
        }
        let Some(wanted) = &self.wanted else { return };
        let (key, frame) = (wanted.key.clone(), Arc::clone(&wanted.frame));
        self.asked_for = Some(key.clone());
        tasks.start("surfels in view", move || {
            let part = key.surfels(&frame);
            Arc::new(InView { key, part })
        });
    }

    /// Takes the result of a task.
    pub(in crate::app) fn take(&mut self, made: &Arc<InView>) {
        if self.asked_for.as_ref() == Some(&made.key) {
            self.asked_for = None;
            self.made = Some(Arc::clone(made));
        }
    }

    /// Time at which the view rests and its surfels are due. One view is processed at a time, so that orbiting waits
    /// for at most one.
    pub(in crate::app) fn next_deadline(&self) -> Option<Duration> {
        let is_due = self.asked_for.is_none() && self.made_as_wanted().is_none();
        let wanted = self.wanted.as_ref().filter(|_| is_due)?;
        Some(wanted.since + REST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Outcome;
    use crate::cloud::{Frame, Positions, RawCloud};
    use crate::composition::can_draw;
    use crate::math::Aabb;
    use crate::scene::{Camera, Primitive, Scene, UpAxis};
    use crate::sequence::{Needs, PrepareCounters, prepare};
    use glam::{DVec3, Vec3};
    use std::sync::mpsc::sync_channel;

    const VIEWPORT_PX: [u32; 2] = [64, 48];

    /// A square of points, without the attributes of surfels.
    fn square() -> Arc<PreparedFrame> {
        let positions = (0..10_000_u16).map(|index| [index % 100, index / 100, 0].map(f32::from));
        let raw = RawCloud::from_positions(Positions::F32(positions.collect()));
        let frame = Arc::new(Frame::from_raw(raw, DVec3::ZERO).unwrap());
        let counters = PrepareCounters::default();
        Arc::new(prepare(0, frame, 0.0, &Needs::default(), &counters))
    }

    fn camera(edge: f32) -> Camera {
        let bounds = Aabb::from_points(&[Vec3::ZERO, Vec3::splat(edge)]);
        Camera::framing(&bounds, DVec3::ZERO, UpAxis::Z)
    }

    fn view(camera: &Camera) -> PictureView<'_> {
        PictureView {
            camera,
            origin: DVec3::ZERO,
            size_px: VIEWPORT_PX,
        }
    }

    fn for_all_clouds() -> SurfelsInView {
        SurfelsInView {
            min_points: 0,
            ..SurfelsInView::default()
        }
    }

    fn ms(time_ms: u64) -> Duration {
        Duration::from_millis(time_ms)
    }

    fn choose(
        surfels: &mut SurfelsInView,
        frame: &Arc<PreparedFrame>,
        camera: &Camera,
        time_ms: u64,
    ) -> Option<Arc<PreparedFrame>> {
        surfels.choose(frame, &view(camera), &Style::default(), ms(time_ms))
    }

    /// Makes the surfels due at `time_ms`; `None` if none are.
    fn make(surfels: &mut SurfelsInView, time_ms: u64) -> Option<Arc<InView>> {
        let (woken, wakes) = sync_channel(1);
        let mut tasks = Tasks::<Outcome>::new(Arc::new(move || woken.send(()).unwrap()));
        surfels.prepare(&tasks, ms(time_ms));
        surfels.asked_for.as_ref()?;
        wakes.recv_timeout(Duration::from_secs(30)).unwrap();
        let mut made = None;
        tasks
            .take()
            .pop()
            .unwrap()
            .give(|message| made = Some(message))
            .unwrap();
        made
    }

    #[test]
    fn each_view_at_rest_gets_its_own_surfels() {
        let (frame, mut surfels) = (square(), for_all_clouds());
        let [near, far] = [camera(100.0), camera(400.0)];
        assert!(choose(&mut surfels, &frame, &near, 0).is_none());
        assert_eq!(surfels.next_deadline(), Some(REST));
        assert!(make(&mut surfels, 49).is_none());
        let made = make(&mut surfels, 50).unwrap();
        // Nothing else is started in the meantime.
        assert_eq!(surfels.next_deadline(), None);
        surfels.take(&made);
        assert_eq!(surfels.next_deadline(), None);
        let part = choose(&mut surfels, &frame, &near, 60).unwrap();
        assert!(can_draw(&part, &Style::default()) && part.is_sample());
        assert!(part.points.len() < frame.points.len());

        assert!(choose(&mut surfels, &frame, &far, 70).is_none());
        assert_eq!(surfels.next_deadline(), Some(ms(70) + REST));
        let made = make(&mut surfels, 120).unwrap();
        surfels.take(&made);
        let farther = choose(&mut surfels, &frame, &far, 121).unwrap();
        assert!(farther.points.len() < part.points.len());
    }

    #[test]
    fn late_results_are_not_drawn() {
        let (frame, mut surfels) = (square(), for_all_clouds());
        let [before, after] = [camera(100.0), camera(400.0)];
        choose(&mut surfels, &frame, &before, 0);
        let made = make(&mut surfels, 50).unwrap();
        assert!(choose(&mut surfels, &frame, &after, 55).is_none());
        surfels.take(&made);
        assert!(choose(&mut surfels, &frame, &after, 60).is_none());
        assert_eq!(surfels.next_deadline(), Some(ms(55) + REST));
        // Nor are results that were requested for another view.
        let mut other = for_all_clouds();
        choose(&mut other, &frame, &before, 0);
        other.take(&made);
        assert!(choose(&mut other, &frame, &before, 60).is_none());
    }

    #[test]
    fn no_surfels_are_made_for_complete_frames_or_for_points() {
        let (frame, mut surfels) = (square(), for_all_clouds());
        let camera = camera(100.0);
        choose(&mut surfels, &frame, &camera, 0);
        let made = make(&mut surfels, 50).unwrap();
        surfels.take(&made);
        let needs = Scene::needs(&Style::default());
        let whole = crate::sequence::complete(&frame, &needs, &PrepareCounters::default());
        assert!(choose(&mut surfels, &Arc::new(whole), &camera, 60).is_none());
        assert!(surfels.made.is_none() && surfels.next_deadline().is_none());

        let points = Style {
            primitive: Primitive::Point,
            ..Style::default()
        };
        let chosen = surfels.choose(&frame, &view(&camera), &points, ms(70));
        assert!(chosen.is_none() && surfels.next_deadline().is_none());
        // Nor are any computed for clouds whose own surfels are ready soon.
        let mut surfels = SurfelsInView::default();
        assert!(choose(&mut surfels, &frame, &camera, 0).is_none());
        assert_eq!(surfels.next_deadline(), None);
    }

    #[test]
    fn an_empty_view_is_not_estimated_repeatedly() {
        let (frame, mut surfels) = (square(), for_all_clouds());
        let mut aside = camera(100.0);
        aside.target_in_world.x += 1e6;
        choose(&mut surfels, &frame, &aside, 0);
        let made = make(&mut surfels, 50).unwrap();
        surfels.take(&made);
        assert!(choose(&mut surfels, &frame, &aside, 60).is_none());
        assert_eq!(surfels.next_deadline(), None);
    }
}
