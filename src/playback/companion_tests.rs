//! Two sequences by one clock that the test turns, on workers and a disk that do not exist.

use super::*;
use crate::cloud::{Positions, RawCloud};
use crate::playback::Player;
use crate::scene::Primitive;
use crate::sequence::simulation::{Cost, Simulation};
use crate::sequence::{FrameEntry, FrameState};
use proptest::prelude::*;
use std::time::Duration;

const POINTS: usize = 256;

const FAST: Cost = Cost {
    decode_ms: 1.0,
    ns_per_point: 10.0,
};

/// A sequence of `count` frames of `spacing_ms`, or without times, at 25 per second.
fn sequence(count: u64, spacing_ms: Option<u64>, broken: &'static [u64]) -> Arc<Sequence> {
    let source = |number| FrameEntry {
        number: Some(number),
        time: spacing_ms.map(|spacing| Duration::from_millis(5000 + number * spacing)),
        ..FrameEntry::file(format!("{number}.ply"))
    };
    let sequence = Sequence::with_decoder((0..count).map(source).collect(), |source| {
        if source.number.is_some_and(|number| broken.contains(&number)) {
            return Err("torn".into());
        }
        let positions = (0..POINTS).map(|i| [i as f32, 0.0, 0.0]).collect();
        Ok(RawCloud::from_positions(Positions::F32(positions)))
    });
    Arc::new(sequence.with_fps(25.0))
}

/// Two sequences in one window.
struct Theatre {
    player: Player,
    companion: Companion,
    workers: [Simulation; 2],
    style: Style,
    now_ms: u64,
}

fn options(budget_bytes: usize) -> LoaderOptions {
    LoaderOptions {
        workers: 1,
        budget_bytes,
        ..LoaderOptions::default()
    }
}

impl Theatre {
    fn new(sequences: &[Arc<Sequence>; 2], costs: [Cost; 2], budget_bytes: usize) -> Self {
        let shares = Companion::shares(budget_bytes);
        let (a, a_workers) = Simulation::new(&sequences[0], options(shares[0]), POINTS, move |_| costs[0]);
        let (b, b_workers) = Simulation::new(&sequences[1], options(shares[1]), POINTS, move |_| costs[1]);
        Self {
            player: Player::with_loader(a, true),
            companion: Companion::with_loader(&sequences[0], b),
            workers: [a_workers, b_workers],
            style: Style {
                primitive: Primitive::Point,
                ..Style::default()
            },
            now_ms: 0,
        }
    }

    fn now(&self) -> Duration {
        Duration::from_millis(self.now_ms)
    }

    /// Simulates one window update.
    fn update(&mut self) {
        let now = self.now();
        let (player, companion) = (&mut self.player, &mut self.companion);
        for (workers, loader) in self.workers.iter_mut().zip([player.loader(), companion.loader()]) {
            workers.advance(loader, now);
        }
        player.update_with_companion(now, &self.style, |clock, is_playing| {
            companion.prepare(clock, is_playing, &self.style)
        });
        if !(player.is_playing() && player.waiting_for().is_some()) {
            companion.show(&self.style);
        }
    }

    fn shown(&self) -> [Option<usize>; 2] {
        [self.player.shown(), self.companion.shown()].map(|frame| frame.map(|frame| frame.index))
    }

    /// Plays until `end_ms`: the times in milliseconds and the pairs of frames first shown then.
    fn play(&mut self, end_ms: u64) -> Vec<(u64, Option<usize>, Option<usize>)> {
        let mut schedule = Vec::new();
        let mut last = [None; 2];
        while self.now_ms <= end_ms {
            self.update();
            if self.shown() != last {
                last = self.shown();
                schedule.push((self.now_ms, last[0], last[1]));
            }
            self.now_ms += 1;
        }
        schedule
    }
}

#[test]
fn both_change_together_and_the_slower_disk_sets_the_pace() {
    let slow = Cost {
        decode_ms: 60.0,
        ns_per_point: 0.0,
    };
    for costs in [[FAST, slow], [slow, FAST]] {
        let sequences = [sequence(6, None, &[]), sequence(6, None, &[])];
        let mut theatre = Theatre::new(&sequences, costs, 1 << 30);
        // One frame every 60 ms from the disk; then all are loaded, and the loop achieves its 40 ms.
        let expected = [
            (60, Some(0), Some(0)),
            (120, Some(1), Some(1)),
            (180, Some(2), Some(2)),
            (240, Some(3), Some(3)),
            (300, Some(4), Some(4)),
            (360, Some(5), Some(5)),
            (400, Some(0), Some(0)),
            (440, Some(1), Some(1)),
        ];
        assert_eq!(theatre.play(450), expected);
        assert_eq!(theatre.player.late_frames(), 5);
    }
}

