//! The original frames, compared with their encodings.

use crate::bench::BenchError;
use crate::bench::subject::Subject;
use crate::cloud::RawCloud;
use crate::reel::NewFrame;

/// A frame of the sequence as its file has it.
pub(super) struct Original {
    pub(super) index: usize,
    pub(super) cloud: RawCloud,
    name: String,
}

impl Original {
    /// As a sequence file takes it.
    pub(super) fn as_new(&self) -> NewFrame<'_> {
        NewFrame {
            cloud: &self.cloud,
            name: &self.name,
            time: None,
        }
    }
}

/// Returns the chosen number of frames, but consecutive from the first one on: each frame is predicted from the
/// preceding ones.
pub(super) fn consecutive(subject: &Subject<'_>) -> Result<Vec<Original>, BenchError> {
    let first = subject.chosen.first().copied().unwrap_or(0);
    let frames = subject.sequence.frames().skip_while(|&index| index < first);
    let frames = frames.take(subject.chosen.len());
    let decoded = frames.filter_map(|index| {
        let cloud = subject.sequence.decode(index).ok()?;
        let name = subject.sequence.entry(index).name.clone();
        Some(Original { index, cloud, name })
    });
    let frames: Vec<Original> = decoded.filter(|frame| !frame.cloud.positions.is_empty()).collect();
    if frames.is_empty() {
        return Err(BenchError::Nothing(format!(
            "{} has no frame with points",
            subject.name
        )));
    }
    Ok(frames)
}
