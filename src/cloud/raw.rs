//! What a decoder hands over: arrays in file order and file coordinates, not yet checked.

use super::LengthUnit;
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

/// One number a point, under the name that the file has for it: intensity, classification, time.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarField {
    /// The file's name for it.
    pub name: String,
    /// One entry a point.
    pub values: Vec<f32>,
    /// What is to be added to a value to get the number in the file: not zero where single precision would lose it, as
    /// in GPS times.
    pub offset: f64,
}

impl ScalarField {
    /// Values as the file has them.
    pub fn new(name: impl Into<String>, values: Vec<f32>) -> Self {
        Self {
            name: name.into(),
            values,
            offset: 0.0,
        }
    }

    /// Numbers of double precision, of which the smallest finite one becomes the offset if single precision loses
    /// digits.
    pub fn from_f64(name: impl Into<String>, values: &[f64]) -> Self {
        let is_exact = |value: &f64| !value.is_finite() || f64::from(*value as f32) == *value;
        let offset = if values.iter().all(is_exact) {
            0.0
        } else {
            let finite = values.iter().copied().filter(|value| value.is_finite());
            finite.reduce(f64::min).unwrap_or(0.0).floor()
        };
        Self {
            name: name.into(),
            values: values.iter().map(|value| (value - offset) as f32).collect(),
            offset,
        }
    }
}

/// Which way the axes of a file point, as its format or its header says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisConvention {
    /// Y is up: glTF.
    YUp,
    /// Z is up: maps and surveys, LAS among them.
    ZUp,
    /// Z is up in most files of the format, though nothing says that it must be: KITTI, PTX, E57, ROS, STL.
    UsuallyZUp,
    /// Right, down, forward: a cloud in the optical frame of a camera.
    Camera,
}

impl AxisConvention {
    /// Whether a file that has other axes is wrong.
    pub fn is_binding(self) -> bool {
        !matches!(self, Self::UsuallyZUp)
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
    /// Further numbers, the one to colour by first.
    pub scalars: Vec<ScalarField>,
    /// Whether the colours were found as 0 to 255 in fields of 16 bits, which other programs may show black.
    pub has_narrow_colors: bool,
    /// Triangles of a mesh: indices of three points each, all below the number of points. Empty where there is no mesh.
    pub faces: Vec<[u32; 3]>,
    /// Where the sensor stood, in file coordinates, if the file says so: normals are turned towards it.
    pub sensor: Option<DVec3>,
    /// What the file says about its axes.
    pub convention: Option<AxisConvention>,
    /// What was assumed about the file because nothing in it says so.
    pub assumption: Option<String>,
    /// The unit of coordinates, if format or file say it.
    pub unit: Option<LengthUnit>,
    /// What of the file could not be read although its points could: a sentence each, with file and place.
    pub warnings: Vec<String>,
}

impl RawCloud {
    /// A cloud of bare positions.
    pub fn from_positions(positions: Positions) -> Self {
        Self {
            positions,
            colors: None,
            normals: None,
            radii: None,
            scalars: Vec::new(),
            has_narrow_colors: false,
            faces: Vec::new(),
            sensor: None,
            convention: None,
            assumption: None,
            unit: None,
            warnings: Vec::new(),
        }
    }

    /// Leaves the points at `indices`, in their order, and no faces. Precondition: each is below the number of points
    /// and of the entries of every attribute.
    pub fn keep(&mut self, indices: &[usize]) {
        fn gather<T: Copy>(values: &[T], indices: &[usize]) -> Vec<T> {
            indices.iter().map(|&index| values[index]).collect()
        }
        self.positions = match &self.positions {
            Positions::F32(positions) => Positions::F32(gather(positions, indices)),
            Positions::F64(positions) => Positions::F64(gather(positions, indices)),
        };
        self.colors = self.colors.as_ref().map(|colors| gather(colors, indices));
        self.normals = self.normals.as_ref().map(|normals| gather(normals, indices));
        self.radii = self.radii.as_ref().map(|radii| gather(radii, indices));
        for field in &mut self.scalars {
            field.values = gather(&field.values, indices);
        }
        self.faces.clear();
    }

    /// Names of the attributes that are there, positions first.
    pub fn attributes(&self) -> Vec<&str> {
        let arrays = [
            ("position", true),
            ("color", self.colors.is_some()),
            ("normal", self.normals.is_some()),
            ("radius", self.radii.is_some()),
        ];
        let names = arrays.into_iter().filter_map(|(name, there)| there.then_some(name));
        names
            .chain(self.scalars.iter().map(|field| field.name.as_str()))
            .collect()
    }
}
