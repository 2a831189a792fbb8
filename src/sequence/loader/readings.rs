//! The frames that are being read, for those who want to see how far that is, and to end it.

use crate::locks::lock;
use crate::progress::Progress;
use std::sync::Mutex;

/// Stage of the work on a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReadingStage {
    /// It is read, and prepared as far as images need it.
    Frame,
    /// Some of its points can be shown, and all of them, with their number, are being read.
    AllPoints(usize),
    /// Its points can be shown, and their normals and radii are being estimated, and all else they lack.
    Normals,
    /// Its points can be shown, and its triangles are being read.
    Mesh,
    /// Its points can be shown, and an octree of them is being made.
    Octree,
}

/// A frame that is being read and prepared.
#[derive(Debug, Clone)]
pub struct Reading {
    /// Index of the frame that it is read for: the first one is read for any, as it decides the origin.
    pub index: usize,
    /// Current stage.
    pub stage: ReadingStage,
    /// Progress: how much of the frame is read, then how much of it is decoded, then the progress of its normal
    /// estimation if it has none.
    pub progress: Progress,
}

/// All of one loader.
#[derive(Debug, Default)]
pub(super) struct Readings(Mutex<List>);

#[derive(Debug, Default)]
struct List {
    under_way: Vec<Entry>,
    /// One was read.
    has_read: bool,
    /// Somebody has cancelled one.
    was_cancelled: bool,
    /// None is wanted any more.
    is_over: bool,
}

#[derive(Debug)]
struct Entry {
    reading: Reading,
    /// True if the result is not needed any more. It is cancelled, but not by a user.
    is_superseded: bool,
}

impl Entry {
    fn was_cancelled(&self) -> bool {
        !self.is_superseded && self.reading.progress.is_cancelled()
    }
}

impl List {
    fn was_cancelled(&self) -> bool {
        self.was_cancelled || self.under_way.iter().any(Entry::was_cancelled)
    }
}

/// A reading that is under way as long as this is there.
pub(super) struct UnderWay<'a> {
    readings: &'a Readings,
    pub(super) progress: Progress,
}

impl Readings {
    /// Frame `index` is about to be read. Where nothing is wanted any more, or the first one was cancelled, that is
    /// cancelled at once.
    pub(super) fn begin(&self, index: usize, stage: ReadingStage) -> UnderWay<'_> {
        let progress = Progress::default();
        let mut list = lock(&self.0);
        if list.is_over || (!list.has_read && list.was_cancelled()) {
            progress.cancel();
        }
        let reading = Reading {
            index,
            stage,
            progress: progress.clone(),
        };
        list.under_way.push(Entry {
            reading,
            is_superseded: false,
        });
        UnderWay {
            readings: self,
            progress,
        }
    }

    /// Readings that do not wait for others.
    pub(super) fn list(&self) -> Vec<Reading> {
        let list = lock(&self.0);
        let wanted = list.under_way.iter().filter(|entry| !entry.is_superseded);
        let begun = wanted.filter(|entry| entry.reading.progress.has_begun());
        begun.map(|entry| entry.reading.clone()).collect()
    }

    /// Ends readings that add to frames which are already complete for the present needs.
    pub(super) fn supersede(&self, is_complete: impl Fn(usize) -> bool) {
        let adds = |stage| matches!(stage, ReadingStage::Normals | ReadingStage::Mesh | ReadingStage::Octree);
        for entry in &mut lock(&self.0).under_way {
            let reading = &entry.reading;
            if adds(reading.stage) && !reading.progress.is_cancelled() && is_complete(reading.index) {
                entry.is_superseded = true;
                reading.progress.cancel();
            }
        }
    }

    /// Returns true if one of them was cancelled, even if it is over.
    pub(super) fn was_cancelled(&self) -> bool {
        lock(&self.0).was_cancelled()
    }

    /// Ends all of them, and those to come.
    pub(super) fn end(&self) {
        let mut list = lock(&self.0);
        list.is_over = true;
        for entry in &list.under_way {
            entry.reading.progress.cancel();
        }
    }
}

impl UnderWay<'_> {
    /// Its file is read and decoded.
    pub(super) fn note_read(&self) {
        lock(&self.readings.0).has_read = true;
    }

    /// Returns true if its result is superseded: its additions are no longer needed.
    pub(super) fn is_superseded(&self) -> bool {
        let list = lock(&self.readings.0);
        let mut under_way = list.under_way.iter();
        under_way.any(|entry| entry.is_superseded && entry.reading.progress.is_same(&self.progress))
    }
}

impl Drop for UnderWay<'_> {
    fn drop(&mut self) {
        let mut list = lock(&self.readings.0);
        let is_this = |entry: &mut Entry| entry.reading.progress.is_same(&self.progress);
        let ended: Vec<Entry> = list.under_way.extract_if(.., is_this).collect();
        list.was_cancelled |= ended.iter().any(Entry::was_cancelled);
    }
}
