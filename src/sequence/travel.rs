//! The way of a playhead through a sequence: what comes after what, which frame is needed how soon.
//!
//! **How it works.** Playing backward is playing forward through the mirrored sequence, so every rule is written once, for
//! forward, between two reflections. The clock asks where the playhead is after so many steps; the loader asks in which
//! order frames will be needed (its *rank*: 0 for the playhead) and, inverted, which resident frame is needed last.

use std::collections::BTreeSet;

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

/// What happens at the ends of a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
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
pub(super) struct Travel {
    pub(super) frame_count: usize,
    pub(super) loop_mode: LoopMode,
}

/// Where a playhead is after some steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Arrival {
    pub(super) index: usize,
    pub(super) direction: Direction,
    /// Fewer than asked for where the sequence ends.
    pub(super) steps: u64,
}

impl Travel {
    /// `index` counted from the end that `direction` leaves behind; its own inverse.
    fn mirrored(&self, direction: Direction, index: usize) -> usize {
        match direction {
            Direction::Forward => index,
            Direction::Backward => self.frame_count - 1 - index,
        }
    }

    /// Where a playhead at `index` is after `steps`. Precondition: `index < frame_count`, or both are 0.
    pub(super) fn after(&self, index: usize, direction: Direction, steps: u64) -> Arrival {
        let last = self.frame_count.saturating_sub(1) as u64;
        if last == 0 {
            return Arrival {
                index: 0,
                direction,
                steps: match self.loop_mode {
                    LoopMode::Off => 0,
                    LoopMode::Loop | LoopMode::PingPong => steps,
                },
            };
        }
        let position = self.mirrored(direction, index) as u64;
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
            direction: if turned {
                direction.reversed()
            } else {
                direction
            },
            steps,
        }
    }

    /// The frame that is needed `rank`-th, each counted once; `None` beyond the last that will be needed.
    pub(super) fn upcoming(
        &self,
        playhead: usize,
        direction: Direction,
        rank: usize,
    ) -> Option<usize> {
        if rank >= self.frame_count {
            return None;
        }
        let position = self.mirrored(direction, playhead);
        let ahead = self.frame_count - position;
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

    /// How soon `index` is needed: the inverse of [`Travel::upcoming`]. Frames that lie behind and will not be needed
    /// rank after all others, the farthest last.
    pub(super) fn rank(&self, playhead: usize, direction: Direction, index: usize) -> usize {
        let playhead = self.mirrored(direction, playhead);
        let index = self.mirrored(direction, index);
        if index >= playhead {
            index - playhead
        } else {
            match self.loop_mode {
                LoopMode::Loop => self.frame_count - playhead + index,
                LoopMode::Off | LoopMode::PingPong => self.frame_count - 1 - index,
            }
        }
    }

    /// `resident` without the playhead by falling [`Travel::rank`]: what is needed last comes first. Each step is
    /// O(log n).
    pub(super) fn needed_last_first<'a>(
        &self,
        resident: &'a BTreeSet<usize>,
        playhead: usize,
        direction: Direction,
    ) -> Box<dyn Iterator<Item = usize> + 'a> {
        let below = resident.range(..playhead).copied();
        let above = resident.range(playhead + 1..).copied();
        match (direction, self.loop_mode) {
            (Direction::Forward, LoopMode::Loop) => Box::new(below.rev().chain(above.rev())),
            (Direction::Forward, _) => Box::new(below.chain(above.rev())),
            (Direction::Backward, LoopMode::Loop) => Box::new(above.chain(below)),
            (Direction::Backward, _) => Box::new(above.rev().chain(below)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn walk(loop_mode: LoopMode, start: usize, direction: Direction, count: u64) -> Vec<usize> {
        let travel = Travel {
            frame_count: 4,
            loop_mode,
        };
        (0..count)
            .map(|steps| travel.after(start, direction, steps).index)
            .collect()
    }

    #[test]
    fn each_mode_goes_its_way() {
        use Direction::{Backward, Forward};
        assert_eq!(walk(LoopMode::Off, 1, Forward, 5), [1, 2, 3, 3, 3]);
        assert_eq!(walk(LoopMode::Off, 1, Backward, 4), [1, 0, 0, 0]);
        assert_eq!(walk(LoopMode::Loop, 2, Forward, 5), [2, 3, 0, 1, 2]);
        assert_eq!(walk(LoopMode::Loop, 1, Backward, 5), [1, 0, 3, 2, 1]);
        assert_eq!(
            walk(LoopMode::PingPong, 2, Forward, 8),
            [2, 3, 2, 1, 0, 1, 2, 3]
        );
        assert_eq!(walk(LoopMode::PingPong, 1, Backward, 6), [1, 0, 1, 2, 3, 2]);
        assert_eq!(walk(LoopMode::PingPong, 3, Forward, 3), [3, 2, 1]);
    }

    fn any_travel() -> impl Strategy<Value = (Travel, usize, Direction)> {
        (1usize..12, 0usize..12, 0usize..3, any::<bool>()).prop_map(|(n, playhead, mode, back)| {
            (
                Travel {
                    frame_count: n,
                    loop_mode: LoopMode::ALL[mode],
                },
                playhead % n,
                if back {
                    Direction::Backward
                } else {
                    Direction::Forward
                },
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
        fn the_plan_is_the_walk((travel, start, direction) in any_travel()) {
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
        }

        #[test]
        fn what_is_needed_last_is_found_first(
            (travel, playhead, direction) in any_travel(), held in prop::collection::btree_set(0usize..12, 0..12),
        ) {
            let held: BTreeSet<usize> = held.into_iter().filter(|&i| i < travel.frame_count).collect();
            let found: Vec<usize> = travel.needed_last_first(&held, playhead, direction).collect();
            let mut expected: Vec<usize> = held.into_iter().filter(|&i| i != playhead).collect();
            expected.sort_by_key(|&i| std::cmp::Reverse(travel.rank(playhead, direction, i)));
            prop_assert_eq!(found, expected);
        }
    }
}
