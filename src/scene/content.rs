//! Drawable content of an image, one variant for each render mode.

use super::Clip;
use crate::cloud::{MeshRecords, PointRecord, ShapeRecord, VoxelRecord};
use crate::levels::octree::CodedCloud;
use crate::levels::{NodeRecords, RecordBuffers, Records, Selection};
use crate::scene::clip::at;
use crate::scene::visible::visible_points::VisiblePoints;
use std::sync::Arc;

/// The records of a packet. Equal if they are the same allocations: neither compared nor uploaded again.
#[derive(Debug, Clone, Default)]
pub enum Content {
    /// The frame lacks data that the primitive needs: only the background is drawn.
    #[default]
    Nothing,
    /// Points with only positions and colours.
    Points(Arc<Vec<PointRecord>>),
    /// Points with radii and normals: oriented disks, or points where the primitive is the point.
    Surfels(Surfels),
    /// Oriented disks selected from all nodes of levels of detail, for GPUs, which hold them all.
    Selected(Selected),
    /// Oriented disks of the points that are visible in an image, for GPUs, which find them and their normals.
    Visible(Arc<VisiblePoints>),
    /// Cubes.
    Voxels(Voxels),
    /// Triangles, and points between them.
    Mesh(Arc<MeshRecords>),
    /// Surfels as byte code.
    Coded(CodedCells),
}

/// Oriented disks: the same number of records of both kinds.
#[derive(Debug, Clone)]
pub struct Surfels {
    /// Positions and colours.
    pub points: Arc<Vec<PointRecord>>,
    /// Normals and radii.
    pub shapes: Arc<Vec<ShapeRecord>>,
}

/// Disks of some nodes.
#[derive(Debug, Clone)]
pub struct Selected {
    /// Records of all nodes.
    pub nodes: NodeRecords,
    /// Selection of the records that are drawn.
    pub selection: Arc<Selection>,
}

impl Selected {
    /// The drawn surfels, contiguously.
    pub fn gathered(&self) -> Surfels {
        let (points, shapes) = self.selection.gathered(&self.nodes, Vec::new(), Vec::new());
        Surfels {
            points: Arc::new(points),
            shapes: Arc::new(shapes),
        }
    }
}

/// Cells of an octree.
#[derive(Debug, Clone)]
pub struct Voxels {
    /// One record a drawn cell.
    pub records: Arc<Vec<VoxelRecord>>,
    /// Records used for their normals only, one per cell, where these are lit and not the faces.
    pub normals: Option<Arc<Vec<ShapeRecord>>>,
    /// Edge of the octree's cube; a cell of level h has this edge / 2^h.
    pub cube_edge: f32,
}

/// Surfels as the byte code of an octree, and how finely they are drawn.
#[derive(Debug, Clone)]
pub struct CodedCells {
    /// The code.
    pub cloud: Arc<CodedCloud>,
    /// Cells whose edge projects below this many pixels are not divided.
    pub lod_px: f32,
    /// Cells of this level are not divided: the codes and attributes of the levels down to it are a coarser cloud.
    pub deepest_level: u32,
}

impl Content {
    /// Surfels left to the renderer: a selection from all nodes, or those of visible points.
    pub fn gathered(&self) -> Option<Surfels> {
        match self {
            Self::Selected(selected) => Some(selected.gathered()),
            Self::Visible(visible) => {
                let surfels = visible.surfels();
                Some(Surfels {
                    points: Arc::clone(&surfels.points),
                    shapes: Arc::clone(&surfels.shapes),
                })
            }
            _ => None,
        }
    }

    /// Positions and colours of points or surfels; where some nodes or visible points are drawn, of all.
    pub fn points(&self) -> Option<&Arc<Vec<PointRecord>>> {
        match self {
            Self::Points(points) | Self::Surfels(Surfels { points, .. }) => Some(points),
            Self::Selected(Selected { nodes, .. }) => Some(&nodes.points),
            Self::Visible(visible) => Some(&visible.points),
            Self::Nothing | Self::Voxels(_) | Self::Mesh(_) | Self::Coded(_) => None,
        }
    }

