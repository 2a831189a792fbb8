//! A bar of a round length, as long as it looks where the camera's target is.

use crate::cloud::LengthUnit;
use crate::scene::Camera;
use std::ops::RangeInclusive;

/// A length to be painted over an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleBar {
    /// One, two or five times a power of ten, scene units.
    pub length: f64,
    /// Length of the bar as drawn, in the pixels of the height that it was made for.
    pub length_px: f64,
    unit: Option<LengthUnit>,
}

impl ScaleBar {
    /// Range of bar lengths: from one round length to the next it is a factor of 2.5 at most.
    pub const LENGTHS_PX: RangeInclusive<f64> = 80.0..=200.0;

    /// The longest within [`Self::LENGTHS_PX`] times `scale` in an image `height_px` high. In perspective, things
    /// nearer than the target look longer than that, and those farther away shorter. `None` where lengths are beyond
    /// f64.
    pub fn of(camera: &Camera, height_px: f64, scale: f64, unit: Option<LengthUnit>) -> Option<Self> {
        let lens = camera.lens();
        let px_per_unit = 0.5 * height_px * lens.focal / lens.distance;
        let longest = Self::LENGTHS_PX.end() * scale / px_per_unit;
        let length = round_length(longest)?;
        Some(Self {
            length,
            length_px: length * px_per_unit,
            unit,
        })
    }

    /// Its length with a unit: `50 cm`, `2 km`, `0.5 units` where none is known.
    pub fn text(&self) -> String {
        let length = self.length;
        let (number, symbol) = match self.unit {
            Some(LengthUnit::Metre) => metric(length),
            Some(LengthUnit::Millimetre) => metric(length / 1000.0),
            Some(LengthUnit::Centimetre) => metric(length / 100.0),
            Some(unit) => (length, unit.symbol()),
            None if length == 1.0 => (length, "unit"),
            None => (length, "units"),
        };
        format!("{} {symbol}", plain(number))
    }
}

/// The largest of 1, 2 and 5 times powers of ten that is at most `longest`.
fn round_length(longest: f64) -> Option<f64> {
    // Numbers that are round except for rounding errors count as round.
    let longest = longest * (1.0 + 1e-9);
    let exponent = longest.log10().floor();
    let is_usable = longest.is_normal() && longest > 0.0 && exponent.abs() < 300.0;
    let power = 10f64.powi(exponent as i32);
    let steps = [5.0, 2.0, 1.0].map(|step| step * power);
    steps.into_iter().find(|step| *step <= longest).filter(|_| is_usable)
}

/// Metres in the unit in which they are read best.
fn metric(metres: f64) -> (f64, &'static str) {
    let units = [(1000.0, "km"), (1.0, "m"), (0.01, "cm"), (0.001, "mm")];
    let fits = |(unit, _): &&(f64, &str)| metres >= unit * (1.0 - 1e-9);
    let (unit, symbol) = units.iter().find(fits).copied().unwrap_or((1e-6, "µm"));
    (metres / unit, symbol)
}

/// Without digits that are zeros or rounding; with a power of ten where there were many zeros.
fn plain(number: f64) -> String {
    if (1e-4..1e6).contains(&number) {
        let text = format!("{number:.4}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{number:.0e}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::scene::{Projection, UpAxis};
    use glam::{DVec3, Vec3};

    fn camera(distance: f64, projection: Projection) -> Camera {
        let bounds = Aabb {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        };
        Camera {
            distance,
            projection,
            ..Camera::framing(&bounds, DVec3::ZERO, UpAxis::Z)
        }
    }

    #[test]
    fn lengths_are_round_and_fit_over_twelve_decades() {
        for hundredth in -600..=600 {
            let distance = 10f64.powf(f64::from(hundredth) / 100.0);
            for projection in [Projection::Perspective, Projection::Orthographic] {
                let camera = camera(distance, projection);
                let bar = ScaleBar::of(&camera, 720.0, 1.0, None).unwrap();
                let range = 79.99..=200.01;
                assert!(range.contains(&bar.length_px), "{distance}: {bar:?}");
                let mantissa = bar.length / 10f64.powf(bar.length.log10().floor());
                let is_round = [1.0, 2.0, 5.0, 10.0].iter().any(|step| (mantissa - step).abs() < 1e-9);
                assert!(is_round, "{distance}: {bar:?}");
            }
        }
    }

    /// The distance in the image of two places at the target's distance is the length of the bar.
    #[test]
    fn the_bar_is_as_long_as_the_distance_it_states() {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = camera(7.3, projection);
            let bar = ScaleBar::of(&camera, 480.0, 1.0, None).unwrap();
            let right = camera.view_from_world_rotation().row(0);
            let [a, b] = [-0.5, 0.5].map(|end| {
                let place = camera.target_in_world + right * (end * bar.length);
                camera.to_px(place, [640, 480]).unwrap()
            });
            assert!(((b - a).length() - bar.length_px).abs() < 1e-6);
        }
    }

    #[test]
    fn texts_have_readable_units() {
        let text = |length, unit| {
            ScaleBar {
                length,
                length_px: 100.0,
                unit,
            }
            .text()
        };
        let metre = Some(LengthUnit::Metre);
        for (length, unit, expected) in [
            (0.5, metre, "50 cm"),
            (1.0, metre, "1 m"),
            (200.0, metre, "200 m"),
            (5000.0, metre, "5 km"),
            (0.002, metre, "2 mm"),
            (2e-5, metre, "20 µm"),
            (20.0, Some(LengthUnit::Millimetre), "2 cm"),
            (50.0, Some(LengthUnit::Foot), "50 ft"),
            (0.2, Some(LengthUnit::SurveyFoot), "0.2 ftUS"),
            (0.5, None, "0.5 units"),
            (1.0, None, "1 unit"),
            (0.0005, None, "0.0005 units"),
            (5e-7, None, "5e-7 units"),
            (2e9, None, "2e9 units"),
        ] {
            assert_eq!(text(length, unit), expected);
        }
    }

    #[test]
    fn views_without_a_scale_have_no_bar() {
        for (distance, height_px) in [(f64::NAN, 720.0), (1.0, 0.0), (0.0, 720.0), (1e307, 720.0)] {
            let camera = camera(distance, Projection::Perspective);
            assert_eq!(ScaleBar::of(&camera, height_px, 1.0, None), None, "{distance}");
        }
    }
}
