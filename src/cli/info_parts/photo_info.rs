//! Calibrated-image section of `info`.

use super::camera_info::{Intrinsics, rows};
use crate::photos::{ReprojectionError, ViewSet};
use serde::Serialize;

/// A calibrated image, its camera, and how well that fits.
#[derive(Serialize)]
pub(in crate::cli) struct PhotoInfo {
    name: String,
    file: String,
    #[serde(flatten)]
    intrinsics: Intrinsics,
    /// Row by row; x to the right, y down, z forward in the camera.
    world_from_camera: [f64; 16],
    /// The file that cuts out its object.
    #[serde(skip_serializing_if = "Option::is_none")]
    mask: Option<String>,
    /// The file with its depths.
    #[serde(skip_serializing_if = "Option::is_none")]
    depth: Option<String>,
    /// Reprojection error of the points found in it; null where there are none.
    reprojection_error: Option<ErrorInfo>,
}

#[derive(Serialize)]
struct ErrorInfo {
    points: usize,
    /// Points that the camera cannot show, behind it for one.
    unseen: usize,
    rms_px: f64,
    median_px: f64,
}

impl PhotoInfo {
    /// Returns the calibrated images of a set, in its order.
    pub(in crate::cli) fn of(set: &ViewSet) -> Vec<Self> {
        let errors = set.reprojection_errors();
        let photos = set.photos.iter().zip(errors);
        photos
            .map(|(photo, error)| Self {
                name: photo.name.clone(),
                file: photo.path.display().to_string(),
                intrinsics: Intrinsics::of(&photo.camera),
                world_from_camera: rows(&photo.camera_from_world.inverse()),
                mask: photo.mask.as_ref().map(|path| path.display().to_string()),
                depth: photo.depth.as_ref().map(|depth| depth.path.display().to_string()),
                reprojection_error: error.map(ErrorInfo::of),
            })
            .collect()
    }

    /// For people: all of them together; `None` without any.
    pub(in crate::cli) fn line(photos: &[Self]) -> Option<String> {
        let count = photos.len();
        let errors = photos.iter().filter_map(|photo| photo.reprojection_error.as_ref());
        let worst = errors.clone().map(|error| error.rms_px).reduce(f64::max);
        let mut medians: Vec<f64> = errors.map(|error| error.rms_px).collect();
        medians.sort_by(f64::total_cmp);
        let error = match (medians.get(medians.len() / 2), worst) {
            (Some(median), Some(worst)) => {
                format!("reprojection error (RMS) {median:.2} px in the median, {worst:.2} px at most")
            }
            _ => "no point says how well their cameras fit".to_owned(),
        };
        (count > 0).then(|| format!("{count} calibrated images; {error}"))
    }
}

impl ErrorInfo {
    fn of(error: ReprojectionError) -> Self {
        Self {
            points: error.count,
            unseen: error.behind,
            rms_px: error.rms_px,
            median_px: error.median_px,
        }
    }
}
