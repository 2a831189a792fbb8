//! Trails: trajectories of picked points, or of points spread over the frame.
//!
//! How it works. All of them are found together by one task, which visits every frame from in to out point
//! ([`crate::composition::Trails`]) and can be cancelled between two. Another task begins only when the one before has
//! ended, so that no more than one frame is being read for it.

mod in_window;
pub(in crate::app) mod panel;

use super::inspection::{Anchor, Inspection};
use crate::analysis::ColorMap;
use crate::app::work::outcome::Message;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::composition::{self, TrailLook, TrailMeasure, TrailRequest};
use crate::document::{MeasuredPoint, ShownTrails, SpreadTrails};
use crate::playback::Player;
use crate::progress::Progress;
use crate::sequence::{Needs, PreparedFrame, Slot};
use glam::DVec3;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Weak};

/// Trails of points that are spread evenly over the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrailField {
    /// Visibility of the trails.
    pub is_on: bool,
    /// Number of points.
    pub points: usize,
    /// Number of frames before the shown one.
    pub length: usize,
}

impl TrailField {
    /// Most trails.
    pub const MAX_POINTS: usize = 500;
    /// Longest trails, frames.
    pub const MAX_LENGTH: usize = 240;
}

/// Trail request to be computed.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Wish {
    request: TrailRequest,
    /// The number of picked points, which come first.
    picked: usize,
}

/// A running task.
#[derive(Debug)]
struct Running {
    wish: Wish,
    /// Progress over the visited frames.
    progress: Progress,
}

impl Message for Traced {}

/// Result of a trail task; `None` if it was cancelled.
#[derive(Debug)]
pub struct Traced(Option<composition::Trails>);

/// Trails: the selection shown, and their known data.
#[derive(Debug)]
pub struct Trails {
    /// True if the trails of the picked points are shown.
    pub is_on: bool,
    /// Points whose trails stay when others are picked.
    pub pinned: Vec<Anchor>,
    /// Trails of other points.
    pub field: TrailField,
    /// The frame whose points [`Trails::field`] is of, and how many its file has.
    field_of: Option<(usize, usize)>,
    running: Option<Running>,
    found: Option<(Wish, composition::Trails)>,
}

impl Default for Trails {
    fn default() -> Self {
        Self {
            is_on: false,
            pinned: Vec::new(),
            field: TrailField {
                is_on: false,
                points: 100,
                length: 24,
            },
            field_of: None,
            running: None,
            found: None,
        }
    }
}

impl Trails {
    /// Returns the trails, if they are known for the current request.
    pub fn found(&self) -> Option<&composition::Trails> {
        self.found.as_ref().map(|(_, trails)| trails)
    }

    /// Returns true if trails are drawn, or are to be.
    pub(in crate::app) fn are_shown(&self) -> bool {
        self.is_on || self.field.is_on || !self.pinned.is_empty()
    }

    /// Numbers of visited frames and of all, while trails are being found.
    pub fn progress(&self) -> Option<(usize, usize)> {
        let running = self.running.as_ref()?;
        let progress = &running.progress;
        (!progress.is_cancelled()).then(|| (progress.done(), running.wish.request.frames.len()))
    }

    /// Length and speeds of the trail of the point of this index in the file, if it is among the picked ones.
    pub fn measure(&self, index_in_file: u32, time_s: impl Fn(usize) -> f64) -> Option<TrailMeasure> {
        let (wish, trails) = self.found.as_ref()?;
        let picked = &wish.request.indices[..wish.picked];
        let trail = picked.iter().position(|&index| index == index_in_file)?;
        trails.measure(trail, time_s)
    }

    /// The trails of picked points, and of others.
    pub(in crate::app) fn parts(&self) -> [Range<usize>; 2] {
        let Some((wish, trails)) = &self.found else {
            return [0..0, 0..0];
        };
        let count = trails.trail_count();
        let picked = wish.picked.min(count);
        [0..picked, picked..count]
    }

