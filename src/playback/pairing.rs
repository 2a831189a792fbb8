//! Pairing of the frames of a sequence A with those of a sequence B for side-by-side display.
//!
//! **How it works.** By index, the frames at the same position belong together. By number, frames whose names contain
//! the same number do, so that a lost file shifts nothing. By time, the frame of B taken nearest in time to the frame
//! of A does, unless it is so far away that B has none at that instant: before its first, behind its last, or where one
//! was lost. Times of both are on one clock if they overlap; if not (one counts from its start, the other since 1970),
//! each counts from its first frame. The offset is in frames of B: by time and by number, a frame is the median
//! spacing.

use std::cmp::Ordering;
use std::ops::Sub;
use std::time::Duration;

/// Maximum distance of a frame from an instant for pairing, in median spacings: more than half of one, as frames are
/// not evenly spaced, and less than a whole, at which a lost one would hide behind its neighbours.
const REACH_IN_SPACINGS: f64 = 0.75;

/// The criterion by which frames are paired.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairBy {
    /// Their places in the sequences.
    Index,
    /// The numbers in their names.
    Number,
    /// Capture times.
    Time,
}

/// A frame of B.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The frame that belongs there, or is the nearest to it.
    pub nearest: usize,
    /// True if the frame belongs to that position.
    pub is_there: bool,
}

impl Pair {
    /// The frame that belongs there, if there is one.
    pub fn frame(self) -> Option<usize> {
        self.is_there.then_some(self.nearest)
    }

    /// The frame `offset` later than `index`, of `frame_count`, which is at least 1.
    pub(super) fn by_index(index: usize, offset: i64, frame_count: usize) -> Self {
        let last = i64::try_from(frame_count - 1).unwrap_or(i64::MAX);
        let wanted = i64::try_from(index).unwrap_or(i64::MAX).saturating_add(offset);
        let nearest = wanted.clamp(0, last);
        Self {
            nearest: nearest as usize,
            is_there: nearest == wanted,
        }
    }
}

/// The numbers in the names of the frames of A and of B.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PairNumbers {
    a: Vec<u64>,
    b: Vec<u64>,
    b_spacing: u64,
}

impl PairNumbers {
    /// `None` unless all frames of both have numbers that grow, and one is the same.
    pub fn of(a: &[Option<u64>], b: &[Option<u64>]) -> Option<Self> {
        let (a, b) = (growing(a)?, growing(b)?);
        if !b.iter().any(|number| a.binary_search(number).is_ok()) {
            return None;
        }
        let b_spacing = median_spacing(&b).unwrap_or(1);
        Some(Self { a, b, b_spacing })
    }

    /// The frame of B with the number of frame `index` of A, `offset` frames later.
    pub(super) fn pair(&self, index: usize, offset: i64) -> Pair {
        let last = self.a.len() - 1;
        let wanted = i128::from(self.a[index.min(last)]) + i128::from(offset) * i128::from(self.b_spacing);
        let away = |frame: usize| (i128::from(self.b[frame]) - wanted).unsigned_abs();
        let after = self.b.partition_point(|&number| i128::from(number) < wanted);
        let nearest = nearest_of(self.b.len(), after, away);
        Pair {
            nearest,
            is_there: away(nearest) == 0,
        }
    }
}

/// Capture times of the frames of A and of B.
#[derive(Debug, Clone, PartialEq)]
pub struct PairTimes {
    a_secs: Vec<f64>,
    b_secs: Vec<f64>,
    b_spacing_secs: f64,
    counts_from_first: bool,
}

impl PairTimes {
    /// `None` unless both have frames, and all of them times that grow.
    pub fn of(a: &[Option<Duration>], b: &[Option<Duration>]) -> Option<Self> {
        let (a, b) = (growing(a)?, growing(b)?);
        let ([a_first, a_last], [b_first, b_last]) = (ends(&a)?, ends(&b)?);
        let counts_from_first = a_last < b_first || b_last < a_first;
        let begin = a_first.min(b_first);
        let [a_begin, b_begin] = if counts_from_first {
            [a_first, b_first]
        } else {
            [begin; 2]
        };
        let (a_secs, b_secs) = (secs_since(a_begin, &a), secs_since(b_begin, &b));
        let b_spacing_secs = median_spacing(&b_secs)
            .or_else(|| median_spacing(&a_secs))
            .unwrap_or(0.0);
        Some(Self {
            a_secs,
            b_secs,
            b_spacing_secs,
            counts_from_first,
        })
    }

    /// Returns true if the times of each sequence are counted from its first frame, because their time ranges do not
    /// overlap.
    pub fn counts_from_first(&self) -> bool {
        self.counts_from_first
    }

