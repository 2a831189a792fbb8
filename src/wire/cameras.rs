//! Cameras and poses.

use super::bytes::{Fields, Written};
use super::error::WireError;
use crate::rgbd::{Camera, Distortion};
use glam::{DAffine3, DMat3, DVec2, DVec3};

/// Maximum pixels along an edge.
const MAX_EDGE_PX: u32 = 1 << 15;

/// Maximum pixels of an image: no depth camera has more, and packed ones may claim any number.
// RVL encodes any number of holes in six bytes.
const MAX_PIXELS: u64 = 1 << 25;

/// Coefficients of a lens.
const COEFFICIENTS: usize = 8;

/// Width and height, where an image may have them.
pub(super) fn checked_size(size_px: [u32; 2], what: &'static str) -> Result<[u32; 2], WireError> {
    let [width, height] = size_px;
    let pixels = u64::from(width) * u64::from(height);
    let edges = 1..=MAX_EDGE_PX;
    if edges.contains(&width) && edges.contains(&height) && pixels <= MAX_PIXELS {
        return Ok(size_px);
    }
    let reason =
        format!("{width} × {height} pixels, and 1 to {MAX_EDGE_PX} along an edge and {MAX_PIXELS} together are read");
    Err(WireError::malformed(what, reason))
}

pub(super) fn write_camera(camera: &Camera, out: &mut Written) {
    let [width, height] = camera.size_px();
    let (focal, principal) = (camera.focal_px(), camera.principal_px());
    let lens = match camera.distortion() {
        Distortion::None => 0,
        Distortion::Brown { .. } => 1,
        Distortion::Rational { .. } => 2,
        Distortion::Fisheye { .. } => 3,
    };
    let mut coefficients = camera.distortion().coefficients();
    coefficients.resize(COEFFICIENTS, 0.0);
    out.u32(width)
        .u32(height)
        .f64s(&[focal.x, focal.y, principal.x, principal.y])
        .u32(lens)
        .u32(0)
        .f64s(&coefficients);
}

/// Writes the placeholder for a missing camera, which has only the image size.
pub(super) fn write_size(size_px: [u32; 2], out: &mut Written) {
    out.u32(size_px[0]).u32(size_px[1]).f64s(&[0.0; 4]).u32(0).u32(0);
    out.f64s(&[0.0; COEFFICIENTS]);
}

/// Wire representation of a camera: its numbers, or only the size of its image.
pub(super) struct CameraFields {
    pub(super) size_px: [u32; 2],
    focal_px: DVec2,
    principal_px: DVec2,
    lens: u32,
    k: [f64; COEFFICIENTS],
}

impl CameraFields {
    pub(super) fn read(fields: &mut Fields<'_>) -> Result<Self, WireError> {
        let size_px = [fields.u32()?, fields.u32()?];
        let [fx, fy, cx, cy] = fields.f64s()?;
        let lens = fields.u32()?;
        fields.u32()?;
        Ok(Self {
            size_px,
            focal_px: DVec2::new(fx, fy),
            principal_px: DVec2::new(cx, cy),
            lens,
            k: fields.f64s()?,
        })
    }

    pub(super) fn camera(&self, what: &'static str) -> Result<Camera, WireError> {
        let k = self.k;
        let distortion = match self.lens {
            0 => Distortion::None,
            1 => Distortion::Brown {
                k: [k[0], k[1], k[4]],
                p: [k[2], k[3]],
            },
            2 => Distortion::Rational {
                k: [k[0], k[1], k[4], k[5], k[6], k[7]],
                p: [k[2], k[3]],
            },
            3 => Distortion::Fisheye {
                k: [k[0], k[1], k[2], k[3]],
            },
            other => {
                let reason = format!("lens {other}: 0 (none), 1 (Brown), 2 (rational) and 3 (fisheye) are known");
                return Err(WireError::malformed(what, reason));
            }
        };
        let size_px = checked_size(self.size_px, what)?;
        Camera::new(size_px, self.focal_px, self.principal_px, distortion)
            .map_err(|error| WireError::malformed(what, error.to_string()))
    }
}

/// Three rows of four numbers.
pub(super) fn write_transform(transform: &DAffine3, out: &mut Written) {
    let rows = transform.matrix3.transpose();
    let [x, y, z] = transform.translation.to_array();
    for (row, last) in [(rows.x_axis, x), (rows.y_axis, y), (rows.z_axis, z)] {
        out.f64s(&[row.x, row.y, row.z, last]);
    }
}

pub(super) fn read_transform(fields: &mut Fields<'_>, what: &'static str) -> Result<DAffine3, WireError> {
    let n: [f64; 12] = fields.f64s()?;
    let rows = DMat3::from_cols(
        DVec3::new(n[0], n[1], n[2]),
        DVec3::new(n[4], n[5], n[6]),
        DVec3::new(n[8], n[9], n[10]),
    );
    let transform = DAffine3 {
        matrix3: rows.transpose(),
        translation: DVec3::new(n[3], n[7], n[11]),
    };
    if transform.is_finite() {
        Ok(transform)
    } else {
        Err(WireError::malformed(what, "numbers that are not finite"))
    }
}
