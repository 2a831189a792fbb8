//! Rate control of sequence files: the precision that gives a file of a size, or points with an error (the 4D media
//! paper §III asks for it).
//!
//! How it works: some frames, spread over the sequence, are encoded in memory as the conversion would do it. The more
//! precise positions are, the larger is the file, so the precision of a size is found by bisection. The error is
//! proportional to the precision, so a few steps find that of an error.

use super::edit::Edit;
use super::error::ConvertError;
use super::estimate::{SampleFrame, Target, megabytes};
use super::rate_goal::RateGoal;
use crate::messages::counted;
use crate::progress::Progress;
use crate::reel::{Precision, ReelOptions};
use crate::sequence::Sequence;

/// Frames that the precision is chosen by.
const FRAMES: usize = 3;

/// Finest and coarsest precision, as powers of two of the extent of the cloud. Outliers may be far away, so the finest
/// is that of f64.
const FINEST_LOG2: f64 = -52.0;
const COARSEST_LOG2: f64 = -2.0;

/// Bisections of that range: to a 160th of an octave, less than a hundredth of a bit per coordinate.
const STEPS: usize = 13;

/// Share of the requested size that estimates may fill: those of three frames are off by a percent or two.
const FILLED_SHARE: f64 = 0.98;

/// Evaluations of an error.
const ERROR_STEPS: usize = 4;

/// A precision that was chosen for a goal, and its estimates.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenRate {
    /// The options with that precision.
    pub options: ReelOptions,
    /// Estimated bytes of all frames.
    pub bytes: f64,
}

impl RateGoal {
    /// Chooses the precision for `frames` of a sequence; `None` once `progress` is cancelled. `options` are all others.
    ///
    /// # Errors
    /// Frames that cannot be read or encoded, and goals that no precision meets.
    pub fn choose(
        self,
        sequence: &Sequence,
        frames: &[usize],
        edit: &Edit,
        options: &ReelOptions,
        progress: &Progress,
    ) -> Result<Option<ChosenRate>, ConvertError> {
        let (Some(&first), Some(&last)) = (frames.first(), frames.last()) else {
            return Ok(None);
        };
        let converted = first..=last;
        let count = FRAMES.min(frames.len());
        let places = (0..count).map(|place| frames[(2 * place + 1) * frames.len() / (2 * count)]);
        let mut samples = Vec::new();
        let mut first_failure = None;
        for index in places {
            if progress.is_cancelled() {
                return Ok(None);
            }
            match SampleFrame::read(sequence, &converted, index, edit) {
                Ok(sample) => samples.push(sample),
                Err(error) => {
                    first_failure.get_or_insert(error);
                }
            }
        }
        match first_failure {
            Some(error) if samples.is_empty() => Err(error),
            _ => {
                let samples: Vec<&SampleFrame> = samples.iter().collect();
                self.choose_by(&samples, frames.len(), options, progress)
            }
        }
    }

    /// [`RateGoal::choose`] by these frames of `frame_count`.
    pub fn choose_by(
        self,
        samples: &[&SampleFrame],
        frame_count: usize,
        options: &ReelOptions,
        progress: &Progress,
    ) -> Result<Option<ChosenRate>, ConvertError> {
        let candidates = Candidates {
            samples,
            frame_count: frame_count as f64,
            options,
            progress,
        };
        match self {
            Self::Bytes(bytes) => candidates.of_size(bytes as f64),
            Self::RmsError(error) => candidates.of_error(error),
        }
    }

    /// The goal and what was chosen for it, in words.
    pub(super) fn note(self, chosen: &ChosenRate, frames: usize) -> String {
        let goal = match self {
            Self::Bytes(bytes) => format!("a size of {}", megabytes(bytes as f64)),
            Self::RmsError(error) => format!("an error of {error}"),
        };
        let precision = match chosen.options.precision {
            Precision::Lossless => "exact positions".to_owned(),
            Precision::Length(length) => format!("precision {length:.3e}"),
            other => format!("{other:?}"),
        };
        let by = counted(FRAMES.min(frames) as i64, "frame");
        format!("for {goal}: {precision}, about {} by {by}", megabytes(chosen.bytes))
    }
}

/// Bytes of a sequence file that is larger than was requested, in words.
pub(super) fn excess_note(goal: RateGoal, bytes: u64) -> Option<String> {
    let RateGoal::Bytes(wanted) = goal else { return None };
    let percent = 100.0 * (bytes as f64 / wanted.max(1) as f64 - 1.0);
    (bytes > wanted).then(|| {
        format!(
            "the file has {}, {percent:.1} % more than the requested size: its frames differ from those that the \
             precision was chosen by; request less",
            megabytes(bytes as f64)
        )
    })
}

/// Frames that are encoded with one precision after another.
struct Candidates<'a> {
    samples: &'a [&'a SampleFrame],
    frame_count: f64,
    options: &'a ReelOptions,
    progress: &'a Progress,
}

