//! Estimates for the save settings, computed on a thread while they are edited.
//!
//! **How it works.** The shown frame and some others are evaluated one after the other ([`SampleFrame`]), so the first
//! numbers appear soon. A change of the settings cancels the running estimate; none begins before they have been stable
//! for a short time. Decoded frames stay cached for the next settings as long as they are small. The numbers of the
//! previous settings stay visible until there are new ones.

use crate::app::work::outcome::Message;
use crate::app::work::pool::PoolBehindDrawing;
use crate::app::work::tasks::{TaskOutcome, Tasks};
use crate::app::work::works::Progress;
use crate::convert::{ConvertError, Edit, Estimate, RateGoal, SampleEstimate, SampleFrame, Target, source_bytes};
use crate::sequence::Sequence;
use std::ops::RangeInclusive;
use std::sync::Arc;
use std::time::Duration;

/// Choices rest for so long before they are judged.
const REST: Duration = Duration::from_millis(250);

/// Frames that are judged, the shown one among them.
const FRAMES: usize = 5;

/// Decoded frames that take no more than this together are cached while the dialog is open.
const CACHED_BYTES: usize = 256 << 20;

/// Key of the current evaluation.
#[derive(Debug, Clone, PartialEq)]
struct Question {
    /// Its address tells sequences apart.
    sequence: usize,
    target: Target,
    edit: Edit,
    goal: Option<RateGoal>,
    frames: RangeInclusive<usize>,
    shown: usize,
}

/// Evaluation request.
pub(super) struct Asked<'a> {
    pub(super) sequence: &'a Arc<Sequence>,
    pub(super) target: Target,
    pub(super) edit: Edit,
    pub(super) goal: Option<RateGoal>,
    pub(super) frames: RangeInclusive<usize>,
    /// The shown frame.
    pub(super) shown: usize,
    pub(super) is_playing: bool,
}

/// Estimates for the settings, as far as they are known.
#[derive(Debug, Default)]
pub struct Estimates {
    question: Option<Question>,
    /// Frames that are not judged yet, the next one last.
    waiting: Vec<usize>,
    judged: Vec<SampleEstimate>,
    /// Why a frame cannot be judged, the first of them.
    problem: Option<String>,
    /// Running evaluation, and its progress.
    running: Option<Progress>,
    /// When the next frame may begin.
    due: Duration,
    /// Estimate of the previous settings.
    before: Option<Estimate>,
    cached: Vec<Arc<SampleFrame>>,
    /// Bytes of the files of the frames, if known.
    source: Option<(usize, RangeInclusive<usize>, Option<u64>)>,
    pool: PoolBehindDrawing,
}

/// Bytes of the files of frames, if known.
#[derive(Debug, Clone, Copy)]
struct SourceBytes(Option<u64>);

impl Message for Box<Estimated> {}

/// Result of the evaluation of a frame.
#[derive(Debug)]
pub struct Estimated {
    question: Question,
    sample: Option<Arc<SampleFrame>>,
    /// `None` if cancelled.
    judged: Option<Result<SampleEstimate, String>>,
    /// `None` if it was known before.
    source: Option<SourceBytes>,
}

impl Estimates {
    /// Returns the estimate for the present settings; else the previous one, and then the second value is true.
    pub fn estimate(&self) -> Option<(Estimate, bool)> {
        let present = Estimate::of(&self.judged).map(|estimate| (estimate, false));
        present.or_else(|| self.before.clone().map(|estimate| (estimate, true)))
    }

    /// Returns true if more frames are to be evaluated.
    pub fn is_busy(&self) -> bool {
        !self.waiting.is_empty() || self.running.is_some()
    }

    /// Why no frame can be judged, or some.
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// Bytes of the files of the frames, if known.
    pub fn source_bytes(&self) -> Option<u64> {
        self.source.as_ref()?.2
    }

    /// Begins with the next frame where there is one, and time for it.
    pub(super) fn follow<T: TaskOutcome + From<Box<Estimated>>>(
        &mut self,
        asked: Asked<'_>,
        tasks: &Tasks<T>,
        now: Duration,
    ) {
        let Asked {
            sequence,
            target,
            edit,
            goal,
            frames,
            shown,
            is_playing,
        } = asked;
        let address = Arc::as_ptr(sequence).addr();
        // While playing, an estimate for the previously shown frame is good enough.
        let before = self
            .question
            .as_ref()
            .filter(|before| is_playing && before.sequence == address);
        let question = Question {
            sequence: address,
            target,
            edit,
            goal,
            frames,
            shown: before.map_or(shown, |before| before.shown),
        };
        if self.question.as_ref() != Some(&question) {
            self.ask(question, now);
        }
        if self.running.is_none() && now >= self.due {
            self.begin_next(sequence, tasks);
        }
    }

    fn ask(&mut self, question: Question, now: Duration) {
        if let Some(progress) = &self.running {
            progress.cancel();
        }
        let of_same = |before: &Question| before.sequence == question.sequence;
        if self.question.as_ref().is_some_and(of_same) {
            self.before = Estimate::of(&self.judged).or(self.before.take());
        } else {
            self.before = None;
        }
        if self
            .question
            .as_ref()
            .is_none_or(|before| !before.has_same_samples(&question))
        {
            self.cached.clear();
        }
        self.judged.clear();
        self.problem = None;
        self.waiting = spread(&question.frames, question.shown);
        self.waiting.reverse();
        // The first choices are estimated at once.
        self.due = if self.question.is_some() { now + REST } else { now };
        self.question = Some(question);
    }

