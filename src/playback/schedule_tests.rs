//! Tests of the playback schedule: which frame is shown when, and with how many points, for slow files, slow rendering
//! and broken files, on a clock advanced by the test.

use super::*;
use crate::cloud::{Positions, RawCloud};
use crate::scene::Primitive;
use crate::sequence::FrameEntry;
use crate::sequence::simulation::{Cost, Simulation};

/// Points of the frames that playing begins with.
const FIRST_POINTS: usize = 1 << 14;

const POINTS: usize = 1 << 16;

/// A window, its workers and its screen, none of which exist.
struct Theatre {
    player: Player,
    workers: Simulation,
    style: Style,
    now: Duration,
    /// Time when the image being drawn is finished.
    free_at: Duration,
    /// Index and number of points of the frame in it.
    last: Option<(usize, usize)>,
    /// Milliseconds to draw this number of points.
    picture_ms: fn(usize) -> f64,
}

/// Times in milliseconds, the frame shown then and its number of points.
type TimedFrame = (u64, usize, usize);

const FAST: Cost = Cost {
    decode_ms: 1.0,
    ns_per_point: 10.0,
};

impl Theatre {
    /// Twelve frames per turn at 25 per second, on two workers.
    fn new(cost: impl Fn(usize) -> Cost + 'static, broken: &'static [u64]) -> Self {
        let source = |number| FrameEntry {
            number: Some(number),
            ..FrameEntry::file(format!("{number}.ply"))
        };
        let sequence = Sequence::with_decoder((0..12).map(source).collect(), |source| {
            if source.number.is_some_and(|number| broken.contains(&number)) {
                return Err("torn".into());
            }
            let position = |i: usize| [(i % 256) as f32, (i / 256) as f32, 0.0];
            let positions = (0..POINTS).map(position).collect();
            Ok(RawCloud::from_positions(Positions::F32(positions)))
        });
        let options = LoaderOptions {
            workers: 2,
            ..LoaderOptions::default()
        };
        let sequence = Arc::new(sequence.with_fps(25.0));
        let (loader, workers) = Simulation::new(&sequence, options, POINTS, cost);
        Self {
            player: Player::with_loader(loader, true),
            workers,
            style: Style {
                primitive: Primitive::Point,
                ..Style::default()
            },
            now: Duration::ZERO,
            free_at: Duration::ZERO,
            last: None,
            picture_ms: |_| 1.0,
        }
    }

    /// Plays until `end_ms` and returns the frames shown.
    fn play(&mut self, end_ms: u64) -> Vec<TimedFrame> {
        let mut schedule = Vec::new();
        let end = Duration::from_millis(end_ms);
        while self.now < end {
            self.workers.advance(&self.player.loader, self.now);
            self.player.update(self.now, &self.style);
            let shown = self.player.shown().map(|frame| (frame.index, frame.frame.len()));
            if let Some((index, points)) = shown
                && shown != self.last
            {
                // Deadlines are rounded up to nanoseconds.
                schedule.push((self.now.as_micros().div_ceil(1000) as u64, index, points));
                let picture_ms = (self.picture_ms)(points);
                self.player.note_picture_ms(points, picture_ms);
                self.free_at = self.now + Duration::from_secs_f64(picture_ms / 1e3);
                self.last = shown;
            }
            self.workers.advance(&self.player.loader, self.now);
            let next = [self.player.next_deadline(), self.workers.next_event()];
            let next = next.into_iter().flatten().min().unwrap_or(end);
            self.now = next.max(self.free_at).max(self.now + Duration::from_nanos(1));
        }
        schedule
    }

    /// Frames shown late, skipped, and with fewer points.
    fn counted(&self) -> [u64; 3] {
        let player = &self.player;
        [
            player.late_frames(),
            player.clock().skipped(),
            player.coarse_frames_shown(),
        ]
    }
}

#[test]
fn fast_frames_are_shown_on_time_with_all_points() {
    let mut theatre = Theatre::new(|_| FAST, &[]);
    let schedule = theatre.play(1000);
    // On an unknown machine only a few points are requested at first; all of them follow 7 ms later.
    assert_eq!(schedule[..2], [(2, 0, FIRST_POINTS), (9, 0, POINTS)]);
    let due = |number: usize| (2 + 40 * number as u64, number % 12, POINTS);
    assert_eq!(schedule[2..], (1..25).map(due).collect::<Vec<_>>());
    assert_eq!(theatre.counted(), [0, 0, 1]);
}

