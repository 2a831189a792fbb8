//! Cameras, from the files that programs write.

mod json;
mod model;
mod text;
mod xml;

use super::error::RgbdError;
use super::folder::{has_extension, name_of};
use super::text::{array, read};
pub(super) use model::{Calibration, Intrinsics, NoCamera};
use std::path::Path;

impl Intrinsics {
    /// fx, fy, cx, cy in a matrix of numbers.
    pub(super) fn pinhole_of(numbers: &[f64]) -> Option<[f64; 4]> {
        text::pinhole_of(numbers)
    }
}

impl Calibration {
    /// Parses a calibration option: `fx,fy,cx,cy`, or a file.
    pub(super) fn of_option(text: &str) -> Result<Self, RgbdError> {
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse()).collect();
        match numbers.map(<[f64; 4]>::try_from) {
            Ok(Ok(numbers)) => Ok(Self::of_depth(Intrinsics::pinhole(numbers, None), "--intrinsics")),
            Ok(Err(numbers)) => Err(RgbdError::Calibration {
                path: text.into(),
                reason: format!("it is {} numbers", numbers.len()),
            }),
            Err(_) => Self::read(Path::new(text)),
        }
    }

    /// Reads a calibration from the file at `path`, in any of the formats of [`RgbdError::Calibration`].
    pub(super) fn read(path: &Path) -> Result<Self, RgbdError> {
        let wrong = |reason: String| RgbdError::Calibration {
            path: path.to_owned(),
            reason,
        };
        let because = path.display().to_string();
        if has_extension(name_of(path), &["npy"]) {
            let (_, numbers) = array(path)?;
            let pinhole =
                text::pinhole_of(&numbers).ok_or_else(|| wrong(format!("it has {} numbers", numbers.len())))?;
            return Ok(Self::of_depth(Intrinsics::pinhole(pinhole, None), because));
        }
        let text = read(path)?;
        let calibration = match text.trim_start().chars().next() {
            Some('{') => json::calibration(&text, because).map_err(wrong)?,
            Some('<') => xml::calibration(&text, because).map_err(wrong)?,
            _ => text::calibration(path, &text, because)?,
        };
        // An invalid camera is reported here, and not at each frame.
        let sizes = [
            &Some(&calibration.depth),
            &calibration.color.as_ref().map(|(color, _)| color),
        ];
        for intrinsics in sizes.into_iter().flatten() {
            let size = intrinsics.for_size_px.unwrap_or([640, 480]);
            if let Err(NoCamera::Numbers(error)) = intrinsics.camera(size) {
                return Err(wrong(error.to_string()));
            }
        }
        Ok(calibration)
    }
}
