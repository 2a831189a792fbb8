//! The octree as levels of detail: its cells as cubes, its nodes as surfels.

use super::{LodSurfels, Octree};
use crate::cloud::VoxelRecord;
use crate::levels::cut::{Cut, CutHints, SelectStats, SelectView};
use crate::levels::selection::Selection;
use crate::levels::structure::{Levels, LevelsSize, RecordBuffers, Records};
use std::sync::Arc;

/// The cells of an octree as cubes whose light falls on normals.
#[derive(Debug, Clone)]
pub struct VoxelLevels {
    /// The surfels of the octree's nodes, which know their normals.
    pub surfels: Arc<LodSurfels>,
}

impl Octree {
    /// Replaces the contents of `out` by the voxels that represent the cloud in `view`: those of [`Levels::cut`],
    /// without those that close gaps.
    pub fn select(&self, view: &SelectView, out: &mut Vec<VoxelRecord>) -> SelectStats {
        let cut = self.cut(view, CutHints::default());
        self.write_voxels(&cut, out);
        cut.stats()
    }
}

/// Cubes whose light falls on their faces.
impl Levels for Octree {
    fn cut(&self, view: &SelectView, hints: CutHints<'_>) -> Cut {
        self.cut_between(view, hints.before, None)
    }

    fn write(&self, cut: &Cut, max_records: usize, buffers: RecordBuffers) -> Records {
        write_cubes(self, None, cut, max_records, buffers)
    }

    fn size(&self) -> LevelsSize {
        LevelsSize {
            nodes: self.node_count(),
            bytes: self.byte_size(),
        }
    }
}

impl Levels for VoxelLevels {
    fn cut(&self, view: &SelectView, hints: CutHints<'_>) -> Cut {
        // Without normal cones: voxels have no back, and culling theirs would make holes in open surfaces.
        self.surfels.octree().cut(view, hints)
    }

    fn write(&self, cut: &Cut, max_records: usize, buffers: RecordBuffers) -> Records {
        let surfels = Some(&*self.surfels);
        write_cubes(self.surfels.octree(), surfels, cut, max_records, buffers)
    }

    fn size(&self) -> LevelsSize {
        self.surfels.size()
    }
}

impl Levels for LodSurfels {
    fn cut(&self, view: &SelectView, hints: CutHints<'_>) -> Cut {
        // Otherwise surfels are culled individually, so the image is the same.
        let cones = hints.culls_back_faces.then_some(self);
        self.octree().cut_between(view, hints.before, cones)
    }

    fn write(&self, cut: &Cut, _max_records: usize, buffers: RecordBuffers) -> Records {
        let RecordBuffers {
            mut points, mut shapes, ..
        } = buffers;
        self.write_surfels(cut, &mut points, &mut shapes);
        Records::Surfels { points, shapes }
    }

    fn select(&self, cut: &Cut, buffers: &mut RecordBuffers) -> Option<Records> {
        let mut places = std::mem::take(&mut buffers.places);
        let nodes = self.select_surfels(cut, &mut places)?;
        Some(Records::Selected {
            nodes,
            selection: Selection::At(places),
        })
    }

    fn size(&self) -> LevelsSize {
        let octree = self.octree();
        LevelsSize {
            nodes: octree.node_count(),
            bytes: octree.byte_size() + self.max_bytes(),
        }
    }
}

fn write_cubes(
    octree: &Octree,
    surfels: Option<&LodSurfels>,
    cut: &Cut,
    max_records: usize,
    buffers: RecordBuffers,
) -> Records {
    let RecordBuffers {
        mut voxels, mut shapes, ..
    } = buffers;
    octree.write_voxels(cut, &mut voxels);
    let mut gaps = octree.gaps_of(cut);
    if voxels.len() + gaps.len() > max_records {
        gaps.clear();
    }
    octree.add_gap_voxels(&gaps, &mut voxels);
    let normals = surfels.map(|surfels| {
        surfels.write_voxel_normals(cut, &mut shapes);
        surfels.add_gap_normals(&gaps, &mut shapes);
        shapes
    });
    Records::Voxels {
        voxels,
        normals,
        cube_edge: octree.cube().edge,
    }
}
