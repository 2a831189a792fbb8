//! What a decoder hands over: arrays in file order and file coordinates, not yet checked.

use glam::DVec3;

/// Coordinates at the precision of the file, so that nothing is lost before the origin is subtracted.
#[derive(Debug, Clone, PartialEq)]
pub enum Positions {
    /// Single precision.
    F32(Vec<[f32; 3]>),
    /// Double precision.
    F64(Vec<[f64; 3]>),
}

impl Positions {
    /// Number of points.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(positions) => positions.len(),
            Self::F64(positions) => positions.len(),
        }
    }

    /// True when there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Point `index` in file coordinates. Precondition: `index < len()`.
    pub fn get(&self, index: usize) -> DVec3 {
        match self {
            Self::F32(positions) => glam::Vec3::from_array(positions[index]).as_dvec3(),
            Self::F64(positions) => DVec3::from_array(positions[index]),
        }
    }

    /// Number of points with three finite coordinates, and their smallest and largest corner in file
    /// coordinates; `None` when there is no such point.
    pub fn finite_bounds(&self) -> (usize, Option<(DVec3, DVec3)>) {
        let mut count = 0;
        let mut min = DVec3::INFINITY;
        let mut max = DVec3::NEG_INFINITY;
        for index in 0..self.len() {
            let position = self.get(index);
            if position.is_finite() {
                count += 1;
                min = min.min(position);
                max = max.max(position);
            }
        }
        (count, (count > 0).then_some((min, max)))
    }
}

/// A decoded point cloud. Every attribute that is there has one entry a point; [`super::Frame::from_raw`] checks it.
#[derive(Debug, Clone, PartialEq)]
pub struct RawCloud {
    /// Coordinates; holes of organised clouds are NaN.
    pub positions: Positions,
    /// 8-bit red, green, blue, alpha.
    pub colors: Option<Vec<[u8; 4]>>,
    /// Normals of any length.
    pub normals: Option<Vec<[f32; 3]>>,
    /// Splat radii in file units.
    pub radii: Option<Vec<f32>>,
    /// One free scalar a point: intensity, reflectance, confidence.
    pub scalars: Option<Vec<f32>>,
    /// Where the sensor stood, in file coordinates, if the file says so: normals are turned towards it.
    pub sensor: Option<DVec3>,
}

impl RawCloud {
    /// A cloud of bare positions.
    pub fn from_positions(positions: Positions) -> Self {
        Self {
            positions,
            colors: None,
            normals: None,
            radii: None,
            scalars: None,
            sensor: None,
        }
    }

    /// Names of the attributes that are there, positions first.
    pub fn attributes(&self) -> Vec<&'static str> {
        [
            ("position", true),
            ("color", self.colors.is_some()),
            ("normal", self.normals.is_some()),
            ("radius", self.radii.is_some()),
            ("scalar", self.scalars.is_some()),
        ]
        .into_iter()
        .filter_map(|(name, there)| there.then_some(name))
        .collect()
    }
}
