//! Second sequence for comparison next to the open one: the same camera, settings and clock, its own frames.
//!
//! How it works. A [`Companion`] provides the frames that belong to those of the player; here its image is laid out,
//! drawn and compared. Both clouds stay at the coordinates of their files: each is drawn relative to the origin of its
//! sequence, which is a common one wherever that loses nothing. Distances of the two clouds are measured on a thread,
//! when a user asks for them.

mod distances;
mod in_window;
pub(in crate::app) mod panel;

pub use distances::{FrameDistances, OneWay};

use super::comparison::PicturePair;
use crate::app::drawing::Drawing;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::app::work::works::Progress;
use crate::playback::{Companion, Player, PlayerChange};
use crate::scene::Style;
use crate::sequence::PreparedFrame;
use distances::between;
use egui::{Pos2, Rect};
use glam::{DVec3, Vec3};
use std::sync::Arc;
use std::time::Duration;

/// The narrowest half, as a share of the width.
const NARROWEST: f32 = 0.1;

/// Layout of two images.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Each in a half of its own.
    SideBySide,
    /// One over the other, with a line between them.
    Wipe,
}

/// The second sequence.
#[derive(Debug)]
pub struct SplitView {
    /// Its frames.
    pub companion: Companion,
    /// Display name.
    pub name: String,
    /// Layout of both images.
    pub layout: Layout,
    /// Both images; compared where they have the same view and size, one over the other.
    pub pictures: PicturePair,
    pub(in crate::app) drawing: Drawing,
    distances: Option<FrameDistances>,
    /// Frames whose distances are being measured, and the work on that.
    measuring: Option<([u64; 2], Progress)>,
    /// True if the gap between both has been checked.
    knows_gap: bool,
}

impl SplitView {
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

    /// Advances both; returns changes of the player's frames, and of B's.
    pub(in crate::app) fn update(&mut self, player: &mut Player, now: Duration, style: &Style) -> [PlayerChange; 2] {
        let companion = &mut self.companion;
        let of_a = player.update_with_companion(now, style, |clock, is_playing| {
            companion.prepare(clock, is_playing, style)
        });
        // While playback is stalled, both sides keep their frames, which belong together.
        let is_held = player.is_playing() && player.waiting_for().is_some();
        let of_b = if is_held {
            PlayerChange::default()
        } else {
            companion.show(style)
        };
        if self.ids(player) != self.measuring.as_ref().map(|(ids, _)| *ids) {
            self.cancel();
        }
        [of_a, of_b]
    }

    /// Records that one of the images changed. They are compared where they are one over the other.
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

    /// Computes the rectangles of the images of A and of B within `rect`: the same rectangle, or a half each.
    pub(in crate::app) fn places(&self, rect: Rect, line: f32) -> [Rect; 2] {
        match self.layout {
            Layout::SideBySide => [rect.with_max_x(line), rect.with_min_x(line)],
            Layout::Wipe => [rect; 2],
        }
    }

    /// Returns the range of the line between the images, as fractions of the width.
    pub(in crate::app) fn line_range(&self) -> std::ops::RangeInclusive<f32> {
        match self.layout {
            Layout::SideBySide => NARROWEST..=1.0 - NARROWEST,
            Layout::Wipe => 0.0..=1.0,
        }
    }

    /// Returns true if `place` in an image over `rect` is on B's side of the line.
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

    /// Shift from positions relative to the origin of A to positions relative to B's.
    pub(in crate::app) fn shift_from(&self, player: &Player) -> DVec3 {
        self.companion.sequence().origin() - player.sequence().origin()
    }

    /// The distances of the shown frames, if they were measured.
    pub fn distances(&self, player: &Player) -> Option<&FrameDistances> {
        let ids = self.ids(player);
        self.distances.as_ref().filter(|known| ids == Some(known.ids))
    }

    /// Returns true if distances are being measured.
    pub fn is_measuring(&self) -> bool {
        self.measuring.is_some()
    }

    /// The frames to measure: both are here, have points, and all that their files have.
    pub(in crate::app) fn whole_frames<'a>(&'a self, player: &'a Player) -> Option<[&'a Arc<PreparedFrame>; 2]> {
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
        tasks.start("distances", move || between(&a, &b, shift, || !progress.is_cancelled()));
    }

    /// Takes the answer, unless other frames are shown by now.
    pub(in crate::app) fn take_in(&mut self, distances: FrameDistances) {
        if self.measuring.take_if(|(ids, _)| *ids == distances.ids).is_some() {
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

impl Drop for SplitView {
    fn drop(&mut self) {
        self.cancel();
    }
}
