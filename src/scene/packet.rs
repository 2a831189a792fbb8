//! From a prepared frame, a camera and settings to the one value that a renderer draws.
//!
//! [`Scene`] remembers the last traversal: as long as camera, viewport, octree and level of detail stay, the visible
//! set is the same allocation, so that nobody downstream uploads it again.

use super::clip::at;
use super::lod::{Affordable, Lod};
use super::{Camera, Clip, GroundPlane, Settings, ViewTransform};
use crate::cloud::{PointRecord, ShapeRecord, VoxelRecord};
use crate::levels::octree::{CodedCloud, Cut, CutHints, LodSurfels, Octree};
use crate::math::Aabb;
use crate::sequence::{Needs, PreparedFrame};
use glam::DVec3;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The visible set of one octree.
#[derive(Debug, Clone)]
pub struct Voxels {
    /// One record a drawn cell.
    pub records: Arc<Vec<VoxelRecord>>,
    /// Records of which only the normals count, one a cell, where light falls on them and not on faces.
    pub normals: Option<Arc<Vec<ShapeRecord>>>,
    /// Edge of the octree's cube; a cell of level h has this edge / 2^h.
    pub cube_edge: f32,
}

/// Surfels as the byte code of an octree, and how finely they are drawn.
#[derive(Debug, Clone)]
pub struct CodedCells {
    /// The code.
    pub cloud: Arc<CodedCloud>,
    /// Cells whose edge projects below so many pixels are not divided.
    pub lod_px: f32,
    /// Cells of this level are not divided: the codes and attributes of the levels down to it are a coarser cloud.
    pub deepest_level: u32,
}

impl PartialEq for CodedCells {
    /// Clouds are compared by identity.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.cloud, &other.cloud)
            && self.lod_px == other.lod_px
            && self.deepest_level == other.deepest_level
    }
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
    /// The same surfels as byte code, for renderers that draw from it as [`Settings::footprint`] says.
    pub coded: Option<CodedCells>,
    /// The box around the cloud, for the grey of [`super::Splatting::Visibility`].
    pub bounds: Aabb,
    /// The plane of [`Settings::grid`], if it is on.
    pub ground: Option<GroundPlane>,
}

impl ScenePacket {
    /// The view distances that [`super::Splatting::Visibility`] shows white and black: around the whole cloud.
    pub fn depth_range(&self) -> [f32; 2] {
        let middle = -self.view.to_view(self.bounds.center()).z;
        let radius = self.bounds.radius().max(f32::MIN_POSITIVE);
        [middle - radius, middle + radius]
    }

    /// The part of `part_px` of this picture whose upper left pixel is `start_px`, with the same records. Precondition:
    /// it lies within the picture, which is no part itself.
    #[must_use]
    pub fn part(&self, start_px: [u32; 2], part_px: [u32; 2]) -> Self {
        Self {
            viewport_px: part_px,
            view: self.view.of_part(self.viewport_px, start_px, part_px),
            ..self.clone()
        }
    }

    /// Whether two packets have the same records, however they draw them. Arrays are compared by identity, which costs
    /// nothing.
    pub fn has_same_records(&self, other: &Self) -> bool {
        let same_voxels = match (&self.voxels, &other.voxels) {
            (Some(a), Some(b)) => {
                Arc::ptr_eq(&a.records, &b.records)
                    && is_same(a.normals.as_ref(), b.normals.as_ref())
                    && a.cube_edge == b.cube_edge
            }
            (None, None) => true,
            _ => false,
        };
        same_voxels
            && is_same(self.shapes.as_ref(), other.shapes.as_ref())
            && self.coded == other.coded
            && Arc::ptr_eq(&self.points, &other.points)
    }
}

/// Whether both are nothing or one allocation.
fn is_same<T>(a: Option<&Arc<T>>, b: Option<&Arc<T>>) -> bool {
    a.map(Arc::as_ptr) == b.map(Arc::as_ptr)
}

