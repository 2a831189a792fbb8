//! Clipping of the cloud: the frames a box is fitted around, and its outline in the image with handles to drag.

pub(in crate::app) mod handles;
mod in_window;
mod outline;
mod panel;

use crate::math::Aabb;
use crate::scene::{Clip, ClipShape};
use glam::DVec3;

/// Clipping state of the window, in addition to the clip itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clipping {
    /// Visibility of the outline with its handles in the image.
    pub shows_outline: bool,
    /// The shape that was put around all frames: until it is edited, it grows as frames become known.
    around_all: Option<ClipShape>,
    /// Handle being dragged.
    held: Option<Held>,
    /// Bounds of the known frames, at this revision.
    known: Option<(u64, KnownBounds)>,
}

impl Default for Clipping {
    fn default() -> Self {
        Self {
            shows_outline: true,
            around_all: None,
            held: None,
            known: None,
        }
    }
}

/// A handle in the hand.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Held {
    /// Position at the start of the drag.
    place: DVec3,
    /// Distance of the pointer from that position along its line.
    slack: f64,
}

/// Known bounds of all frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::app) struct KnownBounds {
    /// Around the frames that are known, relative to the origin of the sequence.
    pub(in crate::app) bounds: Aabb,
    /// Number of frames with known bounds.
    pub(in crate::app) known: usize,
    /// Total number of frames.
    pub(in crate::app) count: usize,
}

/// The frames that something is put around.
#[derive(Debug, Clone, Copy)]
pub(in crate::app) struct ClippedFrames {
    /// The box around the shown frame.
    pub(in crate::app) shown: Aabb,
    pub(in crate::app) all: KnownBounds,
    /// The origin of positions.
    pub(in crate::app) origin: DVec3,
}

/// Around which frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum ClipFit {
    ThisFrame,
    AllFrames,
}

impl ClippedFrames {
    fn bounds(&self, fit: ClipFit) -> Aabb {
        match fit {
            ClipFit::ThisFrame => self.shown,
            ClipFit::AllFrames => self.all.bounds.union(&self.shown),
        }
    }

    /// The box around the frames.
    pub(in crate::app) fn around(&self, fit: ClipFit) -> ClipShape {
        ClipShape::around(&self.bounds(fit), self.origin)
    }

    /// Creates the plane through the centre of the frames.
    pub(in crate::app) fn through_center(&self, normal: DVec3, fit: ClipFit) -> ClipShape {
        let center = self.origin + self.bounds(fit).center().as_dvec3();
        let offset = normal.dot(center);
        ClipShape::Plane { normal, offset }
    }

    /// Corners of the box around all frames, in the coordinates of the file.
    fn corners(&self) -> [DVec3; 2] {
        let bounds = self.bounds(ClipFit::AllFrames);
        [bounds.min, bounds.max].map(|corner| self.origin + corner.as_dvec3())
    }

    /// Edge of the largest side of the box around all frames, scene units.
    pub(in crate::app) fn extent(&self) -> f64 {
        let extent = self.bounds(ClipFit::AllFrames).extent().max_element();
        f64::from(extent).max(f64::from(f32::MIN_POSITIVE))
    }
}

impl Clipping {
    /// Puts a shape around frames.
    pub(in crate::app) fn fit(&mut self, shape: &mut ClipShape, frames: &ClippedFrames, fit: ClipFit) {
        *shape = match *shape {
            ClipShape::Box { .. } => frames.around(fit),
            ClipShape::Plane { normal, .. } => frames.through_center(normal, fit),
        };
        self.note_fit(*shape, fit);
    }

    /// Takes notice that `shape` was put around frames.
    pub(in crate::app) fn note_fit(&mut self, shape: ClipShape, fit: ClipFit) {
        self.around_all = (fit == ClipFit::AllFrames).then_some(shape);
    }

    /// Returns true if the clip is still as it was put around all frames.
    pub(in crate::app) fn is_around_all(&self, clip: &Clip) -> bool {
        self.around_all == Some(clip.shape)
    }

    /// Extends a box around all frames to those that have become known.
    pub(in crate::app) fn grow(&mut self, clip: &mut Option<Clip>, frames: &ClippedFrames) {
        if let Some(clip) = clip.as_mut()
            && matches!(clip.shape, ClipShape::Box { .. })
            && self.is_around_all(clip)
        {
            self.fit(&mut clip.shape, frames, ClipFit::AllFrames);
        }
    }

    /// The bounds of all frames as of `revision`, found by `find` where that is a later one.
    pub(in crate::app) fn bounds_of_all(&mut self, revision: u64, find: impl FnOnce() -> KnownBounds) -> KnownBounds {
        if let Some((_, known)) = self.known.filter(|(of, _)| *of == revision) {
            return known;
        }
        let known = find();
        self.known = Some((revision, known));
        known
    }

    /// Another sequence is opened.
    pub(in crate::app) fn forget_frames(&mut self) {
        *self = Self {
            shows_outline: self.shows_outline,
            ..Self::default()
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A cube that starts at the origin of the sequence, and one around `known` frames.
    fn frames(edge: f32, known: usize) -> ClippedFrames {
        let cube = |edge: f32| Aabb {
            min: Vec3::ZERO,
            max: Vec3::splat(edge),
        };
        ClippedFrames {
            shown: cube(1.0),
            all: KnownBounds {
                bounds: cube(edge),
                known,
                count: 24,
            },
            origin: DVec3::splat(1e6),
        }
    }

    fn edge_of(clip: Option<Clip>) -> f64 {
        match clip.unwrap().shape {
            ClipShape::Box { min, max } => (max - min).x,
            ClipShape::Plane { .. } => panic!("it is a box"),
        }
    }

    #[test]
    fn a_box_around_all_frames_grows_as_frames_are_read_until_edited() {
        let mut clipping = Clipping::default();
        let shape = frames(3.0, 3).around(ClipFit::AllFrames);
        clipping.note_fit(shape, ClipFit::AllFrames);
        let mut clip = Some(Clip::to(shape));
        assert_eq!(edge_of(clip), 3.0);
        clipping.grow(&mut clip, &frames(24.0, 24));
        assert_eq!(edge_of(clip), 24.0);
        let ClipShape::Box { max, .. } = &mut clip.as_mut().unwrap().shape else {
            panic!("it is a box");
        };
        max.x -= 17.0;
        clipping.grow(&mut clip, &frames(30.0, 24));
        assert_eq!(edge_of(clip), 7.0);
        // Fitted to one frame it does not grow either.
        clipping.fit(&mut clip.as_mut().unwrap().shape, &frames(24.0, 24), ClipFit::ThisFrame);
        clipping.grow(&mut clip, &frames(30.0, 24));
        assert_eq!(edge_of(clip), 1.0);
    }

    #[test]
    fn bounds_are_computed_once_for_the_known_frames() {
        let mut clipping = Clipping::default();
        let known = frames(3.0, 3).all;
        assert_eq!(clipping.bounds_of_all(7, || known), known);
        assert_eq!(clipping.bounds_of_all(7, || panic!("nothing is new")), known);
        let more = frames(4.0, 4).all;
        assert_eq!(clipping.bounds_of_all(8, || more), more);
    }
}
