use super::Direction::{Backward, Forward};
use super::*;
use proptest::prelude::*;

fn at(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds)
}

/// Creates a clock at ten frames per second, playing from frame 0 since time 0.
fn playing(frame_count: usize, loop_mode: LoopMode) -> Clock {
    let mut clock = Clock::new(frame_count);
    clock.set_fps(10.0, Duration::ZERO);
    clock.set_loop_mode(loop_mode, Duration::ZERO);
    clock.play(Duration::ZERO);
    clock
}

/// Returns the frames at the midpoint of each tenth of a second.
fn shown(clock: &mut Clock, from: usize, count: usize) -> Vec<usize> {
    (from..from + count)
        .map(|tenth| clock.advance(at((tenth as f64 + 0.5) / 10.0)))
        .collect()
}

#[test]
fn a_new_clock_is_paused_at_the_start() {
    let mut clock = Clock::new(5);
    assert_eq!(clock.advance(at(100.0)), 0);
    assert!(!clock.is_playing());
    assert_eq!(clock.next_deadline(), None);
    assert_eq!(
        (clock.fps(), clock.speed(), clock.loop_mode()),
        (24.0, 1.0, LoopMode::Loop)
    );
}

#[test]
fn looping_starts_over() {
    let mut clock = playing(3, LoopMode::Loop);
    assert_eq!(shown(&mut clock, 0, 7), [0, 1, 2, 0, 1, 2, 0]);
    assert_eq!(clock.skipped(), 0);
}

#[test]
fn the_last_frame_lasts_as_long_as_the_others_then_playing_ends() {
    let mut clock = playing(3, LoopMode::Off);
    assert_eq!(shown(&mut clock, 0, 3), [0, 1, 2]);
    assert!(clock.is_playing());
    assert_eq!(clock.next_deadline(), Some(at(0.3)));
    assert_eq!(clock.advance(at(0.3)), 2);
    assert!(!clock.is_playing());
    assert_eq!(clock.next_deadline(), None);
    // Playing at the end starts over.
    clock.play(at(1.0));
    assert_eq!(clock.frame(), 0);
    assert_eq!(clock.advance(at(1.15)), 1);
}

#[test]
fn backward_playback_ends_at_the_first_frame_and_restarts_from_the_last() {
    let mut clock = playing(3, LoopMode::Off);
    clock.seek(2, at(0.0));
    clock.set_speed(-1.0, at(0.0));
    assert_eq!(shown(&mut clock, 0, 3), [2, 1, 0]);
    clock.advance(at(0.31));
    assert!(!clock.is_playing());
    clock.toggle(at(1.0));
    assert_eq!(
        (clock.frame(), clock.is_playing(), clock.direction()),
        (2, true, Direction::Backward)
    );
}

#[test]
fn ping_pong_shows_each_end_once() {
    let mut clock = playing(3, LoopMode::PingPong);
    assert_eq!(shown(&mut clock, 0, 9), [0, 1, 2, 1, 0, 1, 2, 1, 0]);
    let mut clock = playing(2, LoopMode::PingPong);
    assert_eq!(shown(&mut clock, 0, 5), [0, 1, 0, 1, 0]);
}

#[test]
fn ping_pong_reports_its_next_frame() {
    let mut clock = playing(3, LoopMode::PingPong);
    let directions: Vec<Direction> = (0..6)
        .map(|tenth| {
            clock.advance(at((tenth as f64 + 0.5) / 10.0));
            clock.direction()
        })
        .collect();
    assert_eq!(directions, [Forward, Forward, Backward, Backward, Forward, Forward]);
}

#[test]
fn reverse_playback_loops_too() {
    let mut clock = playing(3, LoopMode::Loop);
    clock.set_speed(-1.0, at(0.0));
    assert_eq!(shown(&mut clock, 0, 5), [0, 2, 1, 0, 2]);
    let mut clock = playing(3, LoopMode::PingPong);
    clock.set_speed(-1.0, at(0.0));
    assert_eq!(shown(&mut clock, 0, 5), [0, 1, 2, 1, 0]);
}