    /// Frames of B for each of A, at their usual rates.
    pub(super) fn frames_per_frame(&self) -> f64 {
        match median_spacing(&self.a_secs) {
            Some(a_spacing_secs) if self.b_spacing_secs > 0.0 => a_spacing_secs / self.b_spacing_secs,
            _ => 1.0,
        }
    }

    /// The frame of B nearest to frame `index` of A, `offset` frames later.
    pub(super) fn pair(&self, index: usize, offset: i64) -> Pair {
        let last = self.a_secs.len() - 1;
        let at_secs = self.a_secs[index.min(last)] + offset as f64 * self.b_spacing_secs;
        let after = self.b_secs.partition_point(|&secs| secs < at_secs);
        let away = |frame: usize| (self.b_secs[frame] - at_secs).abs();
        let nearest = nearest_of(self.b_secs.len(), after, away);
        Pair {
            nearest,
            is_there: away(nearest) <= REACH_IN_SPACINGS * self.b_spacing_secs,
        }
    }
}

/// All of them, if each frame has one and they grow.
fn growing<T: Copy + PartialOrd>(of_frames: &[Option<T>]) -> Option<Vec<T>> {
    let all: Vec<T> = of_frames.iter().copied().collect::<Option<_>>()?;
    all.windows(2).all(|pair| pair[0] < pair[1]).then_some(all)
}

fn ends(times: &[Duration]) -> Option<[Duration; 2]> {
    Some([*times.first()?, *times.last()?])
}

fn secs_since(begin: Duration, times: &[Duration]) -> Vec<f64> {
    let since = |time: &Duration| time.saturating_sub(begin).as_secs_f64();
    times.iter().map(since).collect()
}

fn median_spacing<T: Copy + PartialOrd + Sub<Output = T>>(growing: &[T]) -> Option<T> {
    let mut spacings: Vec<T> = growing.windows(2).map(|pair| pair[1] - pair[0]).collect();
    spacings.sort_by(order);
    spacings.get(spacings.len() / 2).copied()
}

/// Returns the index of the frame nearest to a position in the order of `frame_count` frames, `after` being the first
/// frame that is not before it.
fn nearest_of<T: PartialOrd>(frame_count: usize, after: usize, away: impl Fn(usize) -> T) -> usize {
    let candidates = after.saturating_sub(1)..(after + 1).min(frame_count);
    candidates.min_by(|&a, &b| order(&away(a), &away(b))).unwrap_or(0)
}

