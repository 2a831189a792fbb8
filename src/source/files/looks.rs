//! Files that are being written while their folder is open.
//!
//! **How it works.** A new file is read once it *rests*: two looks in a row find the same size and time. A slow writer
//! may pause for longer, so the stamp under which a file was taken is remembered, and a file with another one is read
//! again as soon as it rests. Of a folder with many frames the newest are looked at each time, the others by turns.
//! Where frames are numbered evenly, one that jumps ahead waits for those before it for a while.

use crate::source::FrameEntry;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

/// Newest frames whose files are looked at each time.
const NEWEST: usize = 64;

/// Older frames that are looked at in addition.
const BY_TURNS: usize = 512;

/// A file as old as this rests at the first look.
const OLD: Duration = Duration::from_secs(3);

/// A file that never rests, as a log does, is taken after this time.
const MAX_UNREST: Duration = Duration::from_secs(30);

/// Maximum wait for frames missing from the numbering.
const MAX_GAP_WAIT: Duration = Duration::from_secs(5);

/// Normals are written within this time after their points.
const NORMALS: Duration = Duration::from_secs(10);

/// Normals rest after this time.
const QUIET: Duration = Duration::from_millis(500);

/// Size and time of a file.
type Stamp = (u64, Option<SystemTime>);

#[derive(Debug)]
struct Seen {
    stamp: Stamp,
    first: Instant,
}

/// Results of earlier folder scans.
#[derive(Debug, Default)]
pub(super) struct Looks {
    /// Files that are not frames yet.
    coming: HashMap<PathBuf, Seen>,
    /// Stamps under which files of frames were taken.
    taken: HashMap<PathBuf, Stamp>,
    /// Stamps of files that changed since, and may still do so.
    changing: HashMap<PathBuf, Stamp>,
    turn: usize,
}

impl Looks {
    /// Frames that were found when their folder was opened.
    pub(super) fn of_opened(entries: &[FrameEntry]) -> Self {
        let mut looks = Self::default();
        for entry in entries.iter().rev().take(NEWEST) {
            looks.note(entry);
        }
        looks
    }

    /// Notes that the file of `entry` is a frame from now on.
    pub(super) fn note(&mut self, entry: &FrameEntry) {
        self.coming.remove(&entry.path);
        if let Some(stamp) = stamp_of(&entry.path) {
            self.taken.insert(entry.path.clone(), stamp);
        }
    }

    /// Indices of `entries` whose files have changed and are no longer changing.
    pub(super) fn changed(&mut self, entries: &[Arc<FrameEntry>]) -> Vec<usize> {
        let newest = entries.len().saturating_sub(NEWEST)..entries.len();
        let older = newest.start;
        let turn = self.turn.min(older)..(self.turn + BY_TURNS).min(older);
        self.turn = if turn.end == older { 0 } else { turn.end };
        newest
            .chain(turn)
            .filter(|&index| self.has_changed(&entries[index]))
            .collect()
    }

    fn has_changed(&mut self, entry: &FrameEntry) -> bool {
        if !entry.is_file() {
            return false;
        }
        // A file that is briefly missing is being replaced.
        let Some(stamp) = stamp_of(&entry.path) else {
            return false;
        };
        let path = &entry.path;
        match self.taken.get(path) {
            None => {
                self.taken.insert(path.clone(), stamp);
                false
            }
            Some(taken) if *taken == stamp => {
                self.changing.remove(path);
                false
            }
            Some(_) if self.changing.get(path) == Some(&stamp) => {
                self.changing.remove(path);
                self.taken.insert(path.clone(), stamp);
                true
            }
            Some(_) => {
                self.changing.insert(path.clone(), stamp);
                false
            }
        }
    }

    /// Returns true if `entry`, which comes next after `entries`, can be appended as a frame now.
    pub(super) fn may_append(
        &mut self,
        entry: &FrameEntry,
        entries: &[Arc<FrameEntry>],
        expects_normals: bool,
    ) -> bool {
        let Some(stamp) = stamp_of(&entry.path) else {
            return false;
        };
        let seen = self.coming.get(&entry.path);
        let first = seen.map_or_else(Instant::now, |seen| seen.first);
        // Two checks, so that a slow writer leaves no broken frame behind.
        let rests = seen.is_some_and(|seen| seen.stamp == stamp) || is_older(&entry.path, OLD);
        self.coming.insert(entry.path.clone(), Seen { stamp, first });
        let has_waited = |max: Duration| first.elapsed() >= max;
        let has_normals = match &entry.normals {
            Some(normals) => is_older(normals, QUIET),
            None => !expects_normals || is_older(&entry.path, NORMALS),
        };
        let is_next = !jumps_ahead(entry, entries) || has_waited(MAX_GAP_WAIT);
        (rests || has_waited(MAX_UNREST)) && has_normals && is_next
    }
}

/// Returns true if a number is missing between `entries`, whose numbers have equal steps, and `entry`.
fn jumps_ahead(entry: &FrameEntry, entries: &[Arc<FrameEntry>]) -> bool {
    const LAST: usize = 3;
    let Some(last) = entries.last_chunk::<LAST>() else {
        return false;
    };
    let [Some(first), Some(second), Some(third)] = last.each_ref().map(|entry| entry.number) else {
        return false;
    };
    let step = third.saturating_sub(second);
    let is_even = step > 0 && second.checked_sub(first) == Some(step);
    is_even && entry.number.is_some_and(|number| number > third + step)
}

/// Returns true if the files of `entry` have not been written to for a while.
pub(super) fn is_quiet(entry: &FrameEntry) -> bool {
    let normals = entry.normals.as_deref();
    is_older(&entry.path, QUIET) && normals.is_none_or(|normals| is_older(normals, QUIET))
}

fn is_older(path: &Path, min: Duration) -> bool {
    let modified = fs::metadata(path).and_then(|metadata| metadata.modified());
    // A clock behind the file's says nothing.
    modified.is_ok_and(|at| at.elapsed().is_ok_and(|age| age >= min))
}

/// `None` for a file that is not there.
fn stamp_of(path: &Path) -> Option<Stamp> {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.len(), metadata.modified().ok()))
}
