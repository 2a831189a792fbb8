//! What a picture needs of a frame: what is not needed is not computed.

use crate::cloud::Frame;
use crate::octree::StopCriterion;

/// Where the colours of points come from. What a frame does not have is replaced as [`ColorSource::Auto`] would.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "lowercase")]
pub enum ColorSource {
    /// The file's colours, else the direction of the normal (the paper's fake colour).
    #[default]
    Auto,
    /// The colours of the file.
    File,
    /// The paper's fake colour: the direction of the normal.
    Normal,
    /// The file's scalar (intensity and the like) through a colour map.
    Scalar,
    /// One colour for all points, [`super::UNIFORM_COLOR`].
    Uniform,
}

impl ColorSource {
    /// All sources, in the order in which a list shows them.
    pub const ALL: [Self; 5] = [
        Self::Auto,
        Self::File,
        Self::Normal,
        Self::Scalar,
        Self::Uniform,
    ];

    /// Its word on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::File => "file",
            Self::Normal => "normal",
            Self::Scalar => "scalar",
            Self::Uniform => "uniform",
        }
    }

    /// The source that `frame` really has; never [`ColorSource::Auto`].
    #[must_use]
    pub fn resolve(self, frame: &Frame) -> Self {
        let automatic = || {
            if frame.colors().is_some() {
                Self::File
            } else {
                Self::Normal
            }
        };
        match self {
            Self::Normal | Self::Uniform => self,
            Self::File if frame.colors().is_some() => self,
            Self::Scalar if frame.scalars().is_some() => self,
            Self::Auto | Self::File | Self::Scalar => automatic(),
        }
    }
}

/// What a picture needs of a frame beyond its points.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Needs {
    /// Normals and radii: for surfels.
    pub shapes: bool,
    /// Ellipses in the shapes, where radii are estimated. Off for drawing, which shows circles: they take twice as
    /// long as radii.
    pub ellipses: bool,
    /// An octree of this depth: for voxels, levels of detail and picking.
    pub octree: Option<StopCriterion>,
    /// The byte code of the octree with attributes, where shapes and an octree are asked for: for footprints from masks.
    pub coded: bool,
    /// The colours of points and voxels.
    pub colors: ColorSource,
}

impl Needs {
    /// Whether byte codes are asked for, and all that they are made of.
    pub(super) fn asks_for_codes(&self) -> bool {
        self.coded && self.shapes && self.octree.is_some()
    }
}
