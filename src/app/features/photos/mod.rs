//! Photographs of what is shown: they are loaded on a thread, and put on the frame that is drawn.
//!
//! How it works. The source says which photographs there are of a frame; their pixels take long, so the first frame is
//! shown in the colours of its points until they are there. As long as frames have the same set, it is loaded once. Of
//! what was filmed each frame has a set of its own: those of the next frames are loaded ahead, playing waits for them
//! as for frames, and sets are kept as long as all of them fit into the budget.

pub(in crate::app) mod frusta;
pub(in crate::app) mod panel;

use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::headless::PHOTOGRAPH_BYTES;
use crate::photos::{LoadedPhotographs, Photographs, ReprojectionError, ViewSet};
use crate::playback::Player;
use crate::progress::Progress;
use crate::scene::Style;
use crate::sequence::PreparedFrame;
use crate::source::Source;
use crate::stereo::photo_surface;
use crate::timeline::Direction;
use glam::{DVec3, Vec3};
use std::collections::BTreeSet;
use std::sync::Arc;

/// A set whose pixels were loaded; `None` where nobody waits for it any more.
#[derive(Debug)]
pub struct PhotosLoaded(Option<LoadedSet>);

#[derive(Debug)]
struct LoadedSet {
    set: Arc<ViewSet>,
    loaded: LoadedPhotographs,
    errors: Vec<Option<ReprojectionError>>,
    /// Those that are used.
    used: Arc<Photographs>,
}

/// Frames whose photographs are loaded before they are shown.
const FRAMES_AHEAD: usize = 3;

/// Sets of frames that follow each other share the budget: the shown one, those ahead, and some to go back to.
const SHARES: u64 = FRAMES_AHEAD as u64 + 3;

/// What the window knows of photographs.
#[derive(Debug, Default)]
pub struct Photos {
    /// Whether the picture shows where they were taken.
    pub shows_frusta: bool,
    /// The one that was asked for last comes last.
    loaded: Vec<LoadedSet>,
    /// That of the shown frame.
    shown: Option<Arc<ViewSet>>,
    /// What the photographs of a set look at: a walk over all of its points.
    middles: Option<(Arc<ViewSet>, Arc<[DVec3]>)>,
    running: Option<(Arc<ViewSet>, Progress)>,
    /// Those that are not used, by their numbers.
    off: BTreeSet<usize>,
    /// The last frame with them.
    dressed: Option<Dressed>,
}

/// A frame, and the same with photographs.
#[derive(Debug)]
struct Dressed {
    of: Arc<PreparedFrame>,
    frame: Arc<PreparedFrame>,
}

impl Photos {
    /// The photographs of the frame that is shown, as far as they are known.
    pub(in crate::app) fn set_of(player: &Player) -> Option<Arc<ViewSet>> {
        player.sequence().source().photographs(player.shown()?.index)
    }

    /// Numbers of those that are not used.
    pub(in crate::app) fn left_out(&self) -> Vec<usize> {
        self.off.iter().copied().collect()
    }

    /// The place that each photograph of a set looks at.
    fn middles_of(&mut self, set: &Arc<ViewSet>) -> Arc<[DVec3]> {
        let known = self.middles.take().filter(|(of, _)| Arc::ptr_eq(of, set));
        let known = known.unwrap_or_else(|| (Arc::clone(set), set.middles().into()));
        Arc::clone(&self.middles.insert(known).1)
    }

    /// Whether a photograph is put on the surface.
    pub(in crate::app) fn is_used(&self, number: usize) -> bool {
        !self.off.contains(&number)
    }

    /// How well the camera of a photograph fits its points, once they are loaded.
    pub(in crate::app) fn reprojection_error(&self, number: usize) -> Option<ReprojectionError> {
        self.shown_set()?.errors.get(number).copied().flatten()
    }

    /// What the colours of a photograph are multiplied with, once it is loaded.
    pub(in crate::app) fn gain(&self, number: usize) -> Option<Vec3> {
        let photographs = &self.shown_set()?.loaded.photographs;
        Some(photographs.numbered(number)?.gain)
    }

    /// Uses a photograph, or does not.
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

    /// Whether the photographs of frame `index` are there, if it has some that are to be drawn. Before the first ones
    /// are, nothing is waited for.
    pub(in crate::app) fn are_there(&self, source: &dyn Source, index: usize, style: &Style) -> bool {
        if !style.draws_photographs() || self.loaded.is_empty() || !source.frames().contains(&index) {
            return true;
        }
        let set = source.photographs(index);
        set.is_none_or(|set| self.loaded.iter().any(|loaded| Arc::ptr_eq(&loaded.set, &set)))
    }

