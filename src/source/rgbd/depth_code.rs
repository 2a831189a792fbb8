//! Encoding of depth image values.

use super::error::RgbdError;
use crate::raster::{Raster, Samples};
use crate::rgbd::{DepthImage, DepthTable, RayTable, is_measured};
use std::path::Path;

/// Encoding of depth image values, except those that are not measurements in any code ([`is_measured`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DepthCode {
    bits: Bits,
    /// Units per metre; for floats only if stated explicitly.
    units_per_metre: f64,
    is_told: bool,
    /// True if the values are ray lengths, not depths along the axis.
    is_ray_length: bool,
}

/// Transformation applied to 16-bit values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Bits {
    Plain,
    /// The three lowest are at the top.
    Rotated,
    /// Bytes are swapped, and the rest is the code of a Kinect.
    Kinect,
}

/// A code of a Kinect d is 351.3 / (1092.5 − d) metres.
const KINECT: [f64; 2] = [351.3, 1092.5];

impl DepthCode {
    /// Returns the length of one unit in metres, if the values are plain depths along the axis.
    pub(super) fn metres_per_unit(&self) -> Option<f64> {
        let is_plain = self.bits == Bits::Plain && !self.is_ray_length;
        is_plain.then(|| self.units_per_metre.recip())
    }

    /// Returns the number of units per metre, if integers are plain depths along the axis.
    pub(super) fn units_per_metre(&self) -> Option<f64> {
        let is_plain = self.bits == Bits::Plain && !self.is_ray_length;
        is_plain.then_some(self.units_per_metre)
    }

    /// Units per metre.
    pub(super) fn per_metre(units_per_metre: f64) -> Self {
        Self {
            bits: Bits::Plain,
            units_per_metre,
            is_told: false,
            is_ray_length: false,
        }
    }

    /// Metres along rays.
    pub(super) fn ray_length() -> Self {
        Self {
            is_ray_length: true,
            ..Self::per_metre(1.0)
        }
    }

    /// Millimetres, with the three lowest bits at the top.
    pub(super) fn rotated() -> Self {
        Self {
            bits: Bits::Rotated,
            ..Self::per_metre(1000.0)
        }
    }

    /// Codes of a Kinect with their bytes swapped.
    pub(super) fn nyu() -> Self {
        Self {
            bits: Bits::Kinect,
            ..Self::per_metre(1.0)
        }
    }

    /// Returns the same depth code with other units, which apply to floats too.
    pub(super) fn told(self, units_per_metre: f64) -> Self {
        Self {
            units_per_metre,
            is_told: true,
            ..self
        }
    }

    /// Returns the same depth code with integer units given by a companion file of the images.
    pub(super) fn with_units(self, units_per_metre: f64) -> Self {
        Self {
            units_per_metre,
            ..self
        }
    }

    /// The depths in `raster`, which is from the file at `path`. Precondition: `rays` are of its size.
    pub(super) fn depth_image(&self, path: &Path, raster: Raster, rays: &RayTable) -> Result<DepthImage, RgbdError> {
        let mut metres = match raster.samples {
            Samples::Gray16(samples) => samples.iter().map(|&sample| self.metres(sample)).collect(),
            Samples::GrayF32(samples) if self.is_told => {
                let scaled = samples
                    .iter()
                    .map(|&sample| (f64::from(sample) / self.units_per_metre) as f32);
                scaled.collect()
            }
            Samples::GrayF32(samples) => samples,
            other => {
                return Err(RgbdError::NotDepth {
                    path: path.to_owned(),
                    found: other.name(),
                });
            }
        };
        if self.is_ray_length {
            for (depth, &[x, y]) in metres.iter_mut().zip(rays.rays()) {
                let ray = f64::from(x).hypot(f64::from(y)).hypot(1.0);
                *depth = (f64::from(*depth) / ray) as f32;
            }
        }
        DepthImage::new(raster.size_px, metres).ok_or_else(|| RgbdError::Image {
            path: path.to_owned(),
            reason: "it does not have the number of pixels that it claims".to_owned(),
        })
    }

    /// Returns the lookup table for all 16-bit values, if their meaning does not depend on the pixel.
    pub(super) fn table(&self) -> Option<DepthTable> {
        (!self.is_ray_length).then(|| DepthTable::new(|sample| self.metres(sample)))
    }

    fn metres(&self, sample: u16) -> f32 {
        if !is_measured(sample) {
            return 0.0;
        }
        let units = match self.bits {
            Bits::Plain => f64::from(sample),
            Bits::Rotated => f64::from(sample.rotate_right(3)),
            Bits::Kinect => {
                let [scale, end] = KINECT;
                scale / (end - f64::from(sample.swap_bytes()))
            }
        };
        (units / self.units_per_metre) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_decode_to_metres() {
        assert_eq!(DepthCode::per_metre(5000.0).metres(5000), 1.0);
        assert_eq!(DepthCode::per_metre(1000.0).told(5000.0).metres(2500), 0.5);
        assert_eq!(DepthCode::rotated().metres(1234_u16.rotate_left(3)), 1.234);
        let kinect = DepthCode::nyu().metres(800_u16.swap_bytes());
        assert!((kinect - 351.3 / 292.5).abs() < 1e-6);
        // A Kinect's code for no measurement lies beyond the end.
        assert!(DepthCode::nyu().metres(2047_u16.swap_bytes()) < 0.0);
        for code in [DepthCode::per_metre(1.0), DepthCode::rotated(), DepthCode::nyu()] {
            assert_eq!([code.metres(0), code.metres(65535)], [0.0, 0.0]);
        }
    }
}
