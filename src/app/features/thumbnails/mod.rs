//! Thumbnails of frames, on a strip over the timeline and in its tooltips.
//!
//! **How it works.** One thumbnail at a time is rendered on its own thread, from points in memory where available, else
//! from the file. [`schedule`] determines the next frame and when there is time for it: while frames are played only
//! frames in memory are drawn, at most ten thumbnails per second, and nothing while playing falls behind or a benchmark
//! runs; files are read when nothing is played and no frame is being prepared. Thumbnails are cached in 16 MiB
//! ([`store`]).
//!
//! All are rendered from one view, so that motion is visible: the first view of the sequence ([`FirstLook`]). It stays
//! until the up axis or the source of the colours changes, or a user asks for new thumbnails.

mod draw;
mod in_window;
pub(in crate::app) mod panel;
mod schedule;
mod store;

pub(in crate::app) use schedule::strip_frames;
pub(in crate::app) use store::{MAX_CELLS, PICTURE_PX, ThumbnailState};

use crate::app::work::outcome::Message;
use crate::app::work::pool::PoolBehindDrawing;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::playback::Player;
use crate::scene::{Camera, FirstLook, UpAxis};
use crate::sequence::{ColorHints, Coloring, FrameError, Needs, Slot};
use draw::{Material, Thumbnail, ThumbnailJob};
use egui::Context;
use schedule::{Bustle, Leisure, WantedFrames};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use store::Store;

/// Min time between thumbnails while playing.
const INTERVAL: Duration = Duration::from_millis(100);

/// Frames shown at less than this share of the requested rate are not in time.
const IN_TIME: f64 = 0.9;

/// Up axis and colours: common to all thumbnails.
type ThumbnailKey = (UpAxis, Coloring, ColorHints);

/// The thumbnails of the open sequence.
#[derive(Debug)]
pub struct Thumbnails {
    /// Thumbnail generation and visibility.
    pub is_on: bool,
    wanted: WantedFrames,
    store: Store,
    key: Option<ThumbnailKey>,
    view: Option<Camera>,
    /// Generation of thumbnails, to recognise results of an old one.
    generation: u64,
    is_busy: bool,
    /// Time at which the last thumbnail was begun.
    begun: Option<Duration>,
    pool: PoolBehindDrawing,
    /// File for the next thumbnail.
    keep_at: Option<PathBuf>,
}

impl Message for Box<Delivery> {}

/// Thumbnail that the thread has rendered for a frame.
#[derive(Debug)]
pub struct Delivery {
    generation: u64,
    frame: usize,
    made: Thumbnail,
}

impl Default for Thumbnails {
    fn default() -> Self {
        Self::new(true)
    }
}

impl Thumbnails {
    pub(in crate::app) fn new(is_on: bool) -> Self {
        Self {
            is_on,
            wanted: WantedFrames::default(),
            store: Store::default(),
            key: None,
            view: None,
            generation: 0,
            is_busy: false,
            begun: None,
            pool: PoolBehindDrawing::default(),
            keep_at: None,
        }
    }

    /// Number of frames of the strip that have their thumbnail or mark, and of all frames of the strip.
    pub fn progress(&self) -> [usize; 2] {
        let strip = &self.wanted.strip;
        let made = strip.iter().filter(|&&frame| self.store.has(frame));
        [made.count(), strip.len()]
    }

    /// Bytes of all cached thumbnails.
    pub fn byte_size(&self) -> usize {
        self.store.bytes()
    }

    /// Forgets all thumbnails, so that they are regenerated, from an up-to-date view.
    pub fn redo(&mut self) {
        self.store = Store::default();
        self.view = None;
        self.generation += 1;
    }

    /// The file of `frame` has changed: its thumbnail or mark is out of date.
    pub(in crate::app) fn forget_frame(&mut self, frame: usize) {
        self.store.forget(frame);
    }

    /// Another sequence was opened.
    pub(in crate::app) fn forget_frames(&mut self) {
        self.wanted = WantedFrames::default();
        self.keep_at = None;
        self.redo();
    }

    /// Has the next thumbnail of the open sequence written to a file, for the list of recent inputs.
    pub(in crate::app) fn keep_next_at(&mut self, file: Option<PathBuf>) {
        self.keep_at = file;
    }

    /// The window is another one.
    pub(in crate::app) fn forget_textures(&mut self) {
        self.store.forget_textures();
    }

    /// Says which frames the strip shows.
    pub(in crate::app) fn want(&mut self, strip: Vec<usize>) {
        self.wanted.strip = strip;
    }

    /// Sets the frame under the pointer: its thumbnail is made first.
    pub(in crate::app) fn hover(&mut self, frame: Option<usize>) {
        self.wanted.hovered = frame;
    }

