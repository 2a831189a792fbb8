//! Cameras, from the files that programs write.

use super::error::RgbdError;
use super::text::{number_lines, read};
use crate::rgbd::{Camera, CameraError, ColorCamera, Distortion, Rig};
use glam::{DAffine3, DMat4, DVec2};
use serde_json::Value;
use std::path::Path;

/// What is said of a camera before it is known how large its images are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Intrinsics {
    pub(super) focal_px: DVec2,
    pub(super) principal_px: DVec2,
    pub(super) distortion: Distortion,
    /// The size of the images that the numbers are for.
    pub(super) for_size_px: Option<[u32; 2]>,
}

/// What is said of the cameras of a sensor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Calibration {
    pub(super) depth: Intrinsics,
    /// Of colours, where those are from another place or lens.
    pub(super) color: Option<(Intrinsics, DAffine3)>,
    /// Units of the depth images that are a metre, if it says that too.
    pub(super) units_per_metre: Option<f64>,
    /// Where it is from, for people.
    pub(super) because: String,
    /// Whether nothing in the recording says it.
    pub(super) is_assumed: bool,
}

impl Intrinsics {
    /// Without distortion.
    pub(super) fn pinhole([fx, fy, cx, cy]: [f64; 4], for_size_px: Option<[u32; 2]>) -> Self {
        Self {
            focal_px: DVec2::new(fx, fy),
            principal_px: DVec2::new(cx, cy),
            distortion: Distortion::None,
            for_size_px,
        }
    }

    /// Those of `camera`.
    fn of_camera(camera: &Camera) -> Self {
        Self {
            focal_px: camera.focal_px(),
            principal_px: camera.principal_px(),
            distortion: *camera.distortion(),
            for_size_px: Some(camera.size_px()),
        }
    }

    /// The camera of images of `size_px`, which may be those that the numbers are for in another size, but of the same
    /// shape; the size that was expected otherwise.
    fn camera(&self, size_px: [u32; 2]) -> Result<Camera, NoCamera> {
        let scale = match self.for_size_px {
            Some([width, height]) if [width, height] != size_px => {
                let scales = [
                    f64::from(size_px[0]) / f64::from(width),
                    f64::from(size_px[1]) / f64::from(height),
                ];
                if scales[0] != scales[1] {
                    return Err(NoCamera::Size([width, height]));
                }
                scales[0]
            }
            _ => 1.0,
        };
        // Centres of pixels are at integers: the corner of the image is at −½ in every size.
        let principal = scale * (self.principal_px + 0.5) - 0.5;
        Camera::new(size_px, scale * self.focal_px, principal, self.distortion).map_err(NoCamera::Numbers)
    }
}

/// Why there is no camera for an image.
pub(super) enum NoCamera {
    /// Another size was expected.
    Size([u32; 2]),
    Numbers(CameraError),
}

impl Calibration {
    /// Of a depth camera alone.
    pub(super) fn of_depth(depth: Intrinsics, because: impl Into<String>) -> Self {
        Self {
            depth,
            color: None,
            units_per_metre: None,
            because: because.into(),
            is_assumed: false,
        }
    }

    /// The numbers of cameras that are known already.
    pub(super) fn of_rig(rig: &Rig, because: impl Into<String>) -> Self {
        let color = rig.color.as_ref();
        Self {
            color: color.map(|color| (Intrinsics::of_camera(&color.camera), color.color_from_depth)),
            ..Self::of_depth(Intrinsics::of_camera(&rig.depth), because)
        }
    }

    /// What holds for recordings of a kind unless they say otherwise: images of 640 × 480.
    pub(super) fn usual(numbers: [f64; 4], kind: &str) -> Self {
        Self {
            is_assumed: true,
            ..Self::of_depth(
                Intrinsics::pinhole(numbers, Some([640, 480])),
                format!("the usual camera of {kind}"),
            )
        }
    }

    /// The cameras of images of these sizes.
    pub(super) fn rig(&self, depth_px: [u32; 2], color_px: Option<[u32; 2]>) -> Result<Rig, NoCamera> {
        let color = match (&self.color, color_px) {
            (Some((intrinsics, color_from_depth)), Some(size)) => Some(ColorCamera {
                camera: intrinsics.camera(size)?,
                color_from_depth: *color_from_depth,
            }),
            _ => None,
        };
        Ok(Rig {
            depth: self.depth.camera(depth_px)?,
            color,
        })
    }

    /// What a person names: `fx,fy,cx,cy`, or a file.
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

