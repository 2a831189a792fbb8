//! Export plan: the frame shown at each time, and its camera, in videos without keyframes by a user.
//!
//! **How it works.** One keyframe per image: it shows the frame that the player would show at the midpoint of that
//! image's interval, whatever its time stamps, speed, direction and range. Video frames are sampled exactly at
//! keyframes then.

use crate::scene::{Camera, CameraPath, Keyframe, PathError};
use crate::timeline::{Clock, Direction, LoopMode};
use std::time::Duration;

/// Number of images after which the clock is re-anchored: it counts the frames since then.
const ANCHOR_PICTURES: usize = 128;

/// A clock at the frame at which its range begins; with `LoopMode::Loop` at its present frame.
fn started(clock: &Clock, now: Duration, loop_mode: LoopMode) -> Clock {
    let mut clock = clock.clone();
    clock.pause(now);
    clock.set_loop_mode(loop_mode, now);
    if loop_mode == LoopMode::Off {
        let frames = clock.range().of(clock.frame_count());
        let first = match clock.direction() {
            Direction::Forward => frames.start,
            Direction::Backward => frames.end.saturating_sub(1),
        };
        clock.seek(first, now);
    } else {
        clock.seek(clock.frame(), now);
    }
    clock.play(now);
    clock
}

/// The frames that `clock` shows, one per image; at least one.
fn frames(clock: &Clock, now: Duration, loop_mode: LoopMode, per_second: f64) -> impl Iterator<Item = usize> {
    let mut clock = started(clock, now, loop_mode);
    (0..).map_while(move |picture: usize| {
        let center_s = (picture as f64 + 0.5) / per_second;
        let at = now + Duration::try_from_secs_f64(center_s).ok()?;
        let frame = clock.advance(at);
        let is_shown = picture == 0 || clock.is_playing();
        if picture.is_multiple_of(ANCHOR_PICTURES) {
            clock.set_fps(clock.fps(), at);
        }
        is_shown.then_some(frame)
    })
}

/// The frames between in and out point, once, as `clock` plays them, from the current viewpoint.
///
/// # Errors
/// If there are more images than a path can have keyframes.
pub(super) fn sequence(camera: Camera, clock: &Clock, now: Duration, per_second: f64) -> Result<CameraPath, PathError> {
    let frames = frames(clock, now, LoopMode::Off, per_second);
    let keys = frames.take(CameraPath::MAX_KEYFRAMES + 1).enumerate();
    let keys = keys.map(|(picture, frame)| key(picture, per_second, camera, frame));
    CameraPath::new(keys.collect(), false)
}

/// `turns` revolutions about the up axis in this many images, at constant speed, as a loop, while the frames play as in
/// `clock`, looping over its range.
///
/// # Errors
/// If there are more images than a path can have keyframes.
pub(super) fn turntable(
    camera: Camera,
    turns: f64,
    count: usize,
    clock: &Clock,
    now: Duration,
    per_second: f64,
) -> Result<CameraPath, PathError> {
    let frames = frames(clock, now, LoopMode::Loop, per_second).take(count);
    let keys = frames.enumerate().map(|(picture, frame)| {
        let turned_deg = 360.0 * turns * picture as f64 / count as f64;
        let camera = Camera {
            azimuth_deg: camera.azimuth_deg + turned_deg,
            ..camera
        };
        key(picture, per_second, camera, frame)
    });
    CameraPath::new(keys.collect(), false)
}

fn key(picture: usize, per_second: f64, camera: Camera, frame: usize) -> Keyframe {
    Keyframe {
        time_s: picture as f64 / per_second,
        camera,
        frame: frame as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::scene::UpAxis;
    use crate::timeline::{Pace, PlayRange};
    use glam::DVec3;

    fn camera() -> Camera {
        Camera::framing(&Aabb::EMPTY, DVec3::ZERO, UpAxis::Y)
    }

    const NOW: Duration = Duration::from_millis(12_345);

    /// The frames of a video of `clock` at a rate, as the video takes them.
    fn frames_of(clock: &Clock, per_second: f64) -> Vec<usize> {
        let path = sequence(camera(), clock, NOW, per_second).unwrap();
        let count = path.picture_count(per_second);
        let at = |picture: usize| path.at(picture as f64 / per_second).1;
        (0..count).map(at).collect()
    }

    #[test]
    fn a_sequence_is_played_once_from_in_to_out_point() {
        let mut clock = Clock::new(10);
        clock.seek(5, NOW);
        assert_eq!(frames_of(&clock, 24.0), (0..10).collect::<Vec<_>>());
        clock.set_range(PlayRange::default().beginning_at(3).ending_at(6), NOW);
        assert_eq!(frames_of(&clock, 24.0), [3, 4, 5, 6]);
        assert_eq!(frames_of(&clock, 48.0), [3, 3, 4, 4, 5, 5, 6, 6]);
        assert_eq!(frames_of(&clock, 12.0), [4, 6]);
        clock.set_speed(-2.0, NOW);
        assert_eq!(frames_of(&clock, 48.0), [6, 5, 4, 3]);
        clock.set_range(PlayRange::default().beginning_at(3).ending_at(3), NOW);
        assert_eq!(frames_of(&clock, 48.0), [3]);
    }

    #[test]
    fn frame_durations_follow_the_timestamps() {
        let times: Vec<Duration> = [0, 100, 200, 500, 600].map(Duration::from_millis).into();
        let (pace, fps) = Pace::of_times(&times).unwrap();
        let mut clock = Clock::new(5);
        clock.set_fps(fps, NOW);
        clock.set_pace(pace, NOW);
        assert_eq!(frames_of(&clock, 10.0), [0, 1, 2, 2, 2, 3, 4]);
    }

    #[test]
    fn long_sequences_lose_no_frame() {
        let clock = Clock::new(1000);
        assert_eq!(frames_of(&clock, 24.0), (0..1000).collect::<Vec<_>>());
        let error = sequence(camera(), &Clock::new(200_000), NOW, 24.0).unwrap_err();
        assert!(matches!(error, PathError::TooMany { .. }), "{error}");
    }

    #[test]
    fn a_turntable_turns_at_constant_speed_while_the_range_loops() {
        let mut clock = Clock::new(10);
        clock.set_range(PlayRange::default().beginning_at(2).ending_at(4), NOW);
        clock.seek(3, NOW);
        let path = turntable(camera(), -1.0, 8, &clock, NOW, 24.0).unwrap();
        assert_eq!(path.picture_count(24.0), 8);
        let begin = camera().azimuth_deg;
        for (picture, frame) in [3, 4, 2, 3, 4, 2, 3, 4].into_iter().enumerate() {
            let (seen, shown) = path.at(picture as f64 / 24.0);
            assert_eq!(shown, frame);
            let turned = seen.azimuth_deg - (begin - 45.0 * picture as f64);
            assert!((turned / 360.0 - (turned / 360.0).round()).abs() < 1e-9);
        }
    }
}