    fn begin_next<T: TaskOutcome + From<Box<Estimated>>>(&mut self, sequence: &Arc<Sequence>, tasks: &Tasks<T>) {
        let Some((question, index)) = self.question.clone().zip(self.waiting.pop()) else {
            return;
        };
        let Some(pool) = self.pool.get("estimate", 1) else {
            self.waiting.clear();
            self.problem = Some("No thread could be started for estimates: close other programs".to_owned());
            return;
        };
        let progress = Progress::default();
        self.running = Some(progress.clone());
        let cached = self.cached.iter().find(|sample| sample.index == index).cloned();
        let (of, frames, _) = self.source.as_ref().map_or((0, 0..=0, None), Clone::clone);
        let knows_source = of == question.sequence && frames == question.frames;
        let sequence = Arc::clone(sequence);
        tasks.start_in(pool, move || {
            Box::new(judge(&sequence, question, index, cached, knows_source, &progress))
        });
    }

    /// Takes the result of a frame.
    pub(in crate::app) fn take_in(&mut self, estimated: Estimated) {
        self.running = None;
        let Estimated {
            question,
            sample,
            judged,
            source,
        } = estimated;
        let is_of_same = |asked: &Question| asked.sequence == question.sequence;
        if !self.question.as_ref().is_some_and(is_of_same) {
            return;
        }
        let has_same_samples = |asked: &Question| asked.has_same_samples(&question);
        let is_asked = self.question.as_ref().is_some_and(has_same_samples);
        if let Some(sample) = sample.filter(|_| is_asked) {
            self.keep(sample);
        }
        if let Some(SourceBytes(bytes)) = source {
            self.source = Some((question.sequence, question.frames.clone(), bytes));
        }
        if self.question.as_ref() != Some(&question) {
            return;
        }
        match judged {
            Some(Ok(judged)) => self.judged.push(judged),
            Some(Err(problem)) => {
                self.problem.get_or_insert(problem);
            }
            None => {}
        }
    }

    fn keep(&mut self, sample: Arc<SampleFrame>) {
        let cached: usize = self.cached.iter().map(|sample| sample.byte_size()).sum();
        let is_new = self.cached.iter().all(|known| known.index != sample.index);
        if is_new && cached + sample.byte_size() <= CACHED_BYTES {
            self.cached.push(sample);
        }
    }

    /// Forgets everything: the dialog was closed.
    pub(in crate::app) fn stop(&mut self) {
        if let Some(progress) = &self.running {
            progress.cancel();
        }
        if self.question.is_some() {
            *self = Self {
                // Work in progress reports when it ends.
                running: self.running.take(),
                pool: std::mem::take(&mut self.pool),
                ..Self::default()
            };
        }
    }

    /// When the next frame may begin.
    pub(in crate::app) fn next_deadline(&self) -> Option<Duration> {
        (!self.waiting.is_empty() && self.running.is_none()).then_some(self.due)
    }
}

fn judge(
    sequence: &Sequence,
    question: Question,
    index: usize,
    cached: Option<Arc<SampleFrame>>,
    knows_source: bool,
    progress: &Progress,
) -> Estimated {
    let source = (!knows_source).then(|| SourceBytes(source_bytes(sequence, &question.frames)));
    let sample = match cached {
        Some(sample) => Ok(sample),
        None => SampleFrame::read(sequence, &question.frames, index, &question.edit).map(Arc::new),
    };
    let judged = match &sample {
        Ok(sample) => question.judge(sample, progress).transpose(),
        Err(_) => None,
    };
    let judged = judged.map(|judged| judged.map_err(|error| error.to_string()));
    let (sample, judged) = match sample {
        Ok(sample) => (Some(sample), judged),
        Err(error) => (None, Some(Err(error.to_string()))),
    };
    Estimated {
        question,
        sample,
        judged,
        source,
    }
}

impl Question {
    /// Returns true if frames are read in the same way.
    fn has_same_samples(&self, other: &Self) -> bool {
        self.sequence == other.sequence && self.frames == other.frames && self.edit == other.edit
    }

    /// Judges a frame, with the precision that is chosen by it alone if there is a goal; `None` once cancelled.
    fn judge(&self, sample: &SampleFrame, progress: &Progress) -> Result<Option<SampleEstimate>, ConvertError> {
        let (Some(goal), Target::Reel(options)) = (self.goal, &self.target) else {
            return sample.judge(&self.target, progress);
        };
        let frame_count = self.frames.clone().count();
        match goal.choose_by(&[sample], frame_count, options, progress)? {
            Some(chosen) => sample.judge(&Target::Reel(chosen.options), progress),
            None => Ok(None),
        }
    }
}

/// The shown frame first, if it is among `frames`, then others spread over them.
fn spread(frames: &RangeInclusive<usize>, shown: usize) -> Vec<usize> {
    let (first, count) = (*frames.start(), frames.clone().count());
    let mut chosen: Vec<usize> = frames.contains(&shown).then_some(shown).into_iter().collect();
    let places = FRAMES.min(count);
    for place in 0..places {
        let frame = first + (2 * place + 1) * count / (2 * places);
        if chosen.len() < places && !chosen.contains(&frame) {
            chosen.push(frame);
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shown_frame_is_estimated_first_and_none_twice() {
        assert_eq!(spread(&(0..=99), 99), [99, 10, 30, 50, 70]);
        assert_eq!(spread(&(0..=99), 50), [50, 10, 30, 70, 90]);
        assert_eq!(spread(&(5..=7), 6), [6, 5, 7]);
        assert_eq!(spread(&(5..=7), 0), [5, 6, 7]);
        assert_eq!(spread(&(3..=3), 3), [3]);
    }
}
