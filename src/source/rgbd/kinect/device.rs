//! Device calibration, which is attached to its recordings as JSON.
//!
//! *How it works.* Cameras are identified by their `Location`. Focal lengths and the principal point are in widths and
//! heights of the sensor, counted from the corner of its first pixel; lenses are rational polynomials with coefficients
//! in a specific order: cx cy fx fy k₁ … k₆, the centre of the distortion, p₂ p₁. `Rt` transforms points of the depth
//! camera to each camera, in metres, its rotation row by row. Colours are calibrated for the sensor's 4:3; images of
//! 16:9 are its central part. (`calibration.c` and `mode_specific_calibration.c` of the SDK.)

use super::super::calibration::Intrinsics;
use super::modes::DepthMode;
use crate::rgbd::Distortion;
use glam::{DAffine3, DMat3, DVec2, DVec3};
use serde_json::Value;

const DEPTH: &str = "CALIBRATION_CameraLocationD0";
const COLOR: &str = "CALIBRATION_CameraLocationPV0";

/// The sensor of every depth camera, which modes are cut from.
const DEPTH_SENSOR_PX: [u64; 2] = [1024, 1024];

/// Tolerance for the products of rotation axes, which should be 0 and 1: they are written as single-precision floats.
const MAX_SKEW: f64 = 1e-3;

/// The cameras of a device.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Device {
    depth: DeviceCamera,
    color: Option<DeviceCamera>,
}

/// A camera; lengths are in sizes of its sensor.
#[derive(Debug, Clone, PartialEq)]
struct DeviceCamera {
    focal: DVec2,
    /// From the corner of the first pixel.
    principal: DVec2,
    distortion: Distortion,
    sensor_px: [u64; 2],
    camera_from_rig: DAffine3,
}

impl Device {
    /// Parses the calibration in the attached file; the error is the end of a sentence.
    pub(super) fn of_json(bytes: &[u8]) -> Result<Self, String> {
        // Some are written with the terminating zero of their text.
        let end = bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
        let json: Value = serde_json::from_slice(&bytes[..end]).map_err(|error| error.to_string())?;
        let cameras = json
            .pointer("/CalibrationInformation/Cameras")
            .and_then(Value::as_array);
        let cameras = cameras.ok_or("it has no list `CalibrationInformation`, `Cameras`")?;
        let at = |location: &str| {
            let is_there = |camera: &&Value| camera.get("Location").and_then(Value::as_str) == Some(location);
            let camera = cameras.iter().find(is_there);
            camera.map(|camera| DeviceCamera::of_json(camera).map_err(|problem| format!("{location}: {problem}")))
        };
        let depth = at(DEPTH).ok_or_else(|| format!("it has no camera {DEPTH}"))??;
        if depth.sensor_px != DEPTH_SENSOR_PX {
            return Err(format!(
                "its depth camera has {} × {} pixels, and modes are known of 1024 × 1024",
                depth.sensor_px[0], depth.sensor_px[1]
            ));
        }
        Ok(Self {
            depth,
            color: at(COLOR).transpose()?,
        })
    }

    /// The depth camera in a mode.
    pub(super) fn depth(&self, mode: &DepthMode) -> Intrinsics {
        let [sensor, offset] = [mode.sensor_px, mode.offset_px].map(pair);
        self.depth.part(sensor, offset, mode.size_px)
    }

    /// Returns the colour camera intrinsics for images of this size: all of the sensor's 4:3, or the 16:9 crop at its
    /// centre.
    pub(super) fn color(&self, size_px: [u32; 2]) -> Result<Intrinsics, String> {
        let camera = self.color.as_ref().ok_or_else(|| format!("it has no camera {COLOR}"))?;
        let [width, height] = size_px.map(u64::from);
        if 3 * width != 4 * height && 9 * width != 16 * height {
            return Err(format!(
                "the colour images have {width} × {height} pixels: 4:3 or 16:9 was expected"
            ));
        }
        // Relative to the height of the calibrated image at this width; the first devices were calibrated for the
        // central part only.
        let [sensor_width, sensor_height] = camera.sensor_px;
        let is_four_thirds = 3 * sensor_width == 4 * sensor_height;
        if !is_four_thirds && 9 * sensor_width != 16 * sensor_height {
            return Err(format!(
                "its colour camera has {sensor_width} × {sensor_height} pixels: 4:3 or 16:9 was expected"
            ));
        }
        let [width, height] = size_px.map(f64::from);
        let sensor = DVec2::new(width, width * if is_four_thirds { 0.75 } else { 0.5625 });
        let offset = DVec2::new(0.0, 0.5 * (sensor.y - height));
        Ok(camera.part(sensor, offset, size_px))
    }

