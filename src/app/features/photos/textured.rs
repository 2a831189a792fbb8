//! View-dependent texturing of frames: frames with input images on them.
//!
//! How it works. To texture a frame, outliers are searched and splats are curved with the surface, then its depths from
//! each image are rendered. All of it takes longer than rendering a frame, so it is done on threads: for the drawn
//! frame first, then for the frames that follow it. Until that is available, a frame is drawn in the colours of its
//! points, or as it was before: of fewer points, with other images, or with smaller disks.

use crate::app::work::outcome::Message;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::composition::{Composed, DepthsAhead, Frames, Inputs, Lane, Request};
use crate::photos::{LoadedPhotos, PosedImages};
use crate::progress::Progress;
use crate::render::depths_of_photos;
use crate::scene::{PhotoMode, Style, SurfelStyle};
use crate::sequence::PreparedFrame;
use glam::DVec3;
use rayon::ThreadPool;
use std::sync::Arc;

/// Number of cached frames, however large they are: the shown one, those ahead, and some to go back to.
const RETAINED: usize = 6;

/// Budget for keeping more frames, as long as all take no more than this together: a short multi-view video is played
/// over and over.
const RETAINED_BYTES: usize = 256 << 20;

/// Parts of a textured frame.
#[derive(Debug, Clone)]
pub(super) struct Parts {
    pub(super) frame: Arc<PreparedFrame>,
    pub(super) posed_images: Arc<PosedImages>,
    /// Depths are of disks of this size.
    pub(super) surfels: SurfelStyle,
}

impl PartialEq for Parts {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.frame, &other.frame)
            && Arc::ptr_eq(&self.posed_images, &other.posed_images)
            && self.surfels == other.surfels
    }
}

/// Input images that are projected on one frame.
#[derive(Debug)]
struct Loaded<'a> {
    posed_images: &'a Arc<PosedImages>,
    ahead: DepthsAhead,
}

impl Frames for Loaded<'_> {
    fn posed_images(&self, _index: usize, _skipped: &[usize]) -> Option<LoadedPhotos> {
        Some(LoadedPhotos {
            posed_images: Arc::clone(self.posed_images),
            notes: Vec::new(),
        })
    }

    fn depths_ahead(&self) -> Option<DepthsAhead> {
        Some(self.ahead)
    }
}

impl Message for TexturedFrame {}

/// Frame with input images projected on it.
#[derive(Debug, Clone)]
pub(in crate::app) struct TexturedFrame {
    of: Parts,
    /// As if the frame were the pose.
    composed: Composed,
}

impl TexturedFrame {
    fn new(of: Parts, style: Style, origin: DVec3) -> Self {
        // The other side of a comparison may show images where this one does not.
        let style = style.with(|style| {
            style.of_sequence.has_photos = true;
            style.photos.mode = PhotoMode::Vdts;
        });
        let loaded = Loaded {
            posed_images: &of.posed_images,
            ahead: DepthsAhead {
                style,
                origin,
                draw: depths_of_photos,
            },
        };
        let inputs = Inputs::of_photos(&of.frame, &style, &loaded);
        let request = Request::gather(Lane::Photos, &of.frame, &inputs);
        let composed = request.and_then(|request| request.run(&Progress::default()));
        let composed = composed.map_or_else(|| Composed::of(Arc::clone(&of.frame)), |(composed, _)| composed);
        Self { of, composed }
    }

    /// Returns the textured frame.
    pub(in crate::app) fn frame(&self) -> &Arc<PreparedFrame> {
        &self.composed.frame
    }

    /// Composes the texturing on `pose`, which the frame was made from.
    pub(in crate::app) fn composed(&self, pose: &Arc<PreparedFrame>) -> Composed {
        Composed {
            pose: Arc::clone(pose),
            ..self.composed.clone()
        }
    }

    /// Returns the frame that the images were projected on.
    pub(in crate::app) fn bare(&self) -> &Arc<PreparedFrame> {
        &self.of.frame
    }

    fn byte_size(&self) -> usize {
        let depths = self.composed.depths.as_ref();
        self.composed.frame.byte_size() + depths.map_or(0, |depths| depths.byte_size())
    }
}

/// Finished frames, and the one being made.
#[derive(Debug, Default)]
pub(super) struct TexturedFrames {
    /// Least recently used first.
    made: Vec<TexturedFrame>,
    running: Option<Parts>,
    /// Parts drawn without input images, or with others.
    drawn_without: Option<Parts>,
}

impl TexturedFrames {
    /// Returns the frame that is drawn. Until that is available, the same with other images, or its substitute: a
    /// coarse copy becomes the whole frame when playing stops.
    pub(super) fn drawn(&mut self, parts: Parts) -> Option<&TexturedFrame> {
        let is_same_frame = |made: &TexturedFrame| Arc::ptr_eq(&made.of.frame, &parts.frame);
        let is_same_pose = |made: &TexturedFrame| made.of.frame.index == parts.frame.index;
        let exact = self.made.iter().position(|made| made.of == parts);
        let at = exact
            .or_else(|| self.made.iter().rposition(is_same_frame))
            .or_else(|| self.made.iter().rposition(is_same_pose));
        if exact.is_none() {
            self.drawn_without = Some(parts);
        }
        let made = self.made.remove(at?);
        self.made.push(made);
        self.made.last()
    }

