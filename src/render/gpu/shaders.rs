//! The permutation table: which files make the shader of a strategy, a primitive and a pass.
//!
//! WGSL has no includes; a permutation is the concatenation of its files. A test validates every row without a GPU.

use crate::scene::Strategy;
use std::fmt::Write;

/// What one record becomes; a file of `shaders/primitives/`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Amplification {
    /// One vertex of a point list.
    Pixel,
    /// One quad that faces the screen.
    Square,
    /// One quad on the surface.
    Surfel,
    /// Three faces of a cube.
    Voxel,
    /// The same, lit as the surface in it is.
    VoxelWithNormal,
}

impl Amplification {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Pixel,
        Self::Square,
        Self::Surfel,
        Self::Voxel,
        Self::VoxelWithNormal,
    ];

    /// Vertices that the vertex stage runs for a record; the WGSL constant `VERTICES_PER_RECORD`.
    pub fn vertices_per_record(self) -> u32 {
        match self {
            Self::Pixel => 1,
            Self::Square | Self::Surfel => 4,
            Self::Voxel | Self::VoxelWithNormal => 12,
        }
    }

    /// Whether the [`super::gpu_data::ShapeRecord`] stream is needed.
    pub fn needs_shapes(self) -> bool {
        matches!(self, Self::Surfel | Self::VoxelWithNormal)
    }

    /// Whether records are cells.
    pub fn draws_cells(self) -> bool {
        matches!(self, Self::Voxel | Self::VoxelWithNormal)
    }

    fn source(self) -> &'static str {
        match self {
            Self::Pixel => include_str!("../../../shaders/primitives/points_of_a_pixel.wgsl"),
            Self::Square => include_str!("../../../shaders/primitives/points.wgsl"),
            Self::Surfel => include_str!("../../../shaders/primitives/surfels.wgsl"),
            Self::Voxel => include_str!("../../../shaders/primitives/voxels.wgsl"),
            Self::VoxelWithNormal => {
                include_str!("../../../shaders/primitives/voxels_lit_by_normals.wgsl")
            }
        }
    }
}

/// A pass over geometry; a file of `shaders/passes/`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum GeometryPass {
    /// Depths only.
    Visibility,
    /// Weighted sums of what lies at the surface.
    Attribute,
    /// One-pass blending with depth.
    Regular,
    /// One-pass blending without depth.
    NoDepth,
    /// Opaque faces.
    Solid,
    /// Unlit points.
    Point,
    /// The same, round.
    RoundPoint,
}

impl GeometryPass {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Visibility,
        Self::Attribute,
        Self::Regular,
        Self::NoDepth,
        Self::Solid,
        Self::Point,
        Self::RoundPoint,
    ];

    /// Which amplifications the pass draws.
    pub fn draws(self, amplification: Amplification) -> bool {
        match self {
            Self::Visibility | Self::Attribute | Self::Regular | Self::NoDepth => {
                amplification == Amplification::Surfel
            }
            Self::Solid => amplification.draws_cells(),
            Self::Point => matches!(amplification, Amplification::Pixel | Amplification::Square),
            Self::RoundPoint => amplification == Amplification::Square,
        }
    }

    fn source(self) -> &'static str {
        match self {
            Self::Visibility => include_str!("../../../shaders/passes/visibility.wgsl"),
            Self::Attribute => include_str!("../../../shaders/passes/attribute.wgsl"),
            Self::Regular | Self::NoDepth => include_str!("../../../shaders/passes/splat.wgsl"),
            Self::Solid => include_str!("../../../shaders/passes/solid.wgsl"),
            Self::Point => include_str!("../../../shaders/passes/point.wgsl"),
            Self::RoundPoint => include_str!("../../../shaders/passes/round_point.wgsl"),
        }
    }
}

/// A pass over the whole target; a file of `shaders/passes/`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ScreenPass {
    /// The gradient.
    Background,
    /// Normalisation of the attribute pass.
    Resolve,
    /// The visibility pass as grey.
    DepthView,
    /// Eye-dome lighting of the picture.
    EyeDome,
    /// Eye-dome lighting of the sums of the attribute pass, to which the background is not added yet.
    EyeDomeOfSums,
    /// Lines on the ground.
    Grid,
}

