//! Timeline marks painted under the playhead: frames that are in memory and frames that failed.
//!
//! A sequence may have more frames than the screen has pixels, so states are stored as runs of equal ones, and queried
//! only when the loader reports that they may have changed.

use crate::sequence::FrameState;

/// State of a frame as shown on the timeline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Not in memory.
    Absent,
    /// Being loaded.
    Pending,
    /// In memory, with fewer points than in the file.
    Coarse,
    /// In memory.
    Resident,
    /// Cannot be shown.
    Failed,
}

impl From<FrameState> for Mark {
    fn from(state: FrameState) -> Self {
        match state {
            FrameState::Absent | FrameState::Gone => Self::Absent,
            FrameState::Loading | FrameState::Stale => Self::Pending,
            FrameState::Coarse => Self::Coarse,
            FrameState::Ready => Self::Resident,
            FrameState::Failed => Self::Failed,
        }
    }
}

/// Neighbouring frames with one mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MarkRun {
    /// First frame.
    pub start: usize,
    /// One past the last frame.
    pub end: usize,
    /// State shared by these frames.
    pub mark: Mark,
}

/// Runs of equal states, in order, covering all frames.
pub(super) fn runs(states: impl IntoIterator<Item = FrameState>) -> Vec<MarkRun> {
    let mut runs: Vec<MarkRun> = Vec::new();
    for (index, state) in states.into_iter().enumerate() {
        let mark = Mark::from(state);
        match runs.last_mut() {
            Some(run) if run.mark == mark => run.end = index + 1,
            _ => runs.push(MarkRun {
                start: index,
                end: index + 1,
                mark,
            }),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_neighbours_are_merged_into_runs() {
        use FrameState::{Absent, Coarse, Failed, Loading, Ready, Stale};
        let run = |start, end, mark| MarkRun { start, end, mark };
        assert_eq!(
            runs([Ready, Ready, Failed, Loading, Stale, Absent, Coarse]),
            [
                run(0, 2, Mark::Resident),
                run(2, 3, Mark::Failed),
                run(3, 5, Mark::Pending),
                run(5, 6, Mark::Absent),
                run(6, 7, Mark::Coarse)
            ]
        );
        assert_eq!(runs([]), []);
    }
}