    /// Normals and radii of surfels; where some nodes are drawn, of all.
    pub fn shapes(&self) -> Option<&Arc<Vec<ShapeRecord>>> {
        match self {
            Self::Surfels(surfels) => Some(&surfels.shapes),
            Self::Selected(Selected { nodes, .. }) => Some(&nodes.shapes),
            _ => None,
        }
    }

    /// Returns true if the drawn records have normals and radii, including those that the renderer computes.
    pub fn has_shapes(&self) -> bool {
        self.shapes().is_some() || matches!(self, Self::Visible(_) | Self::Coded(_))
    }

    /// Cells of an octree.
    pub fn voxels(&self) -> Option<&Voxels> {
        match self {
            Self::Voxels(voxels) => Some(voxels),
            _ => None,
        }
    }

    /// Triangles.
    pub fn mesh(&self) -> Option<&Arc<MeshRecords>> {
        match self {
            Self::Mesh(mesh) => Some(mesh),
            _ => None,
        }
    }

    /// Byte code.
    pub fn coded(&self) -> Option<&CodedCells> {
        match self {
            Self::Coded(coded) => Some(coded),
            _ => None,
        }
    }

    /// Number of records; of byte codes the nodes of the deepest level that may be drawn, of points drawn where
    /// visible, the number of all.
    pub fn record_count(&self) -> usize {
        match self {
            Self::Nothing => 0,
            Self::Points(points) | Self::Surfels(Surfels { points, .. }) => points.len(),
            Self::Selected(selected) => selected.selection.len(),
            Self::Visible(visible) => visible.points.len(),
            Self::Voxels(voxels) => voxels.records.len(),
            Self::Mesh(mesh) => mesh.triangles.len(),
            Self::Coded(coded) => coded.deepest_nodes(),
        }
    }

    /// Returns the content that `clip` keeps, by the centres of records; the same allocations if that is all. A code
    /// cannot be cut and stays whole.
    #[must_use]
    pub fn clipped(&self, clip: &Clip) -> Self {
        match self {
            Self::Nothing | Self::Coded(_) => self.clone(),
            Self::Points(points) => {
                let retained = clip.retained(points);
                if retained.len() == points.len() {
                    return self.clone();
                }
                Self::Points(Arc::new(at(points, &retained)))
            }
            Self::Surfels(Surfels { points, shapes }) => {
                let retained = clip.retained(points);
                if retained.len() == points.len() {
                    return self.clone();
                }
                Self::Surfels(Surfels {
                    points: Arc::new(at(points, &retained)),
                    shapes: Arc::new(at(shapes, &retained)),
                })
            }
            Self::Selected(_) | Self::Visible(_) => {
                let gathered = self.gathered().map(Self::Surfels);
                gathered.map_or_else(|| self.clone(), |surfels| surfels.clipped(clip))
            }
            Self::Voxels(voxels) => {
                let retained = clip.retained(&voxels.records);
                if retained.len() == voxels.records.len() {
                    return self.clone();
                }
                let normals = voxels.normals.as_ref();
                Self::Voxels(Voxels {
                    records: Arc::new(at(&voxels.records, &retained)),
                    normals: normals.map(|normals| Arc::new(at(normals, &retained))),
                    cube_edge: voxels.cube_edge,
                })
            }
            Self::Mesh(mesh) => {
                let retained = clip.retained_places(mesh.triangles.len(), |triangle| mesh.center(triangle));
                if retained.len() == mesh.triangles.len() {
                    return self.clone();
                }
                Self::Mesh(Arc::new(mesh.with_triangles(at(&mesh.triangles, &retained))))
            }
        }
    }