/// Compares two numbers that are not NaN.
fn order<T: PartialOrd>(a: &T, b: &T) -> Ordering {
    a.partial_cmp(b).unwrap_or(Ordering::Equal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(millis: &[u64]) -> Vec<Option<Duration>> {
        millis
            .iter()
            .map(|&millis| Some(Duration::from_millis(millis)))
            .collect()
    }

    fn frames(times: &PairTimes, offset: i64) -> Vec<Option<usize>> {
        (0..times.a_secs.len())
            .map(|index| times.pair(index, offset).frame())
            .collect()
    }

    #[test]
    fn pairing_by_index_with_an_offset_runs_out_of_frames() {
        let frames = |offset| -> Vec<_> { (0..4).map(|index| Pair::by_index(index, offset, 3).frame()).collect() };
        assert_eq!(frames(0), [Some(0), Some(1), Some(2), None]);
        assert_eq!(frames(2), [Some(2), None, None, None]);
        assert_eq!(frames(-1), [None, Some(0), Some(1), Some(2)]);
        assert_eq!(frames(i64::MIN), [None; 4]);
        // In the meantime, the nearest frame is prepared.
        assert_eq!(Pair::by_index(9, 0, 3).nearest, 2);
        assert_eq!(Pair::by_index(0, -7, 3).nearest, 0);
    }

    #[test]
    fn pairing_by_time_shares_frames_of_b_between_two_of_a() {
        let a = at(&[1000, 1050, 1100, 1150, 1200]);
        let b = at(&[1010, 1110, 1210]);
        let times = PairTimes::of(&a, &b).unwrap();
        assert!(!times.counts_from_first());
        // 1050 is 40 ms after the first and 60 ms before the second.
        assert_eq!(frames(&times, 0), [Some(0), Some(0), Some(1), Some(1), Some(2)]);
        assert_eq!(frames(&times, 1), [Some(1), Some(1), Some(2), Some(2), None]);
        assert!((times.frames_per_frame() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn frames_without_a_counterpart_in_b_have_no_pair() {
        // B starts later, lacks the frame at 500 and ends earlier.
        let a = at(&[0, 100, 200, 300, 400, 500, 600, 700, 800]);
        let b = at(&[200, 300, 400, 600, 700]);
        let times = PairTimes::of(&a, &b).unwrap();
        let expected = [None, None, Some(0), Some(1), Some(2), None, Some(3), Some(4), None];
        assert_eq!(frames(&times, 0), expected);
        assert_eq!((times.pair(0, 0).nearest, times.pair(8, 0).nearest), (0, 4));
    }

    #[test]
    fn clocks_that_do_not_overlap_count_from_their_first_frames() {
        let since_1970 = at(&[1_700_000_000_000, 1_700_000_000_100, 1_700_000_000_200]);
        let from_zero = at(&[0, 100, 200]);
        let times = PairTimes::of(&since_1970, &from_zero).unwrap();
        assert!(times.counts_from_first());
        assert_eq!(frames(&times, 0), [Some(0), Some(1), Some(2)]);
        assert_eq!(frames(&times, -1), [None, Some(0), Some(1)]);
    }

    #[test]
    fn pairing_by_number_is_not_shifted_by_a_lost_file() {
        let numbers = |numbers: &[u64]| -> Vec<_> { numbers.iter().copied().map(Some).collect() };
        // 7 and 8 are missing, and B ends earlier.
        let pairs = PairNumbers::of(&numbers(&[5, 6, 7, 8, 9, 10, 11]), &numbers(&[4, 5, 6, 9, 10])).unwrap();
        let frames = |offset| -> Vec<_> { (0..7).map(|index| pairs.pair(index, offset).frame()).collect() };
        assert_eq!(frames(0), [Some(1), Some(2), None, None, Some(3), Some(4), None]);
        assert_eq!(frames(-1), [Some(0), Some(1), Some(2), None, None, Some(3), Some(4)]);
        assert_eq!(frames(i64::MAX), [None; 7]);
        assert_eq!(frames(i64::MIN), [None; 7]);
        // In the meantime, the nearest frame is prepared.
        assert_eq!((pairs.pair(2, 0).nearest, pairs.pair(6, 0).nearest), (2, 4));
        // Every tenth: an offset of one is the next frame of B.
        let tens = PairNumbers::of(&numbers(&[0, 5, 10]), &numbers(&[0, 10, 20])).unwrap();
        assert_eq!((tens.pair(0, 1).frame(), tens.pair(1, 1).frame()), (Some(1), None));
    }

    #[test]
    fn meaningless_numbers_pair_no_frames() {
        let some = [Some(1), Some(2)];
        for other in [&[Some(1), None][..], &[Some(2), Some(2)], &[Some(3), Some(4)], &[]] {
            assert_eq!(PairNumbers::of(&some, other), None, "{other:?}");
            assert_eq!(PairNumbers::of(other, &some), None, "{other:?}");
        }
    }

    #[test]
    fn pairing_by_time_needs_increasing_times_of_all_frames() {
        let times = at(&[0, 100]);
        let torn = [Some(Duration::ZERO), None];
        let falling = at(&[100, 0]);
        for other in [&torn[..], &falling, &[]] {
            assert_eq!(PairTimes::of(&times, other), None, "{other:?}");
            assert_eq!(PairTimes::of(other, &times), None, "{other:?}");
        }
        // One frame each: they belong together.
        let one = PairTimes::of(&at(&[5]), &at(&[7])).unwrap();
        assert_eq!(frames(&one, 0), [Some(0)]);
    }

    proptest! {
        /// A look at all frames of B finds none nearer; even times are paired like indices.
        #[test]
        fn pairs_match_a_search_for_the_nearest_time(
            a in prop::collection::btree_set(0u64..2000, 1..20),
            b in prop::collection::btree_set(0u64..2000, 1..20),
            offset in -3i64..=3,
        ) {
            let [a, b] = [a, b].map(|set| at(&set.into_iter().collect::<Vec<_>>()));
            let times = PairTimes::of(&a, &b).unwrap();
            for index in 0..a.len() {
                let pair = times.pair(index, offset);
                let wanted = times.a_secs[index] + offset as f64 * times.b_spacing_secs;
                let nearest = times.b_secs.iter().map(|secs| (secs - wanted).abs()).fold(f64::INFINITY, f64::min);
                prop_assert_eq!((times.b_secs[pair.nearest] - wanted).abs(), nearest);
                prop_assert_eq!(pair.is_there, nearest <= REACH_IN_SPACINGS * times.b_spacing_secs);
            }
        }

        #[test]
        fn even_times_are_paired_like_indices(a in 1usize..20, b in 2usize..20, spacing in 1u64..500,
            offset in -20i64..20) {
            let even = |count: usize| at(&(0..count as u64).map(|frame| frame * spacing).collect::<Vec<_>>());
            let times = PairTimes::of(&even(a), &even(b)).unwrap();
            for index in 0..a {
                prop_assert_eq!(times.pair(index, offset), Pair::by_index(index, offset, b));
            }
        }
    }
}
