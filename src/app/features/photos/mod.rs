//! View-dependent texturing: input images are loaded on a thread, and projected on the frame that is drawn.
//!
//! How it works. The source lists the images of a frame; decoding their pixels takes long, so the first frame is shown
//! in the colours of its points until they are available. As long as frames have the same set, it is loaded once. In
//! multi-view video each frame has its own set: the sets of the next frames are loaded ahead, and projected on these
//! frames (`textured.rs`); playing waits for them as for frames, and sets stay cached as long as all of them fit into
//! the budget.

pub(in crate::app) mod frusta;
mod in_window;
pub(in crate::app) mod panel;
mod textured;

pub(in crate::app) use textured::TexturedFrame;

use crate::app::work::outcome::Message;
use crate::app::work::pool::PoolBehindDrawing;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::composition::{PHOTO_BYTES, on_surface};
use crate::messages::grouped;
use crate::photos::{LoadedPhotos, PosedImages, ReprojectionError, ViewSet};
use crate::playback::Player;
use crate::progress::Progress;
use crate::scene::{Scene, Style};
use crate::sequence::{PreparedFrame, Slot};
use crate::source::Source;
use crate::timeline::Direction;
use glam::{DVec3, Vec3};
use std::collections::BTreeSet;
use std::sync::Arc;
use textured::{Parts, TexturedFrames};

impl Message for PhotosLoaded {}

/// A set whose pixels were loaded; `None` if it was cancelled.
#[derive(Debug)]
pub(in crate::app) struct PhotosLoaded(Option<LoadedSet>);

#[derive(Debug)]
struct LoadedSet {
    set: Arc<ViewSet>,
    loaded: LoadedPhotos,
    errors: Vec<Option<ReprojectionError>>,
    /// Those that are used.
    used: Arc<PosedImages>,
}

/// Number of frames whose images are loaded before they are shown.
const FRAMES_AHEAD: usize = 3;

/// Sets of frames that follow each other share the budget: the shown one, those ahead, and some to go back to.
const SHARES: u64 = FRAMES_AHEAD as u64 + 3;

/// View-dependent texturing state of the window.
#[derive(Debug, Default)]
pub struct Photos {
    /// Visibility of the camera frusta in the rendered view.
    pub shows_frusta: bool,
    /// Least recently used first.
    loaded: Vec<LoadedSet>,
    /// The set of the shown frame.
    shown: Option<Arc<ViewSet>>,
    /// Positions that the images of a set look at: a walk over all of its points.
    centers: Option<(Arc<ViewSet>, Arc<[DVec3]>)>,
    running: Option<(Arc<ViewSet>, Progress)>,
    /// Those that are not used, by their numbers.
    off: BTreeSet<usize>,
    /// Frames with them.
    frames: TexturedFrames,
    pool: PoolBehindDrawing,
}

impl Photos {
    /// Numbers of those that are not used.
    pub(in crate::app) fn skipped(&self) -> Vec<usize> {
        self.off.iter().copied().collect()
    }

    /// Returns the position that each image of a set looks at.
    fn centers_of(&mut self, set: &Arc<ViewSet>) -> Arc<[DVec3]> {
        let known = self.centers.take().filter(|(of, _)| Arc::ptr_eq(of, set));
        let known = known.unwrap_or_else(|| (Arc::clone(set), set.centers().into()));
        Arc::clone(&self.centers.insert(known).1)
    }

    /// Returns true if an input image is projected on the surface.
    pub(in crate::app) fn is_used(&self, number: usize) -> bool {
        !self.off.contains(&number)
    }

    /// Returns the reprojection error of an image's camera against its points, once they are loaded.
    pub(in crate::app) fn reprojection_error(&self, number: usize) -> Option<ReprojectionError> {
        self.shown_set()?.errors.get(number).copied().flatten()
    }

    /// Returns the colour gain of an image, once it is loaded.
    pub(in crate::app) fn gain(&self, number: usize) -> Option<Vec3> {
        let posed_images = &self.shown_set()?.loaded.posed_images;
        Some(posed_images.numbered(number)?.gain)
    }

    /// Enables or disables an input image.
    pub(in crate::app) fn set_used(&mut self, number: usize, is_used: bool) {
        let is_changed = if is_used {
            self.off.remove(&number)
        } else {
            self.off.insert(number)
        };
        if is_changed {
            self.use_what_is_on();
        }
    }