impl Candidates<'_> {
    fn with(&self, precision: Precision) -> ReelOptions {
        ReelOptions {
            precision,
            ..self.options.clone()
        }
    }

    /// The file with these options.
    fn chosen(&self, options: ReelOptions) -> Result<ChosenRate, ConvertError> {
        let mut bytes = 0.0;
        for sample in self.samples {
            bytes += sample.other(&options)?.bytes;
        }
        Ok(ChosenRate {
            bytes: bytes / self.samples.len().max(1) as f64 * self.frame_count,
            options,
        })
    }

    /// Longest edge of the frames.
    fn extent(&self) -> f64 {
        let extents = self.samples.iter().map(|sample| sample.extent());
        extents.fold(0.0, f64::max)
    }

    /// The most precise file that is no larger.
    fn of_size(&self, bytes: f64) -> Result<Option<ChosenRate>, ConvertError> {
        let fits = |chosen: &ChosenRate| chosen.bytes <= FILLED_SHARE * bytes;
        let lossless = self.chosen(self.with(Precision::Lossless))?;
        let extent = self.extent();
        if fits(&lossless) {
            return Ok(Some(lossless));
        }
        let refused = |smallest: &ChosenRate| ConvertError::TooSmall {
            wanted: megabytes(bytes),
            smallest: megabytes(smallest.bytes / FILLED_SHARE),
        };
        if extent == 0.0 {
            return Err(refused(&lossless));
        }
        let of = |log2: f64| self.chosen(self.with(Precision::Length(extent * log2.exp2())));
        let [mut finest, mut coarsest] = [FINEST_LOG2, COARSEST_LOG2];
        let mut best = of(coarsest)?;
        if !fits(&best) {
            return Err(refused(&best));
        }
        for _ in 0..STEPS {
            if self.progress.is_cancelled() {
                return Ok(None);
            }
            let halfway = 0.5 * (finest + coarsest);
            // A precision may be too fine for the format: then a coarser one is tried as well.
            match of(halfway) {
                Ok(chosen) if fits(&chosen) => (best, coarsest) = (chosen, halfway),
                _ => finest = halfway,
            }
        }
        Ok(Some(best))
    }

    /// The coarsest file that is no further off.
    fn of_error(&self, error: f64) -> Result<Option<ChosenRate>, ConvertError> {
        let mut length = error;
        let mut best = self.with(Precision::Length(length));
        for _ in 0..ERROR_STEPS {
            let options = self.with(Precision::Length(length));
            let Some(rms) = self.rms(&options)? else {
                return Ok(None);
            };
            if rms <= error {
                best = options;
            }
            // As near as makes no difference; without any error, coordinates are exact at this precision.
            if rms == 0.0 || (FILLED_SHARE * error..=error).contains(&rms) {
                break;
            }
            // Halfway between the bounds of what is near enough.
            length *= 0.5 * (1.0 + FILLED_SHARE) * error / rms;
        }
        self.chosen(best).map(Some)
    }

    /// Root mean square distance of points from their originals; `None` once cancelled.
    fn rms(&self, options: &ReelOptions) -> Result<Option<f64>, ConvertError> {
        let target = Target::Reel(options.clone());
        let mut squares = Vec::new();
        for sample in self.samples {
            match sample.judge(&target, self.progress)? {
                Some(judged) => squares.extend(judged.error.map(|error| error.geometry.point_to_point.mean_squared())),
                None => return Ok(None),
            }
        }
        Ok(Some((squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convert::{Conversion, Output, Shard, convert};
    use crate::io::WriteFormat;
    use crate::measure::ReferenceCloud;
    use std::path::PathBuf;

    fn written(goal: RateGoal, folder: &std::path::Path) -> Result<(PathBuf, Vec<String>), ConvertError> {
        let path = folder.join("walk.reel");
        let conversion = Conversion {
            frames: Some(0..=11),
            shard: Shard::WHOLE,
            edit: Edit::default(),
            format: WriteFormat::default(),
            output: Output::Reel(path.clone(), ReelOptions::default()),
            goal: Some(goal),
            overwrites: true,
            reading: String::new(),
        };
        let converted = convert(&Sequence::demo(), &conversion, &Progress::default())?;
        assert_eq!(converted.written, 12);
        Ok((path, converted.notes))
    }

    #[test]
    fn files_have_the_requested_size() {
        let folder = tempfile::tempdir().unwrap();
        let mut sizes = Vec::new();
        for wanted in [150_000u64, 300_000, 600_000] {
            let (path, notes) = written(RateGoal::Bytes(wanted), folder.path()).unwrap();
            let size = path.metadata().unwrap().len();
            assert!(notes.iter().any(|note| note.contains("precision")), "{notes:?}");
            let share = size as f64 / wanted as f64;
            assert!((0.9..=1.02).contains(&share), "{size} of {wanted}: {notes:?}");
            assert_eq!(
                size > wanted,
                notes.iter().any(|note| note.contains("more than")),
                "{notes:?}"
            );
            sizes.push(size);
        }
        assert!(sizes.is_sorted(), "{sizes:?}");
        // Larger than a lossless file.
        let (_, notes) = written(RateGoal::Bytes(1 << 40), folder.path()).unwrap();
        assert!(notes.iter().any(|note| note.contains("exact positions")), "{notes:?}");
        let refused = written(RateGoal::Bytes(100), folder.path()).unwrap_err().to_string();
        assert!(refused.contains("0.00 MB") && refused.contains("--sample"), "{refused}");
    }

    #[test]
    fn points_have_the_requested_error() {
        let folder = tempfile::tempdir().unwrap();
        for wanted in [1e-3, 1e-2] {
            let (path, _) = written(RateGoal::RmsError(wanted), folder.path()).unwrap();
            let decoded = Sequence::discover(&[path]).unwrap().decode(6).unwrap();
            let original = Sequence::demo().decode(6).unwrap();
            let compared = ReferenceCloud::new(&original).unwrap().compare(&decoded).unwrap();
            let found = compared.geometry.point_to_point.mean_squared().sqrt();
            assert!((0.9..=1.05).contains(&(found / wanted)), "{found} for {wanted}");
        }
    }
}
