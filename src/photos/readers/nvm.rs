//! VisualSFM's `NVM_V3`: models of cameras and points.
//!
//! Its manual: a camera is `name focal w x y z centre radial 0`, where the quaternion rotates the world to the camera
//! (x right, y down, z forward). Measurements are pixels from the principal point, which is the centre of the image
//! unless the first line fixes the calibration (`FixedK fx cx fy cy`). A file may hold several models; the one of the
//! most cameras is taken.
//!
//! *Lens.* VisualSFM distorts in the opposite direction: a measurement m, in focal lengths, is in the direction m·(1 +
//! r|m|²). The cameras of `rgbd` define where a direction x is measured: m = x·f(s) with s = r|x|², and f solves f·(1 +
//! s·f²) = 1. Its series is 1 − s + 3s² − 12s³ + 55s⁴ − …; the quotient of two cubics with the same first seven terms
//! follows it further, up to the turn at s = −4/27. It is off by 7·10⁻⁸ of the distance from the centre at s = −0.05,
//! which is a strong lens, and by 6·10⁻⁵ at s = −0.1.

use super::probe::begins_with;
use super::reader::{Claim, Reader};
use crate::photos::error::{PhotosError, read_file};
use crate::photos::found::draft::{Draft, Drafts};
use crate::photos::parts::text::Text;
use crate::photos::sets::lens::{Focal, Lens, Origin};
use crate::photos::sets::points::{Observation, SparsePoints};
use crate::rgbd::Distortion;
use glam::{DMat3, DQuat, DVec2, DVec3};
use std::path::Path;

/// Magic bytes at the beginning of the file.
const MAGIC: &[u8] = b"NVM_V3";

/// A calibration for all cameras.
#[derive(Debug, Clone, Copy)]
struct Fixed {
    focal_px: DVec2,
    /// From the corner of the image.
    principal_px: DVec2,
}

/// A model.
#[derive(Debug, Default)]
struct Model {
    cameras: Vec<Draft>,
    points: SparsePoints,
}

/// `VisualSFM`.
pub(super) const READER: Reader = Reader {
    name: "NVM (VisualSFM)",
    in_folder: |folder| folder.by_ending(".nvm").filter(|path| begins_with(path, MAGIC)),
    of_file: |file| Ok((file.extension() == "nvm").then(|| Claim::certain(file.path))),
    read,
};

/// Reads the input images of the file `path`.
fn read(path: &Path) -> Result<Drafts, PhotosError> {
    let file = read_file(path)?;
    let file = String::from_utf8_lossy(&file);
    let mut text = Text::new(path, &file);
    let first = text.rest_of_line();
    let words: Vec<&str> = first.split_whitespace().collect();
    let fixed = match words.as_slice() {
        ["NVM_V3", "FixedK", numbers @ ..] => {
            let numbers: Vec<f64> = numbers.iter().filter_map(|word| word.parse().ok()).collect();
            let [fx, cx, fy, cy] = numbers[..] else {
                return Err(PhotosError::invalid(
                    path,
                    "line 1",
                    "expected four numbers behind FixedK: fx cx fy cy",
                ));
            };
            Some(Fixed {
                focal_px: DVec2::new(fx, fy),
                principal_px: DVec2::new(cx, cy),
            })
        }
        ["NVM_V3", ..] => None,
        _ => {
            return Err(PhotosError::invalid(
                path,
                "line 1",
                "expected `NVM_V3`: write it with VisualSFM 0.5.18 or newer",
            ));
        }
    };
    let mut models = Vec::new();
    while !text.is_at_end() {
        let camera_count: u64 = text.number("the number of cameras of a model")?;
        if camera_count == 0 {
            break;
        }
        models.push(model(&mut text, camera_count, fixed)?);
    }
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut drafts = Drafts::new(path, vec![folder]);
    // The last model of VisualSFM holds images that were not placed, and no points.
    let with_points = models.iter().filter(|model| !model.points.is_empty()).count();
    let rank = |model: &Model| (!model.points.is_empty(), model.cameras.len());
    // Among models of the same rank, the first.
    if let Some(model) = models.into_iter().rev().max_by_key(rank) {
        if with_points > 1 {
            drafts.notes.push(format!(
                "{with_points} models are in {}: the one of the most cameras was taken ({})",
                path.display(),
                model.cameras.len()
            ));
        }
        drafts.photos = model.cameras;
        drafts.points = model.points;
    }
    Ok(drafts)
}