#[test]
fn slow_frames_get_fewer_points_and_are_on_time() {
    // Of the 80 ms between two frames, 68 are planned: 4 to decode and 64 for 32,000 points at 2 µs.
    let slow = Cost {
        decode_ms: 4.0,
        ns_per_point: 2000.0,
    };
    let mut theatre = Theatre::new(move |_| slow, &[]);
    let schedule = theatre.play(1000);
    let due = |number: u64| (37 + 40 * number, number as usize, FIRST_POINTS);
    assert_eq!(schedule[..6], [0, 1, 2, 3, 4, 5].map(due));
    assert_eq!(theatre.counted()[..2], [0, 0], "neither late nor skipped");
    assert!(
        schedule.windows(2).all(|pair| pair[1].0 - pair[0].0 == 40),
        "{schedule:?}"
    );

    // When paused, the frame gets all its points.
    theatre.player.toggle(theatre.now);
    let paused = theatre.play(1400);
    let (_, frame, points) = *schedule.iter().chain(&paused).next_back().unwrap();
    assert_eq!((frame, points), (theatre.player.clock().frame(), POINTS));
}

#[test]
fn a_loop_gains_points_with_each_repetition() {
    let slow = Cost {
        decode_ms: 4.0,
        ns_per_point: 1500.0,
    };
    let mut theatre = Theatre::new(move |_| slow, &[]);
    theatre.play(5000);
    let schedule = theatre.play(5600);
    assert!(schedule.len() >= 12, "a whole turn");
    assert!(schedule.iter().all(|&(_, _, points)| points == POINTS), "{schedule:?}");
    assert_eq!(theatre.counted()[..2], [0, 0]);
}

#[test]
fn slow_drawing_gets_fewer_points_instead_of_skipping_frames() {
    let mut theatre = Theatre::new(|_| FAST, &[]);
    // 67 ms for all points, 34 for half of them.
    theatre.picture_ms = |points| 1.0 + points as f64 / 1000.0;
    theatre.play(3000);
    let skipped = theatre.player.clock().skipped();
    assert_eq!(
        skipped, 2,
        "three pictures of all points tell, of which two hide one each"
    );
    let schedule = theatre.play(4000);
    assert!(
        schedule.windows(2).all(|pair| pair[1].0 - pair[0].0 == 40),
        "{schedule:?}"
    );
    assert!(
        schedule.iter().all(|&(_, _, points)| points == POINTS / 2),
        "{schedule:?}"
    );
    assert_eq!(theatre.player.clock().skipped(), skipped);
}

#[test]
fn a_disk_that_is_too_slow_for_anything_delays_frames_and_loses_none() {
    let disk = Cost {
        decode_ms: 200.0,
        ns_per_point: 10.0,
    };
    let mut theatre = Theatre::new(move |_| disk, &[]);
    let schedule = theatre.play(1000);
    // The first alone, then two at a time, 200 ms each plus a little for the points; the second of each pair is on
    // time.
    let due = [(201, 0), (401, 1), (441, 2), (601, 3), (641, 4), (801, 5), (841, 6)];
    let shown: Vec<(u64, usize)> = schedule.iter().map(|&(ms, frame, _)| (ms, frame)).collect();
    assert_eq!(shown, due);
    let [late, skipped, _] = theatre.counted();
    assert_eq!((late, skipped), (4, 0));
}

#[test]
fn broken_frames_are_skipped_in_their_time() {
    let mut theatre = Theatre::new(|_| FAST, &[3, 4, 11]);
    let schedule = theatre.play(1000);
    let good = (1..25).filter(|number| ![3, 4, 11].contains(&(number % 12)));
    let expected: Vec<TimedFrame> = good
        .map(|number| (2 + 40 * number as u64, number % 12, POINTS))
        .collect();
    assert_eq!(schedule[2..], expected);
    assert_eq!(theatre.counted(), [0, 0, 1]);
}

/// Render times measured while paused are known when playback starts: no frame first appears with few points.
#[test]
fn playing_after_a_pause_starts_with_all_points() {
    let mut theatre = Theatre::new(|_| FAST, &[]);
    theatre.player.toggle(Duration::ZERO);
    let paused = theatre.play(1000);
    assert_eq!(paused, [(2, 0, POINTS)]);
    theatre.player.toggle(theatre.now);
    let schedule = theatre.play(1500);
    assert!(schedule.len() > 10, "{schedule:?}");
    assert!(schedule.iter().all(|&(_, _, points)| points == POINTS), "{schedule:?}");
}

/// Frames that are there with all points are not shown with them for want of a copy with more than before.
#[test]
fn complete_frames_are_not_drawn_where_that_takes_too_long() {
    let mut theatre = Theatre::new(|_| FAST, &[]);
    // 118 ms for all points, 60 for half of them, 30 for a quarter.
    theatre.picture_ms = |points| 1.0 + points as f64 / 560.0;
    theatre.player.toggle(Duration::ZERO);
    theatre.play(1000);
    assert_eq!(theatre.player.loader.stats().resident_frames, 12, "whole");
    theatre.player.toggle(theatre.now);
    theatre.play(2000);
    let schedule = theatre.play(12_000);
    let points: HashSet<usize> = schedule.iter().map(|&(_, _, points)| points).collect();
    assert_eq!(
        points,
        HashSet::from([POINTS / 4, POINTS / 2]),
        "twice as many are tried"
    );
}
