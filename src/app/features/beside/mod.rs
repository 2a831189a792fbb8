//! A second sequence beside the open one: the same camera, settings and clock, its own frames.
//!
//! How it works. A [`Companion`] brings the frames that belong to those of the player; here is how its picture is laid
//! out, drawn and compared. Both clouds stay where their files say: each is drawn relative to the origin of its
//! sequence, which is one for both wherever that loses nothing. Distances of the two clouds are measured on a thread,
//! when a person asks for them.

pub(in crate::app) mod panel;

use super::comparison::PicturePair;
use crate::app::drawing::Drawing;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::app::work::works::Progress;
use crate::measure::Change;
use crate::playback::{Companion, Player, PlayerChange};
use crate::scene::Style;
use crate::sequence::PreparedFrame;
use egui::{Pos2, Rect};
use glam::{DVec3, Vec3};
use std::sync::Arc;
use std::time::Duration;

/// The narrowest half, as a share of the width.
const NARROWEST: f32 = 0.1;

/// How two pictures are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Each in a half of its own.
    SideBySide,
    /// One over the other, with a line between them.
    Wipe,
}

/// The second sequence.
#[derive(Debug)]
pub struct Beside {
    /// Its frames.
    pub companion: Companion,
    /// What people know it by.
    pub name: String,
    /// How both are laid out.
    pub layout: Layout,
    /// Both pictures; compared where they are of the same view and size, one over the other.
    pub pictures: PicturePair,
    pub(in crate::app) drawing: Drawing,
    distances: Option<FrameDistances>,
    /// Frames whose distances are being measured, and the work on that.
    measuring: Option<([u64; 2], Progress)>,
    /// Where both are has been looked at.
    knows_gap: bool,
}

/// How far the points of one frame are from those of another, scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneWay {
    /// Mean distance to the nearest point.
    pub mean: f64,
    /// Root of the mean of their squares.
    pub root_mean_squared: f64,
    /// The largest one.
    pub largest: f64,
}

/// How far two frames are from each other, scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameDistances {
    /// From each point of A to the nearest of B.
    pub from_a: OneWay,
    /// From each point of B to the nearest of A.
    pub from_b: OneWay,
    /// The frames, by [`PreparedFrame::id`].
    ids: [u64; 2],
}

impl FrameDistances {
    /// The Hausdorff distance: the larger of both largest.
    pub fn hausdorff(&self) -> f64 {
        self.from_a.largest.max(self.from_b.largest)
    }
}

impl Beside {
    /// Side by side in equal halves.
    pub(in crate::app) fn new(companion: Companion, name: String) -> Self {
        Self {
            companion,
            name,
            layout: Layout::SideBySide,
            pictures: PicturePair::default(),
            drawing: Drawing::default(),
            distances: None,
            measuring: None,
            knows_gap: false,
        }
    }

    /// Moves both on: what has changed about the player's frames, and about those of B.
    pub(in crate::app) fn update(
        &mut self,
        player: &mut Player,
        now: Duration,
        settings: &Style,
    ) -> [PlayerChange; 2] {
        let companion = &mut self.companion;
        let of_a = player.update_beside(now, settings, |clock, is_playing| {
            companion.prepare(clock, is_playing, settings)
        });
        // While playing waits, both stay as they are: two frames that belong together.
        let is_held = player.is_playing() && player.waiting_for().is_some();
        let of_b = if is_held {
            PlayerChange::default()
        } else {
            companion.show(settings)
        };
        if self.ids(player) != self.measuring.as_ref().map(|(ids, _)| *ids) {
            self.cancel();
        }
        [of_a, of_b]
    }

    /// Takes notice that one of the pictures is another one. They are compared where they are one over the other.
    pub(in crate::app) fn note_change(&mut self, now: Duration) {
        if self.layout == Layout::Wipe && self.companion.shown().is_some() {
            self.pictures.note_change(now);
        } else {
            self.pictures.forget_difference();
        }
    }