    /// The memory that is not shared.
    pub(super) fn into_buffers(self) -> RecordBuffers {
        fn memory<T>(records: Arc<Vec<T>>) -> Vec<T> {
            Arc::try_unwrap(records).unwrap_or_default()
        }
        match self {
            Self::Surfels(Surfels { points, shapes }) => RecordBuffers {
                points: memory(points),
                shapes: memory(shapes),
                ..RecordBuffers::default()
            },
            Self::Selected(selected) => match Arc::try_unwrap(selected.selection) {
                Ok(Selection::At(places)) => RecordBuffers {
                    places,
                    ..RecordBuffers::default()
                },
                Ok(Selection::Every { .. } | Selection::Filtered(_)) | Err(_) => RecordBuffers::default(),
            },
            Self::Voxels(voxels) => RecordBuffers {
                voxels: memory(voxels.records),
                shapes: voxels.normals.map(memory).unwrap_or_default(),
                ..RecordBuffers::default()
            },
            Self::Nothing | Self::Points(_) | Self::Visible(_) | Self::Mesh(_) | Self::Coded(_) => {
                RecordBuffers::default()
            }
        }
    }
}

impl From<Records> for Content {
    fn from(records: Records) -> Self {
        match records {
            Records::Surfels { points, shapes } => Self::Surfels(Surfels {
                points: Arc::new(points),
                shapes: Arc::new(shapes),
            }),
            Records::Selected { nodes, selection } => Self::Selected(Selected {
                nodes,
                selection: Arc::new(selection),
            }),
            Records::Voxels {
                voxels,
                normals,
                cube_edge,
            } => Self::Voxels(Voxels {
                records: Arc::new(voxels),
                normals: normals.map(Arc::new),
                cube_edge,
            }),
        }
    }
}

/// Every variant is named on the left: the compiler asks for a new one.
impl PartialEq for Content {
    fn eq(&self, other: &Self) -> bool {
        match self {
            Self::Nothing => matches!(other, Self::Nothing),
            Self::Points(a) => matches!(other, Self::Points(b) if Arc::ptr_eq(a, b)),
            Self::Surfels(a) => matches!(other, Self::Surfels(b) if a == b),
            Self::Selected(a) => matches!(other, Self::Selected(b) if a == b),
            Self::Visible(a) => matches!(other, Self::Visible(b) if Arc::ptr_eq(a, b)),
            Self::Voxels(a) => matches!(other, Self::Voxels(b) if a == b),
            Self::Mesh(a) => matches!(other, Self::Mesh(b) if Arc::ptr_eq(a, b)),
            Self::Coded(a) => matches!(other, Self::Coded(b) if a == b),
        }
    }
}

impl PartialEq for Surfels {
    fn eq(&self, other: &Self) -> bool {
        let Self { points, shapes } = self;
        Arc::ptr_eq(points, &other.points) && Arc::ptr_eq(shapes, &other.shapes)
    }
}

impl PartialEq for Selected {
    fn eq(&self, other: &Self) -> bool {
        let Self { nodes, selection } = self;
        Arc::ptr_eq(&nodes.points, &other.nodes.points)
            && Arc::ptr_eq(&nodes.shapes, &other.nodes.shapes)
            && Arc::ptr_eq(selection, &other.selection)
    }
}

impl PartialEq for Voxels {
    fn eq(&self, other: &Self) -> bool {
        let Self {
            records,
            normals,
            cube_edge,
        } = self;
        Arc::ptr_eq(records, &other.records)
            && normals.as_ref().map(Arc::as_ptr) == other.normals.as_ref().map(Arc::as_ptr)
            && *cube_edge == other.cube_edge
    }
}

impl PartialEq for CodedCells {
    fn eq(&self, other: &Self) -> bool {
        let Self {
            cloud,
            lod_px,
            deepest_level,
        } = self;
        Arc::ptr_eq(cloud, &other.cloud) && *lod_px == other.lod_px && *deepest_level == other.deepest_level
    }
}

impl CodedCells {
    /// The nodes of the deepest level that may be drawn: no view shows more.
    pub fn deepest_nodes(&self) -> usize {
        let level = self.deepest_level.min(self.cloud.depth());
        self.cloud.level(level).len()
    }
}

#[cfg(test)]
#[path = "content_tests.rs"]
mod tests;
