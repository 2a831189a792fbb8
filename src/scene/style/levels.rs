//! Levels of detail: how deep the octree goes, and which of its cells are drawn.

use super::choices::choices;
use super::describe::{
    Kind, KindNumber, Label, Numbers, Place, Section, Setting, Typed, Unit, Value, Values, Word, Words, group,
};
use crate::levels::octree::StopCriterion;
use crate::levels::{LevelsKind, Lod, LodMetric, SphereKind};
use crate::math::morton;

choices! {
    /// Structure that levels of detail of surfels are taken from.
    LevelStructure, "structure of levels of detail" {
        Octree = "octree", "Octree", "Surfels of the octree's cells, as large as the level of detail says";
        None = "none", "None (list)",
            "Every second, fourth or eighth point, by level, budget or time; nothing is built or culled";
        /// Rusinkiewicz and Levoy 2000.
        QSplat = "qsplat", "QSplat",
            "A tree of spheres in six bytes a node: the least memory, places and colours rounded";
        /// Dachsbacher et al. 2003.
        Sequential = "spt", "Sequential point tree", "The same tree as one sorted list, of which a part is tested";
        /// Sainz and Pajarola 2004 §4.3.
        Printed = "spt-paper", "Sequential, as printed",
            "The same list by the paper's own rule, which draws some points twice: for comparison";
        /// Windisch et al. 2025.
        Hierarchical = "hspt", "Hierarchy of sequences", "Short sorted lists below nodes that are culled first";
    }
}

impl LevelStructure {
    /// Returns the kind of levels that surfels are taken from.
    pub fn kind(self) -> LevelsKind {
        match self {
            Self::Octree => LevelsKind::Surfels,
            Self::None => LevelsKind::List,
            Self::QSplat => LevelsKind::Spheres(SphereKind::QSplat),
            Self::Sequential => LevelsKind::Spheres(SphereKind::Sequential),
            Self::Printed => LevelsKind::Spheres(SphereKind::Printed),
            Self::Hierarchical => LevelsKind::Spheres(SphereKind::Hierarchical),
        }
    }

    /// The structure of the levels: all but surfel structures are made from the octree.
    pub fn of(kind: LevelsKind) -> Self {
        let mut all = Self::ALL.iter().copied();
        all.find(|structure| structure.kind() == kind).unwrap_or(Self::Octree)
    }
}

const HEADING: &str = "Level of detail";

const LEVELS: Numbers = Numbers {
    retained: [0.0, morton::LEVELS as f32],
    offered: [0.0, morton::LEVELS as f32],
    typed: Typed::Whole,
    ..Numbers::USUAL
};

const STOPS: &[Kind] = &[
    Kind {
        flag: "spacing",
        help: "Subdivide the octree down to the point spacing: closed surfaces",
        title: "By spacing",
        hint: "Until voxels would be smaller than the spacing of the points in them: closed surfaces",
        label: "by spacing",
        also: &[],
        number: None,
    },
    Kind {
        flag: "delta",
        help: "Subdivide the octree until at most this fraction of the points shares leaves, such as 0.05",
        title: "By loss",
        hint: "Until few enough points share a voxel; all voxels have one size",
        label: "δ {}",
        also: &[],
        number: Some(KindNumber {
            value_name: "0..0.6",
            title: "Detail lost (δ)",
            hint: "Percentage of points that may share a voxel at the deepest level",
            // The value of the paper.
            usual: 0.05_f32 as f64,
            numbers: Numbers {
                retained: [0.0, 0.6],
                offered: [0.0, 0.6],
                typed: Typed::Retained("a number from 0 to 0.6, such as 0.05"),
                unit: Unit::Percent,
                decimals: 1,
                ..Numbers::USUAL
            },
        }),
    },
    Kind {
        flag: "depth",
        help: "Subdivide the octree down to this level",
        title: "To a level",
        hint: "Down to a level of the octree; all voxels have one size",
        label: "to level {}",
        also: &["octree depth"],
        number: Some(KindNumber {
            value_name: "0..21",
            title: "Leaf level",
            hint: "Level of all leaves; an edge of the octree's cube is 2 to the power of it voxels long",
            usual: 9.0,
            numbers: LEVELS,
        }),
    },
    Kind {
        flag: "octant-points",
        help: "Subdivide octree nodes that hold more than N points",
        title: "By points",
        hint: "While a cell holds more than N points; voxels have several sizes",
        label: "by {} points",
        also: &["leaf size"],
        number: Some(KindNumber {
            value_name: "N",
            title: "Points per leaf",
            hint: "Maximum points in a leaf of the octree",
            usual: 8.0,
            numbers: Numbers {
                retained: [1.0, u32::MAX as f32],
                offered: [1.0, 10_000.0],
                typed: Typed::WholePositive,
                is_logarithmic: true,
                ..Numbers::USUAL
            },
        }),
    },
];