impl ScreenPass {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Background,
        Self::Resolve,
        Self::DepthView,
        Self::EyeDome,
        Self::EyeDomeOfSums,
        Self::Grid,
    ];

    fn source(self) -> &'static str {
        match self {
            Self::Background => include_str!("../../../shaders/passes/background.wgsl"),
            Self::Resolve => include_str!("../../../shaders/passes/resolve.wgsl"),
            Self::DepthView => include_str!("../../../shaders/passes/depth_view.wgsl"),
            Self::EyeDome | Self::EyeDomeOfSums => {
                include_str!("../../../shaders/passes/eye_dome.wgsl")
            }
            Self::Grid => include_str!("../../../shaders/passes/grid.wgsl"),
        }
    }
}

/// One shader module.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Permutation {
    /// A geometry pass under a strategy.
    Geometry(Strategy, Amplification, GeometryPass),
    /// The compute stage of [`Strategy::Compute`].
    Amplify(Amplification),
    /// A pass over the screen.
    Screen(ScreenPass),
}

impl Permutation {
    /// Every module that a renderer can ask for.
    pub fn all() -> Vec<Self> {
        let mut all: Vec<Self> = ScreenPass::ALL.map(Self::Screen).to_vec();
        for amplification in Amplification::ALL {
            if compute_amplifies(amplification) {
                all.push(Self::Amplify(amplification));
            }
            for pass in GeometryPass::ALL
                .into_iter()
                .filter(|pass| pass.draws(amplification))
            {
                all.extend(
                    Strategy::ALL
                        .iter()
                        .map(|&strategy| Self::Geometry(strategy, amplification, pass)),
                );
            }
        }
        all
    }

    /// A name for error messages and debuggers.
    pub fn label(self) -> String {
        match self {
            Self::Geometry(strategy, amplification, pass) => {
                format!("{strategy}/{amplification:?}/{pass:?}")
            }
            Self::Amplify(amplification) => format!("amplify/{amplification:?}"),
            Self::Screen(pass) => format!("screen/{pass:?}"),
        }
    }

    /// The complete WGSL source.
    pub fn source(self) -> String {
        let view = include_str!("../../../shaders/common/view.wgsl");
        let records = include_str!("../../../shaders/common/records.wgsl");
        let light = include_str!("../../../shaders/common/light.wgsl");
        let splat = include_str!("../../../shaders/common/splat.wgsl");
        match self {
            Self::Geometry(strategy, amplification, pass) => {
                let mut files = vec![view, records, light, splat, fetch(strategy, amplification)];
                if reads_amplified(strategy, amplification) {
                    files.push(include_str!("../../../shaders/fetch/compute.wgsl"));
                } else {
                    files.push(amplification.source());
                }
                files.push(include_str!("../../../shaders/common/varyings.wgsl"));
                files.push(pass.source());
                concatenate(&files)
            }
            Self::Amplify(amplification) => concatenate(&[
                view,
                records,
                light,
                splat,
                include_str!("../../../shaders/fetch/storage.wgsl"),
                amplification.source(),
                include_str!("../../../shaders/passes/amplify.wgsl"),
            ]),
            Self::Screen(pass) => concatenate(&[
                view,
                include_str!("../../../shaders/common/fullscreen.wgsl"),
                pass.source(),
            ]),
        }
    }
}

/// Plain points gain nothing from a compute pass that would write what the vertex stage computes once anyway.
pub(super) fn compute_amplifies(amplification: Amplification) -> bool {
    amplification == Amplification::Surfel || amplification.draws_cells()
}

/// Whether the vertex stage reads corners that a compute pass wrote.
pub(super) fn reads_amplified(strategy: Strategy, amplification: Amplification) -> bool {
    strategy == Strategy::Compute && compute_amplifies(amplification)
}

fn fetch(strategy: Strategy, amplification: Amplification) -> &'static str {
    match strategy {
        Strategy::Compute if reads_amplified(strategy, amplification) => "",
        Strategy::Storage | Strategy::Compute => {
            include_str!("../../../shaders/fetch/storage.wgsl")
        }
        Strategy::Uniform => include_str!("../../../shaders/fetch/uniform.wgsl"),
        Strategy::Texture => include_str!("../../../shaders/fetch/texture.wgsl"),
        Strategy::Vertex if amplification.needs_shapes() => {
            include_str!("../../../shaders/fetch/vertex.wgsl")
        }
        Strategy::Vertex => include_str!("../../../shaders/fetch/vertex_points.wgsl"),
    }
}

fn concatenate(files: &[&str]) -> String {
    let mut source = String::with_capacity(files.iter().map(|file| file.len() + 1).sum());
    for file in files {
        // Writing to a String cannot fail.
        let _ = writeln!(source, "{file}");
    }
    source
}
