//! A camera path while it is edited: at any time a valid path, or no keyframes at all.

use crate::scene::{Camera, CameraPath, Keyframe, PathError};
use std::ops::RangeInclusive;

/// Keyframes nearer than this to a time are at it, seconds: half of the last digit that the window shows.
const SAME_TIME_S: f64 = 0.0005;

/// Neighbouring keyframes that are set by hand are so far apart, seconds.
const MIN_STEP_S: f64 = 0.001;

/// Times and frames that the window sets are at most these; files have the same bounds.
const MAX_TIME_S: f64 = 1e6;
const MAX_FRAME: f64 = 1e9;

/// A camera path, or the beginning of one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Draft {
    path: Option<CameraPath>,
    eases: bool,
}

impl Draft {
    /// A path that is edited on.
    pub fn of(path: CameraPath) -> Self {
        let eases = path.eases();
        let path = Some(path);
        Self { path, eases }
    }

    /// The path; `None` without keyframes.
    pub fn path(&self) -> Option<&CameraPath> {
        self.path.as_ref()
    }

    /// Keyframes at ascending times.
    pub fn keyframes(&self) -> &[Keyframe] {
        self.path.as_ref().map_or(&[], CameraPath::keyframes)
    }

    /// Returns true if the camera path has easing, starting and ending at rest.
    pub fn eases(&self) -> bool {
        self.eases
    }

    /// The first and the last time; `None` without keyframes.
    pub fn times_s(&self) -> Option<RangeInclusive<f64>> {
        let keys = self.keyframes();
        Some(keys.first()?.time_s..=keys.last()?.time_s)
    }

    /// Returns the index of the keyframe at this time.
    pub fn key_at(&self, time_s: f64) -> Option<usize> {
        let keys = self.keyframes();
        let index = keys.partition_point(|key| key.time_s < time_s - SAME_TIME_S);
        let key = keys.get(index)?;
        (key.time_s <= time_s + SAME_TIME_S).then_some(index)
    }

    /// Sets a keyframe at its time, replacing an existing one.
    ///
    /// # Errors
    /// If its projection differs from the others, or its numbers are out of range.
    pub fn put(&mut self, key: Keyframe) -> Result<(), PathError> {
        let index = self.key_at(key.time_s);
        self.edit(|keys| {
            if let Some(index) = index {
                let time_s = keys[index].time_s;
                keys[index] = Keyframe { time_s, ..key };
            } else {
                let index = keys.partition_point(|other| other.time_s < key.time_s);
                keys.insert(index, key);
            }
        })
    }

    /// The view and the frame of keyframe `index`, at its time.
    ///
    /// # Errors
    /// As [`Draft::put`].
    pub fn replace(&mut self, index: usize, camera: Camera, frame: f64) -> Result<(), PathError> {
        self.edit(|keys| {
            keys[index].camera = camera;
            keys[index].frame = frame;
        })
    }

    /// Takes keyframe `index` away.
    pub fn remove(&mut self, index: usize) {
        self.edit_soundly(|keys| {
            keys.remove(index);
        });
    }

    /// When keyframe `index` may be: between its neighbours.
    pub fn time_range_s(&self, index: usize) -> RangeInclusive<f64> {
        let keys = self.keyframes();
        let before = index.checked_sub(1).and_then(|before| keys.get(before));
        let first = before.map_or(0.0, |key| key.time_s + MIN_STEP_S);
        let after = keys.get(index + 1);
        let last = after.map_or(MAX_TIME_S, |key| key.time_s - MIN_STEP_S);
        // Files may have keyframes closer together: those stay where they are.
        let time_s = keys[index].time_s;
        first.min(time_s)..=last.max(time_s)
    }

    /// Moves keyframe `index` in time, as far as its neighbours let it.
    pub fn set_time(&mut self, index: usize, time_s: f64) {
        let range = self.time_range_s(index);
        let time_s = time_s.clamp(*range.start(), *range.end());
        self.edit_soundly(|keys| keys[index].time_s = time_s);
    }

    /// The frame that is shown at keyframe `index`.
    pub fn set_frame(&mut self, index: usize, frame: f64) {
        self.edit_soundly(|keys| keys[index].frame = frame.clamp(0.0, MAX_FRAME));
    }

    /// Returns the playback rate between keyframe `index` and the next one in frames per second, negative if backwards;
    /// `None` after the last.
    pub fn rate_after(&self, index: usize) -> Option<f64> {
        let keys = self.keyframes();
        let (key, next) = (keys.get(index)?, keys.get(index + 1)?);
        Some((next.frame - key.frame) / (next.time_s - key.time_s))
    }

    /// Sets the playback rate between keyframe `index` and the next one in frames per second. Later segments keep their
    /// rates, as far as there are frames.
    pub fn set_rate_after(&mut self, index: usize, rate: f64) {
        self.edit_soundly(|keys| {
            let Some(next) = keys.get(index + 1) else {
                return;
            };
            let span_s = next.time_s - keys[index].time_s;
            let moved = keys[index].frame + rate * span_s - next.frame;
            for key in &mut keys[index + 1..] {
                key.frame = (key.frame + moved).clamp(0.0, MAX_FRAME);
            }
        });
    }