#[test]
fn a_single_frame_never_sets_a_deadline() {
    for loop_mode in [LoopMode::Loop, LoopMode::PingPong] {
        let mut clock = playing(1, loop_mode);
        assert_eq!(clock.next_deadline(), None);
        assert_eq!(clock.advance(at(50.0)), 0);
        assert_eq!((clock.is_playing(), clock.skipped()), (true, 0));
        assert!(!clock.is_moving());
        clock.set_frames(0..2, at(60.0));
        assert!(clock.is_moving(), "a live source has sent another one");
    }
    let mut clock = playing(1, LoopMode::Off);
    assert_eq!(clock.next_deadline(), Some(at(0.1)));
    assert_eq!(clock.advance(at(0.1)), 0);
    assert!(!clock.is_playing());
}

#[test]
fn an_empty_sequence_is_handled() {
    let mut clock = Clock::new(0);
    for loop_mode in LoopMode::ALL {
        clock.set_loop_mode(loop_mode, at(0.0));
        clock.play(at(0.0));
        clock.step(3, at(0.5));
        clock.seek(7, at(0.6));
        clock.play(at(1.0));
        assert_eq!(clock.advance(at(2.0)), 0);
    }
}

#[test]
fn late_calls_count_skipped_frames() {
    let mut clock = playing(100, LoopMode::Loop);
    clock.advance(at(0.05));
    assert_eq!(clock.advance(at(0.55)), 5);
    assert_eq!(clock.skipped(), 4);
    // At the end of a sequence that does not loop, frames that do not exist are not counted.
    let mut clock = playing(4, LoopMode::Off);
    clock.advance(at(0.05));
    assert_eq!(clock.advance(at(9.0)), 3);
    assert_eq!(clock.skipped(), 2);
}

#[test]
fn seeking_and_stepping_skip_nothing() {
    let mut clock = playing(100, LoopMode::Loop);
    clock.seek(50, at(0.05));
    assert_eq!(clock.advance(at(0.14)), 50);
    assert_eq!(clock.advance(at(0.16)), 51);
    clock.step(10, at(0.17));
    assert_eq!((clock.frame(), clock.is_playing()), (61, false));
    assert_eq!(clock.skipped(), 0);
}

#[test]
fn steps_wrap_around_only_in_looping_modes() {
    let mut clock = Clock::new(5);
    clock.step(-2, at(0.0));
    assert_eq!(clock.frame(), 3);
    clock.step(12, at(0.0));
    assert_eq!(clock.frame(), 0);
    clock.step(i64::MIN, at(0.0));
    assert!(clock.frame() < 5);
    for loop_mode in [LoopMode::Off, LoopMode::PingPong] {
        clock.set_loop_mode(loop_mode, at(0.0));
        clock.step(10, at(0.0));
        assert_eq!(clock.frame(), 4);
        clock.step(-10, at(0.0));
        assert_eq!(clock.frame(), 0);
    }
}

#[test]
fn a_seek_beyond_the_end_goes_to_the_last_frame() {
    let mut clock = Clock::new(5);
    clock.seek(usize::MAX, at(0.0));
    assert_eq!(clock.frame(), 4);
}

#[test]
fn a_pause_keeps_the_fraction_of_a_frame() {
    let mut clock = playing(10, LoopMode::Loop);
    clock.pause(at(0.27));
    assert_eq!(clock.frame(), 2);
    assert_eq!(clock.advance(at(100.0)), 2);
    clock.play(at(200.0));
    assert_eq!(clock.advance(at(200.029)), 2);
    assert_eq!(clock.advance(at(200.031)), 3);
}

#[test]
fn another_rate_keeps_the_position() {
    let mut clock = playing(100, LoopMode::Loop);
    clock.set_fps(1.0, at(0.55));
    assert_eq!(clock.frame(), 5);
    assert_eq!(clock.advance(at(1.04)), 5);
    assert_eq!(clock.advance(at(1.06)), 6);
    clock.set_speed(10.0, at(1.06));
    assert_eq!(clock.advance(at(1.14)), 6);
    assert_eq!(clock.advance(at(1.16)), 7);
}

