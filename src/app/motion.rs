//! Camera motion. By itself the camera moves gliding to another view, and turning about the up axis as on a turntable.

use super::fly::Fly;
use super::grip::Grip;
use crate::scene::Camera;
use std::time::Duration;

/// Camera motion sources other than the panels.
#[derive(Debug, Default)]
pub struct CameraMotion {
    /// Keys that fly.
    pub fly: Fly,
    /// The camera on a turntable.
    pub turntable: Turntable,
    /// The transition to another view.
    pub(super) glide: Option<Glide>,
    /// The grabbed image.
    pub(super) grip: Option<Grip>,
}

/// Duration of a glide.
const GLIDE_TIME: Duration = Duration::from_millis(250);

/// After a pause in drawing a turntable does not jump farther than in this time.
const MAX_STEP: Duration = Duration::from_millis(100);

/// A transition to another view. Moving the camera ends it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Glide {
    from: Camera,
    to: Camera,
    begin: Duration,
    /// Camera set last.
    last: Camera,
}

impl Glide {
    pub(super) fn new(from: Camera, to: Camera, begin: Duration) -> Self {
        Self {
            from,
            to,
            begin,
            last: from,
        }
    }

    /// Moves `camera` to its position at `now`; false once the transition is over.
    pub(super) fn step(&mut self, camera: &mut Camera, now: Duration) -> bool {
        if *camera != self.last {
            return false;
        }
        let elapsed = now.saturating_sub(self.begin).as_secs_f64();
        let part = elapsed / GLIDE_TIME.as_secs_f64();
        if part >= 1.0 {
            *camera = self.to;
            return false;
        }
        // Ease in and out.
        let part = part * part * (3.0 - 2.0 * part);
        let closer = (self.to.distance / self.from.distance).powf(part);
        *camera = Camera {
            target_in_world: self.from.target_in_world.lerp(self.to.target_in_world, part),
            distance: self.from.distance * closer,
            ..self.from
        };
        self.last = *camera;
        true
    }
}

/// The camera on its orbit, at an even pace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turntable {
    /// True if the turntable is turning.
    pub is_on: bool,
    /// Speed, degrees per second; negative in the other direction.
    pub deg_per_sec: f64,
    /// The time of the last step.
    last: Option<Duration>,
}

impl Default for Turntable {
    fn default() -> Self {
        Self {
            is_on: false,
            deg_per_sec: 20.0,
            last: None,
        }
    }
}

impl Turntable {
    /// Speeds that the window offers, degrees per second.
    pub const PACES: std::ops::RangeInclusive<f64> = -180.0..=180.0;

    /// Rotates `camera` on to `now`; true if it moved.
    pub(super) fn step(&mut self, camera: &mut Camera, now: Duration) -> bool {
        let last = std::mem::replace(&mut self.last, self.is_on.then_some(now));
        let Some(last) = last.filter(|_| self.is_on) else {
            return false;
        };
        let elapsed = now.saturating_sub(last).min(MAX_STEP);
        let before = *camera;
        camera.orbit(self.deg_per_sec * elapsed.as_secs_f64(), 0.0);
        *camera != before
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::scene::UpAxis;
    use glam::DVec3;

    fn camera() -> Camera {
        Camera::framing(&Aabb::EMPTY, DVec3::ZERO, UpAxis::Y)
    }

    fn at(milliseconds: u64) -> Duration {
        Duration::from_millis(milliseconds)
    }

    #[test]
    fn a_glide_starts_and_ends_where_and_when_it_should() {
        let from = camera();
        let to = Camera {
            target_in_world: DVec3::X,
            distance: 0.25 * from.distance,
            ..from
        };
        let mut now = from;
        let mut glide = Glide::new(from, to, at(1000));
        assert!(glide.step(&mut now, at(1000)));
        assert_eq!(now, from);
        assert!(glide.step(&mut now, at(1125)));
        assert!((now.target_in_world.x - 0.5).abs() < 1e-12);
        assert!((now.distance - 0.5 * from.distance).abs() < 1e-12);
        assert!(!glide.step(&mut now, at(1250)));
        assert_eq!(now, to);
    }

    #[test]
    fn a_glide_ends_when_the_user_moves_the_camera() {
        let from = camera();
        let to = Camera { distance: 0.1, ..from };
        let mut now = from;
        let mut glide = Glide::new(from, to, at(0));
        assert!(glide.step(&mut now, at(100)));
        now.orbit(5.0, 0.0);
        let taken = now;
        assert!(!glide.step(&mut now, at(150)));
        assert_eq!(now, taken);
    }

    #[test]
    fn a_turntable_turns_at_its_speed_and_does_not_catch_up_after_pauses() {
        let mut turntable = Turntable {
            is_on: true,
            deg_per_sec: -40.0,
            ..Turntable::default()
        };
        let mut now = camera();
        let begin = now.azimuth_deg;
        assert!(!turntable.step(&mut now, at(5000)), "the first step says when it began");
        for step in 1..=10 {
            assert!(turntable.step(&mut now, at(5000 + 50 * step)));
        }
        assert!((now.azimuth_deg - (begin - 20.0)).abs() < 1e-9);
        turntable.step(&mut now, at(60_000));
        assert!((now.azimuth_deg - (begin - 24.0)).abs() < 1e-9);
        turntable.is_on = false;
        assert!(!turntable.step(&mut now, at(60_050)));
        turntable.is_on = true;
        assert!(!turntable.step(&mut now, at(90_000)), "it begins anew");
    }
}