    /// Sets easing: true if the camera starts and ends at rest.
    pub fn set_eases(&mut self, eases: bool) {
        self.eases = eases;
        self.edit_soundly(|_| {});
    }

    /// Changes the keyframes; nothing is changed if the result is not a path.
    fn edit(&mut self, change: impl FnOnce(&mut Vec<Keyframe>)) -> Result<(), PathError> {
        let mut keys = self.keyframes().to_vec();
        change(&mut keys);
        self.path = if keys.is_empty() {
            None
        } else {
            Some(CameraPath::new(keys, self.eases)?)
        };
        Ok(())
    }

    /// [`Draft::edit`] for changes within bounds.
    fn edit_soundly(&mut self, change: impl FnOnce(&mut Vec<Keyframe>)) {
        if let Err(reason) = self.edit(change) {
            log::warn!("the path stays as it was: {reason}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::scene::{Projection, UpAxis};
    use glam::DVec3;

    fn key(time_s: f64, frame: f64) -> Keyframe {
        let camera = Camera::framing(&Aabb::EMPTY, DVec3::ZERO, UpAxis::Y);
        Keyframe { time_s, camera, frame }
    }

    fn draft(keys: &[(f64, f64)]) -> Draft {
        let mut draft = Draft::default();
        for &(time_s, frame) in keys {
            draft.put(key(time_s, frame)).unwrap();
        }
        draft
    }

    fn frames(draft: &Draft) -> Vec<f64> {
        draft.keyframes().iter().map(|key| key.frame).collect()
    }

    #[test]
    fn keyframes_are_sorted_and_unique_per_time() {
        let mut draft = draft(&[(4.0, 1.0), (0.0, 2.0), (2.0, 3.0)]);
        assert_eq!(frames(&draft), [2.0, 3.0, 1.0]);
        draft.put(key(2.0004, 9.0)).unwrap();
        assert_eq!(frames(&draft), [2.0, 9.0, 1.0]);
        assert_eq!(draft.keyframes()[1].time_s, 2.0, "it stays at its time");
        assert_eq!(draft.key_at(3.9996), Some(2));
        assert_eq!(draft.key_at(3.9), None);
        assert_eq!(draft.times_s(), Some(0.0..=4.0));
        for _ in 0..3 {
            draft.remove(0);
        }
        assert_eq!(draft, Draft::default());
        assert_eq!((draft.path(), draft.times_s()), (None, None));
    }

    #[test]
    fn keyframe_times_stay_between_their_neighbours() {
        let mut draft = draft(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]);
        for (index, asked, expected) in [(1, 5.0, 1.999), (1, -1.0, 0.001), (0, -1.0, 0.0)] {
            draft.set_time(index, asked);
            assert!((draft.keyframes()[index].time_s - expected).abs() < 1e-12);
        }
        draft.set_time(2, 50.0);
        assert_eq!(draft.times_s(), Some(0.0..=50.0));
        // Closer ones from a file stay where they are when they are edited.
        let keys = vec![key(0.0, 0.0), key(2e-6, 1.0)];
        let mut near = Draft::of(CameraPath::new(keys, true).unwrap());
        near.set_time(0, 0.0);
        assert_eq!(near.times_s(), Some(0.0..=2e-6));
        assert!(near.eases());
    }

    #[test]
    fn holds_slow_motion_and_reverse_are_rates_between_keyframes() {
        let mut draft = draft(&[(0.0, 10.0), (1.0, 34.0), (3.0, 82.0)]);
        assert_eq!(draft.rate_after(1), Some(24.0));
        assert_eq!(draft.rate_after(2), None);
        draft.set_rate_after(0, 0.0);
        assert_eq!(frames(&draft), [10.0, 10.0, 58.0], "what follows goes on");
        draft.set_rate_after(1, -12.0);
        assert_eq!(frames(&draft), [10.0, 10.0, 0.0], "there is nothing before");
        draft.set_rate_after(0, 12.0);
        assert_eq!(frames(&draft), [10.0, 22.0, 12.0]);
        draft.set_rate_after(2, 12.0);
        draft.set_frame(2, -4.0);
        assert_eq!(frames(&draft), [10.0, 22.0, 0.0]);
    }

    #[test]
    fn invalid_edits_change_nothing() {
        let mut draft = draft(&[(0.0, 1.0)]);
        let before = draft.clone();
        let mut other = key(1.0, 1.0);
        other.camera.projection = Projection::Orthographic;
        assert!(draft.put(other).is_err());
        assert!(draft.put(key(-1.0, 1.0)).is_err());
        let Err(PathError::OutOfRange { .. }) = draft.replace(0, key(0.0, 0.0).camera, f64::NAN) else {
            panic!("a frame is a number");
        };
        assert_eq!(draft, before);
        draft.set_eases(true);
        assert!(draft.path().unwrap().eases());
    }
}