    /// Chooses how both are laid out.
    pub(in crate::app) fn lay_out(&mut self, layout: Layout) {
        self.layout = layout;
        let range = self.line_range();
        self.pictures.split = self.pictures.split.clamp(*range.start(), *range.end());
        self.pictures.forget_difference();
    }

    /// Where the pictures of A and of B are within `rect`: the same place, or a half each.
    pub(in crate::app) fn places(&self, rect: Rect, line: f32) -> [Rect; 2] {
        match self.layout {
            Layout::SideBySide => [rect.with_max_x(line), rect.with_min_x(line)],
            Layout::Wipe => [rect; 2],
        }
    }

    /// How far the line between the pictures may go, as shares of the width.
    pub(in crate::app) fn line_range(&self) -> std::ops::RangeInclusive<f32> {
        match self.layout {
            Layout::SideBySide => NARROWEST..=1.0 - NARROWEST,
            Layout::Wipe => 0.0..=1.0,
        }
    }

    /// Whether `place` in a picture over `rect` is on B's side of the line.
    pub(in crate::app) fn is_of_b(&self, place: Pos2, places: [Rect; 2]) -> bool {
        match self.layout {
            Layout::SideBySide => places[1].contains(place) && !places[0].contains(place),
            Layout::Wipe => place.x >= places[0].left() + self.pictures.split * places[0].width(),
        }
    }

    /// Looks once where both clouds are, as soon as both are here: how far their boxes are from each other, if they do
    /// not meet.
    pub(in crate::app) fn take_gap(&mut self, player: &Player) -> Option<f64> {
        if self.knows_gap {
            return None;
        }
        let (a, b) = (player.shown()?, self.companion.shown()?);
        self.knows_gap = true;
        let shift = self.shift_from(player);
        let (a, b) = (a.frame.bounds(), b.frame.bounds());
        let [a_min, a_max, b_min, b_max] = [a.min, a.max, b.min, b.max].map(Vec3::as_dvec3);
        let gap = (b_min + shift - a_max).max(a_min - b_max - shift);
        let gap = gap.max(DVec3::ZERO).length();
        (gap > 0.0 && gap.is_finite()).then_some(gap)
    }

    /// From places relative to the origin of A to the same relative to that of B.
    pub(in crate::app) fn shift_from(&self, player: &Player) -> DVec3 {
        self.companion.sequence().origin() - player.sequence().origin()
    }

    /// The distances of the shown frames, if they were measured.
    pub fn distances(&self, player: &Player) -> Option<&FrameDistances> {
        let ids = self.ids(player);
        self.distances
            .as_ref()
            .filter(|known| ids == Some(known.ids))
    }

    /// Whether distances are being measured.
    pub fn is_measuring(&self) -> bool {
        self.measuring.is_some()
    }

