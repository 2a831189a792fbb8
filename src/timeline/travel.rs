//! The path of a playhead through a sequence: the order of frames, and how soon each is needed.
//!
//! **How it works.** Playing backward is playing forward through the mirrored sequence, so every rule is written once,
//! for forward, between two reflections. The clock queries the playhead after a number of steps; the loader asks in
//! which order frames will be needed (its *rank*: 0 for the playhead) and, inverted, which resident frame is needed
//! last.

use super::PlayRange;
use std::collections::BTreeSet;
use std::ops::Range;

/// The direction in which a sequence plays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Direction {
    /// Towards higher frame numbers.
    #[default]
    Forward,
    /// Towards lower frame numbers.
    Backward,
}

impl Direction {
    /// The other one.
    #[must_use]
    pub fn reversed(self) -> Self {
        match self {
            Self::Forward => Self::Backward,
            Self::Backward => Self::Forward,
        }
    }
}

/// Loop mode: the behaviour at the ends of a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoopMode {
    /// Playing stops.
    Off,
    /// The other end follows.
    #[default]
    Loop,
    /// The direction turns; the frame at the end is shown once.
    PingPong,
}

impl LoopMode {
    /// All modes, in the order in which a button switches them.
    pub const ALL: [Self; 3] = [Self::Off, Self::Loop, Self::PingPong];
}

/// A sequence as a playhead sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Travel {
    pub(crate) frame_count: usize,
    /// Frames before this one are gone: none of them plays.
    pub(crate) first: usize,
    /// The frames that play. A playhead that was put elsewhere goes to their beginning with its next step.
    pub(crate) range: PlayRange,
    pub(crate) loop_mode: LoopMode,
}

/// Position of a playhead after some steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Arrival {
    pub(crate) index: usize,
    pub(crate) direction: Direction,
    /// Fewer than requested where the sequence ends.
    pub(crate) steps: u64,
}

impl Travel {
    /// All of a sequence.
    pub(crate) fn whole(frame_count: usize, loop_mode: LoopMode) -> Self {
        Self {
            frame_count,
            first: 0,
            range: PlayRange::default(),
            loop_mode,
        }
    }

    /// The frames that play.
    pub(crate) fn frames(&self) -> Range<usize> {
        let Range { start, end } = self.range.of(self.frame_count);
        if end <= self.first {
            // All frames of the range are gone.
            return self.first.min(self.frame_count.saturating_sub(1))..self.frame_count;
        }
        start.max(self.first)..end
    }

    /// Returns true if `index` is one of the frames that play.
    pub(crate) fn plays(&self, index: usize) -> bool {
        self.frames().contains(&index)
    }

    /// The frame that plays first in `direction`.
    pub(crate) fn start(&self, direction: Direction) -> usize {
        self.mirrored(direction, 0)
    }

    /// A frame that plays and its number from the end that `direction` leaves behind, the first being 0, are each
    /// other's image.
    fn mirrored(&self, direction: Direction, position: usize) -> usize {
        let frames = self.frames();
        match direction {
            Direction::Forward => frames.start + position,
            Direction::Backward => frames.end.saturating_sub(1 + position),
        }
    }

    /// The inverse of [`Travel::mirrored`]; `None` for a frame that does not play.
    fn position(&self, direction: Direction, index: usize) -> Option<usize> {
        let frames = self.frames();
        frames.contains(&index).then(|| match direction {
            Direction::Forward => index - frames.start,
            Direction::Backward => frames.end - 1 - index,
        })
    }

    /// Returns the arrival of a playhead at `index` after `steps`. Precondition: `index < frame_count`, or both are 0.
    pub(crate) fn after(&self, index: usize, direction: Direction, steps: u64) -> Arrival {
        let Some(position) = self.position(direction, index) else {
            return self.after_from_elsewhere(index, direction, steps);
        };
        let last = self.frames().len() as u64 - 1;
        if last == 0 {
            return Arrival {
                index,
                direction,
                steps: self.steps_on_the_spot(steps),
            };
        }
        let position = position as u64;
        let (position, turned, steps) = match self.loop_mode {
            LoopMode::Off => {
                let steps = steps.min(last - position);
                (position + steps, false, steps)
            }
            LoopMode::Loop => ((position + steps % (last + 1)) % (last + 1), false, steps),
            LoopMode::PingPong => {
                let period = 2 * last;
                let phase = (position + steps % period) % period;
                (phase.min(period - phase), phase >= last, steps)
            }
        };
        Arrival {
            index: self.mirrored(direction, position as usize),
            direction: if turned { direction.reversed() } else { direction },
            steps,
        }
    }

    /// Returns the number of `steps` made by a playhead that has nowhere to go.
    fn steps_on_the_spot(&self, steps: u64) -> u64 {
        match self.loop_mode {
            LoopMode::Off => 0,
            LoopMode::Loop | LoopMode::PingPong => steps,
        }
    }

