//! From where a frame is seen (paper 000 §VII: "distinct viewpoints", 25 to 85 % of the pixels covered).
//!
//! How it works: viewpoints stand on a circle around the middle of the frame at changing elevations. How much of a picture
//! the object covers cannot be computed from its box, so it is measured: the frame is drawn, its pixels are counted,
//! and the camera moves in or out until the share lies in the band. The covered area goes with 1/distance² as long as
//! all of it is in the picture, which makes the next guess. A viewpoint starts where the one before it ended, so
//! that one distance serves most of them. What cannot be brought into the band (a thin sweep seen from the
//! side) is measured where it came closest, and its coverage is reported like any other.

use crate::scene::Camera;
use image::RgbaImage;
use std::ops::RangeInclusive;

/// The share of covered pixels that the protocol asks for.
pub const COVERAGE_BAND: RangeInclusive<f64> = 0.25..=0.85;

/// What a correction aims at: far from both ends, so that one distance fits wide and narrow sides of an object.
const COVERAGE_TARGET: f64 = 0.5;

/// Corrections of one viewpoint before it is taken as it is.
const MAX_CORRECTIONS: usize = 8;

/// Largest change of the distance in one correction: 1/distance² is a guess once the object leaves the picture.
const MAX_CORRECTION_FACTOR: f64 = 2.0;

/// How far in and out the camera may go, as parts of the distance that frames the whole object. Closer than this the eye
/// would stand inside it.
const DISTANCE_RANGE: RangeInclusive<f64> = 0.12..=4.0;

/// Elevations that successive viewpoints take, degrees.
const ELEVATIONS_DEG: [f64; 4] = [0.0, 25.0, -15.0, 45.0];

/// Azimuth and elevation of `count` viewpoints, degrees.
pub(super) fn directions(count: usize) -> impl Iterator<Item = (f64, f64)> {
    (0..count)
        .zip(ELEVATIONS_DEG.into_iter().cycle())
        .map(move |(index, elevation_deg)| (360.0 * index as f64 / count as f64, elevation_deg))
}

/// A camera with the share of pixels that it sees covered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Viewpoint {
    pub(super) camera: Camera,
    pub(super) coverage: f64,
}

/// Moves `start` along its direction until `measure`, the covered share of a picture, lies in [`COVERAGE_BAND`].
///
/// `framing_distance` is the distance that shows all of the object. Returns the viewpoint that came closest.
pub(super) fn place<E>(
    start: Camera,
    framing_distance: f64,
    mut measure: impl FnMut(&Camera) -> Result<f64, E>,
) -> Result<Viewpoint, E> {
    let mut camera = start;
    let mut best: Option<Viewpoint> = None;
    for _ in 0..=MAX_CORRECTIONS {
        let coverage = measure(&camera)?;
        if best.is_none_or(|best| distance_to_band(coverage) < distance_to_band(best.coverage)) {
            best = Some(Viewpoint { camera, coverage });
        }
        if COVERAGE_BAND.contains(&coverage) {
            break;
        }
        let factor = (coverage / COVERAGE_TARGET)
            .sqrt()
            .clamp(MAX_CORRECTION_FACTOR.recip(), MAX_CORRECTION_FACTOR);
        let distance = (camera.distance * factor).clamp(
            DISTANCE_RANGE.start() * framing_distance,
            DISTANCE_RANGE.end() * framing_distance,
        );
        if distance == camera.distance {
            break;
        }
        camera.distance = distance;
    }
    // The loop measures at least once.
    Ok(best.unwrap_or(Viewpoint {
        camera,
        coverage: 0.0,
    }))
}

fn distance_to_band(coverage: f64) -> f64 {
    (COVERAGE_BAND.start() - coverage)
        .max(coverage - COVERAGE_BAND.end())
        .max(0.0)
}

/// Share of pixels that differ between the background and the drawn object, from the same picture on two backgrounds:
/// a pixel is free only where it shows both of them, so no colour of the object can pass for background.
pub(super) fn covered_share(
    on_first: &RgbaImage,
    on_second: &RgbaImage,
    backgrounds: [[u8; 3]; 2],
) -> f64 {
    let pixels = on_first.pixels().len().max(1);
    let free = on_first
        .pixels()
        .zip(on_second.pixels())
        .filter(|(first, second)| first.0[..3] == backgrounds[0] && second.0[..3] == backgrounds[1])
        .count();
    1.0 - free as f64 / pixels as f64
}

