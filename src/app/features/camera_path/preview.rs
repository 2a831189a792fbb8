//! A camera path as it plays in the window, at its own speed.

use crate::scene::{Camera, CameraPath};
use std::time::Duration;

/// A playing path. Moving the camera ends it.
#[derive(Debug, Clone)]
pub(in crate::app) struct Preview {
    path: CameraPath,
    /// Seconds after the first keyframe at `begun`.
    from_s: f64,
    begun: Duration,
    /// Camera set last.
    last: Camera,
    /// The sequence was playing before.
    pub(in crate::app) resumes: bool,
}

/// Playback position of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::app) struct PreviewTime {
    /// Seconds from the beginning of the video.
    pub(in crate::app) time_s: f64,
    pub(in crate::app) camera: Camera,
    pub(in crate::app) frame: usize,
    /// Nothing follows.
    pub(in crate::app) is_end: bool,
}

impl Preview {
    /// `path` from `time_s` on; from its first keyframe if the time is past its end.
    pub(in crate::app) fn new(path: CameraPath, time_s: f64, camera: Camera, now: Duration, resumes: bool) -> Self {
        let from_s = time_s - first_s(&path);
        let is_within = (0.0..path.duration_s()).contains(&from_s);
        Self {
            from_s: if is_within { from_s } else { 0.0 },
            path,
            begun: now,
            last: camera,
            resumes,
        }
    }

    /// Returns the playback position at `now`; `None` if `camera` is not where it was put: something else controls it.
    pub(in crate::app) fn step(&mut self, camera: &Camera, now: Duration) -> Option<PreviewTime> {
        if *camera != self.last {
            return None;
        }
        let elapsed_s = now.saturating_sub(self.begun).as_secs_f64();
        let duration_s = self.path.duration_s();
        let seconds = (self.from_s + elapsed_s).min(duration_s);
        let (camera, frame) = self.path.at(seconds);
        self.last = camera;
        Some(PreviewTime {
            time_s: first_s(&self.path) + seconds,
            camera,
            frame,
            is_end: seconds >= duration_s,
        })
    }
}

fn first_s(path: &CameraPath) -> f64 {
    path.keyframes().first().map_or(0.0, |key| key.time_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::scene::{Keyframe, UpAxis};
    use glam::DVec3;

    fn camera() -> Camera {
        Camera::framing(&Aabb::EMPTY, DVec3::ZERO, UpAxis::Y)
    }

    /// From second 5 to second 7, thirty frames.
    fn path() -> CameraPath {
        let key = |time_s, frame| Keyframe {
            time_s,
            camera: camera(),
            frame,
        };
        CameraPath::new(vec![key(5.0, 0.0), key(7.0, 30.0)], false).unwrap()
    }

    fn at(milliseconds: u64) -> Duration {
        Duration::from_millis(milliseconds)
    }

    #[test]
    fn the_preview_plays_at_its_speed_to_the_end() {
        let mut preview = Preview::new(path(), 6.0, camera(), at(400), false);
        let preview_time = preview.step(&camera(), at(900)).unwrap();
        let expected = PreviewTime {
            time_s: 6.5,
            camera: path().at(1.5).0,
            frame: 23,
            is_end: false,
        };
        assert_eq!(preview_time, expected);
        let end = preview.step(&preview_time.camera, at(9000)).unwrap();
        assert_eq!((end.time_s, end.frame, end.is_end), (7.0, 30, true));
    }

    #[test]
    fn the_preview_restarts_at_the_end() {
        for time_s in [0.0, 7.0, 80.0] {
            let mut preview = Preview::new(path(), time_s, camera(), at(0), false);
            assert_eq!(preview.step(&camera(), at(0)).unwrap().time_s, 5.0);
        }
    }

    #[test]
    fn moving_the_camera_stops_the_preview() {
        let mut preview = Preview::new(path(), 5.0, camera(), at(0), false);
        let mut taken = preview.step(&camera(), at(100)).unwrap().camera;
        taken.orbit(3.0, 0.0);
        assert_eq!(preview.step(&taken, at(200)), None);
    }
}
