//! Flying with W A S D and Q E, by the place of the keys rather than their letters, so that other layouts fly as well.

use crate::scene::Camera;
use egui::{Event, Key, Modifiers};
use glam::DVec3;

/// The keys of the US layout at the places that fly, and the view-space direction (right, up, backward) of each.
const DIRECTIONS: [(Key, DVec3); 6] = [
    (Key::W, DVec3::NEG_Z),
    (Key::S, DVec3::Z),
    (Key::A, DVec3::NEG_X),
    (Key::D, DVec3::X),
    (Key::Q, DVec3::NEG_Y),
    (Key::E, DVec3::Y),
];

/// Flying speed, in distances to the target per second.
const SPEED_DISTANCES_PER_SEC: f64 = 0.7;

/// Factor by which Shift is faster, and Ctrl slower.
const BOOST: f64 = 4.0;

/// After a pause in drawing the camera does not jump farther than in this time.
const MAX_STEP_SECS: f64 = 0.1;

/// Fly navigation: the keys held.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Fly {
    held: [bool; DIRECTIONS.len()],
    /// Time of the last step, seconds of egui's clock.
    last_secs: Option<f64>,
}

impl Fly {
    /// Notes keys going down and up. While `typing`, keys belong to a text field and all are let go.
    pub fn note(&mut self, events: &[Event], typing: bool) {
        for event in events {
            match event {
                Event::WindowFocused(false) => *self = Self::default(),
                Event::Key {
                    key,
                    physical_key,
                    pressed,
                    modifiers,
                    ..
                } => {
                    let place = physical_key.unwrap_or(*key);
                    let Some(index) = DIRECTIONS.iter().position(|(key, _)| *key == place) else {
                        continue;
                    };
                    // A first key with Ctrl is a shortcut (Ctrl+Q); while flying, Ctrl means slow.
                    let shortcut = (modifiers.ctrl || modifiers.command) && !self.is_flying();
                    self.held[index] = *pressed && !typing && !shortcut;
                }
                _ => {}
            }
        }
        if typing {
            *self = Self::default();
        }
        if !self.is_flying() {
            self.last_secs = None;
        }
    }

    /// True while a key is held: the window then draws without pause.
    pub fn is_flying(&self) -> bool {
        self.held.contains(&true)
    }

    /// Moves `camera` on to `now_secs`.
    pub fn step(&mut self, camera: &mut Camera, now_secs: f64, modifiers: Modifiers) {
        if !self.is_flying() {
            return;
        }
        let elapsed_secs = self
            .last_secs
            .map_or(0.0, |last| (now_secs - last).clamp(0.0, MAX_STEP_SECS));
        self.last_secs = Some(now_secs);
        let direction: DVec3 = DIRECTIONS
            .iter()
            .zip(self.held)
            .filter(|(_, held)| *held)
            .map(|((_, direction), _)| *direction)
            .sum();
        let slow = modifiers.ctrl || modifiers.command;
        let pace = match (modifiers.shift, slow) {
            (true, false) => BOOST,
            (false, true) => 1.0 / BOOST,
            _ => 1.0,
        };
        let length = camera.distance * SPEED_DISTANCES_PER_SEC * pace * elapsed_secs;
        camera.fly(direction.normalize_or_zero() * length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::scene::UpAxis;
    use glam::Vec3;

    fn key(key: Key, physical_key: Option<Key>, pressed: bool, modifiers: Modifiers) -> Event {
        Event::Key {
            key,
            physical_key,
            pressed,
            repeat: false,
            modifiers,
        }
    }

    fn camera() -> Camera {
        let bounds = Aabb {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        };
        Camera {
            azimuth_deg: 0.0,
            elevation_deg: 0.0,
            distance: 10.0,
            ..Camera::framing(&bounds, DVec3::ZERO, UpAxis::Y)
        }
    }

    #[test]
    fn keys_are_matched_by_position_not_by_letter() {
        let mut fly = Fly::default();
        // The key above S is labelled Z on a French keyboard.
        fly.note(&[key(Key::Z, Some(Key::W), true, Modifiers::NONE)], false);
        let mut camera = camera();
        fly.step(&mut camera, 1.0, Modifiers::NONE);
        fly.step(&mut camera, 1.05, Modifiers::NONE);
        let expected = DVec3::new(0.0, 0.0, -10.0 * SPEED_DISTANCES_PER_SEC * 0.05);
        assert!((camera.target_in_world - expected).length() < 1e-9);
        fly.note(&[key(Key::Z, Some(Key::W), false, Modifiers::NONE)], false);
        assert!(!fly.is_flying());
    }

    #[test]
    fn text_fields_shortcuts_and_lost_focus_do_not_fly() {
        let mut fly = Fly::default();
        fly.note(&[key(Key::W, None, true, Modifiers::NONE)], true);
        assert!(!fly.is_flying());
        fly.note(&[key(Key::Q, None, true, Modifiers::CTRL)], false);
        assert!(!fly.is_flying());
        fly.note(&[key(Key::W, None, true, Modifiers::NONE)], false);
        fly.note(&[key(Key::D, None, true, Modifiers::CTRL)], false);
        assert_eq!(fly.held, [true, false, false, true, false, false]);
        fly.note(&[Event::WindowFocused(false)], false);
        assert!(!fly.is_flying());
    }

    #[test]
    fn shift_is_faster_and_a_long_pause_does_not_jump() {
        let mut fly = Fly::default();
        fly.note(&[key(Key::D, None, true, Modifiers::NONE)], false);
        let mut camera = camera();
        fly.step(&mut camera, 0.0, Modifiers::SHIFT);
        fly.step(&mut camera, 100.0, Modifiers::SHIFT);
        let expected = 10.0 * SPEED_DISTANCES_PER_SEC * BOOST * MAX_STEP_SECS;
        assert!((camera.target_in_world.x - expected).abs() < 1e-9);
    }
}
