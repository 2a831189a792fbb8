//! A validated pose: finite f32 positions relative to the sequence origin.

use super::{Positions, RawCloud};
use crate::math::Aabb;
use glam::{DVec3, Vec3};

/// Why a decoded cloud cannot become a frame.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CloudError {
    /// An attribute array does not have one entry a point.
    #[error("{attribute} has {found} entries for {expected} points")]
    LengthMismatch {
        /// Which attribute.
        attribute: &'static str,
        /// Number of points.
        expected: usize,
        /// Number of entries.
        found: usize,
    },
}

/// One pose: a structure of arrays, all of one length.
///
/// Invariants, held by [`Frame::from_raw`]: every position and scalar is finite; normals are of unit length, or zero
/// where the file gave none that can be used; radii are finite and not negative.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    positions: Vec<Vec3>,
    colors: Option<Vec<[u8; 4]>>,
    normals: Option<Vec<Vec3>>,
    radii: Option<Vec<f32>>,
    scalars: Option<Vec<f32>>,
    sensor: Option<Vec3>,
    bounds: Aabb,
    dropped_points: usize,
}

impl Frame {
    /// Validates `raw`, moves it to `origin` (in f64) and drops points without finite coordinates.
    pub fn from_raw(raw: RawCloud, origin: DVec3) -> Result<Self, CloudError> {
        let point_count = raw.positions.len();
        check_length("color", point_count, raw.colors.as_deref())?;
        check_length("normal", point_count, raw.normals.as_deref())?;
        check_length("radius", point_count, raw.radii.as_deref())?;
        check_length("scalar", point_count, raw.scalars.as_deref())?;

        let moved = move_to_origin(raw.positions, origin);
        let keep: Option<Vec<bool>> = moved
            .iter()
            .any(|position| !position.is_finite())
            .then(|| moved.iter().map(|position| position.is_finite()).collect());
        let positions = compact(moved, keep.as_deref());
        Ok(Self {
            bounds: Aabb::from_points(&positions),
            dropped_points: point_count - positions.len(),
            colors: raw.colors.map(|colors| compact(colors, keep.as_deref())),
            normals: raw.normals.map(|normals| {
                compact(normals, keep.as_deref())
                    .into_iter()
                    .map(|normal| Vec3::from_array(normal).normalize_or_zero())
                    .collect()
            }),
            radii: raw.radii.map(|mut radii| {
                for radius in &mut radii {
                    *radius = if radius.is_nan() {
                        0.0
                    } else {
                        radius.clamp(0.0, f32::MAX)
                    };
                }
                compact(radii, keep.as_deref())
            }),
            scalars: raw.scalars.map(|mut scalars| {
                for scalar in scalars.iter_mut().filter(|scalar| !scalar.is_finite()) {
                    *scalar = 0.0;
                }
                compact(scalars, keep.as_deref())
            }),
            sensor: raw.sensor.map(|sensor| (sensor - origin).as_vec3()),
            positions,
        })
    }

    /// Number of points; may be 0.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// True when no point is left.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Finite positions relative to the sequence origin.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// 8-bit colours of the file.
    pub fn colors(&self) -> Option<&[[u8; 4]]> {
        self.colors.as_deref()
    }

    /// Unit normals of the file, zero where it gave none that can be used.
    pub fn normals(&self) -> Option<&[Vec3]> {
        self.normals.as_deref()
    }

    /// Splat radii of the file.
    pub fn radii(&self) -> Option<&[f32]> {
        self.radii.as_deref()
    }

    /// The file's free scalar (intensity and the like).
    pub fn scalars(&self) -> Option<&[f32]> {
        self.scalars.as_deref()
    }

    /// Where the sensor stood, relative to the sequence origin.
    pub fn sensor(&self) -> Option<Vec3> {
        self.sensor
    }

    /// The box around all positions.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// How many points of the file had no finite coordinates.
    pub fn dropped_points(&self) -> usize {
        self.dropped_points
    }

    /// Bytes of all arrays.
    pub fn byte_size(&self) -> usize {
        let per_point = size_of::<Vec3>()
            + self.colors.as_ref().map_or(0, |_| size_of::<[u8; 4]>())
            + self.normals.as_ref().map_or(0, |_| size_of::<Vec3>())
            + self.radii.as_ref().map_or(0, |_| size_of::<f32>())
            + self.scalars.as_ref().map_or(0, |_| size_of::<f32>());
        self.len() * per_point
    }
}

fn check_length<T>(
    attribute: &'static str,
    expected: usize,
    entries: Option<&[T]>,
) -> Result<(), CloudError> {
    match entries {
        Some(entries) if entries.len() != expected => Err(CloudError::LengthMismatch {
            attribute,
            expected,
            found: entries.len(),
        }),
        _ => Ok(()),
    }
}

/// Positions relative to `origin`: subtracted in f64, narrowed after. Not yet free of NaN and infinities.
fn move_to_origin(positions: Positions, origin: DVec3) -> Vec<Vec3> {
    match positions {
        Positions::F32(positions) if origin == DVec3::ZERO => bytemuck::cast_vec(positions),
        positions => (0..positions.len())
            .map(|index| (positions.get(index) - origin).as_vec3())
            .collect(),
    }
}

/// `values` where `keep` is true; all of them, untouched, for `None`.
fn compact<T>(mut values: Vec<T>, keep: Option<&[bool]>) -> Vec<T> {
    if let Some(keep) = keep {
        let mut kept = keep.iter();
        values.retain(|_| kept.next().copied().unwrap_or(false));
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_are_dropped_from_every_array() {
        let mut raw = RawCloud::from_positions(Positions::F32(vec![
            [1.0, 2.0, 3.0],
            [f32::NAN, 0.0, 0.0],
            [4.0, 5.0, f32::INFINITY],
            [7.0, 8.0, 9.0],
        ]));
        raw.colors = Some(vec![[1; 4], [2; 4], [3; 4], [4; 4]]);
        raw.normals = Some(vec![[0.0, 0.0, 2.0], [1.0; 3], [1.0; 3], [f32::NAN; 3]]);
        raw.radii = Some(vec![0.5, 1.0, 1.0, f32::NAN]);
        let frame = Frame::from_raw(raw, DVec3::ZERO).unwrap();
        assert_eq!(
            frame.positions(),
            [Vec3::new(1.0, 2.0, 3.0), Vec3::new(7.0, 8.0, 9.0)]
        );
        assert_eq!(frame.colors(), Some([[1; 4], [4; 4]].as_slice()));
        assert_eq!(frame.normals(), Some([Vec3::Z, Vec3::ZERO].as_slice()));
        assert_eq!(frame.radii(), Some([0.5, 0.0].as_slice()));
        assert_eq!(frame.dropped_points(), 2);
    }

    #[test]
    fn millimetres_survive_at_ten_thousand_kilometres() {
        let raw = RawCloud::from_positions(Positions::F64(vec![[1e7 + 0.001, -1e7, 3e6 + 0.002]]));
        let frame = Frame::from_raw(raw, DVec3::new(1e7, -1e7, 3e6)).unwrap();
        assert!((frame.positions()[0] - Vec3::new(0.001, 0.0, 0.002)).length() < 1e-8);
    }

    #[test]
    fn a_short_attribute_is_refused() {
        let mut raw = RawCloud::from_positions(Positions::F32(vec![[0.0; 3]; 2]));
        raw.scalars = Some(vec![1.0]);
        assert_eq!(
            Frame::from_raw(raw, DVec3::ZERO),
            Err(CloudError::LengthMismatch {
                attribute: "scalar",
                expected: 2,
                found: 1
            })
        );
    }
}