    /// Returns the appearance of all trails.
    pub(in crate::app) fn looks(&self) -> Vec<TrailLook> {
        let [picked, others] = self.parts();
        let count = others.len();
        let other = |(number, trail): (usize, usize)| {
            let [red, green, blue, _] = ColorMap::Viridis.color(field_place(number, count));
            TrailLook {
                trail,
                tint: [red, green, blue],
                length: Some(self.field.length),
            }
        };
        let others = others.enumerate().map(other);
        picked.map(TrailLook::picked).chain(others).collect()
    }

    /// Keeps the trail of a point, or lets it go.
    pub fn toggle_pinned(&mut self, anchor: Anchor) {
        let is_same = |pinned: &Anchor| pinned.index_in_file == anchor.index_in_file;
        match self.pinned.iter().position(is_same) {
            Some(place) => _ = self.pinned.remove(place),
            None => self.pinned.push(anchor),
        }
    }

    /// Cancels the running task: no trails are shown.
    pub fn cancel(&mut self) {
        self.is_on = false;
        self.field.is_on = false;
        self.stop();
    }

    fn stop(&mut self) {
        if let Some(running) = &self.running {
            running.progress.cancel();
        }
    }

    /// The requested trails, as in a document.
    pub(in crate::app) fn shown(&self) -> ShownTrails {
        ShownTrails {
            of_picked: self.is_on,
            pinned: self.pinned.iter().filter_map(Anchor::measured).collect(),
            spread: self.field.is_on.then_some(SpreadTrails {
                points: self.field.points,
                frames: self.field.length,
            }),
        }
    }

    /// Asks for the trails of a document. Points that are known already stay as they were picked.
    pub(in crate::app) fn show(&mut self, shown: &ShownTrails) {
        self.is_on = shown.of_picked;
        let before = std::mem::take(&mut self.pinned);
        let anchor = |point: &MeasuredPoint| {
            let known = before.iter().find(|anchor| anchor.point() == point.point);
            known.copied().unwrap_or_else(|| Anchor::of(point))
        };
        self.pinned = shown.pinned.iter().map(anchor).collect();
        self.field.is_on = shown.spread.is_some();
        if let Some(SpreadTrails { points, frames }) = shown.spread {
            self.field.points = points.clamp(1, TrailField::MAX_POINTS);
            self.field.length = frames.clamp(1, TrailField::MAX_LENGTH);
        }
    }

    /// Forgets the points, as another sequence is opened.
    pub(in crate::app) fn forget_points(&mut self) {
        self.stop();
        self.pinned.clear();
        self.field_of = None;
        self.found = None;
    }

    /// Starts a task for requested trails that are not known. True if other trails are to be drawn.
    pub(in crate::app) fn follow<T: TaskOutcome + From<Traced>>(
        &mut self,
        player: &Player,
        inspection: &Inspection,
        tasks: &Tasks<T>,
    ) -> bool {
        let wish = self.wish(player, inspection);
        let is_known = self.found.as_ref().map(|(known, _)| known) == wish.as_ref();
        let had_some = self.found.is_some();
        if !is_known {
            self.found = None;
        }
        match wish.filter(|_| !is_known) {
            None => self.stop(),
            Some(wish) => match &self.running {
                Some(running) if running.wish == wish && self.progress().is_some() => {}
                Some(_) => self.stop(),
                None => self.start(wish, player, tasks),
            },
        }
        had_some && self.found.is_none()
    }

    /// The points that are followed, and through which frames; `None` if there are none.
    fn wish(&mut self, player: &Player, inspection: &Inspection) -> Option<Wish> {
        let shown = player.shown()?;
        if !self.field.is_on {
            self.field_of = None;
        } else if self.field_of.is_none() {
            self.field_of = Some((shown.index, shown.frame.points_in_file()));
        }
        let picked: Vec<Anchor> = if self.is_on {
            let points = inspection.picked();
            self.pinned.iter().copied().chain(points).collect()
        } else {
            Vec::new()
        };
        // Based on the newest pick where frames have different numbers of points.
        let newest = inspection.point.as_ref().map(|point| point.anchor);
        let first = newest.filter(|_| self.is_on).or(picked.last().copied());
        let (chosen_in, points_in_file) = first
            .map(|anchor| (anchor.clicked_in, anchor.points_in_file))
            .or(self.field_of)?;
        let mut indices: Vec<u32> = Vec::new();
        for anchor in picked {
            let is_new = !indices.contains(&anchor.index_in_file);
            if is_new && anchor.points_in_file == points_in_file {
                indices.push(anchor.index_in_file);
            }
        }
        let picked = indices.len();
        if self.field.is_on {
            let spread = spread(points_in_file, self.field.points);
            indices.extend(spread);
        }
        let frames = player.clock().range().of(player.sequence().len());
        let request = TrailRequest {
            indices,
            chosen_in,
            points_in_file,
            frames,
        };
        Some(Wish { request, picked })
    }

