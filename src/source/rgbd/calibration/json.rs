//! Cameras in JSON: Open3D, Replica, `librealsense`, `pointreel info --json`.

use super::model::{Calibration, Intrinsics};
use super::text::{pinhole_of, units_of_scale};
use crate::rgbd::Distortion;
use glam::{DAffine3, DMat4};
use serde_json::Value;

/// Names of a matrix of a camera, row by row.
const MATRICES: &[&str] = &[
    "K",
    "camera_matrix",
    "cam_K",
    "intrinsic",
    "intrinsics",
    "depth_intrinsics",
];

/// Names of the units of a metre.
const SCALES: &[&str] = &[
    "scale",
    "depth_scale",
    "png_depth_scale",
    "depth_factor",
    "DepthMapFactor",
];

fn number(value: &Value, key: &str) -> Result<f64, String> {
    let number = value.get(key).and_then(Value::as_f64);
    number.ok_or_else(|| format!("`{key}` is missing"))
}

fn numbers(value: &Value, key: &str) -> Result<Vec<f64>, String> {
    let numbers = value.get(key).and_then(Value::as_array);
    let numbers = numbers.and_then(|numbers| numbers.iter().map(Value::as_f64).collect::<Option<_>>());
    numbers.ok_or_else(|| format!("`{key}` is not a list of numbers"))
}

fn size(value: &Value) -> Result<Option<[u32; 2]>, String> {
    let edge = |key: &str, short: &str| match value.get(key).or_else(|| value.get(short)) {
        None => Ok(None),
        Some(edge) => {
            let edge = edge
                .as_u64()
                .and_then(|edge| u32::try_from(edge).ok())
                .filter(|&edge| edge > 0);
            edge.map(Some)
                .ok_or_else(|| format!("`{key}` is not a number of pixels"))
        }
    };
    Ok(edge("width", "w")?
        .zip(edge("height", "h")?)
        .map(|(width, height)| [width, height]))
}

/// Open3D's `intrinsic_matrix`, column by column; `camera` of Replica, with the units of its depths; a matrix as lists
/// of rows; or the output of `pointreel info --json`.
pub(super) fn calibration(text: &str, because: String) -> Result<Calibration, String> {
    let json: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    if let Some(camera) = json.get("camera").filter(|camera| camera.is_object()) {
        return Ok(Calibration {
            units_per_metre: units(camera).or_else(|| units(&json)),
            ..Calibration::of_depth(intrinsics(camera)?, because)
        });
    }
    if let Some(matrix) = MATRICES.iter().find_map(|key| rows(json.get(key)?)) {
        let depth = Intrinsics::pinhole(matrix, size(&json)?);
        return Ok(Calibration {
            units_per_metre: units(&json),
            ..Calibration::of_depth(depth, because)
        });
    }
    if json.get("intrinsic_matrix").is_some() {
        let &[fx, _, _, _, fy, _, cx, cy, _] = numbers(&json, "intrinsic_matrix")?.as_slice() else {
            return Err("`intrinsic_matrix` has not nine numbers".to_owned());
        };
        let depth = Intrinsics::pinhole([fx, fy, cx, cy], size(&json)?);
        return Ok(Calibration {
            units_per_metre: units(&json),
            ..Calibration::of_depth(depth, because)
        });
    }
    let depth = intrinsics(json.get("depth").unwrap_or(&json))?;
    let color = match json.get("color").filter(|color| !color.is_null()) {
        Some(color) => {
            // Without a pose of its own the colour camera coincides with the depth camera: colours were registered.
            let color_from_depth = if color.get("color_from_depth").is_none() {
                DAffine3::IDENTITY
            } else {
                let matrix: [f64; 16] = numbers(color, "color_from_depth")?
                    .try_into()
                    .map_err(|_| "`color_from_depth` has not 16 numbers")?;
                DAffine3::from_mat4(DMat4::from_cols_array(&matrix).transpose())
            };
            Some((intrinsics(color)?, color_from_depth))
        }
        None => None,
    };
    Ok(Calibration {
        color,
        units_per_metre: units(&json).or_else(|| units(json.get("depth")?)),
        ..Calibration::of_depth(depth, because)
    })
}

/// Units of the depth images per metre; a value below 1 is the length of a unit.
fn units(value: &Value) -> Option<f64> {
    let said = SCALES.iter().find_map(|key| value.get(key)?.as_f64());
    said.and_then(units_of_scale)
}

/// fx, fy, cx, cy of a matrix of 3 × 3 or 4 × 4 numbers: a list of rows, or of all numbers row by row.
fn rows(value: &Value) -> Option<[f64; 4]> {
    let list = value.as_array()?;
    let flat = list.iter().flat_map(|row| match row.as_array() {
        Some(row) => row.iter().collect::<Vec<_>>(),
        None => vec![row],
    });
    pinhole_of(&flat.map(Value::as_f64).collect::<Option<Vec<f64>>>()?)
}

fn intrinsics(value: &Value) -> Result<Intrinsics, String> {
    // `librealsense` calls the principal point ppx, ppy.
    let pinhole = [
        number(value, "fx")?,
        number(value, "fy")?,
        number(value, "cx").or_else(|error| number(value, "ppx").map_err(|_| error))?,
        number(value, "cy").or_else(|error| number(value, "ppy").map_err(|_| error))?,
    ];
    let distortion = match value.get("distortion").filter(|distortion| !distortion.is_null()) {
        None => Distortion::None,
        Some(distortion) => {
            let model = distortion.get("model").and_then(Value::as_str).unwrap_or_default();
            let coefficients = match distortion.get("coefficients") {
                None => Vec::new(),
                Some(_) => numbers(distortion, "coefficients")?,
            };
            match (model, coefficients.as_slice()) {
                ("none", []) => Distortion::None,
                ("brown", &[k1, k2, p1, p2, k3]) => Distortion::Brown {
                    k: [k1, k2, k3],
                    p: [p1, p2],
                },
                ("rational", &[k1, k2, p1, p2, k3, k4, k5, k6]) => Distortion::Rational {
                    k: [k1, k2, k3, k4, k5, k6],
                    p: [p1, p2],
                },
                ("fisheye", &[k1, k2, k3, k4]) => Distortion::Fisheye { k: [k1, k2, k3, k4] },
                (model, coefficients) => {
                    return Err(format!(
                        "a distortion `{}` of {} coefficients: expected none, brown of 5, rational of 8 or fisheye \
                         of 4",
                        model.escape_default(),
                        coefficients.len()
                    ));
                }
            }
        }
    };
    Ok(Intrinsics {
        distortion,
        ..Intrinsics::pinhole(pinhole, size(value)?)
    })
}