    /// [`Travel::after`] from a frame that does not play.
    fn after_from_elsewhere(&self, index: usize, direction: Direction, steps: u64) -> Arrival {
        let Some(rest) = steps.checked_sub(1).filter(|_| self.frame_count > 0) else {
            return Arrival {
                index,
                direction,
                steps: self.steps_on_the_spot(steps),
            };
        };
        let arrival = self.after(self.start(direction), direction, rest);
        Arrival {
            steps: arrival.steps + 1,
            ..arrival
        }
    }

    /// The frame that is needed `rank`-th, each counted once; `None` beyond the last that will be needed.
    pub(crate) fn upcoming(&self, playhead: usize, direction: Direction, rank: usize) -> Option<usize> {
        let count = self.frames().len();
        let Some(position) = self.position(direction, playhead) else {
            return match rank.checked_sub(1) {
                None => (playhead < self.frame_count).then_some(playhead),
                Some(position) => (position < count).then(|| self.mirrored(direction, position)),
            };
        };
        if rank >= count {
            return None;
        }
        let ahead = count - position;
        let found = if rank < ahead {
            position + rank
        } else {
            match self.loop_mode {
                LoopMode::Off => return None,
                LoopMode::Loop => rank - ahead,
                LoopMode::PingPong => position - 1 - (rank - ahead),
            }
        };
        Some(self.mirrored(direction, found))
    }

    /// Returns the rank of `index` by how soon it is needed: the inverse of [`Travel::upcoming`]. Frames that lie
    /// behind and will not be needed rank after those that will, the farthest last; frames that do not play after all
    /// others.
    pub(crate) fn rank(&self, playhead: usize, direction: Direction, index: usize) -> usize {
        let frames = self.frames();
        let Some(position) = self.position(direction, index) else {
            return match index {
                _ if index == playhead => 0,
                _ if index < frames.start => frames.len() + frames.start - index,
                _ => 1 + index,
            };
        };
        let Some(playhead) = self.position(direction, playhead) else {
            return 1 + position;
        };
        if position >= playhead {
            position - playhead
        } else {
            match self.loop_mode {
                LoopMode::Loop => frames.len() - playhead + position,
                LoopMode::Off | LoopMode::PingPong => frames.len() - 1 - position,
            }
        }
    }