    /// Points of the depth camera as the colour camera has them.
    pub(super) fn color_from_depth(&self) -> DAffine3 {
        let color = self.color.as_ref();
        let color_from_rig = color.map_or(DAffine3::IDENTITY, |color| color.camera_from_rig);
        color_from_rig * self.depth.camera_from_rig.inverse()
    }
}

impl DeviceCamera {
    fn of_json(camera: &Value) -> Result<Self, String> {
        let side = |key: &str| {
            let side = camera.get(key).and_then(Value::as_u64);
            let side = side.and_then(|side| u32::try_from(side).ok());
            side.map(u64::from)
                .ok_or_else(|| format!("`{key}` is not a number of pixels"))
        };
        let numbers = numbers(camera, "/Intrinsics/ModelParameters")?;
        let &[cx, cy, fx, fy, k1, k2, k3, k4, k5, k6, codx, cody, p2, p1, ..] = numbers.as_slice() else {
            return Err(format!("its lens has {} numbers, and 14 were expected", numbers.len()));
        };
        let model = camera
            .pointer("/Intrinsics/ModelType")
            .and_then(Value::as_str)
            .unwrap_or_default();
        // The older model has half of the mixed tangential terms.
        let is_known = match model {
            "CALIBRATION_LensDistortionModelBrownConrady" => true,
            "CALIBRATION_LensDistortionModelRational6KT" => p1 == 0.0 && p2 == 0.0,
            _ => false,
        };
        if !is_known || codx != 0.0 || cody != 0.0 {
            return Err(format!(
                "its lens is of the model `{}`, and one of Brown and Conrady around the axis was expected",
                model.escape_default()
            ));
        }
        let k = [k1, k2, k3, k4, k5, k6];
        let is_lens = k.iter().chain(&[p1, p2]).any(|&number| number != 0.0);
        Ok(Self {
            focal: DVec2::new(fx, fy),
            principal: DVec2::new(cx, cy),
            distortion: if is_lens {
                Distortion::Rational { k, p: [p1, p2] }
            } else {
                Distortion::None
            },
            sensor_px: [side("SensorWidth")?, side("SensorHeight")?],
            camera_from_rig: place(camera)?,
        })
    }

    /// The camera of a part of the sensor, whose whole has `sensor` pixels of the image.
    fn part(&self, sensor: DVec2, offset: DVec2, size_px: [u32; 2]) -> Intrinsics {
        Intrinsics {
            focal_px: self.focal * sensor,
            // Pixel centres are at integers.
            principal_px: self.principal * sensor - offset - 0.5,
            distortion: self.distortion,
            for_size_px: Some(size_px),
        }
    }
}

fn pair(numbers: [u32; 2]) -> DVec2 {
    DVec2::new(f64::from(numbers[0]), f64::from(numbers[1]))
}

fn numbers(camera: &Value, pointer: &str) -> Result<Vec<f64>, String> {
    let list = camera.pointer(pointer).and_then(Value::as_array);
    let numbers = list.and_then(|list| list.iter().map(Value::as_f64).collect::<Option<_>>());
    numbers.ok_or_else(|| format!("`{}` is not a list of numbers", &pointer[1..]))
}

fn place(camera: &Value) -> Result<DAffine3, String> {
    let rows: Result<[f64; 9], _> = numbers(camera, "/Rt/Rotation")?.try_into();
    let shift: Result<[f64; 3], _> = numbers(camera, "/Rt/Translation")?.try_into();
    let (Ok(rows), Ok(shift)) = (rows, shift) else {
        return Err("`Rt` is not a rotation of nine numbers and a translation of three".to_owned());
    };
    let rotation = DMat3::from_cols_array(&rows).transpose();
    let off = (rotation.transpose() * rotation - DMat3::IDENTITY).to_cols_array();
    let is_rotation = off.iter().all(|off| off.abs() <= MAX_SKEW) && rotation.determinant() > 0.0;
    if !is_rotation {
        return Err("the rotation of `Rt` is none: its axes are not at right angles".to_owned());
    }
    Ok(DAffine3::from_mat3_translation(rotation, DVec3::from_array(shift)))
}