    /// Returns true if the frame at `index` is available with these images.
    pub(super) fn has(&self, index: usize, posed_images: &Arc<PosedImages>, surfels: &SurfelStyle) -> bool {
        self.made.iter().any(|made| {
            let of = &made.of;
            of.frame.index == index && Arc::ptr_eq(&of.posed_images, posed_images) && of.surfels == *surfels
        })
    }

    /// Returns the next parts to texture, if nothing is under way: the drawn ones if they lack it, else the first of
    /// `following` that is not available.
    pub(super) fn next(&self, following: impl Iterator<Item = Parts>) -> Option<Parts> {
        if self.running.is_some() {
            return None;
        }
        let is_missing = |parts: &Parts| !self.made.iter().any(|made| made.of == *parts);
        self.drawn_without.iter().cloned().chain(following).find(is_missing)
    }

    /// Starts to make a frame of `parts`.
    pub(super) fn start<T: TaskOutcome + From<TexturedFrame>>(
        &mut self,
        parts: Parts,
        style: Style,
        origin: DVec3,
        tasks: &Tasks<T>,
        pool: &ThreadPool,
    ) {
        self.drawn_without = None;
        self.running = Some(parts.clone());
        tasks.start_in(pool, move || TexturedFrame::new(parts, style, origin));
    }

    /// Takes one that was made, unless all were forgotten meanwhile.
    pub(super) fn take_in(&mut self, made: TexturedFrame) {
        if self.running.take_if(|running| *running == made.of).is_none() {
            return;
        }
        self.made.push(made);
        let mut bytes: usize = self.made.iter().map(TexturedFrame::byte_size).sum();
        while self.made.len() > RETAINED && bytes > RETAINED_BYTES {
            bytes -= self.made.remove(0).byte_size();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Frame, Positions, RawCloud};
    use crate::sequence::{Needs, PrepareCounters, prepare};

    fn frame(index: usize) -> Arc<PreparedFrame> {
        let raw = RawCloud::from_positions(Positions::F32(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        let frame = Arc::new(Frame::from_raw(raw, DVec3::ZERO).unwrap());
        Arc::new(prepare(
            index,
            frame,
            0.0,
            &Needs::default(),
            &PrepareCounters::default(),
        ))
    }

    fn parts(frame: &Arc<PreparedFrame>, posed_images: &Arc<PosedImages>) -> Parts {
        Parts {
            frame: Arc::clone(frame),
            posed_images: Arc::clone(posed_images),
            surfels: SurfelStyle::default(),
        }
    }

    fn made(of: &Parts) -> TexturedFrame {
        TexturedFrame::new(of.clone(), Style::default(), DVec3::ZERO)
    }

    #[test]
    fn a_coarse_frame_is_drawn_until_the_complete_one_is_ready() {
        let posed_images = Arc::new(PosedImages::new(Vec::new(), None));
        let (coarse, whole, other) = (frame(3), frame(3), frame(4));
        let of_coarse = parts(&coarse, &posed_images);
        let mut frames = TexturedFrames {
            made: vec![made(&of_coarse), made(&parts(&other, &posed_images))],
            ..TexturedFrames::default()
        };
        let is_drawn = |frames: &mut TexturedFrames, parts: &Parts, expected: &Arc<PreparedFrame>| {
            let drawn = frames
                .drawn(parts.clone())
                .map(|drawn| Arc::ptr_eq(drawn.bare(), expected));
            assert_eq!(drawn, Some(true));
        };
        is_drawn(&mut frames, &of_coarse, &coarse);
        assert!(frames.drawn_without.is_none());
        let of_whole = parts(&whole, &posed_images);
        is_drawn(&mut frames, &of_whole, &coarse);
        assert!(frames.drawn_without.as_ref() == Some(&of_whole), "it is made first");
        let following = || std::iter::once(parts(&frame(7), &posed_images));
        frames.running = frames.next(following());
        assert!(frames.running.as_ref() == Some(&of_whole) && frames.next(following()).is_none());
        frames.take_in(made(&of_whole));
        // It was drawn without images in the meantime, and is not built again.
        let next = frames.next(following()).unwrap();
        assert_eq!(next.frame.index, 7);
        is_drawn(&mut frames, &of_whole, &whole);
        // With other images, the frame itself is used instead, and not its coarse copy.
        let others = Arc::new(PosedImages::new(Vec::new(), None));
        is_drawn(&mut frames, &parts(&whole, &others), &whole);
        assert!(frames.drawn(parts(&frame(5), &posed_images)).is_none());
    }

    #[test]
    fn small_frames_stay_cached_and_unrequested_ones_are_dropped() {
        let posed_images = Arc::new(PosedImages::new(Vec::new(), None));
        let mut frames = TexturedFrames::default();
        for index in 0..2 * RETAINED {
            let of = parts(&frame(index), &posed_images);
            frames.running = Some(of.clone());
            frames.take_in(made(&of));
        }
        assert_eq!(frames.made.len(), 2 * RETAINED);
        assert!(frames.has(0, &posed_images, &SurfelStyle::default()));
        frames.take_in(made(&parts(&frame(99), &posed_images)));
        assert!(!frames.has(99, &posed_images, &SurfelStyle::default()));
    }
}
