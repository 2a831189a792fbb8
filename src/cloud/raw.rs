//! Raw decoder output: arrays in file order and file coordinates, not yet checked.

use super::attributes::gather;
use super::{Attributes, Dropped, ImageGrid, LengthUnit, MadeFrom, Texturing};
use crate::assumption::Assumption;
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;
use std::fmt;
use std::str::FromStr;

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

    /// Bytes that the coordinates of a point take.
    pub fn point_bytes(&self) -> usize {
        match self {
            Self::F32(_) => size_of::<[f32; 3]>(),
            Self::F64(_) => size_of::<[f64; 3]>(),
        }
    }

    /// In single precision, if no coordinate loses a digit by that; else as they are.
    #[must_use]
    pub(crate) fn narrowed(self) -> Self {
        let Self::F64(wide) = &self else { return self };
        let fits = |coordinate: &f64| f64::from(*coordinate as f32) == *coordinate || coordinate.is_nan();
        if !wide.iter().flatten().all(fits) {
            return self;
        }
        let narrow = wide.iter().map(|point| point.map(|coordinate| coordinate as f32));
        Self::F32(narrow.collect())
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

/// Axis convention of a file, according to its format or its header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisConvention {
    /// Y is up: glTF.
    YUp,
    /// Z is up: maps and surveys, LAS among them.
    ZUp,
    /// Z is up in most files of the format, by convention only: KITTI, PTX, E57, ROS, STL.
    UsuallyZUp,
    /// Right, down, forward: a cloud in the optical frame of a camera.
    Camera,
    /// Y is down in most files, by convention only: Gaussian splats, which are trained in the axes of a camera.
    UsuallyYDown,
}

impl AxisConvention {
    /// Returns true if a file with other axes is wrong.
    pub fn is_binding(self) -> bool {
        !matches!(self, Self::UsuallyZUp | Self::UsuallyYDown)
    }
}

/// Range of colour values, concluded from the largest where the type of the numbers does not say it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ColorDepth {
    /// 0 to 1.
    Unit,
    /// 0 to 255.
    Bits8,
    /// 0 to 65535.
    Bits16,
}

impl ColorDepth {
    /// The value of full intensity.
    pub fn full_scale(self) -> f32 {
        match self {
            Self::Unit => 1.0,
            Self::Bits8 => f32::from(u8::MAX),
            Self::Bits16 => f32::from(u16::MAX),
        }
    }
}

impl fmt::Display for ColorDepth {
    /// As on the command line.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Unit => "unit",
            Self::Bits8 => "8",
            Self::Bits16 => "16",
        })
    }
}

impl FromStr for ColorDepth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.trim() {
            "unit" => Ok(Self::Unit),
            "8" => Ok(Self::Bits8),
            "16" => Ok(Self::Bits16),
            _ => Err(format!("expected unit (0 to 1), 8 or 16 bits, found \"{text}\"")),
        }
    }
}

/// A decoded point cloud. Every present attribute has one entry per point; [`super::Frame::from_raw`] checks it.
#[derive(Debug, Clone, PartialEq)]
pub struct RawCloud {
    /// Coordinates; holes of organised clouds are NaN.
    pub positions: Positions,
    /// Point attributes in addition to positions.
    // One more indirection per access, but flat fields would be listed again in `Frame` and in every conversion.
    pub attributes: Attributes,
    /// The image grid of an organised cloud, line by line; of a sample, the grid of all points.
    pub grid: Option<ImageGrid>,
    /// Source data of positions and colours, as long as these are unchanged.
    pub made_from: Option<MadeFrom>,
    /// True if the colours were found as 0 to 255 in fields of 16 bits, which other programs may show black.
    pub has_narrow_colors: bool,
    /// The range that was concluded from the colours; `None` if their type determines it.
    pub color_depth: Option<ColorDepth>,
    /// Triangles of a mesh: indices of three points each, all below the number of points. Empty where there is no mesh.
    pub faces: Vec<[u32; 3]>,
    /// Triangles that the file has and `faces` has not: points were sampled on them, or vertices skipped.
    pub skipped_faces: usize,
    /// Textures of the faces, unless their colours are in the points already.
    pub texturing: Option<Texturing>,
    /// Sensor position in file coordinates, if the file states it: normals are oriented towards it.
    pub sensor: Option<DVec3>,
    /// Smallest and largest coordinate along each axis that the integers of the file can hold, where it has integers:
    /// programs overflow to them.
    pub integer_limits: Option<[[f64; 2]; 3]>,
    /// Axis convention stated by the file.
    pub convention: Option<AxisConvention>,
    /// Decisions of the reader about the meaning of the file.
    pub assumptions: Vec<Assumption>,
    /// The unit of coordinates, if format or file say it.
    pub unit: Option<LengthUnit>,
    /// Contents of the file that are not in the cloud, or with fewer digits, without being damaged.
    pub dropped: Vec<Dropped>,
    /// Warnings about parts of the file that could not be read although its points could: a sentence each, with file
    /// and location.
    pub warnings: Vec<String>,
}