#[test]
fn reversing_direction_runs_the_frame_back() {
    let mut clock = playing(10, LoopMode::Loop);
    clock.set_speed(-1.0, at(0.53));
    assert_eq!(clock.frame(), 5);
    assert_eq!(clock.advance(at(0.559)), 5);
    assert_eq!(clock.advance(at(0.561)), 4);
    assert_eq!(clock.direction(), Direction::Backward);
}

#[test]
fn values_out_of_range_are_clamped_or_ignored() {
    let mut clock = Clock::new(3);
    clock.set_speed(1e9, at(0.0));
    assert_eq!(clock.speed(), MAX_SPEED);
    clock.set_speed(-1e-9, at(0.0));
    assert_eq!(clock.speed(), -MIN_SPEED);
    clock.set_speed(0.0, at(0.0));
    clock.set_speed(f64::NAN, at(0.0));
    assert_eq!(clock.speed(), -MIN_SPEED);
    clock.set_fps(f64::NAN, at(0.0));
    assert_eq!(clock.fps(), DEFAULT_FPS);
    clock.set_fps(f64::INFINITY, at(0.0));
    assert_eq!(clock.fps(), FPS_RANGE.1);
}

#[test]
fn time_running_backward_changes_nothing() {
    let mut clock = playing(10, LoopMode::Loop);
    assert_eq!(clock.advance(at(0.55)), 5);
    assert_eq!(clock.advance(at(0.15)), 5);
    clock.pause(at(0.1));
    assert_eq!(clock.frame(), 5);
}

#[test]
fn there_is_no_drift_in_a_day() {
    let mut clock = Clock::new(1_000_000_000);
    clock.set_fps(30.0, at(0.0));
    clock.play(at(0.0));
    // Called about every 16.7 ms for a while, then a day later.
    for call in 0..1000 {
        clock.advance(Duration::from_micros(call * 16_683));
    }
    assert_eq!(clock.advance(at(86_400.0)), 30 * 86_400);
}

/// Frames that begin at 0, 1, 3 and 4 tenths of a second.
fn uneven(loop_mode: LoopMode) -> Clock {
    let times = [0, 100, 300, 400].map(Duration::from_millis);
    let (pace, fps) = Pace::of_times(&times).unwrap();
    let mut clock = playing(4, loop_mode);
    clock.set_pace(pace, Duration::ZERO);
    clock.set_fps(fps, Duration::ZERO);
    clock
}

#[test]
fn frame_durations_follow_their_times() {
    let mut clock = uneven(LoopMode::Loop);
    assert_eq!(shown(&mut clock, 0, 11), [0, 1, 1, 2, 3, 0, 1, 1, 2, 3, 0]);
    assert_eq!(clock.skipped(), 0);
    let mut clock = uneven(LoopMode::PingPong);
    assert_eq!(shown(&mut clock, 0, 12), [0, 1, 1, 2, 3, 2, 1, 1, 0, 1, 1, 2]);
    let mut clock = uneven(LoopMode::Off);
    assert_eq!(shown(&mut clock, 0, 6), [0, 1, 1, 2, 3, 3]);
    assert!(!clock.is_playing());
}

#[test]
fn pausing_within_a_long_frame_keeps_its_place() {
    let mut clock = uneven(LoopMode::Loop);
    clock.pause(at(0.25));
    clock.play(at(10.0));
    assert_eq!(clock.next_deadline(), Some(at(10.05)));
    assert_eq!(clock.advance(at(10.04)), 1);
    assert_eq!(clock.advance(at(10.06)), 2);
    // Reversed halfway through a long frame, the other half remains.
    let mut clock = uneven(LoopMode::Loop);
    clock.set_speed(-1.0, at(0.15));
    assert_eq!(clock.advance(at(0.19)), 1);
    assert_eq!(clock.advance(at(0.21)), 0);
}

#[test]
fn a_growing_sequence_plays_on() {
    let mut clock = playing(2, LoopMode::Off);
    assert_eq!(clock.advance(at(0.15)), 1);
    clock.set_frames(0..4, at(0.15));
    assert_eq!(shown(&mut clock, 2, 2), [2, 3]);
}