impl Setting for StopCriterion {
    type Decided = Self;

    fn decided(&self) -> Self {
        *self
    }

    fn value(&self) -> Value {
        match *self {
            Self::Spacing => Value::Kind(0, 0.0),
            Self::Loss(delta) => Value::Kind(1, f64::from(delta)),
            Self::Depth(depth) => Value::Kind(2, f64::from(depth)),
            Self::PointsPerOctant(points) => Value::Kind(3, f64::from(points)),
        }
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Kind(0, _) => Some(Self::Spacing),
            Value::Kind(1, delta) => Some(Self::Loss(delta as f32)),
            Value::Kind(2, depth) => Some(Self::Depth(depth as u32)),
            Value::Kind(3, points) => Some(Self::PointsPerOctant(points as u32)),
            _ => None,
        }
    }
}

const LODS: &[Kind] = &[
    Kind {
        flag: "lod",
        help: "Merge octree nodes smaller than this on the screen",
        title: "Pixel threshold",
        hint: "Cells that are small on the screen are drawn as one voxel or surfel",
        label: "τ {}",
        also: &["pixel error", "screen-space error", "quality"],
        number: Some(KindNumber {
            value_name: "PX",
            title: "Smallest cell (τ)",
            hint: "Octants whose edge is shorter than this on the screen are drawn as one voxel, pixels",
            usual: 1.0,
            numbers: Numbers {
                retained: [0.0, 4096.0],
                offered: [0.5, 64.0],
                typed: Typed::NotNegative,
                unit: Unit::Is(" px"),
                decimals: 1,
                is_logarithmic: true,
                ..Numbers::USUAL
            },
        }),
    },
    Kind {
        flag: "lod-level",
        help: "Draw all octree nodes of this level",
        title: "Fixed level",
        hint: "All cells of one level",
        label: "level {}",
        also: &[],
        number: Some(KindNumber {
            value_name: "0..21",
            title: "Level",
            hint: "Level of the octree whose cells are drawn; 0 is the cube around the cloud",
            usual: 7.0,
            numbers: LEVELS,
        }),
    },
    Kind {
        flag: "lod-budget",
        help: "Draw at most N octree nodes, the finest possible",
        title: "Budget",
        hint: "The finest image of at most N voxels or surfels",
        label: "at most {}",
        also: &["point budget", "maximum points", "limit points"],
        number: Some(KindNumber {
            value_name: "N",
            title: "Voxels",
            hint: "Maximum voxels per image",
            usual: 50_000.0,
            numbers: Numbers {
                retained: [100.0, 50_000_000.0],
                offered: [1_000.0, 10_000_000.0],
                typed: Typed::WholePositive,
                is_logarithmic: true,
                ..Numbers::USUAL
            },
        }),
    },
    Kind {
        flag: "lod-time",
        help: "Draw the number of octree nodes that fits this frame time",
        title: "Frame time",
        hint: "The most voxels or surfels that this machine draws in the requested time",
        label: "in {} ms",
        also: &["frame budget", "target frame rate"],
        number: Some(KindNumber {
            value_name: "MS",
            title: "Time",
            hint: "Target time per image, milliseconds",
            usual: 16.0,
            numbers: Numbers {
                retained: [1.0, 1000.0],
                offered: [2.0, 200.0],
                unit: Unit::Is(" ms"),
                decimals: 0,
                is_logarithmic: true,
                ..Numbers::USUAL
            },
        }),
    },
];

impl Setting for Lod {
    type Decided = Self;

    fn decided(&self) -> Self {
        *self
    }

    fn value(&self) -> Value {
        match *self {
            Self::ThresholdPx(lod_px) => Value::Kind(0, f64::from(lod_px)),
            Self::Level(level) => Value::Kind(1, f64::from(level)),
            Self::Budget(max) => Value::Kind(2, f64::from(max)),
            Self::FrameTimeMs(time_ms) => Value::Kind(3, f64::from(time_ms)),
        }
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Kind(0, lod_px) => Some(Self::ThresholdPx(lod_px as f32)),
            Value::Kind(1, level) => Some(Self::Level(level as u32)),
            Value::Kind(2, max) => Some(Self::Budget(max as u32)),
            Value::Kind(3, time_ms) => Some(Self::FrameTimeMs(time_ms as f32)),
            _ => None,
        }
    }
}