/// Coverage over all pictures of a sequence.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Coverage {
    /// Smallest share of covered pixels, 0 to 1.
    pub min: f64,
    /// Mean share.
    pub mean: f64,
    /// Largest share.
    pub max: f64,
    /// Pictures whose share is outside [`COVERAGE_BAND`].
    pub outside: usize,
    /// Pictures.
    pub count: usize,
}

impl Coverage {
    /// Sums up the shares of some pictures; `None` without any.
    pub fn of(shares: &[f64]) -> Option<Self> {
        let quantiles = super::Quantiles::of(shares)?;
        Some(Self {
            min: quantiles.min,
            mean: quantiles.mean,
            max: quantiles.max,
            outside: shares
                .iter()
                .filter(|share| !COVERAGE_BAND.contains(share))
                .count(),
            count: quantiles.count,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Aabb;
    use crate::scene::UpAxis;
    use glam::{DVec3, Vec3};
    use image::Rgba;
    use std::convert::Infallible;

    fn camera() -> Camera {
        let unit = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::splat(1.0),
        };
        Camera::framing(&unit, DVec3::ZERO, UpAxis::Y)
    }

    /// A flat object that covers `area_at_1 / distance²` of the picture until it fills it.
    fn disk(area_at_1: f64) -> impl FnMut(&Camera) -> Result<f64, Infallible> {
        move |camera| Ok((area_at_1 / camera.distance.powi(2)).min(1.0))
    }

    #[test]
    fn an_object_of_any_size_is_brought_into_the_band() {
        let start = camera();
        let framed = start.distance;
        for share_when_framed in [0.01, 0.08, 0.3, 0.9, 1.0, 4.0] {
            let area = share_when_framed * framed * framed;
            let viewpoint = place(start, framed, disk(area)).unwrap();
            assert!(
                COVERAGE_BAND.contains(&viewpoint.coverage),
                "{share_when_framed}: {viewpoint:?}"
            );
            assert_eq!(
                viewpoint.coverage,
                (area / viewpoint.camera.distance.powi(2)).min(1.0)
            );
        }
    }

    #[test]
    fn what_is_in_the_band_is_not_moved() {
        let start = camera();
        let mut measured = 0;
        let viewpoint = place(start, start.distance, |_| {
            measured += 1;
            Ok::<_, Infallible>(0.26)
        });
        assert_eq!(
            viewpoint.unwrap(),
            Viewpoint {
                camera: start,
                coverage: 0.26
            }
        );
        assert_eq!(measured, 1);
    }

    #[test]
    fn what_cannot_be_brought_into_the_band_is_reported_as_it_is() {
        let start = camera();
        let nothing = place(start, start.distance, |_| Ok::<_, Infallible>(0.0)).unwrap();
        assert_eq!(nothing.coverage, 0.0);
        // A needle: never more than a fifth, most when close.
        let needle = place(start, start.distance, |camera| {
            Ok::<_, Infallible>((0.05 * start.distance / camera.distance).min(0.2))
        });
        let needle = needle.unwrap();
        assert_eq!(needle.coverage, 0.2);
        assert!(needle.camera.distance >= DISTANCE_RANGE.start() * start.distance);
    }

    #[test]
    fn viewpoints_go_around_the_object() {
        let directions: Vec<_> = directions(8).collect();
        assert_eq!(directions.len(), 8);
        assert_eq!(directions[2], (90.0, -15.0));
        assert_eq!(directions[7], (315.0, 45.0));
    }

    #[test]
    fn an_object_in_the_colour_of_one_background_is_counted() {
        let [black, white] = [[0u8; 3], [255u8; 3]];
        let on_black = RgbaImage::from_pixel(4, 2, Rgba([0, 0, 0, 255]));
        let mut on_white = RgbaImage::from_pixel(4, 2, Rgba([255; 4]));
        assert_eq!(covered_share(&on_black, &on_white, [black, white]), 0.0);
        // A black object of three pixels.
        for x in 0..3 {
            on_white.put_pixel(x, 1, Rgba([0, 0, 0, 255]));
        }
        assert_eq!(covered_share(&on_black, &on_white, [black, white]), 0.375);
    }

    #[test]
    fn coverage_counts_what_is_outside_of_the_band() {
        let coverage = Coverage::of(&[0.2, 0.25, 0.5, 0.85, 0.95]).unwrap();
        assert_eq!((coverage.outside, coverage.count), (2, 5));
        assert!((coverage.mean - 0.55).abs() < 1e-12);
        assert_eq!(Coverage::of(&[]), None);
    }
}