    /// `resident` without the playhead by falling [`Travel::rank`]: the frame needed last comes first. Each step is
    /// O(log n).
    pub(crate) fn needed_last_first<'a>(
        &self,
        resident: &'a BTreeSet<usize>,
        playhead: usize,
        direction: Direction,
    ) -> Box<dyn Iterator<Item = usize> + 'a> {
        let frames = self.frames();
        let all = |range: Range<usize>| resident.range(range).copied();
        let idle = all(frames.end..self.frame_count)
            .rev()
            .chain(all(0..frames.start))
            .filter(move |&index| index != playhead);
        if !self.plays(playhead) {
            return match direction {
                Direction::Forward => Box::new(idle.chain(all(frames).rev())),
                Direction::Backward => Box::new(idle.chain(all(frames))),
            };
        }
        let below = all(frames.start..playhead);
        let above = all(playhead + 1..frames.end);
        match (direction, self.loop_mode) {
            (Direction::Forward, LoopMode::Loop) => Box::new(idle.chain(below.rev()).chain(above.rev())),
            (Direction::Forward, _) => Box::new(idle.chain(below).chain(above.rev())),
            (Direction::Backward, LoopMode::Loop) => Box::new(idle.chain(above).chain(below)),
            (Direction::Backward, _) => Box::new(idle.chain(above.rev()).chain(below)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn walk(loop_mode: LoopMode, start: usize, direction: Direction, count: u64) -> Vec<usize> {
        let travel = Travel::whole(4, loop_mode);
        (0..count)
            .map(|steps| travel.after(start, direction, steps).index)
            .collect()
    }

    #[test]
    fn a_range_is_played_on_its_own_once_entered() {
        use Direction::{Backward, Forward};
        let walk = |loop_mode, start, direction| -> Vec<usize> {
            let range = PlayRange::default().beginning_at(3).ending_at(5);
            let travel = Travel {
                range,
                ..Travel::whole(9, loop_mode)
            };
            (0..6)
                .map(|steps| travel.after(start, direction, steps).index)
                .collect()
        };
        assert_eq!(walk(LoopMode::Loop, 4, Forward), [4, 5, 3, 4, 5, 3]);
        assert_eq!(walk(LoopMode::Loop, 4, Backward), [4, 3, 5, 4, 3, 5]);
        assert_eq!(walk(LoopMode::PingPong, 4, Forward), [4, 5, 4, 3, 4, 5]);
        assert_eq!(walk(LoopMode::Off, 4, Forward), [4, 5, 5, 5, 5, 5]);
        // From outside, playback starts at the end that the direction moves away from.
        assert_eq!(walk(LoopMode::Loop, 8, Forward), [8, 3, 4, 5, 3, 4]);
        assert_eq!(walk(LoopMode::Off, 1, Backward), [1, 5, 4, 3, 3, 3]);
    }

    #[test]
    fn removed_frames_do_not_play() {
        let ring = |range| Travel {
            first: 6,
            range,
            ..Travel::whole(9, LoopMode::Loop)
        };
        let all = PlayRange::default();
        assert_eq!(ring(all).frames(), 6..9);
        assert_eq!(ring(all.beginning_at(2).ending_at(7)).frames(), 6..8);
        // All frames of the range are gone.
        assert_eq!(ring(all.beginning_at(2).ending_at(5)).frames(), 6..9);
        let walk: Vec<usize> = (0..5)
            .map(|steps| ring(all).after(7, Direction::Forward, steps).index)
            .collect();
        assert_eq!(walk, [7, 8, 6, 7, 8]);
        // If the playhead is on a frame that is gone, it moves to the oldest available one.
        assert_eq!(ring(all).after(1, Direction::Forward, 1).index, 6);
    }

    #[test]
    fn each_loop_mode_visits_frames_in_its_order() {
        use Direction::{Backward, Forward};
        assert_eq!(walk(LoopMode::Off, 1, Forward, 5), [1, 2, 3, 3, 3]);
        assert_eq!(walk(LoopMode::Off, 1, Backward, 4), [1, 0, 0, 0]);
        assert_eq!(walk(LoopMode::Loop, 2, Forward, 5), [2, 3, 0, 1, 2]);
        assert_eq!(walk(LoopMode::Loop, 1, Backward, 5), [1, 0, 3, 2, 1]);
        assert_eq!(walk(LoopMode::PingPong, 2, Forward, 8), [2, 3, 2, 1, 0, 1, 2, 3]);
        assert_eq!(walk(LoopMode::PingPong, 1, Backward, 6), [1, 0, 1, 2, 3, 2]);
        assert_eq!(walk(LoopMode::PingPong, 3, Forward, 3), [3, 2, 1]);
    }

    fn any_travel() -> impl Strategy<Value = (Travel, usize, Direction)> {
        let ends = prop::option::of((0usize..14, 0usize..14));
        let first = 0usize..12;
        let travel = (1usize..12, 0usize..12, 0usize..3, any::<bool>(), ends, first);
        travel.prop_map(|(n, playhead, mode, back, ends, first)| {
            let range = ends.map_or_else(PlayRange::default, |(first, last)| {
                PlayRange::default().beginning_at(first).ending_at(last)
            });
            (
                Travel {
                    range,
                    first: first % n,
                    ..Travel::whole(n, LoopMode::ALL[mode])
                },
                playhead % n,
                if back { Direction::Backward } else { Direction::Forward },
            )
        })
    }

    proptest! {
        /// Many steps at once lead where single steps lead: nothing is remembered but place and direction.
        #[test]
        fn steps_add_up((travel, start, direction) in any_travel(), a in 0u64..40, b in 0u64..40) {
            let halfway = travel.after(start, direction, a);
            let end = travel.after(halfway.index, halfway.direction, b);
            let at_once = travel.after(start, direction, a + b);
            prop_assert_eq!(end.index, at_once.index);
            prop_assert_eq!(halfway.steps + end.steps, at_once.steps);
        }

        /// Frames are planned in the order in which a playhead meets them first.
        #[test]
        fn the_plan_matches_the_visited_frames((travel, start, direction) in any_travel()) {
            let mut met = Vec::new();
            for steps in 0..40 {
                let index = travel.after(start, direction, steps).index;
                if !met.contains(&index) {
                    met.push(index);
                }
            }
            let planned: Vec<usize> =
                (0..).map_while(|rank| travel.upcoming(start, direction, rank)).collect();
            prop_assert_eq!(&planned, &met);
            for (rank, &index) in planned.iter().enumerate() {
                prop_assert_eq!(travel.rank(start, direction, index), rank);
            }
            // Only the playhead may lie outside the range.
            prop_assert!(planned[1..].iter().all(|index| travel.frames().contains(index)));
        }

        #[test]
        fn frames_needed_last_come_first(
            (travel, playhead, direction) in any_travel(), held in prop::collection::btree_set(0usize..12, 0..12),
        ) {
            let held: BTreeSet<usize> = held.into_iter().filter(|&i| i < travel.frame_count).collect();
            let found: Vec<usize> = travel.needed_last_first(&held, playhead, direction).collect();
            let mut expected: Vec<usize> = held.into_iter().filter(|&i| i != playhead).collect();
            expected.sort_by_key(|&i| std::cmp::Reverse(travel.rank(playhead, direction, i)));
            prop_assert_eq!(found, expected);
            let ranks: BTreeSet<usize> =
                (0..travel.frame_count).map(|i| travel.rank(playhead, direction, i)).collect();
            prop_assert_eq!(ranks.len(), travel.frame_count, "each has a rank of its own");
        }
    }
}
