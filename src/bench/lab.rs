//! Render modes as points of time and error, and the selection of the best one for a given budget.
//!
//! How it works: a mode is on the *front* (Pareto) if no other in the same light is both as fast and as accurate. There
//! is a front for each error: of an image, and of the change from image to image ([`LabError`]). Fastest below an
//! error, best within a time, and a slider from fast to exact all choose from the front of images alone.

use super::Environment;
use crate::binary::hex;
use crate::persist;
use crate::scene::{Lighting, Settings};
use crate::sequence::Sequence;
use image::RgbaImage;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::PathBuf;

/// Error that render modes are compared by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LabError {
    /// FLIP of an image against the ground truth.
    #[default]
    Image,
    /// FLIP over time: the change from image to image compared with that of the ground truth.
    OverTime,
}

impl LabError {
    /// All errors.
    pub const ALL: [Self; 2] = [Self::Image, Self::OverTime];

    /// The error of a render mode, 0 to 1.
    pub fn of(self, point: &LabPoint) -> f64 {
        match self {
            Self::Image => point.flip,
            Self::OverTime => point.flip_over_time,
        }
    }
}

/// Render mode with its cost and its error.
#[derive(Debug, Clone)]
pub struct LabPoint {
    /// Name of the sequence.
    pub sequence: String,
    /// Render style it was drawn with; names the renderer.
    pub style: Settings,
    /// The settings in a few words.
    pub label: String,
    /// From camera to finished image, median.
    pub draw_ms: f64,
    /// Mean FLIP of the pixels that show the object in the image or in the truth, 0 to 1.
    pub flip: f64,
    /// Mean difference between the FLIP of two consecutive images under an orbiting camera and that of the truth, 0 to
    /// 1.
    pub flip_over_time: f64,
    /// The Pareto fronts that it is on, in the order of [`LabError::ALL`]: no other mode is both as fast and as
    /// accurate.
    pub on_fronts: [bool; LabError::ALL.len()],
    /// The first view, small.
    pub picture: RgbaImage,
    /// The FLIP error of the first view, as small.
    pub error_map: RgbaImage,
}

impl LabPoint {
    /// Returns true if it is on the front of an error.
    pub fn is_on_front(&self, error: LabError) -> bool {
        self.on_fronts[error as usize]
    }

    /// Returns the light of the mode, at each pixel: an image in another light is another image.
    pub fn lighting(&self) -> Lighting {
        self.style.decided().light.lighting.at_each_pixel()
    }

    /// Returns true if another render mode for the same sequence in the same light dominates it: at least as fast and
    /// as accurate, and strictly better in one of the two.
    pub fn is_beaten_by(&self, other: &Self, error: LabError) -> bool {
        let [other_error, own_error] = [other, self].map(|point| error.of(point));
        let is_no_worse = other.draw_ms <= self.draw_ms && other_error <= own_error;
        let is_better = other.draw_ms < self.draw_ms || other_error < own_error;
        let is_comparable = other.sequence == self.sequence && other.lighting() == self.lighting();
        is_comparable && is_no_worse && is_better
    }
}

/// Marks the points of each sequence that are on its fronts.
pub fn mark_fronts(points: &mut [LabPoint]) {
    for index in 0..points.len() {
        points[index].on_fronts =
            LabError::ALL.map(|error| !points.iter().any(|other| points[index].is_beaten_by(other, error)));
    }
}

/// The front of one cloud on one machine, from fast to exact. Not empty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    choices: Vec<QualityChoice>,
}

/// A render mode that can be chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct QualityChoice {
    /// The settings in a few words.
    pub label: String,
    /// Render settings of the choice.
    pub style: Settings,
    /// Draw time of an image, milliseconds.
    pub draw_ms: f64,
    /// FLIP of the object, 0 to 1.
    pub flip: f64,
}

impl Quality {
    /// The front of `points`, all of one sequence, in the default light; `None` without any.
    pub fn of(points: &[LabPoint]) -> Option<Self> {
        let lighting = Settings::default().decided().light.lighting.at_each_pixel();
        let is_beaten = |point: &&LabPoint| points.iter().any(|other| point.is_beaten_by(other, LabError::Image));
        let on_front = points
            .iter()
            .filter(|point| point.lighting() == lighting && !is_beaten(point));
        let mut choices: Vec<QualityChoice> = on_front
            .map(|point| QualityChoice {
                label: point.label.clone(),
                style: point.style,
                draw_ms: point.draw_ms,
                flip: point.flip,
            })
            .collect();
        choices.sort_by(|a, b| a.draw_ms.total_cmp(&b.draw_ms));
        (!choices.is_empty()).then_some(Self { choices })
    }

    /// From the fastest to the one with the least error.
    pub fn choices(&self) -> &[QualityChoice] {
        &self.choices
    }

    /// The fastest whose error is at most `flip`; where there is none, the one with the least error.
    pub fn fastest_below(&self, flip: f64) -> &QualityChoice {
        let last = self.choices.len() - 1;
        let fit = self.choices.iter().find(|choice| choice.flip <= flip);
        fit.unwrap_or(&self.choices[last])
    }

    /// The one with the least error that takes at most `draw_ms`; where there is none, the fastest.
    pub fn best_within(&self, draw_ms: f64) -> &QualityChoice {
        let mut fit = self.choices.iter().rev();
        fit.find(|choice| choice.draw_ms <= draw_ms).unwrap_or(&self.choices[0])
    }