fn model(text: &mut Text<'_>, camera_count: u64, fixed: Option<Fixed>) -> Result<Model, PhotosError> {
    let mut model = Model::default();
    for _ in 0..camera_count {
        model.cameras.push(camera(text, fixed)?);
    }
    if text.is_at_end() {
        return Ok(model);
    }
    let point_count: u64 = text.number("the number of points of a model")?;
    let origin = fixed.map_or(DVec2::ZERO, |fixed| fixed.principal_px);
    for _ in 0..point_count {
        let position = DVec3::from_array(text.numbers("the position of a point")?);
        let color: [f64; 3] = text.numbers("the colour of a point")?;
        let count: u64 = text.number("the number of measurements")?;
        let mut track = Vec::new();
        for _ in 0..count {
            let photo = text.number("the index of a camera")?;
            text.word("the index of a feature")?;
            let pixel = DVec2::from_array(text.numbers("the place of a feature")?) + origin;
            track.push(Observation {
                photo,
                pixel: pixel.as_vec2(),
            });
        }
        model.points.push(position, color.map(|value| value as u8), track);
    }
    Ok(model)
}

fn camera(text: &mut Text<'_>, fixed: Option<Fixed>) -> Result<Draft, PhotosError> {
    // Spaces within a name are written as quotation marks.
    let name = text.word("the name of an image")?.replace('"', " ");
    let [focal_px] = text.numbers("a focal length")?;
    let [w, x, y, z] = text.numbers("a quaternion")?;
    let center = DVec3::from_array(text.numbers("a camera centre")?);
    let [radial] = text.numbers("a radial distortion")?;
    text.rest_of_line();
    let quaternion = DQuat::from_xyzw(x, y, z, w);
    let turn = if !quaternion.is_finite() {
        DMat3::NAN
    } else if quaternion.length_squared() > 0.0 {
        DMat3::from_quat(quaternion.normalize())
    } else {
        DMat3::ZERO
    };
    let (focal, origin, principal_px) = match fixed {
        Some(fixed) => (fixed.focal_px, Origin::Corner, fixed.principal_px),
        None => (DVec2::splat(focal_px), Origin::Center, DVec2::ZERO),
    };
    let lens = Lens {
        size_px: None,
        focal: Focal::Pixels(focal),
        origin,
        principal_px,
        distortion: inverse_radial(radial),
    };
    Ok(Draft::new(name.trim().to_owned(), Ok(lens), turn, -(turn * center)))
}

/// Coefficients of the quotient of cubics that has the first seven terms of f: numerator and denominator after their 1,
/// by 13.
const INVERSE: [[f64; 3]; 2] = [[113.0, 243.0, 85.0], [126.0, 330.0, 193.0]];

/// The lens whose measurements are undistorted by 1 + `radial`·|m|².
fn inverse_radial(radial: f64) -> Distortion {
    if radial == 0.0 {
        return Distortion::None;
    }
    let powers = [radial, radial * radial, radial.powi(3)].map(|power| power / 13.0);
    let [numerator, denominator] = INVERSE.map(|terms| [0, 1, 2].map(|power| terms[power] * powers[power]));
    let [k1, k2, k3] = numerator;
    let [k4, k5, k6] = denominator;
    // A separate model for this lens would have needed another set of Newton steps.
    Distortion::Rational {
        k: [k1, k2, k3, k4, k5, k6],
        p: [0.0; 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::Camera;

    /// The rule of the manual, backwards: measurements that are undistorted have to project onto themselves.
    #[test]
    fn lenses_are_inverted_to_a_hundredth_of_a_pixel() {
        for (radial, widest) in [
            (-0.2, 0.55),
            (-0.08, 0.8),
            (-0.01, 1.0),
            (0.01, 1.0),
            (0.08, 1.0),
            (0.2, 0.7),
        ] {
            let focal_px = 1500.0;
            let camera = Camera::new(
                [4000, 3000],
                DVec2::splat(focal_px),
                DVec2::ZERO,
                inverse_radial(radial),
            )
            .unwrap();
            for step in 1..=20 {
                let m = DVec2::from_angle(0.3) * (widest * f64::from(step) / 20.0);
                let direction = m * (1.0 + radial * m.length_squared());
                let pixel = camera.pixel(direction.extend(1.0)).unwrap();
                let error = pixel.distance(focal_px * m);
                assert!(error < 0.01, "{error} pixels at {m} of {radial}");
            }
        }
        assert_eq!(inverse_radial(0.0), Distortion::None);
    }
}