impl RawCloud {
    /// A cloud of bare positions.
    pub fn from_positions(positions: Positions) -> Self {
        Self {
            positions,
            attributes: Attributes::default(),
            grid: None,
            made_from: None,
            has_narrow_colors: false,
            color_depth: None,
            faces: Vec::new(),
            skipped_faces: 0,
            texturing: None,
            sensor: None,
            integer_limits: None,
            convention: None,
            assumptions: Vec::new(),
            unit: None,
            dropped: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Keeps the points at `indices`, in their order; drops faces and textures, the grid, and the source data.
    /// Precondition: each is below the number of points and of the entries of every attribute.
    pub fn keep(&mut self, indices: &[u32]) {
        self.positions = match &self.positions {
            Positions::F32(positions) => Positions::F32(gather(positions, indices)),
            Positions::F64(positions) => Positions::F64(gather(positions, indices)),
        };
        self.attributes.keep(indices);
        self.skipped_faces += self.faces.len();
        self.faces.clear();
        self.texturing = None;
        // The grid cell of a point follows from its index in the file, which has changed.
        self.grid = None;
        self.made_from = None;
    }

    /// Reads the colours again, as values of the wider range `depth`.
    pub fn widen_colors(&mut self, depth: ColorDepth) {
        let Some(known) = self.color_depth.filter(|known| *known < depth) else {
            return;
        };
        let scale = known.full_scale() / depth.full_scale();
        for [red, green, blue, _] in self.attributes.colors.iter_mut().flatten() {
            for channel in [red, green, blue] {
                *channel = (f32::from(*channel) * scale).round() as u8;
            }
        }
        self.color_depth = Some(depth);
        self.has_narrow_colors = false;
        self.made_from = None;
    }

    /// Moves the points by the rigid `pose`, in double precision.
    pub fn transform(&mut self, pose: &DAffine3) {
        let moved = |position: DVec3| pose.transform_point3(position).to_array();
        let positions = match &self.positions {
            Positions::F32(positions) => {
                let wide = |position: &[f32; 3]| moved(Vec3::from_array(*position).as_dvec3());
                positions.par_iter().map(wide).collect()
            }
            Positions::F64(positions) => {
                let positions = positions.par_iter();
                positions.map(|position| moved(DVec3::from_array(*position))).collect()
            }
        };
        self.positions = Positions::F64(positions);
        let rotation = pose.matrix3.as_mat3();
        for normal in self.attributes.normals.iter_mut().flatten() {
            *normal = (rotation * Vec3::from_array(*normal)).to_array();
        }
        for ellipse in self.attributes.ellipses.iter_mut().flatten() {
            ellipse.axis = rotation * ellipse.axis;
        }
        // Until now, clouds are in the coordinates of their sensor.
        self.sensor = Some(pose.transform_point3(self.sensor.unwrap_or(DVec3::ZERO)));
        self.integer_limits = None;
        self.made_from = None;
    }

    /// Names of the point attributes, positions first.
    pub fn point_names(&self) -> Vec<String> {
        let names = std::iter::once("position").chain(self.attributes.names());
        names.map(str::to_owned).collect()
    }

    /// Bytes of all arrays.
    pub fn byte_size(&self) -> usize {
        let point_bytes = self.positions.point_bytes() + self.attributes.point_bytes();
        let made_from = self.made_from.as_ref().map_or(0, MadeFrom::byte_size);
        self.positions.len() * point_bytes + size_of_val(self.faces.as_slice()) + made_from
    }
}
