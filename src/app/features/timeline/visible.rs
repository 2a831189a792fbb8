//! The part of the sequence that the timeline shows.

use std::ops::Range;

/// Fewer frames are not shown.
const MIN_FRAMES: f64 = 8.0;

/// The frames that the timeline shows: all of them, unless it was zoomed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(in crate::app) struct VisibleFrames {
    zoomed: Option<Zoomed>,
}

/// In frames, with fractions while zooming by wheel.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Zoomed {
    first: f64,
    shown: f64,
}

impl VisibleFrames {
    /// Returns the frame range within `count` frames; at least one where there is one.
    pub(in crate::app) fn of(self, count: usize) -> Range<usize> {
        let Some(Zoomed { first, shown }) = self.zoomed else {
            return 0..count;
        };
        let shown = (shown.round() as usize).clamp(1, count.max(1));
        let first = (first.round().max(0.0) as usize).min(count.saturating_sub(shown));
        first..(first + shown).min(count)
    }

    /// Returns true if the timeline is zoomed, so that frames are excluded.
    pub(in crate::app) fn is_zoomed(self) -> bool {
        self.zoomed.is_some()
    }

    /// Shows `factor` times as many frames, around the position at `share` of the width.
    pub(in crate::app) fn zoom(&mut self, factor: f64, share: f64, count: usize) {
        let Zoomed { first, shown } = self.present(count);
        let all = count as f64;
        let wanted = (shown * factor).clamp(MIN_FRAMES.min(all), all);
        let first = first + share * (shown - wanted);
        self.set(first, wanted, count);
    }

    /// Moves by a share of the visible range.
    pub(in crate::app) fn pan(&mut self, share: f64, count: usize) {
        let Zoomed { first, shown } = self.present(count);
        self.set(first + share * shown, shown, count);
    }

    /// Goes to the page that has `frame`.
    pub(in crate::app) fn turn_to(&mut self, frame: usize, count: usize) {
        if self.is_zoomed() && !self.of(count).contains(&frame) {
            let Zoomed { shown, .. } = self.present(count);
            self.set((frame as f64 / shown).floor() * shown, shown, count);
        }
    }

    fn present(self, count: usize) -> Zoomed {
        self.zoomed.unwrap_or(Zoomed {
            first: 0.0,
            shown: count as f64,
        })
    }

    fn set(&mut self, first: f64, shown: f64, count: usize) {
        let all = count as f64;
        let first = first.clamp(0.0, (all - shown).max(0.0));
        self.zoomed = (shown < all).then_some(Zoomed { first, shown });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn zooming_out_shows_all_again() {
        let mut visible = VisibleFrames::default();
        assert_eq!(visible.of(100), 0..100);
        visible.zoom(0.5, 0.5, 100);
        assert_eq!(visible.of(100), 25..75);
        visible.pan(-1.0, 100);
        assert_eq!(visible.of(100), 0..50);
        visible.turn_to(60, 100);
        assert_eq!(visible.of(100), 50..100);
        visible.turn_to(99, 100);
        assert_eq!(visible.of(100), 50..100, "it is there already");
        visible.zoom(8.0, 0.0, 100);
        assert!(!visible.is_zoomed());
        visible.zoom(0.01, 1.0, 5);
        assert_eq!(visible.of(5), 0..5, "there are only so few");
        assert_eq!(VisibleFrames::default().of(0), 0..0);
    }

    proptest! {
        /// For any wheel events, frames within the sequence are shown, and the frame at the pointer stays there.
        #[test]
        fn zooming_keeps_the_frame_at_the_pointer(
            turns in prop::collection::vec((0.5f64..2.0, 0f64..1.0), 1..20), count in 1usize..500,
        ) {
            let mut visible = VisibleFrames::default();
            for (factor, share) in turns {
                let before = visible.present(count);
                let at = before.first + share * before.shown;
                visible.zoom(factor, share, count);
                let range = visible.of(count);
                prop_assert!(range.start < range.end && range.end <= count);
                let after = visible.present(count);
                let now = after.first + share * after.shown;
                let is_at_end = after.first == 0.0 || (after.first + after.shown - count as f64).abs() < 1e-9;
                prop_assert!(is_at_end || (now - at).abs() < 1e-6, "{} {}", now, at);
            }
        }
    }
}