    /// Returns true if frame `index` is available with its input images, if it has some that are to be drawn. Before
    /// the first ones are loaded, nothing is waited for.
    pub(in crate::app) fn are_there(&self, source: &dyn Source, index: usize, style: &Style) -> bool {
        if !style.draws_photos() || self.loaded.is_empty() || !source.frames().contains(&index) {
            return true;
        }
        let Some(set) = source.posed_images(index) else {
            return true;
        };
        let used = self.loaded(&set).map(|loaded| &loaded.used);
        used.is_some_and(|used| used.all().is_empty() || self.frames.has(index, used, &style.surfels))
    }

    fn loaded(&self, set: &Arc<ViewSet>) -> Option<&LoadedSet> {
        self.loaded.iter().find(|loaded| Arc::ptr_eq(&loaded.set, set))
    }

    /// Returns the frame with the used ones of its input images, once they are loaded.
    fn parts(&self, frame: &Arc<PreparedFrame>, set: &Arc<ViewSet>, style: &Style) -> Option<Parts> {
        let used = self.loaded(set).map(|loaded| &loaded.used);
        used.filter(|used| !used.all().is_empty()).map(|used| Parts {
            frame: Arc::clone(frame),
            posed_images: Arc::clone(used),
            surfels: style.surfels,
        })
    }

    /// Starts to load the input images of the shown frame, and then of those that follow, if the style draws them, and
    /// to project them on these frames; cancels work that is no longer needed.
    pub(in crate::app) fn follow<T>(&mut self, player: &Player, style: &Style, tasks: &Tasks<T>)
    where
        T: TaskOutcome + From<PhotosLoaded> + From<TexturedFrame>,
    {
        self.shown = player.posed_images();
        let frames = if style.draws_photos() {
            frames_wanted(player)
        } else {
            Vec::new()
        };
        self.load(player, &frames, tasks);
        self.put_on(player, &frames, style, tasks);
    }

    /// Starts to load the input images of the first of `frames` whose images are not available.
    fn load<T: TaskOutcome + From<PhotosLoaded>>(&mut self, player: &Player, frames: &[usize], tasks: &Tasks<T>) {
        let wanted = sets_of(player, frames);
        let is_wanted = |known: &Arc<ViewSet>| wanted.iter().any(|wanted| Arc::ptr_eq(wanted, known));
        if let Some((_, progress)) = self.running.take_if(|(running, _)| !is_wanted(running)) {
            progress.cancel();
        }
        let budget_bytes = match wanted.len() {
            0 | 1 => PHOTO_BYTES,
            _ => PHOTO_BYTES / SHARES,
        };
        // The set wanted first is evicted last.
        for set in wanted.iter().rev() {
            if let Some(at) = self.loaded.iter().position(|loaded| Arc::ptr_eq(&loaded.set, set)) {
                let loaded = self.loaded.remove(at);
                self.loaded.push(loaded);
            }
        }
        let next = wanted.iter().find(|set| self.loaded(set).is_none());
        let Some(set) = next.filter(|_| self.running.is_none()).map(Arc::clone) else {
            return;
        };
        let Some(pool) = self.pool.get("images", 0) else {
            return;
        };
        let progress = Progress::default();
        self.running = Some((Arc::clone(&set), progress.clone()));
        let sequence = Arc::clone(player.sequence());
        tasks.start_in(pool, move || {
            let mut loaded = LoadedPhotos::of(&set, budget_bytes, &progress);
            // The origin may have to be read from the frame first: not on the thread that draws.
            loaded.posed_images = on_surface(loaded.posed_images, &set, &sequence, &progress);
            let errors = set.reprojection_errors();
            let used = Arc::clone(&loaded.posed_images);
            let loaded = LoadedSet {
                set,
                loaded,
                errors,
                used,
            };
            PhotosLoaded((!progress.is_cancelled()).then_some(loaded))
        });
    }

    /// Starts to project images on the frame drawn without them, else on the first of `frames` that lacks them.
    fn put_on<T: TaskOutcome + From<TexturedFrame>>(
        &mut self,
        player: &Player,
        frames: &[usize],
        style: &Style,
        tasks: &Tasks<T>,
    ) {
        let needs = Scene::needs(style);
        let source = player.sequence().source();
        let following = frames.iter().filter_map(|&index| {
            let (Slot::Ready(frame) | Slot::Coarse(frame)) = player.loader().get(index, &needs) else {
                return None;
            };
            self.parts(&frame, &source.posed_images(index)?, style)
        });
        let Some(parts) = self.frames.next(following) else {
            return;
        };
        if let Some(pool) = self.pool.get("images", 0) {
            // The frame is loaded, so this does not have to read it.
            let origin = player.sequence().origin();
            self.frames.start(parts, *style, origin, tasks, pool);
        }
    }