    /// The frames to measure: both are here, have points, and all that their files have.
    pub(in crate::app) fn whole_frames<'a>(
        &'a self,
        player: &'a Player,
    ) -> Option<[&'a Arc<PreparedFrame>; 2]> {
        let frames = [player.shown()?, self.companion.shown()?];
        frames
            .iter()
            .all(|frame| !frame.is_sample() && !frame.frame.is_empty())
            .then_some(frames)
    }

    /// Measures the distances of the shown frames on a thread; nothing happens while they are not whole.
    pub(in crate::app) fn measure<T: TaskOutcome + From<Option<FrameDistances>>>(
        &mut self,
        player: &Player,
        tasks: &Tasks<T>,
    ) {
        let Some([a, b]) = self.whole_frames(player) else {
            return;
        };
        let (a, b, ids) = (Arc::clone(a), Arc::clone(b), [a.id, b.id]);
        let shift = self.shift_from(player);
        self.cancel();
        let progress = Progress::default();
        self.measuring = Some((ids, progress.clone()));
        tasks.start("distances", move || {
            between(&a, &b, shift, || !progress.is_cancelled())
        });
    }

    /// Takes the answer, unless other frames are shown by now.
    pub(in crate::app) fn take_in(&mut self, distances: FrameDistances) {
        if self
            .measuring
            .take_if(|(ids, _)| *ids == distances.ids)
            .is_some()
        {
            self.distances = Some(distances);
        }
    }

    fn cancel(&mut self) {
        if let Some((_, progress)) = self.measuring.take() {
            progress.cancel();
        }
    }

    fn ids(&self, player: &Player) -> Option<[u64; 2]> {
        Some([player.shown()?.id, self.companion.shown()?.id])
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// The distances of two frames, of which the origin of the second is `shift` away from that of the first; `None` if one
/// has no points, or once nobody waits.
fn between(
    a: &PreparedFrame,
    b: &PreparedFrame,
    shift: DVec3,
    is_wanted: impl Fn() -> bool + Sync,
) -> Option<FrameDistances> {
    let places_a = a.frame.positions();
    let moved: Vec<Vec3>;
    let places_b = if shift == DVec3::ZERO {
        b.frame.positions()
    } else {
        let move_one = |place: &Vec3| (place.as_dvec3() + shift).as_vec3();
        moved = b.frame.positions().iter().map(move_one).collect();
        &moved
    };
    let one_way = |from: &[Vec3], to: &[Vec3]| {
        let change = Change::between(from, to, &is_wanted).filter(|_| !from.is_empty())?;
        Some(OneWay {
            mean: change.mean,
            root_mean_squared: change.root_mean_squared(),
            largest: f64::from(change.largest()),
        })
    };
    Some(FrameDistances {
        from_a: one_way(places_a, places_b)?,
        from_b: one_way(places_b, places_a)?,
        ids: [a.id, b.id],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Frame, Positions, RawCloud};
    use crate::sequence::{Needs, PrepareCounters, prepare};

    /// A row of 100 points one unit apart, relative to `origin`.
    fn row(height: f64, origin: DVec3, outlier: Option<f64>) -> PreparedFrame {
        let place = |x: u32| [f64::from(x), height, 0.0];
        let mut places: Vec<[f64; 3]> = (0..100).map(place).collect();
        places.extend(outlier.map(|z| [0.0, height, z]));
        let raw = RawCloud::from_positions(Positions::F64(places));
        let frame = Arc::new(Frame::from_raw(raw, origin).unwrap());
        prepare(
            0,
            frame,
            0.0,
            &Needs::default(),
            &PrepareCounters::default(),
        )
    }

    #[test]
    fn rows_with_a_known_shift_have_known_distances() {
        let a = row(0.0, DVec3::ZERO, None);
        for origin in [DVec3::ZERO, DVec3::new(64.0, -8.0, 16.0)] {
            let b = row(0.25, origin, None);
            let found = between(&a, &b, origin, || true).unwrap();
            let quarter = OneWay {
                mean: 0.25,
                root_mean_squared: 0.25,
                largest: 0.25,
            };
            assert_eq!((found.from_a, found.from_b), (quarter, quarter));
            assert_eq!(found.hausdorff(), 0.25);
        }
    }

    #[test]
    fn what_only_one_has_is_far_from_the_other_one_way() {
        let (a, b) = (
            row(0.0, DVec3::ZERO, None),
            row(0.0, DVec3::ZERO, Some(101.0)),
        );
        let found = between(&a, &b, DVec3::ZERO, || true).unwrap();
        assert_eq!((found.from_a.mean, found.from_a.largest), (0.0, 0.0));
        assert_eq!(found.from_b.mean, 1.0, "one of 101 is 101 away");
        let expected = 101f64.sqrt();
        assert!((found.from_b.root_mean_squared - expected).abs() < 1e-12);
        assert_eq!(found.hausdorff(), 101.0);
        assert!(between(&a, &b, DVec3::ZERO, || false).is_none());
    }
}