    /// What the file at `path` says, of any of the formats of [`RgbdError::Calibration`].
    pub(super) fn read(path: &Path) -> Result<Self, RgbdError> {
        let text = read(path)?;
        let wrong = |reason: String| RgbdError::Calibration {
            path: path.to_owned(),
            reason,
        };
        let because = path.display().to_string();
        let calibration = match text.trim_start().chars().next() {
            Some('{') => of_json(&text, because).map_err(wrong)?,
            Some('<') => of_xml(&text, because).map_err(wrong)?,
            _ => {
                let lines = number_lines(path, &text)?;
                let numbers: Vec<f64> = lines.into_iter().flat_map(|(_, numbers)| numbers).collect();
                // The numbers themselves, or a matrix of 3 × 3 or 4 × 4, row by row.
                let depth = match *numbers.as_slice() {
                    [fx, fy, cx, cy]
                    | [fx, _, cx, _, fy, cy, _, _, _]
                    | [fx, _, cx, _, _, fy, cy, _, _, _, _, _, _, _, _, _] => [fx, fy, cx, cy],
                    _ => return Err(wrong(format!("it has {} numbers", numbers.len()))),
                };
                Self::of_depth(Intrinsics::pinhole(depth, None), because)
            }
        };
        // A camera that is none is said here, and not at each frame.
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

fn number(value: &Value, key: &str) -> Result<f64, String> {
    let number = value.get(key).and_then(Value::as_f64);
    number.ok_or_else(|| format!("`{key}` is missing"))
}

fn numbers(value: &Value, key: &str) -> Result<Vec<f64>, String> {
    let numbers = value.get(key).and_then(Value::as_array);
    let numbers = numbers.and_then(|numbers| numbers.iter().map(Value::as_f64).collect::<Option<_>>());
    numbers.ok_or_else(|| format!("`{key}` is no list of numbers"))
}

fn size(value: &Value) -> Result<Option<[u32; 2]>, String> {
    let edge = |key: &str| match value.get(key) {
        None => Ok(None),
        Some(edge) => {
            let edge = edge
                .as_u64()
                .and_then(|edge| u32::try_from(edge).ok())
                .filter(|&edge| edge > 0);
            edge.map(Some).ok_or_else(|| format!("`{key}` is no number of pixels"))
        }
    };
    Ok(edge("width")?
        .zip(edge("height")?)
        .map(|(width, height)| [width, height]))
}

/// Open3D's `intrinsic_matrix`, column by column, or what `pointreel info --json` writes.
fn of_json(text: &str, because: String) -> Result<Calibration, String> {
    let json: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    if json.get("intrinsic_matrix").is_some() {
        let &[fx, _, _, _, fy, _, cx, cy, _] = numbers(&json, "intrinsic_matrix")?.as_slice() else {
            return Err("`intrinsic_matrix` has not nine numbers".to_owned());
        };
        let depth = Intrinsics::pinhole([fx, fy, cx, cy], size(&json)?);
        return Ok(Calibration::of_depth(depth, because));
    }
    let depth = intrinsics(json.get("depth").unwrap_or(&json))?;
    let color = match json.get("color").filter(|color| !color.is_null()) {
        Some(color) => {
            let matrix: [f64; 16] = numbers(color, "color_from_depth")?
                .try_into()
                .map_err(|_| "`color_from_depth` has not 16 numbers")?;
            let matrix = DMat4::from_cols_array(&matrix).transpose();
            Some((intrinsics(color)?, DAffine3::from_mat4(matrix)))
        }
        None => None,
    };
    Ok(Calibration {
        color,
        ..Calibration::of_depth(depth, because)
    })
}

fn intrinsics(value: &Value) -> Result<Intrinsics, String> {
    let pinhole = [
        number(value, "fx")?,
        number(value, "fy")?,
        number(value, "cx")?,
        number(value, "cy")?,
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

/// What PCL's grabbers write: two elements without one around them, which XML does not allow.
fn of_xml(text: &str, because: String) -> Result<Calibration, String> {
    let start = text.trim_start();
    let content = match start.strip_prefix("<?").and_then(|rest| rest.split_once("?>")) {
        Some((_, content)) => content,
        None => start,
    };
    let whole = format!("<camera>{content}</camera>");
    let document = roxmltree::Document::parse(&whole).map_err(|error| error.to_string())?;
    let element = |name: &str| document.descendants().find(|node| node.has_tag_name(name));
    let of = |camera: roxmltree::Node<'_, '_>| -> Result<Intrinsics, String> {
        let number = |name: &str| {
            let node = camera.children().find(|node| node.has_tag_name(name));
            let number = node.and_then(|node| node.text()?.trim().parse().ok());
            number.ok_or_else(|| format!("<{name}> is missing"))
        };
        let numbers = [
            number("focal_length_x")?,
            number("focal_length_y")?,
            number("principal_point_x")?,
            number("principal_point_y")?,
        ];
        Ok(Intrinsics::pinhole(numbers, None))
    };
    let depth = element("depth").ok_or("<depth> is missing")?;
    let factor = depth
        .children()
        .find(|node| node.has_tag_name("z_multiplication_factor"));
    let factor: Option<f64> = factor.and_then(|node| node.text()?.trim().parse().ok());
    Ok(Calibration {
        units_per_metre: factor.filter(|&factor| factor > 0.0).map(|factor| 1.0 / factor),
        ..Calibration::of_depth(of(depth)?, because)
    })
}