    fn start<T: TaskOutcome + From<Traced>>(&mut self, wish: Wish, player: &Player, tasks: &Tasks<T>) {
        let wake = tasks.wake();
        let progress = Progress::told_to(move |_| wake());
        let request = wish.request.clone();
        let sequence = Arc::clone(player.sequence());
        let resident = resident(player, &request);
        self.running = Some(Running {
            wish,
            progress: progress.clone(),
        });
        tasks.start("trails", move || {
            let resident = |index: usize| resident.get(&index).and_then(Weak::upgrade);
            let trails = composition::Trails::trace(&request, &sequence, resident, &progress);
            Traced(trails)
        });
    }

    /// Takes the result of a task, unless the request has changed.
    pub(in crate::app) fn take_in(&mut self, traced: Traced) {
        let Some(running) = self.running.take() else {
            return;
        };
        if let Some(trails) = traced.0
            && !running.progress.is_cancelled()
        {
            self.found = Some((running.wish, trails));
        }
    }
}

/// Trails of a field have the colours of the map from here on: the first ones are as dark as the background.
const FIRST_COLOR: f32 = 0.3;

/// Returns the colour map position of one of `count` trails of a field, 0 to 1.
pub(in crate::app) fn field_place(number: usize, count: usize) -> f32 {
    FIRST_COLOR + (1.0 - FIRST_COLOR) * (number as f32 + 0.5) / count as f32
}

/// Evenly chosen indices of the points of a file.
fn spread(points_in_file: usize, count: usize) -> impl Iterator<Item = u32> {
    let count = count.min(points_in_file);
    (0..count).map(move |number| {
        let place = (2 * number as u64 + 1) * points_in_file as u64 / (2 * count as u64);
        place as u32
    })
}

/// Frames that are in memory with all their points. They may still be evicted.
fn resident(player: &Player, request: &TrailRequest) -> BTreeMap<usize, Weak<PreparedFrame>> {
    let frames = request.frames.clone().chain([request.chosen_in]);
    let frame = |index| match player.loader().get(index, &Needs::default()) {
        Slot::Ready(frame) | Slot::Partial(frame) | Slot::Stale(frame) if !frame.is_sample() => {
            Some((index, Arc::downgrade(&frame)))
        }
        _ => None,
    };
    frames.filter_map(frame).collect()
}

/// A trail in the coordinates of the file, piece by piece as it is connected, of some frames.
pub(in crate::app) fn pieces(
    trails: &composition::Trails,
    trail: usize,
    frames: Range<usize>,
    origin: DVec3,
) -> Vec<Vec<DVec3>> {
    let mut pieces: Vec<Vec<DVec3>> = Vec::new();
    let mut is_connected = false;
    for frame in frames {
        let place = trails.place(trail, frame);
        if let Some(place) = place {
            let place = origin + place.as_dvec3();
            match pieces.last_mut().filter(|_| is_connected) {
                Some(piece) => piece.push(place),
                None => pieces.push(vec![place]),
            }
        }
        is_connected = place.is_some();
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_field_are_spread_evenly() {
        let found = |points, count| spread(points, count).collect::<Vec<_>>();
        assert_eq!(found(100, 4), [12, 37, 62, 87]);
        assert_eq!(found(3, 500), [0, 1, 2]);
        assert_eq!(found(0, 500), [0; 0]);
        let largest = crate::cloud::Frame::MAX_POINTS;
        assert!(found(largest, 500).is_sorted_by(|a, b| a < b));
    }
}