#[test]
fn frames_are_paired_by_time_by_index_and_with_an_offset() {
    // B: half the rate, and it ends before A.
    let sequences = [sequence(6, Some(40), &[]), sequence(2, Some(80), &[])];
    let mut theatre = Theatre::new(&sequences, [FAST; 2], 1 << 30);
    assert_eq!(theatre.companion.paired_by(), PairBy::Time, "both have times");
    let pairs = |theatre: &mut Theatre| -> Vec<Option<usize>> {
        (0..6)
            .map(|frame| {
                theatre.player.seek(frame, theatre.now());
                // Once to request it, once to get it.
                for _ in 0..10 {
                    theatre.update();
                    theatre.now_ms += 1;
                }
                assert_eq!(theatre.shown()[0], Some(frame));
                assert_eq!(theatre.shown()[1], theatre.companion.frame());
                assert_eq!(theatre.companion.waiting_for(), None);
                theatre.shown()[1]
            })
            .collect()
    };
    theatre.play(10);
    theatre.player.toggle(theatre.now());
    // A at 0, 40, 80 … next to B at 0 and 80: in between, the earlier one; B lasts until slightly after 120.
    let by_time = [Some(0), Some(0), Some(1), Some(1), None, None];
    assert_eq!(pairs(&mut theatre), by_time);
    theatre.companion.set_offset_frames(-1);
    let a_frame_earlier = [None, Some(0), Some(0), Some(0), Some(1), Some(1)];
    assert_eq!(pairs(&mut theatre), a_frame_earlier);
    theatre.companion.pair_by(PairBy::Index);
    assert_eq!(pairs(&mut theatre), [None, Some(0), Some(1), None, None, None]);
    theatre.companion.set_offset_frames(0);
    assert_eq!(pairs(&mut theatre), [Some(0), Some(1), None, None, None, None]);
}

#[test]
fn without_times_of_both_the_numbers_decide() {
    for (a, b) in [(None, Some(40)), (Some(40), None), (None, None)] {
        let sequences = [sequence(3, a, &[]), sequence(3, b, &[])];
        let theatre = Theatre::new(&sequences, [FAST; 2], 1 << 30);
        assert_eq!(theatre.companion.paired_by(), PairBy::Number);
        assert!(theatre.companion.times().is_none());
    }
}

#[test]
fn a_copy_with_missing_files_stays_in_sync_with_its_original() {
    let entries = sequence(4, None, &[]).entries();
    let others = entries.iter().filter(|entry| entry.number != Some(1));
    let lacks_one: Vec<FrameEntry> = others.map(|entry| FrameEntry::clone(entry)).collect();
    let copy = Sequence::with_decoder(lacks_one, |_| {
        let positions = (0..POINTS).map(|i| [i as f32, 0.0, 0.0]).collect();
        Ok(RawCloud::from_positions(Positions::F32(positions)))
    });
    let sequences = [sequence(4, None, &[]), Arc::new(copy)];
    let mut theatre = Theatre::new(&sequences, [FAST; 2], 1 << 30);
    theatre.play(10);
    theatre.player.toggle(theatre.now());
    let pairs: Vec<_> = (0..4)
        .map(|frame| {
            theatre.player.seek(frame, theatre.now());
            theatre.update();
            theatre.companion.frame()
        })
        .collect();
    assert_eq!(pairs, [Some(0), None, Some(1), Some(2)]);
}

#[test]
fn without_times_and_numbers_of_both_the_index_decides() {
    let unnumbered = Sequence::with_decoder(vec![FrameEntry::file("a.ply"), FrameEntry::file("b.ply")], |_| {
        Err("not read".into())
    });
    let sequences = [sequence(3, None, &[]), Arc::new(unnumbered)];
    let theatre = Theatre::new(&sequences, [FAST; 2], 1 << 30);
    assert_eq!(theatre.companion.paired_by(), PairBy::Index);
    assert!(theatre.companion.numbers().is_none());
}

#[test]
fn a_broken_frame_of_b_does_not_stop_playback_and_is_reported_once() {
    let sequences = [sequence(4, None, &[]), sequence(4, None, &[2])];
    let mut theatre = Theatre::new(&sequences, [FAST; 2], 1 << 30);
    let shown_by_a: Vec<_> = theatre.play(300).iter().map(|&(ms, a, _)| (ms, a)).collect();
    let each_40_ms: Vec<_> = (0..8).map(|frame| (2 + 40 * frame, Some(frame as usize % 4))).collect();
    assert_eq!(shown_by_a, each_40_ms);
    theatre.player.seek(2, theatre.now());
    theatre.update();
    assert_eq!(theatre.companion.failure().unwrap().index(), 2);
    assert_eq!(theatre.companion.waiting_for(), None);
    let change = theatre.companion.show(&theatre.style);
    assert!(change.new_failure.is_none() && !change.visible, "told before");
}