    /// Takes a frame that input images were projected on.
    pub(in crate::app) fn take_frame(&mut self, made: TexturedFrame) {
        self.frames.take_in(made);
    }

    /// Takes loaded input images; returns the errors of others.
    pub(in crate::app) fn take_in(&mut self, PhotosLoaded(loaded): PhotosLoaded) -> Vec<String> {
        let Some(loaded) = loaded else {
            return Vec::new();
        };
        if self
            .running
            .take_if(|(running, _)| Arc::ptr_eq(running, &loaded.set))
            .is_none()
        {
            return Vec::new();
        }
        let notes = loaded.loaded.notes.clone();
        self.free_space(loaded.loaded.posed_images.byte_size());
        self.loaded.push(loaded);
        self.use_what_is_on();
        notes
    }

    /// Returns `frame` with its input images, once that is available.
    pub(in crate::app) fn drawn(
        &mut self,
        frame: &Arc<PreparedFrame>,
        set: Option<&Arc<ViewSet>>,
        style: &Style,
    ) -> Option<&TexturedFrame> {
        let parts = self.parts(frame, set?, style)?;
        self.frames.drawn(parts)
    }

    /// Returns the progress text of the images of the shown frame, while they are loaded and their surface is built.
    pub(in crate::app) fn loading(&self) -> Option<String> {
        let is_shown = |set: &Arc<ViewSet>| self.shown.as_ref().is_some_and(|shown| Arc::ptr_eq(shown, set));
        let (set, progress) = self.running.as_ref().filter(|(set, _)| is_shown(set))?;
        let count = set.photos.len();
        let (done, of) = (progress.done(), progress.of().unwrap_or(count));
        Some(if of <= count {
            format!("Loading image {} of {}", grouped(done), grouped(of))
        } else {
            let percent = 100 * done / of;
            format!("Reconstructing the surface from {count} images, {percent}\u{2009}%")
        })
    }

    fn shown_set(&self) -> Option<&LoadedSet> {
        self.loaded(self.shown.as_ref()?)
    }

    /// Evicts least recently used sets, until one of `bytes` fits into the budget.
    fn free_space(&mut self, bytes: usize) {
        let size = |loaded: &LoadedSet| loaded.loaded.posed_images.byte_size() as u64;
        let mut total = bytes as u64 + self.loaded.iter().map(size).sum::<u64>();
        let mut gone = 0;
        while total > PHOTO_BYTES && gone < self.loaded.len() {
            total -= size(&self.loaded[gone]);
            gone += 1;
        }
        self.loaded.drain(..gone);
    }

    /// Forgets all of them, as another sequence is opened.
    pub(in crate::app) fn forget(&mut self) {
        if let Some((_, progress)) = self.running.take() {
            progress.cancel();
        }
        *self = Self {
            shows_frusta: self.shows_frusta,
            ..Self::default()
        };
    }

    fn use_what_is_on(&mut self) {
        let off = self.skipped();
        for loaded in &mut self.loaded {
            let all = &loaded.loaded.posed_images;
            loaded.used = if off.is_empty() {
                Arc::clone(all)
            } else {
                Arc::new(all.without(&off))
            };
        }
    }
}

/// The frame that is due, the one that is shown, and those that follow.
fn frames_wanted(player: &Player) -> Vec<usize> {
    let clock = player.clock();
    let due = clock.frame();
    let ahead = (1..=FRAMES_AHEAD).filter_map(|step| match clock.direction() {
        Direction::Forward => due.checked_add(step),
        Direction::Backward => due.checked_sub(step),
    });
    let shown = player.shown().map(|shown| shown.index);
    let frames = player.sequence().source().frames();
    let mut wanted: Vec<usize> = Vec::new();
    for index in std::iter::once(due).chain(shown).chain(ahead) {
        if frames.contains(&index) && !wanted.contains(&index) {
            wanted.push(index);
        }
    }
    wanted
}

/// Returns the input image sets of frames, each set once.
fn sets_of(player: &Player, frames: &[usize]) -> Vec<Arc<ViewSet>> {
    let source = player.sequence().source();
    let mut sets: Vec<Arc<ViewSet>> = Vec::new();
    for set in frames.iter().filter_map(|&index| source.posed_images(index)) {
        if !sets.iter().any(|known| Arc::ptr_eq(known, &set)) {
            sets.push(set);
        }
    }
    sets
}