const METRICS: &Words = &Words {
    what: "LOD metric",
    list: &[
        Word {
            word: "edge",
            title: "Edge",
            hint: "The edge of the cell, or of the cube that the sphere is around",
            also: &[],
        },
        Word {
            word: "area",
            title: "Area",
            hint: "The area of the disk, against the threshold squared; smaller where it is seen from the side (paper \
                   002)",
            also: &[],
        },
    ],
};

impl Setting for LodMetric {
    type Decided = Self;

    fn decided(&self) -> Self {
        *self
    }

    fn value(&self) -> Value {
        Value::Word(*self as usize)
    }

    fn from_value(value: Value) -> Option<Self> {
        match value {
            Value::Word(0) => Some(Self::Edge),
            Value::Word(1) => Some(Self::Area),
            _ => None,
        }
    }
}

group! {
    /// Level-of-detail settings: the octree depth, and the selection of its cells that are drawn.
    LevelStyle {
        /// Surfels stand for cells of the octree, as [`LevelStyle::lod`] says, where they are small; else all points
        /// are drawn.
        surfel_lod: bool = false, "surfel_lod" SURFEL_LOD {
            flag: "surfel-lod",
            help: "Draw surfels and adaptive points by level of detail, as chosen by the --lod… options",
            heading: HEADING,
            title: "Surfel detail",
            hint: "One surfel for all points of an octree's cell that is small on the screen: fewer are drawn from \
                   afar",
            section: Section::Surfels,
            when: |drawn| drawn.has_surfel_radii(),
            also: &["lod", "simplify", "level of detail"],
            values: Values::Switch("Simplify far surfels"),
        }
        /// Level-of-detail structure: the source of surfels that stand for others.
        structure: LevelStructure = LevelStructure::Octree, "level_structure" STRUCTURE {
            flag: "lod-structure",
            other_flags: &["levels"],
            value_name: "STRUCTURE",
            help: "Data structure of --surfel-lod",
            heading: HEADING,
            title: "Structure",
            hint: "Source of the levels of detail",
            section: Section::Surfels,
            when: |drawn| drawn.has_surfel_levels(),
            label: Label::Unusual(Place::HowFine, "of {}"),
            full_name: "Level-of-detail structure",
            also: &["lod", "octree", "point tree"],
            values: Values::Words(LevelStructure::WORDS),
        }
        /// Stop criterion of the octree depth: as far as voxels are closed, or as specified.
        stop: StopCriterion = StopCriterion::default(), "stop" STOP {
            heading: HEADING,
            title: "Divide",
            hint: "Stop criterion of the octree",
            section: Section::Octree,
            when: |style| style.draws_cells() || style.draws_codes(),
            label: Label::If(|drawn| drawn.draws_voxels(), Place::What, "{}"),
            full_name: "Octree: divide",
            also: &["octree depth", "leaf"],
            values: Values::Kinds(STOPS),
        }
        /// Level of detail: selection of the octree cells that are drawn.
        lod: Lod = Lod::default(), "lod" LOD {
            heading: HEADING,
            title: "Level of detail",
            hint: "Selection of the octree's cells to draw",
            section: Section::LevelOfDetail,
            when: |style| style.draws_cells() || style.draws_codes(),
            label: Label::Always(Place::HowFine, "{}"),
            also: &["lod", "point budget", "detail", "decimate", "performance"],
            values: Values::Kinds(LODS),
        }
        /// Level-of-detail metric that is compared with the threshold in pixels.
        metric: LodMetric = LodMetric::Edge, "lod_metric" METRIC {
            flag: "lod-metric",
            value_name: "METRIC",
            help: "Screen-space size to compare with --lod",
            heading: HEADING,
            title: "Metric",
            hint: "Screen-space size of a cell or a sphere that is compared with the threshold",
            section: Section::LevelOfDetail,
            when: |style| style.draws_cells() || style.draws_codes(),
            label: Label::Unusual(Place::HowFine, "by {}"),
            full_name: "Level-of-detail metric",
            also: &["lod", "screen-space error"],
            values: Values::Words(METRICS),
        }
    }
}