#[test]
fn playback_between_in_and_out_point_is_a_separate_sequence() {
    let range = PlayRange::default().beginning_at(2).ending_at(4);
    let ranged = |loop_mode, frame| {
        let mut clock = playing(9, loop_mode);
        clock.seek(frame, at(0.0));
        clock.set_range(range, at(0.0));
        clock
    };
    let mut clock = ranged(LoopMode::Loop, 3);
    assert_eq!(shown(&mut clock, 0, 6), [3, 4, 2, 3, 4, 2]);
    let mut clock = ranged(LoopMode::PingPong, 3);
    assert_eq!(shown(&mut clock, 0, 6), [3, 4, 3, 2, 3, 4]);
    // From outside the range it jumps to the in point, which does not count as skipped frames.
    let mut clock = ranged(LoopMode::Loop, 7);
    assert_eq!(shown(&mut clock, 0, 4), [7, 2, 3, 4]);
    assert_eq!(clock.skipped(), 0);
    let mut clock = ranged(LoopMode::Off, 3);
    assert_eq!(shown(&mut clock, 0, 3), [3, 4, 4]);
    assert!(!clock.is_playing());
    clock.play(at(1.0));
    assert_eq!(clock.frame(), 2, "again means from the in point");
    // For everything else, the end of the sequence is unchanged.
    clock.seek(8, at(1.0));
    assert_eq!(clock.frame(), 8);
    clock.step(-1, at(1.0));
    assert_eq!(clock.frame(), 7);
    // A single-frame range needs one wake-up, to jump there.
    let mut clock = playing(9, LoopMode::Loop);
    clock.set_range(PlayRange::default().beginning_at(5).ending_at(5), at(0.0));
    assert_eq!(clock.next_deadline(), Some(at(0.1)));
    assert_eq!(clock.advance(at(0.1)), 5);
    assert_eq!(clock.next_deadline(), None);
}

#[test]
fn setting_points_while_playing_keeps_the_position_within_the_frame() {
    let mut clock = playing(9, LoopMode::Loop);
    clock.set_range(PlayRange::default().ending_at(1), at(0.05));
    assert_eq!(clock.advance(at(0.09)), 0);
    assert_eq!(clock.advance(at(0.11)), 1);
    assert_eq!(clock.advance(at(0.21)), 0);
    // An open end grows with the sequence.
    let mut clock = playing(3, LoopMode::Loop);
    clock.set_range(PlayRange::default().beginning_at(2), at(0.0));
    clock.set_frames(0..4, at(0.0));
    clock.seek(3, at(0.0));
    assert_eq!(shown(&mut clock, 0, 3), [3, 2, 3]);
}

proptest! {
    /// A window that sleeps until each deadline sees every frame, once, in order, and never spins.
    #[test]
    fn every_deadline_advances_the_clock(
        fps in 0.1f64..1000.0, speed in 0.1f64..10.0, mode in 0usize..3, start in 0.0f64..1e6, count in 2usize..9,
        first in 0usize..8,
    ) {
        let mut clock = Clock::new(count);
        clock.set_fps(fps, at(start));
        clock.set_speed(speed, at(start));
        clock.set_loop_mode(LoopMode::ALL[mode], at(start));
        // At least two frames: with a single one there is nothing to wake up for.
        clock.set_range(PlayRange::default().beginning_at(first.min(count - 2)), at(start));
        clock.play(at(start));
        let mut before = clock.frame();
        for _ in 0..20 {
            let Some(deadline) = clock.next_deadline() else { break };
            let frame = clock.advance(deadline);
            prop_assert!(frame != before || !clock.is_playing(), "spins at {frame}");
            before = frame;
        }
        prop_assert_eq!(clock.skipped(), 0);
        prop_assert_eq!(clock.is_playing(), LoopMode::ALL[mode] != LoopMode::Off);
    }

    /// The frame depends on the time alone, not on how often the clock was polled.
    #[test]
    fn more_frequent_calls_change_nothing(mut times in prop::collection::vec(0.0f64..20.0, 1..30), mode in 0usize..3) {
        times.sort_by(f64::total_cmp);
        let mut often = playing(7, LoopMode::ALL[mode]);
        let mut last = 0;
        for &time in &times {
            last = often.advance(at(time));
        }
        let mut once = playing(7, LoopMode::ALL[mode]);
        prop_assert_eq!(once.advance(at(times[times.len() - 1])), last);
    }
}