    /// Returns the thumbnail state of `frame` in the window of `ctx`.
    pub(in crate::app) fn look(&mut self, ctx: &Context, frame: usize) -> ThumbnailState {
        self.store.look(ctx, frame)
    }

    /// Begins the next thumbnail, if one is missing and there is time for it.
    pub(in crate::app) fn follow<T: TaskOutcome + From<Box<Delivery>>>(
        &mut self,
        player: &Player,
        look: &FirstLook,
        key: ThumbnailKey,
        is_measured: bool,
        tasks: &Tasks<T>,
        now: Duration,
    ) {
        if !self.is_on || self.is_busy || self.wanted.strip.is_empty() {
            return;
        }
        if self.key.replace(key) != Some(key) {
            self.redo();
        }
        let [made, all] = self.progress();
        if made == all && self.wanted.hovered.is_none_or(|frame| self.store.has(frame)) {
            return;
        }
        let leisure = bustle(player, is_measured).leisure();
        let is_early = self.begun.is_some_and(|begun| now < begun + INTERVAL);
        if leisure == Leisure::None || (player.is_playing() && is_early) {
            return;
        }
        let Some((frame, material)) = self.next(player, key, leisure) else {
            return;
        };
        let view = *self.view.get_or_insert_with(|| {
            let [width, height] = PICTURE_PX.map(f64::from);
            look.camera_with_up(key.0, player.sequence().origin(), width / height)
        });
        self.begun = Some(now);
        let job = ThumbnailJob {
            material,
            view,
            colors: (key.1, key.2),
            sequence: Arc::clone(player.sequence()),
        };
        self.start(frame, job, tasks);
    }

    /// The next frame there is time for.
    fn next(&mut self, player: &Player, key: ThumbnailKey, leisure: Leisure) -> Option<(usize, Material)> {
        let loader = player.loader();
        let needs = Needs {
            colors: key.1,
            hints: key.2,
            ..Needs::default()
        };
        let mut material = None;
        let mut broken = Vec::new();
        let frame = self.wanted.next(
            player.clock().frame(),
            |frame| self.store.has(frame),
            |&frame| {
                material = match loader.get(frame, &needs) {
                    Slot::Ready(frame) | Slot::Coarse(frame) => Some(Material::Resident(frame)),
                    // The frame is not broken, but it is gone and cannot be drawn any more.
                    Slot::Failed(error) if matches!(*error, FrameError::Gone { .. }) => None,
                    Slot::Failed(_) => {
                        broken.push(frame);
                        None
                    }
                    // A frame with other colours will soon be recoloured.
                    Slot::Partial(_) | Slot::Stale(_) | Slot::Pending => {
                        let is_there = player.sequence().frames().contains(&frame);
                        let may_be_read = is_there && leisure == Leisure::Reading;
                        may_be_read.then_some(Material::File(frame))
                    }
                };
                material.is_some()
            },
        );
        for frame in broken {
            self.store.mark_broken(frame);
        }
        Some((frame?, material?))
    }

    fn start<T: TaskOutcome + From<Box<Delivery>>>(&mut self, frame: usize, job: ThumbnailJob, tasks: &Tasks<T>) {
        // One thread of low priority: thumbnails take no time from drawing or from preparing frames.
        let Some(pool) = self.pool.get("thumbnails", 1) else {
            self.is_on = false;
            return;
        };
        self.is_busy = true;
        let generation = self.generation;
        let keep_at = self.keep_at.take();
        tasks.start_in(pool, move || {
            let made = job.run();
            if let Some(file) = keep_at {
                made.keep(&file);
            }
            Box::new(Delivery {
                generation,
                frame,
                made,
            })
        });
    }

    /// Takes the result of the thread, unless it is of an old generation.
    pub(in crate::app) fn take_in(&mut self, delivery: Delivery) {
        self.is_busy = false;
        if delivery.generation != self.generation {
            return;
        }
        let frame = delivery.frame;
        match delivery.made {
            Thumbnail::Picture(image) => self.store.insert(frame, image, &self.wanted.all()),
            Thumbnail::Broken => self.store.mark_broken(frame),
        }
    }
}

fn bustle(player: &Player, is_measured: bool) -> Bustle {
    let asked = player.clock().fps() * player.clock().speed().abs();
    let is_whole = player.shown().is_some_and(|frame| !frame.is_sample());
    let is_held = player.fps_held().is_some_and(|held| held >= IN_TIME * asked);
    Bustle {
        is_measured,
        is_playing: player.is_playing(),
        keeps_up: is_whole && is_held && player.waiting_for().is_none(),
        is_loading: player.loader().is_busy(),
    }
}