impl PartialEq for ScenePacket {
    /// Equal packets make equal pictures.
    fn eq(&self, other: &Self) -> bool {
        self.has_same_records(other)
            && self.viewport_px == other.viewport_px
            && self.view == other.view
            && self.settings == other.settings
            && self.bounds == other.bounds
            && self.ground == other.ground
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
    clipped: Option<Clipped>,
    remembers: bool,
    affordable: Affordable,
    stats: SceneStats,
}

/// What was chosen for a picture, and from what.
#[derive(Debug)]
struct Selection {
    from: SelectedFrom,
    cut: Cut,
    drawn: Drawn,
}

/// All that a selection depends on.
#[derive(Debug, Clone)]
struct SelectedFrom {
    octree: Arc<Octree>,
    /// `None` for voxels.
    surfels: Option<Arc<LodSurfels>>,
    /// What knows the normals of voxels, where light falls on them.
    normals: Option<Arc<LodSurfels>>,
    cull_back_faces: bool,
    view: ViewTransform,
    viewport_px: [u32; 2],
    lod: Lod,
    affordable: Affordable,
    clip: Option<Clip>,
}

/// The points of a frame that are drawn where something is clipped, and from what.
#[derive(Debug)]
struct Clipped {
    clip: Clip,
    of: (Arc<Vec<PointRecord>>, Option<Arc<Vec<ShapeRecord>>>),
    points: Arc<Vec<PointRecord>>,
    shapes: Option<Arc<Vec<ShapeRecord>>>,
}

impl Clipped {
    fn is_of(&self, clip: &Clip, packet: &ScenePacket) -> bool {
        let (points, shapes) = &self.of;
        self.clip == *clip
            && Arc::ptr_eq(points, &packet.points)
            && shapes.as_ref().map(Arc::as_ptr) == packet.shapes.as_ref().map(Arc::as_ptr)
    }

    fn new(clip: Clip, packet: &ScenePacket) -> Self {
        let kept = clip.kept(&packet.points);
        let (mut points, mut shapes) = (Arc::clone(&packet.points), packet.shapes.clone());
        // What is drawn as a whole is the same allocation, and not uploaded again.
        if kept.len() < points.len() {
            points = Arc::new(at(&points, &kept));
            shapes = shapes.map(|shapes| Arc::new(at(&shapes, &kept)));
        }
        Self {
            clip,
            of: (Arc::clone(&packet.points), packet.shapes.clone()),
            points,
            shapes,
        }
    }
}

/// The records of a selection.
#[derive(Debug, Clone)]
enum Drawn {
    Voxels(Arc<Vec<VoxelRecord>>, Option<Arc<Vec<ShapeRecord>>>),
    Surfels(Arc<Vec<PointRecord>>, Arc<Vec<ShapeRecord>>),
}

impl SelectedFrom {
    /// Whether the nodes are those of the same points, chosen in the same way.
    fn same_nodes(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.octree, &other.octree)
            && is_same(self.surfels.as_ref(), other.surfels.as_ref())
            && self.cull_back_faces == other.cull_back_faces
            && self.lod == other.lod
    }
}

impl PartialEq for SelectedFrom {
    fn eq(&self, other: &Self) -> bool {
        self.same_nodes(other)
            && is_same(self.normals.as_ref(), other.normals.as_ref())
            && self.view == other.view
            && self.viewport_px == other.viewport_px
            && self.affordable == other.affordable
            && self.clip == other.clip
    }
}

impl Scene {
    /// A scene that remembers which cells it drew, so that levels of detail do not flicker when the camera moves a
    /// little. What it draws depends on what it drew before; that of [`Scene::default`] does not.
    pub fn that_remembers() -> Self {
        Self {
            remembers: true,
            ..Self::default()
        }
    }

    /// What a frame must have for a picture with these settings.
    pub fn needs(settings: &Settings) -> Needs {
        Needs {
            shapes: settings.draws_surfels() || settings.lights_voxels_by_normals(),
            ellipses: false,
            octree: (settings.draws_cells() || settings.draws_codes())
                .then_some(settings.octree_stop()),
            coded: settings.draws_codes(),
            colors: settings.colors,
            hints: settings.color_hints,
        }
    }

