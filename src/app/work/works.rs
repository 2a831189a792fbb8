//! Progress of long-running work: a bar with the remaining time, and cancellation.
//!
//! **How it works.** The worker thread reports the finished part of the work through a [`Progress`]; the window checks
//! it when it is woken, and measures the rate between the first and the last observed step. Preparation, such as
//! opening a GPU device, does not count towards the rate. The work is over when its thread has dropped the
//! [`Progress`].

pub use crate::progress::Progress;

use std::time::Duration;

/// Work that takes less shows no bar, which would only flash.
const UNSEEN: Duration = Duration::from_millis(300);

/// Delay before the reading of an awaited frame is shown as work: users who step through slow frames expect them.
const UNSEEN_READING: Duration = Duration::from_secs(1);

/// Kinds of long work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorkKind {
    /// Frames are being found.
    Open,
    /// A frame is being read.
    Read,
    /// An image or a video is being written.
    Export,
    /// A sequence is being saved.
    Save,
    /// A benchmark is running.
    Benchmark,
}

/// So much was done when the window looked.
#[derive(Debug, Clone, Copy)]
struct ProgressMark {
    at: Duration,
    done: usize,
}

/// Long work as the window sees it.
#[derive(Debug)]
pub struct Work {
    /// Kind of work.
    pub kind: WorkKind,
    /// Display name of the work.
    pub name: String,
    progress: Progress,
    begun: Duration,
    /// When something was first done, and last.
    seen: Option<(ProgressMark, ProgressMark)>,
}

impl Work {
    /// Work that begins at `now`, and the progress for its thread.
    pub fn begin(kind: WorkKind, name: String, now: Duration) -> (Self, Progress) {
        let progress = Progress::default();
        (Self::of(kind, name, progress.clone(), now), progress)
    }

    /// Work that is first seen at `now`.
    fn of(kind: WorkKind, name: String, progress: Progress, now: Duration) -> Self {
        Self {
            kind,
            name,
            progress,
            begun: now,
            seen: None,
        }
    }

    /// Returns the progress of the work.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// The finished share of it, 0 to 1; `None` while unknown.
    pub fn share(&self) -> Option<f32> {
        let of = self.progress.of()?;
        Some((self.progress.done() as f32 / of as f32).min(1.0))
    }

    /// Checks the progress at `now`.
    pub fn look(&mut self, now: Duration) {
        let done = self.progress.done();
        let seen = ProgressMark { at: now, done };
        self.seen = match self.seen {
            Some((first, last)) if done == last.done => Some((first, last)),
            Some((first, last)) if done > last.done => Some((first, seen)),
            // The count started over, as with work in several stages.
            Some(_) | None => (done > 0).then_some((seen, seen)),
        };
    }

    /// The time that is left at `now`, by the measured pace; `None` while there is none.
    pub fn time_left(&self, now: Duration) -> Option<Duration> {
        let (first, last) = self.seen?;
        let took_s = last.at.saturating_sub(first.at).as_secs_f64();
        let steps = last.done - first.done;
        if steps == 0 || took_s == 0.0 {
            return None;
        }
        // Between the first and the last step observed: opening a device or decoding a first frame does not count.
        let step_s = took_s / steps as f64;
        let steps_left = self.progress.of()?.saturating_sub(last.done);
        // A step that takes longer than the others does not reduce the time left for those that follow.
        let since_s = now.saturating_sub(last.at).as_secs_f64().min(step_s);
        let left_s = step_s * steps_left as f64 - since_s;
        Duration::try_from_secs_f64(left_s.max(0.0)).ok()
    }

    /// True once its thread has let go of it.
    fn has_ended(&self) -> bool {
        self.progress.is_alone()
    }

    /// Returns true if it takes long enough to be shown.
    pub fn is_long(&self, now: Duration) -> bool {
        now >= self.shown_at()
    }

    fn shown_at(&self) -> Duration {
        self.begun
            + match self.kind {
                WorkKind::Read => UNSEEN_READING,
                WorkKind::Open | WorkKind::Export | WorkKind::Save | WorkKind::Benchmark => UNSEEN,
            }
    }
}

impl Drop for Work {
    /// Cancels the work: its result is no longer needed.
    fn drop(&mut self) {
        self.progress.cancel();
    }
}

/// All work with a bar.
#[derive(Debug, Default)]
pub struct Works {
    list: Vec<Work>,
}

impl Works {
    /// Adds work that begins at `now`; its thread reports through the returned progress.
    pub fn begin(&mut self, kind: WorkKind, name: String, now: Duration) -> Progress {
        let (work, progress) = Work::begin(kind, name, now);
        self.list.push(work);
        progress
    }

    /// Notes work that others have begun, unless it is known.
    pub(in crate::app) fn watch(
        &mut self,
        kind: WorkKind,
        name: impl FnOnce() -> String,
        progress: &Progress,
        now: Duration,
    ) {
        let is_known = |work: &Work| work.progress.is_same(progress);
        if !self.list.iter().any(is_known) {
            let progress = progress.clone();
            self.list.push(Work::of(kind, name(), progress, now));
        }
    }

    /// Returns the work in progress, oldest first.
    pub fn list(&self) -> &[Work] {
        &self.list
    }

    /// Returns true if work of this kind is in progress.
    pub fn has(&self, kind: WorkKind) -> bool {
        self.list.iter().any(|work| work.kind == kind)
    }

