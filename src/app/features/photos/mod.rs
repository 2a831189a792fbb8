//! Photographs of what is shown: they are loaded on a thread, and put on the frame that is drawn.
//!
//! How it works. The source says which photographs there are of a frame; their pixels take long, so the frame is shown
//! in the colours of its points until they are there. As long as frames have the same set, it is loaded once.

pub(in crate::app) mod frusta;
pub(in crate::app) mod panel;

use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::headless::PHOTOGRAPH_BYTES;
use crate::photos::{LoadedPhotographs, Photographs, ReprojectionError, ViewSet};
use crate::playback::Player;
use crate::progress::Progress;
use crate::scene::Style;
use crate::sequence::PreparedFrame;
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
}

/// What the window knows of photographs.
#[derive(Debug, Default)]
pub struct Photos {
    /// Whether the picture shows where they were taken.
    pub shows_frusta: bool,
    loaded: Option<LoadedSet>,
    /// What the photographs of a set look at: a walk over all of its points.
    middles: Option<(Arc<ViewSet>, Arc<[DVec3]>)>,
    running: Option<(Arc<ViewSet>, Progress)>,
    /// Those that are not used, by their numbers.
    off: BTreeSet<usize>,
    /// Those that are.
    used: Option<Arc<Photographs>>,
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
        self.loaded.as_ref()?.errors.get(number).copied().flatten()
    }

    /// What the colours of a photograph are multiplied with, once it is loaded.
    pub(in crate::app) fn gain(&self, number: usize) -> Option<Vec3> {
        let photographs = &self.loaded.as_ref()?.loaded.photographs;
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

    /// Starts to load the photographs of the shown frame if the style draws them, and ends what nobody waits for.
    pub(in crate::app) fn follow<T: TaskOutcome + From<PhotosLoaded>>(
        &mut self,
        player: &Player,
        style: &Style,
        tasks: &Tasks<T>,
    ) {
        let wanted = Self::set_of(player).filter(|_| style.draws_photographs());
        let is_it = |known: &Arc<ViewSet>| wanted.as_ref().is_some_and(|wanted| Arc::ptr_eq(wanted, known));
        if let Some((_, progress)) = self.running.take_if(|(running, _)| !is_it(running)) {
            progress.cancel();
        }
        let is_known = self.loaded.as_ref().is_some_and(|loaded| is_it(&loaded.set)) || self.running.is_some();
        let Some(set) = wanted.filter(|_| !is_known) else {
            return;
        };
        let progress = Progress::default();
        self.running = Some((Arc::clone(&set), progress.clone()));
        tasks.start("photographs", move || {
            let loaded = LoadedPhotographs::of(&set, PHOTOGRAPH_BYTES, &progress);
            let errors = set.reprojection_errors();
            PhotosLoaded((!progress.is_cancelled()).then_some(LoadedSet { set, loaded, errors }))
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
        self.loaded = Some(loaded);
        self.use_what_is_on();
        notes
    }

    /// `frame` with its photographs, once they are loaded.
    pub(in crate::app) fn dress(
        &mut self,
        frame: &Arc<PreparedFrame>,
        set: Option<&Arc<ViewSet>>,
    ) -> Arc<PreparedFrame> {
        let is_loaded = |set: &Arc<ViewSet>| self.loaded.as_ref().is_some_and(|loaded| Arc::ptr_eq(&loaded.set, set));
        let used = self.used.as_ref().filter(|_| set.is_some_and(is_loaded));
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

    /// How many are loaded of how many, while they are.
    pub(in crate::app) fn loading(&self) -> Option<(usize, usize)> {
        let (set, progress) = self.running.as_ref()?;
        Some((progress.done(), set.photos.len()))
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
        self.used = self.loaded.as_ref().map(|loaded| {
            let all = &loaded.loaded.photographs;
            if off.is_empty() {
                Arc::clone(all)
            } else {
                Arc::new(all.without(&off))
            }
        });
    }
}