    /// The packet for `frame`, whose positions are relative to `origin`, to be shown in a picture of `viewport_px`;
    /// what is drawn may be smaller, see [`Settings::drawn_px`].
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
        let viewport_px = settings.drawn_px(viewport_px);
        let view = camera.transform(origin, viewport_px);
        let clip = settings.clip.filter(|clip| clip.is_on);
        let clip = clip.map(|clip| clip.relative_to(origin));
        let is_surfel = settings.draws_surfels();
        let octree = frame.octree.as_ref().filter(|_| settings.draws_cells());
        let surfels = frame.lod_surfels.as_ref().filter(|_| is_surfel);
        let normals = frame.lod_surfels.as_ref();
        let normals = normals.filter(|_| settings.lights_voxels_by_normals());
        let selected = octree.filter(|_| surfels.is_some() == is_surfel);
        let selected = selected.map(|octree| {
            self.select(SelectedFrom {
                octree: Arc::clone(octree),
                surfels: surfels.map(Arc::clone),
                normals: normals.map(Arc::clone),
                cull_back_faces: settings.culls_back_faces(),
                view,
                viewport_px,
                lod: settings.lod,
                affordable: self.affordable,
                clip,
            })
        });
        let mut packet = ScenePacket {
            viewport_px,
            view,
            settings: Settings { clip, ..*settings },
            points: Arc::clone(&frame.points),
            shapes: frame.shapes.clone().filter(|_| is_surfel),
            voxels: None,
            coded: self.coded(frame, settings).filter(|_| clip.is_none()),
            bounds: frame.frame.bounds(),
            ground: settings.grid.then(|| {
                GroundPlane::under(
                    &settings.ground_box.unwrap_or(frame.frame.bounds()),
                    origin,
                    camera.up,
                    settings.background,
                )
            }),
        };
        if let Some(coded) = &packet.coded
            && selected.is_none()
        {
            self.stats.emitted_voxels = coded
                .cloud
                .level(coded.deepest_level.min(coded.cloud.depth()))
                .len();
        }
        match (selected, octree) {
            (Some(Drawn::Voxels(records, normals)), Some(octree)) => {
                packet.voxels = Some(Voxels {
                    records,
                    normals,
                    cube_edge: octree.cube().edge,
                });
            }
            (Some(Drawn::Surfels(points, shapes)), _) => {
                packet.points = points;
                packet.shapes = Some(shapes);
            }
            _ => {
                if let Some(clip) = clip {
                    self.clip_points(clip, &mut packet);
                }
            }
        }
        packet
    }

    /// Leaves out points of a packet that has all of a frame.
    fn clip_points(&mut self, clip: Clip, packet: &mut ScenePacket) {
        let known = self.clipped.take();
        let known = known.filter(|known| known.is_of(&clip, packet));
        let clipped = known.unwrap_or_else(|| Clipped::new(clip, packet));
        packet.points = Arc::clone(&clipped.points);
        packet.shapes.clone_from(&clipped.shapes);
        self.clipped = Some(clipped);
    }

    /// The byte code of a frame, if it is to be drawn. What is not a threshold chooses a level: as the code is stored
    /// breadth-first, that is one of its prefixes.
    fn coded(&self, frame: &PreparedFrame, settings: &Settings) -> Option<CodedCells> {
        let cloud = frame.coded.as_ref().filter(|_| settings.draws_codes())?;
        let at_most = |nodes: u32| (0.0, cloud.deepest_level_of(nodes as usize));
        let (lod_px, deepest_level) = match settings.lod {
            Lod::ThresholdPx(lod_px) => (lod_px, cloud.depth()),
            Lod::Level(level) => (0.0, level),
            Lod::Budget(nodes) => at_most(nodes),
            Lod::FrameTimeMs(_) => at_most(self.affordable.voxels()),
        };
        let cloud = Arc::clone(cloud);
        Some(CodedCells {
            cloud,
            lod_px,
            deepest_level,
        })
    }

    /// Takes notice of how long the last picture took to draw, for [`Lod::FrameTimeMs`].
    pub fn note_draw_ms(&mut self, settings: &Settings, draw_ms: f64) {
        if let Lod::FrameTimeMs(asked_ms) = settings.lod
            && (settings.draws_cells() || settings.draws_codes())
        {
            let drawn = self.stats.emitted_voxels;
            self.affordable.learn(drawn, draw_ms, f64::from(asked_ms));
        }
    }

    /// Counters since the scene was made.
    pub fn stats(&self) -> SceneStats {
        self.stats
    }

    fn select(&mut self, from: SelectedFrom) -> Drawn {
        if let Some(last) = &self.selected
            && last.from == from
        {
            return last.drawn.clone();
        }
        let last = self.selected.take();
        let start = Instant::now();
        let before = last
            .as_ref()
            .filter(|last| self.remembers && last.from.same_nodes(&from));
        let hints = CutHints {
            back_faces: from.surfels.as_deref().filter(|_| from.cull_back_faces),
            before: before.map(|last| &last.cut),
        };
        let select_view = from.view.select_view(0.0);
        let affordable = from.affordable.voxels();
        let (cut, lod_px) = from.lod.cut(&from.octree, &select_view, hints, affordable);
        let drawn = draw(&from, &cut, last.map(|last| last.drawn));
        let traversed = cut.stats();
        self.stats = SceneStats {
            traversals: self.stats.traversals + 1,
            visited_nodes: traversed.visited_nodes,
            emitted_voxels: traversed.emitted,
            lod_px,
            traverse_time: start.elapsed(),
        };
        self.selected = Some(Selection {
            from,
            cut,
            drawn: drawn.clone(),
        });
        drawn
    }
}