#[test]
fn scrubbing_shows_cached_frames_without_waiting() {
    let slow = Cost {
        decode_ms: 60.0,
        ns_per_point: 0.0,
    };
    let sequences = [sequence(6, None, &[]), sequence(6, None, &[])];
    let mut theatre = Theatre::new(&sequences, [FAST, slow], 1 << 30);
    theatre.play(70);
    theatre.player.toggle(theatre.now());
    theatre.player.seek(4, theatre.now());
    theatre.update();
    assert_eq!(theatre.shown(), [Some(4), Some(0)]);
    assert_eq!(theatre.companion.waiting_for(), Some(4));
    // Work in progress is finished first, then the playhead's frame.
    theatre.play(190);
    assert_eq!(theatre.shown(), [Some(4); 2]);
}

#[test]
fn frames_ahead_are_prepared_in_the_direction_of_the_clock() {
    let sequences = [sequence(40, None, &[]), sequence(40, None, &[])];
    // Memory for ten frames each.
    let frame_bytes = frame_bytes();
    let mut theatre = Theatre::new(&sequences, [FAST; 2], 20 * frame_bytes);
    theatre.player.set_loop_mode(LoopMode::Off, theatre.now());
    theatre.player.seek(20, theatre.now());
    theatre.play(30);
    let ready = |theatre: &Theatre| -> Vec<usize> {
        let states = theatre.companion.loader().states();
        let all = states.iter().enumerate();
        all.filter(|(_, state)| **state == FrameState::Ready)
            .map(|(index, _)| index)
            .collect()
    };
    assert_eq!(ready(&theatre), (20..30).collect::<Vec<_>>());
    theatre.player.set_speed(-1.0, theatre.now());
    theatre.play(60);
    let found = ready(&theatre);
    let playhead = theatre.player.clock().frame();
    assert!(
        found.iter().filter(|&&index| index <= playhead).count() >= 9,
        "{found:?} around {playhead}"
    );
}

/// Returns the memory size of a prepared frame.
fn frame_bytes() -> usize {
    let sequences = [sequence(1, None, &[]), sequence(1, None, &[])];
    let mut theatre = Theatre::new(&sequences, [FAST; 2], 1 << 30);
    theatre.play(10);
    theatre.companion.shown().unwrap().byte_size()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn shares_add_up_to_the_budget(budget_bytes in 0usize..=usize::MAX) {
        let [a, b] = Companion::shares(budget_bytes);
        prop_assert_eq!(a.checked_add(b), Some(budget_bytes));
        prop_assert!(a.abs_diff(b) <= 1);
    }

    /// During all playback, both together stay within the budget, as long as each share holds a few frames: also after
    /// the first sequence has filled all of it alone, and when it is changed.
    #[test]
    fn both_together_stay_within_the_budget(
        frames in 4usize..30,
        later_frames in 4usize..30,
        counts in [1u64..40, 1u64..40],
        decode_ms in [1u32..50, 1u32..50],
        loop_mode in prop::sample::select(LoopMode::ALL.to_vec()),
        speed in prop::sample::select(vec![-2.0, 0.5, 1.0, 4.0]),
        seeks in prop::collection::vec(0usize..40, 0..4),
    ) {
        let frame_bytes = frame_bytes();
        let costs = decode_ms.map(|ms| Cost { decode_ms: f64::from(ms), ns_per_point: 0.0 });
        let sequences = counts.map(|count| sequence(count, None, &[]));
        let budget_bytes = 2 * frames * frame_bytes;
        let mut theatre = Theatre::new(&sequences, costs, budget_bytes);
        // Without a companion at first.
        theatre.player.loader().set_budget_bytes(budget_bytes);
        for _ in 0..500 {
            let now = theatre.now();
            theatre.workers[0].advance(theatre.player.loader(), now);
            theatre.player.update(now, &theatre.style);
            theatre.now_ms += 1;
        }
        theatre.player.set_loop_mode(loop_mode, theatre.now());
        theatre.player.set_speed(speed, theatre.now());
        let mut seeks = seeks.into_iter();
        for budget_bytes in [budget_bytes, 2 * later_frames * frame_bytes] {
            let [a, b] = Companion::shares(budget_bytes);
            theatre.player.loader().set_budget_bytes(a);
            theatre.companion.loader().set_budget_bytes(b);
            for step in 0..300 {
                if step % 150 == 100 && let Some(frame) = seeks.next() {
                    theatre.player.seek(frame, theatre.now());
                }
                theatre.update();
                theatre.now_ms += 1;
                let used = [theatre.player.loader(), theatre.companion.loader()].map(|loader| {
                    let stats = loader.stats();
                    stats.resident_bytes + stats.coarse_bytes + stats.in_flight_bytes
                });
                prop_assert!(used[0] + used[1] <= budget_bytes, "{used:?} of {budget_bytes}");
            }
        }
        // The frame that belongs there is shown, or is about to be: if there was none before, it has just been
        // requested.
        let comes = (0..100).any(|_| {
            theatre.update();
            theatre.now_ms += 1;
            theatre.companion.shown().is_some() || theatre.companion.frame().is_none()
        });
        prop_assert!(comes);
    }
}
