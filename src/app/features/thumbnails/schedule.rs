//! Thumbnail scheduling: the frames on the strip, the next one to render, and the time available for it.

use std::collections::BTreeSet;

/// Returns the central frame of each of `cells` equal parts of a sequence; every frame once where there are fewer.
pub(in crate::app) fn strip_frames(frame_count: usize, cells: usize) -> Vec<usize> {
    let cells = cells.min(frame_count);
    let center = |cell: usize| (2 * cell + 1) * frame_count / (2 * cells);
    (0..cells).map(center).collect()
}

/// Frames with visible thumbnails.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct WantedFrames {
    /// Frames of the strip, in order.
    pub(super) strip: Vec<usize>,
    /// The one under the pointer.
    pub(super) hovered: Option<usize>,
}

impl WantedFrames {
    /// All of them.
    pub(super) fn all(&self) -> BTreeSet<usize> {
        self.strip.iter().copied().chain(self.hovered).collect()
    }

    /// The frame to make next: the one under the pointer, then the strip's, the nearest to the playhead first, the
    /// later one of two equally near. Of the missing ones, the first that can be made now.
    pub(super) fn next(
        &self,
        playhead: usize,
        is_made: impl Fn(usize) -> bool,
        can_be_made: impl FnMut(&usize) -> bool,
    ) -> Option<usize> {
        let mut missing: Vec<usize> = self.strip.clone();
        missing.retain(|&frame| !is_made(frame));
        missing.sort_by_key(|&frame| (frame.abs_diff(playhead), frame < playhead));
        let hovered = self.hovered.filter(|&frame| !is_made(frame));
        hovered.into_iter().chain(missing).find(can_be_made)
    }
}

/// Activity of the window.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a fact of its own about what the machine is busy with"
)]
pub(super) struct Bustle {
    /// A benchmark runs.
    pub(super) is_measured: bool,
    /// Frames are played.
    pub(super) is_playing: bool,
    /// All of them in time and with all their points.
    pub(super) keeps_up: bool,
    /// Frames are being prepared.
    pub(super) is_loading: bool,
}

/// Work that there is time for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Leisure {
    /// For nothing.
    None,
    /// Drawing frames in memory.
    Drawing,
    /// To read files as well.
    Reading,
}

impl Bustle {
    /// Playing and measuring take precedence, then preparing frames.
    pub(super) fn leisure(self) -> Leisure {
        match self {
            Self { is_measured: true, .. }
            | Self {
                is_playing: true,
                keeps_up: false,
                ..
            } => Leisure::None,
            Self { is_playing: true, .. } | Self { is_loading: true, .. } => Leisure::Drawing,
            _ => Leisure::Reading,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_strip_shows_the_frame_at_the_center_of_each_cell() {
        assert_eq!(strip_frames(100, 4), [12, 37, 62, 87]);
        assert_eq!(strip_frames(3, 20), [0, 1, 2]);
        assert_eq!(strip_frames(1, 20), [0]);
        assert_eq!(strip_frames(0, 20), [0; 0]);
        assert_eq!(strip_frames(100, 0), [0; 0]);
    }

    #[test]
    fn the_frame_at_the_pointer_comes_first_then_those_near_the_playhead() {
        let wanted = WantedFrames {
            strip: strip_frames(100, 5),
            hovered: Some(99),
        };
        assert_eq!(wanted.strip, [10, 30, 50, 70, 90]);
        let mut made = Vec::new();
        while let Some(frame) = wanted.next(40, |frame| made.contains(&frame), |_| true) {
            made.push(frame);
        }
        assert_eq!(made, [99, 50, 30, 70, 10, 90]);
        // Only among those in memory.
        let in_memory = [10, 70];
        let next = wanted.next(40, |_| false, |frame| in_memory.contains(frame));
        assert_eq!(next, Some(70));
        let next = wanted.next(40, |frame| frame == 70, |frame| in_memory.contains(frame));
        assert_eq!(next, Some(10));
        assert_eq!(wanted.next(40, |_| false, |_| false), None);
    }

    proptest! {
        #[test]
        fn every_wanted_frame_is_made_once(
            count in 1usize..500, cells in 1usize..60, playhead in 0usize..500,
            hovered in prop::option::of(0usize..500),
        ) {
            let wanted = WantedFrames { strip: strip_frames(count, cells), hovered };
            prop_assert!(wanted.strip.is_sorted_by(|a, b| a < b) && wanted.strip.iter().all(|&frame| frame < count));
            let mut made = Vec::new();
            while let Some(frame) = wanted.next(playhead, |frame| made.contains(&frame), |_| true) {
                prop_assert!(!made.contains(&frame));
                made.push(frame);
            }
            let mut sorted = made.clone();
            sorted.sort_unstable();
            prop_assert!(sorted.into_iter().eq(wanted.all()));
            let nearness: Vec<usize> =
                made.iter().skip(usize::from(hovered.is_some())).map(|frame| frame.abs_diff(playhead)).collect();
            prop_assert!(nearness.is_sorted());
        }
    }

    #[test]
    fn background_work_depends_on_what_else_is_running() {
        let idle = Bustle::default();
        assert_eq!(idle.leisure(), Leisure::Reading);
        let loading = Bustle {
            is_loading: true,
            ..idle
        };
        assert_eq!(loading.leisure(), Leisure::Drawing);
        let late = Bustle {
            is_playing: true,
            ..idle
        };
        assert_eq!(late.leisure(), Leisure::None);
        let in_time = Bustle { keeps_up: true, ..late };
        assert_eq!(in_time.leisure(), Leisure::Drawing);
        let measured = Bustle {
            is_measured: true,
            ..in_time
        };
        assert_eq!(measured.leisure(), Leisure::None);
    }
}
