//! The levels of detail that a frame has: an octree, and one structure that is made from it or from the points.

use super::key::{LevelsKey, LevelsKind};
use super::list::PointList;
use super::octree::{CodedCloud, LodSurfels, Octree, StopCriterion, VoxelLevels};
use super::spheres::SphereLevels;
use super::structure::Levels;
use crate::cloud::{Frame, PointRecord, ShapeRecord};
use std::borrow::Cow;
use std::sync::Arc;

/// Source data of levels: the records of a cloud in the order of its frame, one per point.
#[derive(Debug, Clone, Copy)]
pub struct CloudRecords<'a> {
    /// The frame, whose positions are those of `points`.
    pub frame: &'a Frame,
    /// The colours of `points`, where they exist as an array.
    pub colors: Option<&'a [[u8; 4]]>,
    /// Positions and colours.
    pub points: &'a Arc<Vec<PointRecord>>,
    /// Normals and radii, if they are known.
    pub shapes: Option<&'a Arc<Vec<ShapeRecord>>>,
}

/// Work done to complete levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LevelsWork {
    /// Octrees, also those that share the points of another.
    pub octrees: u32,
    /// Byte codes.
    pub codes: u32,
    /// Trees of spheres.
    pub spheres: u32,
}

/// The levels of one cloud. Clones share them.
#[derive(Debug, Clone, Default)]
pub struct LevelsSet {
    octree: Option<(StopCriterion, Arc<Octree>)>,
    made: Option<ShapeLevels>,
}

/// Levels built from shapes.
#[derive(Debug, Clone)]
enum ShapeLevels {
    List(Arc<PointList>),
    Spheres(Arc<SphereLevels>),
    LitCubes(Arc<VoxelLevels>),
    Surfels(Arc<LodSurfels>),
    Codes(Arc<CodedCloud>),
}

impl LevelsSet {
    /// The octree, if anything built from one was requested.
    pub fn octree(&self) -> Option<&Arc<Octree>> {
        self.octree.as_ref().map(|(_, octree)| octree)
    }

    /// Returns the stop criterion that the octree was built for.
    pub fn stop(&self) -> Option<StopCriterion> {
        self.octree.as_ref().map(|&(stop, _)| stop)
    }

    /// The surfels of the octree's nodes.
    pub fn surfels(&self) -> Option<&Arc<LodSurfels>> {
        match &self.made {
            Some(ShapeLevels::Surfels(surfels)) => Some(surfels),
            Some(ShapeLevels::LitCubes(cubes)) => Some(&cubes.surfels),
            _ => None,
        }
    }

    /// The byte code.
    pub fn codes(&self) -> Option<&Arc<CodedCloud>> {
        match &self.made {
            Some(ShapeLevels::Codes(codes)) => Some(codes),
            _ => None,
        }
    }

    /// Returns the levels that are cut for images of this kind; `None` if they do not exist, and for codes, which
    /// renderers cut themselves. Cubes whose normals are not known yet are lit on their faces.
    pub fn get(&self, kind: LevelsKind) -> Option<Arc<dyn Levels>> {
        match (kind, &self.made) {
            (LevelsKind::List, Some(ShapeLevels::List(list))) => Some(Arc::clone(list) as _),
            (LevelsKind::Spheres(kind), Some(ShapeLevels::Spheres(spheres))) if spheres.kind() == kind => {
                Some(Arc::clone(spheres) as _)
            }
            (LevelsKind::LitCubes, Some(ShapeLevels::LitCubes(cubes))) => Some(Arc::clone(cubes) as _),
            (LevelsKind::Surfels, Some(ShapeLevels::Surfels(surfels))) => Some(Arc::clone(surfels) as _),
            (LevelsKind::Cubes | LevelsKind::LitCubes, _) => Some(Arc::clone(self.octree()?) as _),
            _ => None,
        }
    }

    /// Returns the levels that surfels are taken from, if any, and their kind.
    pub fn of_surfels(&self) -> Option<(LevelsKind, Arc<dyn Levels>)> {
        let kind = self.kind()?;
        let is_of_surfels = matches!(kind, LevelsKind::List | LevelsKind::Spheres(_) | LevelsKind::Surfels);
        Some((kind, self.get(kind).filter(|_| is_of_surfels)?))
    }

    /// Returns true if the requested levels exist. Without shapes that is the octree alone.
    pub fn has(&self, key: LevelsKey, has_shapes: bool) -> bool {
        (!key.kind.needs_octree() || self.stop() == Some(key.stop))
            && (!has_shapes || !key.kind.needs_shapes() || self.kind() == Some(key.kind))
    }

    fn kind(&self) -> Option<LevelsKind> {
        match &self.made {
            Some(ShapeLevels::List(_)) => Some(LevelsKind::List),
            Some(ShapeLevels::Spheres(spheres)) => Some(LevelsKind::Spheres(spheres.kind())),
            Some(ShapeLevels::LitCubes(_)) => Some(LevelsKind::LitCubes),
            Some(ShapeLevels::Surfels(_)) => Some(LevelsKind::Surfels),
            Some(ShapeLevels::Codes(_)) => Some(LevelsKind::Codes),
            None => self.octree().map(|_| LevelsKind::Cubes),
        }
    }