    /// Reads the result cached under `key`; `None` if there is none that is usable.
    pub fn read(key: &QualityKey) -> Option<Self> {
        let file = key.place()?;
        let bytes = persist::read(&file).ok().flatten()?;
        let quality: Self = serde_json::from_slice(&bytes).ok()?;
        let is_sound = |choice: &QualityChoice| choice.draw_ms >= 0.0 && choice.flip >= 0.0;
        let is_sorted = quality.choices.is_sorted_by(|a, b| a.draw_ms <= b.draw_ms);
        let is_usable = !quality.choices.is_empty() && quality.choices.iter().all(is_sound);
        (is_usable && is_sorted).then_some(quality)
    }

    /// Keeps it under `key`.
    pub fn write(&self, key: &QualityKey) -> std::io::Result<()> {
        let Some(file) = key.place() else {
            return Ok(());
        };
        persist::replace(&file, &serde_json::to_vec_pretty(self)?)
    }
}

/// Key of a [`Quality`]: a machine and a sequence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QualityKey(String);

impl QualityKey {
    /// The key of a sequence, by its sources' names and sizes, on this machine with this adapter.
    pub fn new(adapter: &str, sequence: &Sequence) -> Self {
        let mut hash = Sha256::new();
        let machine = [env!("CARGO_PKG_VERSION"), adapter, &Environment::cpu()];
        let entries = sequence.entries().into_iter().map(|entry| {
            let bytes = std::fs::metadata(&entry.path).map_or(0, |metadata| metadata.len());
            format!("{} {bytes}", entry.path.display())
        });
        for text in machine.into_iter().map(str::to_owned).chain(entries) {
            hash.update(text.as_bytes());
            // A separator, so that no two lists of texts hash alike.
            hash.update([0]);
        }
        Self(hex(&hash.finalize()))
    }

    fn place(&self) -> Option<PathBuf> {
        persist::cached_place_of(&format!("quality/{}.json", self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point(draw_ms: f64, flip: f64) -> LabPoint {
        LabPoint {
            sequence: "scan".to_owned(),
            style: Settings::default(),
            label: String::new(),
            draw_ms,
            flip,
            // The more an image is off, the steadier it is.
            flip_over_time: 1.0 - flip,
            on_fronts: [false; 2],
            picture: RgbaImage::new(1, 1),
            error_map: RgbaImage::new(1, 1),
        }
    }

    #[test]
    fn the_pareto_front_is_undominated() {
        let mut points =
            [(1.0, 0.5), (2.0, 0.6), (3.0, 0.2), (3.0, 0.3), (4.0, 0.2)].map(|(draw_ms, flip)| point(draw_ms, flip));
        mark_fronts(&mut points);
        let of_images = |points: &[LabPoint]| {
            points
                .iter()
                .map(|point| point.is_on_front(LabError::Image))
                .collect::<Vec<_>>()
        };
        assert_eq!(of_images(&points), [true, false, true, false, false]);
        assert_eq!(
            points.map(|point| point.is_on_front(LabError::OverTime)),
            [true, true, false, false, false]
        );
        // Equal points are both optimal; points of another sequence do not count.
        let mut points = [point(1.0, 0.5), point(1.0, 0.5), point(0.5, 0.1)];
        points[2].sequence = "other".to_owned();
        mark_fronts(&mut points);
        assert_eq!(of_images(&points), [true; 3]);
        // Nor do those in another light; where the headlight is evaluated makes no other light of it.
        let in_light = |draw_ms: f64, lighting: Lighting| LabPoint {
            style: Settings::default().with(|style| style.light.lighting = lighting.into()),
            ..point(draw_ms, 0.5)
        };
        let mut points = [
            in_light(1.0, Lighting::Physical),
            in_light(2.0, Lighting::PerFragment),
            in_light(3.0, Lighting::PerSurfel),
        ];
        mark_fronts(&mut points);
        assert_eq!(of_images(&points), [true, true, false]);
        let quality = Quality::of(&points).unwrap();
        assert_eq!(quality.choices().len(), 1);
        assert_eq!(quality.choices()[0].draw_ms, 2.0);
    }

    #[test]
    fn the_time_budget_decides() {
        let points = [(1.0, 0.5), (3.0, 0.2), (10.0, 0.05), (11.0, 0.4)].map(|(ms, flip)| point(ms, flip));
        let quality = Quality::of(&points).unwrap();
        assert_eq!(quality.choices().len(), 3);
        assert_eq!(quality.fastest_below(0.3).draw_ms, 3.0);
        assert_eq!(quality.fastest_below(0.01).draw_ms, 10.0);
        assert_eq!(quality.best_within(9.9).flip, 0.2);
        assert_eq!(quality.best_within(0.1).draw_ms, 1.0);
        assert_eq!(Quality::of(&[]), None);
        let json = serde_json::to_vec(&quality).unwrap();
        assert_eq!(serde_json::from_slice::<Quality>(&json).unwrap(), quality);
    }

    proptest! {
        #[test]
        fn errors_decrease_along_the_pareto_front(pairs in prop::collection::vec((0.0f64..9.0, 0.0f64..1.0), 1..40),
            spent in 0.0f64..9.0) {
            let points: Vec<LabPoint> = pairs.iter().map(|&(ms, flip)| point(ms, flip)).collect();
            let quality = Quality::of(&points).unwrap();
            prop_assert!(quality.choices().is_sorted_by(|a, b| a.draw_ms <= b.draw_ms && a.flip >= b.flip));
            // By brute force over all points.
            let affordable = pairs.iter().filter(|(ms, _)| *ms <= spent).map(|&(_, flip)| flip);
            if let Some(min) = affordable.min_by(f64::total_cmp) {
                prop_assert_eq!(quality.best_within(spent).flip, min);
            }
            let error = spent / 9.0;
            let right = pairs.iter().filter(|(_, flip)| *flip <= error).map(|&(ms, _)| ms);
            if let Some(min) = right.min_by(f64::total_cmp) {
                prop_assert_eq!(quality.fastest_below(error).draw_ms, min);
            }
        }
    }
}