/// Writes the records of a cut; to the memory of the last ones, unless a packet still holds them.
fn draw(from: &SelectedFrom, cut: &Cut, last: Option<Drawn>) -> Drawn {
    let (mut voxels, mut points, mut shapes) = Default::default();
    match last {
        Some(Drawn::Voxels(last, last_normals)) => {
            voxels = Arc::try_unwrap(last).unwrap_or_default();
            shapes = last_normals
                .and_then(|last| Arc::try_unwrap(last).ok())
                .unwrap_or_default();
        }
        Some(Drawn::Surfels(last_points, last_shapes)) => {
            points = Arc::try_unwrap(last_points).unwrap_or_default();
            shapes = Arc::try_unwrap(last_shapes).unwrap_or_default();
        }
        None => {}
    }
    if let Some(surfels) = &from.surfels {
        surfels.write(cut, &mut points, &mut shapes);
        if let Some(clip) = &from.clip {
            let kept = clip.kept(&points);
            (points, shapes) = (at(&points, &kept), at(&shapes, &kept));
        }
        Drawn::Surfels(Arc::new(points), Arc::new(shapes))
    } else {
        from.octree.write_voxels(cut, &mut voxels);
        let mut gaps = from.octree.gaps_of(cut);
        if let Lod::Budget(most) = from.lod
            && voxels.len() + gaps.len() > most as usize
        {
            gaps.clear();
        }
        from.octree.add_gap_voxels(&gaps, &mut voxels);
        if let Some(normals) = &from.normals {
            normals.write_voxel_normals(cut, &mut shapes);
            normals.add_gap_normals(&gaps, &mut shapes);
        }
        if let Some(clip) = &from.clip {
            let kept = clip.kept(&voxels);
            voxels = at(&voxels, &kept);
            if from.normals.is_some() {
                shapes = at(&shapes, &kept);
            }
        }
        let normals = from.normals.is_some().then(|| Arc::new(shapes));
        Drawn::Voxels(Arc::new(voxels), normals)
    }
}