    /// Starts to load the photographs of the shown frame, and then of those that follow, if the style draws them; ends
    /// what nobody waits for.
    pub(in crate::app) fn follow<T: TaskOutcome + From<PhotosLoaded>>(
        &mut self,
        player: &Player,
        style: &Style,
        tasks: &Tasks<T>,
    ) {
        self.shown = Self::set_of(player);
        let wanted = if style.draws_photographs() {
            wanted(player)
        } else {
            Vec::new()
        };
        let is_wanted = |known: &Arc<ViewSet>| wanted.iter().any(|wanted| Arc::ptr_eq(wanted, known));
        if let Some((_, progress)) = self.running.take_if(|(running, _)| !is_wanted(running)) {
            progress.cancel();
        }
        let budget_bytes = match wanted.len() {
            0 | 1 => PHOTOGRAPH_BYTES,
            _ => PHOTOGRAPH_BYTES / SHARES,
        };
        // What is wanted first is the last to go.
        for set in wanted.iter().rev() {
            if let Some(at) = self.loaded.iter().position(|loaded| Arc::ptr_eq(&loaded.set, set)) {
                let loaded = self.loaded.remove(at);
                self.loaded.push(loaded);
            }
        }
        let is_loaded = |set: &Arc<ViewSet>| self.loaded.iter().any(|loaded| Arc::ptr_eq(&loaded.set, set));
        let next = wanted.iter().find(|set| !is_loaded(set));
        let Some(set) = next.filter(|_| self.running.is_none()).map(Arc::clone) else {
            return;
        };
        let progress = Progress::default();
        self.running = Some((Arc::clone(&set), progress.clone()));
        // Of what was filmed, each frame has a cloud of its own.
        let sequence = player.sequence();
        let origin = (sequence.len() == 1).then(|| sequence.origin());
        tasks.start("photographs", move || {
            let mut loaded = LoadedPhotographs::of(&set, budget_bytes, &progress);
            if let Some(origin) = origin {
                let surface = photo_surface(&set, &loaded.photographs, origin, &progress);
                loaded.photographs = Arc::new(loaded.photographs.with_surface(surface));
            }
            let errors = set.reprojection_errors();
            let used = Arc::clone(&loaded.photographs);
            let loaded = LoadedSet {
                set,
                loaded,
                errors,
                used,
            };
            PhotosLoaded((!progress.is_cancelled()).then_some(loaded))
        });
    }

    /// Takes photographs that were loaded; what was wrong with others.
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
        self.make_room(loaded.loaded.photographs.byte_size());
        self.loaded.push(loaded);
        self.use_what_is_on();
        notes
    }

    /// `frame` with its photographs, once they are loaded.
    pub(in crate::app) fn dress(
        &mut self,
        frame: &Arc<PreparedFrame>,
        set: Option<&Arc<ViewSet>>,
    ) -> Arc<PreparedFrame> {
        let loaded = set.and_then(|set| self.loaded.iter().find(|loaded| Arc::ptr_eq(&loaded.set, set)));
        let used = loaded.map(|loaded| &loaded.used);
        let Some(used) = used.filter(|used| !used.all().is_empty()) else {
            return Arc::clone(frame);
        };
        let known = self.dressed.take().filter(|dressed| {
            let has = dressed.frame.photographs.as_ref();
            Arc::ptr_eq(&dressed.of, frame) && has.is_some_and(|has| Arc::ptr_eq(has, used))
        });
        let dressed = known.unwrap_or_else(|| Dressed {
            of: Arc::clone(frame),
            frame: Arc::new(frame.with_photographs(Arc::clone(used))),
        });
        Arc::clone(&self.dressed.insert(dressed).frame)
    }

    /// How much of those of the shown frame is done of how much, while they are loaded and their surface is made.
    pub(in crate::app) fn loading(&self) -> Option<(usize, usize)> {
        let is_shown = |set: &Arc<ViewSet>| self.shown.as_ref().is_some_and(|shown| Arc::ptr_eq(shown, set));
        let (set, progress) = self.running.as_ref().filter(|(set, _)| is_shown(set))?;
        Some((progress.done(), progress.of().unwrap_or(set.photos.len())))
    }

    fn shown_set(&self) -> Option<&LoadedSet> {
        let shown = self.shown.as_ref()?;
        self.loaded.iter().find(|loaded| Arc::ptr_eq(&loaded.set, shown))
    }

    /// Forgets sets that nobody asked for in a long time, until one of `bytes` fits into the budget.
    fn make_room(&mut self, bytes: usize) {
        let size = |loaded: &LoadedSet| loaded.loaded.photographs.byte_size() as u64;
        let mut total = bytes as u64 + self.loaded.iter().map(size).sum::<u64>();
        let mut gone = 0;
        while total > PHOTOGRAPH_BYTES && gone < self.loaded.len() {
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
        let off = self.left_out();
        for loaded in &mut self.loaded {
            let all = &loaded.loaded.photographs;
            loaded.used = if off.is_empty() {
                Arc::clone(all)
            } else {
                Arc::new(all.without(&off))
            };
        }
    }
}

/// The sets of the frame that is due, of the one that is shown, and of those that follow, each once.
fn wanted(player: &Player) -> Vec<Arc<ViewSet>> {
    let source = player.sequence().source();
    let (clock, frames) = (player.clock(), source.frames());
    let due = clock.frame();
    let ahead = (1..=FRAMES_AHEAD).filter_map(|step| match clock.direction() {
        Direction::Forward => due.checked_add(step),
        Direction::Backward => due.checked_sub(step),
    });
    let shown = player.shown().map(|shown| shown.index);
    let mut wanted: Vec<Arc<ViewSet>> = Vec::new();
    for index in std::iter::once(due).chain(shown).chain(ahead) {
        let set = frames.contains(&index).then(|| source.photographs(index)).flatten();
        let is_new = |set: &Arc<ViewSet>| !wanted.iter().any(|known| Arc::ptr_eq(known, set));
        if let Some(set) = set.filter(is_new) {
            wanted.push(set);
        }
    }
    wanted
}