    /// These levels with the requested structure, and the data built for it. The octree stays, as others are made from
    /// it; data derived from it is dropped when it is no longer requested.
    ///
    /// Precondition: the existing levels were built from `cloud`.
    #[must_use]
    pub fn completed(&self, key: Option<LevelsKey>, cloud: &CloudRecords<'_>) -> (Self, LevelsWork) {
        let mut work = LevelsWork::default();
        let mut levels = Self {
            octree: self.octree.clone(),
            made: None,
        };
        let Some(LevelsKey { kind, stop }) = key else {
            return (levels, work);
        };
        if kind.needs_octree() && self.stop() != Some(stop) {
            work.octrees = 1;
            let octree = match self.octree() {
                Some(octree) => octree.with_stop(cloud.in_its_cube(stop)),
                None => cloud.octree(stop),
            };
            levels.octree = Some((stop, Arc::new(octree)));
        }
        let shapes = cloud.shapes.filter(|_| kind.needs_shapes());
        levels.made = shapes.and_then(|shapes| {
            let known = self.made.as_ref();
            let octree = levels.octree();
            let known = known.filter(|known| self.kind() == Some(kind) && known.is_of(octree, cloud.points, shapes));
            known.cloned().or_else(|| {
                work.codes = u32::from(kind == LevelsKind::Codes);
                work.spheres = u32::from(matches!(kind, LevelsKind::Spheres(_)));
                ShapeLevels::of(kind, octree, cloud, shapes)
            })
        });
        (levels, work)
    }

    /// Rebuilds the same kinds of levels from other records.
    #[must_use]
    pub fn made_of(&self, cloud: &CloudRecords<'_>) -> Self {
        let key = self.kind().map(|kind| LevelsKey {
            kind,
            stop: self.stop().unwrap_or_default(),
        });
        Self::default().completed(key, cloud).0
    }

    /// Maximum size in bytes.
    pub fn byte_size(&self) -> usize {
        let octree = self.octree().map_or(0, |octree| octree.byte_size());
        let surfels = self.surfels().map_or(0, |surfels| surfels.max_bytes());
        let of_made = match &self.made {
            Some(ShapeLevels::Spheres(spheres)) => spheres.max_bytes(),
            Some(ShapeLevels::Surfels(surfels)) => surfels.max_selectable_bytes(),
            _ => 0,
        };
        octree + surfels + of_made + self.codes().map_or(0, |codes| codes.byte_size())
    }
}

impl ShapeLevels {
    /// Levels of a kind; `None` for those not built from shapes. Precondition: the octree, if the kind needs one.
    fn of(
        kind: LevelsKind,
        octree: Option<&Arc<Octree>>,
        cloud: &CloudRecords<'_>,
        shapes: &Arc<Vec<ShapeRecord>>,
    ) -> Option<Self> {
        let records = || (Arc::clone(cloud.points), Arc::clone(shapes));
        let surfels = || {
            let (points, shapes) = records();
            Some(Arc::new(LodSurfels::new(Arc::clone(octree?), points, shapes)))
        };
        Some(match kind {
            LevelsKind::Cubes => return None,
            LevelsKind::List => {
                let (points, shapes) = records();
                Self::List(Arc::new(PointList::new(points, shapes)))
            }
            LevelsKind::Spheres(kind) => {
                let (points, shapes) = records();
                Self::Spheres(Arc::new(SphereLevels::build(kind, cloud.frame.cube(), points, shapes)))
            }
            LevelsKind::LitCubes => {
                let surfels = surfels()?;
                Self::LitCubes(Arc::new(VoxelLevels { surfels }))
            }
            LevelsKind::Surfels => Self::Surfels(surfels()?),
            LevelsKind::Codes => Self::Codes(Arc::new(CodedCloud::new(octree?, cloud.points, shapes))),
        })
    }

    /// Returns true if they were built from these.
    fn is_of(
        &self,
        octree: Option<&Arc<Octree>>,
        points: &Arc<Vec<PointRecord>>,
        shapes: &Arc<Vec<ShapeRecord>>,
    ) -> bool {
        let of_octree = |is_of: &dyn Fn(&Arc<Octree>) -> bool| octree.is_some_and(is_of);
        match self {
            Self::List(list) => list.is_of(points, shapes),
            Self::Spheres(spheres) => spheres.is_of(points, shapes),
            Self::LitCubes(cubes) => of_octree(&|tree| cubes.surfels.is_of(tree, points, shapes)),
            Self::Surfels(surfels) => of_octree(&|tree| surfels.is_of(tree, points, shapes)),
            Self::Codes(codes) => of_octree(&|tree| codes.is_of(tree, points, shapes)),
        }
    }
}

impl CloudRecords<'_> {
    fn octree(&self, stop: StopCriterion) -> Octree {
        let of_points = || self.points.iter().map(|point| point.color).collect();
        let colors = self.colors.map_or_else(|| Cow::Owned(of_points()), Cow::Borrowed);
        let (cube, positions) = (self.frame.cube(), self.frame.positions());
        Octree::build_in(cube, positions, &colors, self.in_its_cube(stop))
    }

    /// Returns a criterion for the cube of the frame: levels are counted from the cube of the sequence's first frame,
    /// so that one number means cells of one size in all frames.
    fn in_its_cube(&self, stop: StopCriterion) -> StopCriterion {
        match stop {
            StopCriterion::Depth(depth) => StopCriterion::Depth(self.frame.own_level(depth)),
            StopCriterion::Spacing | StopCriterion::Loss(_) | StopCriterion::PointsPerOctant(_) => stop,
        }
    }
}