    /// Asks all work of this kind to stop.
    pub fn cancel(&self, kind: WorkKind) {
        for work in self.list.iter().filter(|work| work.kind == kind) {
            work.progress.cancel();
        }
    }

    /// Checks the progress at `now`, and forgets finished work. True if a bar appears or disappears.
    pub(in crate::app) fn look(&mut self, before: Duration, now: Duration) -> bool {
        let is_shown = |works: &[Work], at| works.iter().filter(|work| work.is_long(at)).count();
        let shown_before = is_shown(&self.list, before);
        self.list.retain(|work| !work.has_ended());
        for work in &mut self.list {
            work.look(now);
        }
        is_shown(&self.list, now) != shown_before
    }

    /// When work begins to be shown that is not yet.
    pub(in crate::app) fn next_deadline(&self, now: Duration) -> Option<Duration> {
        let hidden = self.list.iter().filter(|work| !work.is_long(now));
        hidden.map(Work::shown_at).min()
    }
}

/// The time left as display text.
pub(in crate::app) fn left_text(left: Option<Duration>) -> String {
    let Some(left) = left else {
        return "…".to_owned();
    };
    // Rounded up to whole seconds.
    let seconds = left.as_secs() + u64::from(left.subsec_nanos() > 0);
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    match hours {
        0 => format!("{minutes}:{seconds:02} left"),
        _ => format!("{hours}:{minutes:02}:{seconds:02} left"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: f64) -> Duration {
        Duration::from_secs_f64(seconds)
    }

    /// Work of `of` steps, with the numbers done at some seconds.
    fn work(of: usize, steps: &[(f64, usize)]) -> Work {
        let (mut work, progress) = Work::begin(WorkKind::Export, "Work".to_owned(), at(0.0));
        for &(seconds, done) in steps {
            progress.set(done, of);
            work.look(at(seconds));
        }
        work
    }

    #[test]
    fn time_left_follows_the_observed_rate() {
        // Ten seconds of opening, then two seconds per step.
        let work = work(10, &[(5.0, 0), (10.0, 1), (12.0, 2), (14.0, 3)]);
        assert_eq!(work.share(), Some(0.3));
        assert_eq!(work.time_left(at(14.0)), Some(at(14.0)));
        assert_eq!(work.time_left(at(15.0)), Some(at(13.0)));
        // The fourth step takes longer: six more follow in any case.
        assert_eq!(work.time_left(at(20.0)), Some(at(12.0)));
    }

    #[test]
    fn unmeasured_rates_are_not_guessed() {
        assert_eq!(work(10, &[]).time_left(at(9.0)), None);
        assert_eq!(work(10, &[(1.0, 0)]).time_left(at(9.0)), None);
        assert_eq!(work(10, &[(1.0, 4)]).time_left(at(9.0)), None);
        assert_eq!(work(10, &[(1.0, 4), (1.0, 5)]).time_left(at(9.0)), None);
        let nobody_knows = work(0, &[(1.0, 4), (2.0, 5)]);
        assert_eq!(nobody_knows.share(), None);
        assert_eq!(nobody_knows.time_left(at(9.0)), None);
        // The second stage is measured from scratch.
        let stages = [(1.0, 1), (2.0, 9), (3.0, 1)];
        assert_eq!(work(10, &stages).time_left(at(3.0)), None);
        let stages = [(1.0, 1), (2.0, 9), (3.0, 1), (6.0, 2)];
        assert_eq!(work(10, &stages).time_left(at(6.0)), Some(at(24.0)));
        assert_eq!(work(3, &[(1.0, 1), (2.0, 3)]).time_left(at(2.0)), Some(at(0.0)));
        assert_eq!(work(3, &[(1.0, 5)]).share(), Some(1.0));
    }

    #[test]
    fn times_are_readable() {
        assert_eq!(left_text(None), "…");
        assert_eq!(left_text(Some(at(0.0))), "0:00 left");
        assert_eq!(left_text(Some(at(13.2))), "0:14 left");
        assert_eq!(left_text(Some(at(200.0))), "3:20 left");
        assert_eq!(left_text(Some(at(3765.0))), "1:02:45 left");
    }

    #[test]
    fn long_work_is_shown_until_its_thread_finishes() {
        let mut works = Works::default();
        let progress = works.begin(WorkKind::Open, "Opening".to_owned(), at(1.0));
        assert_eq!(works.next_deadline(at(1.0)), Some(at(1.3)));
        assert!(!works.look(at(1.0), at(1.2)));
        assert!(works.look(at(1.2), at(1.3)), "it begins to be shown");
        assert_eq!(works.next_deadline(at(1.3)), None);
        works.cancel(WorkKind::Export);
        assert!(!progress.is_cancelled());
        works.cancel(WorkKind::Open);
        assert!(progress.is_cancelled());
        assert!(works.has(WorkKind::Open));
        drop(progress);
        assert!(works.look(at(1.3), at(2.0)), "it is no longer shown");
        assert!(works.list().is_empty());
        // Work that ends before it would be shown is never shown.
        drop(works.begin(WorkKind::Open, String::new(), at(3.0)));
        assert!(!works.look(at(3.0), at(3.1)));
    }

    #[test]
    fn unneeded_work_is_cancelled() {
        let (work, progress) = Work::begin(WorkKind::Benchmark, String::new(), at(0.0));
        drop(work);
        assert!(progress.is_cancelled());
    }
}