#[cfg(test)]
mod tests {
    use super::super::modes;
    use super::*;

    fn camera(
        location: &str,
        [width, height]: [u64; 2],
        numbers: [f64; 14],
        rotation: &[f64],
        translation: [f64; 3],
    ) -> Value {
        serde_json::json!({
            "Location": location,
            "SensorWidth": width,
            "SensorHeight": height,
            "MetricRadius": 1.7,
            "Intrinsics": {
                "ModelParameterCount": 14,
                "ModelParameters": numbers.to_vec(),
                "ModelType": "CALIBRATION_LensDistortionModelBrownConrady",
            },
            "Rt": { "Rotation": rotation, "Translation": translation.to_vec() },
        })
    }

    /// Centre, focal lengths, k₁ to k₆, centre of distortion, p₂, p₁.
    const DEPTH_NUMBERS: [f64; 14] = [
        0.5, 0.52, 0.49, 0.49, 5.2, 3.5, 0.18, 5.6, 5.3, 0.93, 0.0, 0.0, -1e-4, 2e-5,
    ];
    const COLOR_NUMBERS: [f64; 14] = [
        0.5, 0.5, 0.475, 0.633, 0.7, -2.7, 1.6, 0.58, -2.5, 1.5, 0.0, 0.0, 2e-4, -3e-4,
    ];
    const UPRIGHT: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    /// Turned by the angle whose cosine is 0.8 around x, row by row.
    const TURNED: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 0.8, 0.6, 0.0, -0.6, 0.8];

    fn json(color_px: [u64; 2]) -> Value {
        let depth = camera(DEPTH, [1024, 1024], DEPTH_NUMBERS, &UPRIGHT, [0.0; 3]);
        let color = camera(COLOR, color_px, COLOR_NUMBERS, &TURNED, [-0.032, -0.002, 0.004]);
        serde_json::json!({ "CalibrationInformation": { "Cameras": [color, depth] } })
    }

    fn device(json: &Value) -> Result<Device, String> {
        Device::of_json(json.to_string().as_bytes())
    }

    /// Values by hand, from the table of the SDK: sizes of the sensor, the cropping, and half a pixel.
    #[test]
    fn depth_camera_modes_are_parts_of_its_sensor() {
        let device = device(&json([4096, 3072])).unwrap();
        for (size_px, focal, center) in [
            ([640, 576], 501.76, [319.5, 351.98]),
            ([320, 288], 250.88, [159.5, 175.74]),
            ([1024, 1024], 501.76, [511.5, 531.98]),
            ([512, 512], 250.88, [255.5, 265.74]),
        ] {
            let found = device.depth(&modes::of_depth(None, size_px).unwrap());
            assert_eq!(found.for_size_px, Some(size_px));
            assert!(found.focal_px.abs_diff_eq(DVec2::splat(focal), 1e-9), "{found:?}");
            assert!(found.principal_px.abs_diff_eq(center.into(), 1e-9), "{found:?}");
            let expected = Distortion::Rational {
                k: [5.2, 3.5, 0.18, 5.6, 5.3, 0.93],
                p: [2e-5, -1e-4],
            };
            assert_eq!(found.distortion, expected);
        }
    }

    #[test]
    fn sixteen_to_nine_images_are_the_center_of_the_sensor() {
        let device = device(&json([4096, 3072])).unwrap();
        for (size_px, sensor_height, cut) in [
            ([1280, 720], 960.0, 120.0),
            ([1920, 1080], 1440.0, 180.0),
            ([2560, 1440], 1920.0, 240.0),
            ([3840, 2160], 2880.0, 360.0),
            ([2048, 1536], 1536.0, 0.0),
            ([4096, 3072], 3072.0, 0.0),
        ] {
            let found = device.color(size_px).unwrap();
            let focal = DVec2::new(0.475 * f64::from(size_px[0]), 0.633 * sensor_height);
            let center = DVec2::new(0.5 * f64::from(size_px[0]) - 0.5, 0.5 * sensor_height - cut - 0.5);
            assert!(found.focal_px.abs_diff_eq(focal, 1e-9), "{size_px:?}: {found:?}");
            assert!(found.principal_px.abs_diff_eq(center, 1e-9), "{size_px:?}: {found:?}");
        }
        assert!(device.color([640, 400]).unwrap_err().contains("640 × 400"));
    }

    /// A device that was calibrated for the centre sees the same: 16:9 numbers are the 4:3 ones in other units.
    #[test]
    fn early_devices_were_calibrated_for_the_center() {
        let mut of_center = json([3840, 2160]);
        let parameters = of_center.pointer_mut("/CalibrationInformation/Cameras/0/Intrinsics/ModelParameters");
        let parameters = parameters.unwrap();
        // Heights relative to 9/16 of the width are 4/3 of those relative to 3/4; the central part starts an eighth
        // below the top.
        parameters[1] = ((COLOR_NUMBERS[1] - 0.125) * 4.0 / 3.0).into();
        parameters[3] = (COLOR_NUMBERS[3] * 4.0 / 3.0).into();
        let [of_center, whole] = [of_center, json([4096, 3072])].map(|json| device(&json).unwrap());
        for size_px in [[1280, 720], [2048, 1536]] {
            let [a, b] = [&of_center, &whole].map(|device| device.color(size_px).unwrap());
            assert!(a.focal_px.abs_diff_eq(b.focal_px, 1e-9) && a.principal_px.abs_diff_eq(b.principal_px, 1e-9));
        }
    }

    #[test]
    fn places_are_read_row_by_row() {
        let found = device(&json([4096, 3072])).unwrap().color_from_depth();
        let point = found.transform_point3(DVec3::new(0.1, 1.0, 2.0));
        // Rows: 0.8 · 1 + 0.6 · 2, and −0.6 · 1 + 0.8 · 2.
        let expected = DVec3::new(0.1 - 0.032, 2.0 - 0.002, 1.0 + 0.004);
        assert!(point.abs_diff_eq(expected, 1e-12), "{point}");
    }

    #[test]
    fn invalid_calibrations_say_what_is_missing() {
        let whole = json([4096, 3072]);
        let zeros = [whole.to_string().as_bytes(), b"\0\0"].concat();
        assert_eq!(Device::of_json(&zeros), device(&whole));
        let with = |pointer: &str, value: Value| {
            let mut json = whole.clone();
            *json.pointer_mut(pointer).unwrap() = value;
            device(&json).unwrap_err()
        };
        let depth = "/CalibrationInformation/Cameras/1";
        for (end, value, expected) in [
            (
                "/Location",
                "elsewhere".into(),
                "no camera CALIBRATION_CameraLocationD0",
            ),
            ("/SensorWidth", 640.into(), "640 × 1024"),
            ("/SensorWidth", (-1).into(), "`SensorWidth`"),
            ("/SensorHeight", u64::MAX.into(), "`SensorHeight`"),
            ("/Intrinsics/ModelParameters", vec![0.5; 5].into(), "5 numbers"),
            (
                "/Intrinsics/ModelParameters",
                "x".into(),
                "`Intrinsics/ModelParameters`",
            ),
            ("/Intrinsics/ModelParameters/10", 0.1.into(), "around the axis"),
            (
                "/Intrinsics/ModelType",
                "CALIBRATION_LensDistortionModelTheta".into(),
                "Theta",
            ),
            (
                "/Intrinsics/ModelType",
                "CALIBRATION_LensDistortionModelRational6KT".into(),
                "6KT",
            ),
            ("/Rt/Rotation", vec![0.0; 9].into(), "right angles"),
            ("/Rt/Rotation", vec![1.0; 4].into(), "nine numbers"),
        ] {
            let error = with(&format!("{depth}{end}"), value);
            assert!(error.contains(expected), "{end}: {error}");
        }
        assert!(with("/CalibrationInformation/Cameras", 1.into()).contains("no list"));
        for broken in [b"".as_slice(), b"\0", b"{", b"\xff"] {
            assert!(Device::of_json(broken).is_err());
        }
        let blind = serde_json::json!({ "CalibrationInformation": { "Cameras": [whole.pointer(depth)] } });
        assert!(device(&blind).unwrap().color([1280, 720]).unwrap_err().contains(COLOR));
    }
}
