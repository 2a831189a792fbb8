//! From a prepared frame, a camera and settings to the one value that a renderer draws.
//!
//! [`Scene`] remembers the last traversal: as long as camera, viewport, octree and level of detail stay, the visible set
//! is the same allocation, so that nobody downstream uploads it again.

use super::lod::{Affordable, Lod};
use super::{Camera, Primitive, Settings, ViewTransform};
use crate::cloud::{PointRecord, ShapeRecord, VoxelRecord};
use crate::math::Aabb;
use crate::octree::Octree;
use crate::sequence::{Needs, PreparedFrame};
use glam::DVec3;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The visible set of one octree.
#[derive(Debug, Clone)]
pub struct Voxels {
    /// One record a drawn cell.
    pub records: Arc<Vec<VoxelRecord>>,
    /// Edge of the octree's cube; a cell of level h has this edge / 2^h.
    pub cube_edge: f32,
}

/// Everything a renderer needs for one picture.
#[derive(Debug, Clone)]
pub struct ScenePacket {
    /// Width and height, at least 1.
    pub viewport_px: [u32; 2],
    /// The camera.
    pub view: ViewTransform,
    /// How to draw.
    pub settings: Settings,
    /// The cloud; the renderer tells clouds apart by the allocation.
    pub points: Arc<Vec<PointRecord>>,
    /// Its surfels, when the primitive needs them.
    pub shapes: Option<Arc<Vec<ShapeRecord>>>,
    /// Its visible cells, when the primitive needs them.
    pub voxels: Option<Voxels>,
    /// The box around the cloud, for the grey of [`super::Splatting::Visibility`].
    pub bounds: Aabb,
}

impl PartialEq for ScenePacket {
    /// Equal packets make equal pictures. Arrays are compared by identity, which costs nothing.
    fn eq(&self, other: &Self) -> bool {
        let same_voxels = match (&self.voxels, &other.voxels) {
            (Some(a), Some(b)) => Arc::ptr_eq(&a.records, &b.records) && a.cube_edge == b.cube_edge,
            (None, None) => true,
            _ => false,
        };
        let same_shapes = match (&self.shapes, &other.shapes) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (None, None) => true,
            _ => false,
        };
        same_voxels
            && same_shapes
            && Arc::ptr_eq(&self.points, &other.points)
            && self.viewport_px == other.viewport_px
            && self.view == other.view
            && self.settings == other.settings
            && self.bounds == other.bounds
    }
}

/// What [`Scene`] did so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct SceneStats {
    /// Octree traversals.
    pub traversals: u64,
    /// Nodes visited by the last traversal.
    pub visited_nodes: usize,
    /// Cells emitted by the last traversal.
    pub emitted_voxels: usize,
    /// LOD threshold of the last traversal in pixels; `None` where a level was chosen.
    pub lod_px: Option<f32>,
    /// Time of the last traversal.
    #[serde(skip)]
    pub traverse_time: Duration,
}

/// Makes packets, and traverses the octree only when the answer can differ.
#[derive(Debug, Default)]
pub struct Scene {
    selected: Option<Selection>,
    affordable: Affordable,
    stats: SceneStats,
}

#[derive(Debug)]
struct Selection {
    octree: Arc<Octree>,
    view: ViewTransform,
    viewport_px: [u32; 2],
    lod: Lod,
    affordable: Affordable,
    records: Arc<Vec<VoxelRecord>>,
}

impl Scene {
    /// What a frame must have for a picture with these settings.
    pub fn needs(settings: &Settings) -> Needs {
        Needs {
            shapes: settings.primitive == Primitive::Surfel,
            ellipses: false,
            octree: (settings.primitive == Primitive::Voxel).then_some(settings.stop),
            colors: settings.colors,
        }
    }

    /// The packet for `frame`, whose positions are relative to `origin`.
    ///
    /// A frame that lacks what the primitive needs gives a packet that draws nothing of it; see [`Scene::needs`].
    pub fn packet(
        &mut self,
        frame: &PreparedFrame,
        origin: DVec3,
        camera: &Camera,
        settings: &Settings,
        viewport_px: [u32; 2],
    ) -> ScenePacket {
        let viewport_px = viewport_px.map(|edge| edge.max(1));
        let view = camera.transform(origin, viewport_px);
        let octree = frame
            .octree
            .as_ref()
            .filter(|_| settings.primitive == Primitive::Voxel);
        ScenePacket {
            viewport_px,
            view,
            settings: *settings,
            points: Arc::clone(&frame.points),
            shapes: frame
                .shapes
                .clone()
                .filter(|_| settings.primitive == Primitive::Surfel),
            voxels: octree.map(|octree| Voxels {
                records: self.select(octree, &view, viewport_px, settings.lod),
                cube_edge: octree.cube().edge,
            }),
            bounds: frame.frame.bounds(),
        }
    }

    /// Takes notice of how long the last picture took to draw, for [`Lod::FrameTimeMs`].
    pub fn note_draw_ms(&mut self, settings: &Settings, draw_ms: f64) {
        if let Lod::FrameTimeMs(asked_ms) = settings.lod
            && settings.primitive == Primitive::Voxel
        {
            let drawn = self.stats.emitted_voxels;
            self.affordable.learn(drawn, draw_ms, f64::from(asked_ms));
        }
    }

    /// Counters since the scene was made.
    pub fn stats(&self) -> SceneStats {
        self.stats
    }

    fn select(
        &mut self,
        octree: &Arc<Octree>,
        view: &ViewTransform,
        viewport_px: [u32; 2],
        lod: Lod,
    ) -> Arc<Vec<VoxelRecord>> {
        if let Some(last) = &self.selected
            && Arc::ptr_eq(&last.octree, octree)
            && last.view == *view
            && last.viewport_px == viewport_px
            && last.lod == lod
            && last.affordable == self.affordable
        {
            return Arc::clone(&last.records);
        }
        // The last set's memory is reused unless a packet still holds it.
        let mut records = self
            .selected
            .take()
            .and_then(|last| Arc::try_unwrap(last.records).ok())
            .unwrap_or_default();
        records.clear();
        let start = Instant::now();
        let select_view = view.select_view(0.0);
        let voxels = self.affordable.voxels();
        let (selected, lod_px) = lod.select(octree, &select_view, voxels, &mut records);
        self.stats = SceneStats {
            traversals: self.stats.traversals + 1,
            visited_nodes: selected.visited_nodes,
            emitted_voxels: selected.emitted,
            lod_px,
            traverse_time: start.elapsed(),
        };
        let records = Arc::new(records);
        self.selected = Some(Selection {
            octree: Arc::clone(octree),
            view: *view,
            viewport_px,
            lod,
            affordable: self.affordable,
            records: Arc::clone(&records),
        });
        records
    }
}
