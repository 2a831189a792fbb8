//! From a prepared frame, a camera and a style to the one value that a renderer draws.
//!
//! [`Scene`] remembers the last traversal: as long as camera, viewport, levels of detail and their policy stay, the
//! visible set is the same allocation, so that it is not uploaded again downstream.

use super::content::{CodedCells, Content, Surfels};
use super::first_look::{PointSpacing, typical_spacing};
use super::packet::{PacketParams, ScenePacket};
use super::{
    Camera, Clip, DrawSettings, GroundPlane, PhotosInFrame, PointSizing, Primitive, RendererChoice, Style,
    ViewTransform,
};
use crate::analysis::screen::ScreenCloud;
use crate::cloud::Frame;
use crate::levels::{
    Affordable, Cut, CutHints, Levels, LevelsKey, LevelsKind, Lod, LodMetric, RecordBuffers, SelectView,
};
use crate::rgbd::DepthFrame;
use crate::scene::remade::Remade;
use crate::scene::sorting::sorted;
use crate::scene::visible::screen_surfels::{ScreenInput, ScreenSurfels};
use crate::scene::visible::visible_points::{PointImages, ScreenStats};
use crate::sequence::{Needs, Paint, PreparedFrame};
use glam::DVec3;
use std::ptr;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Statistics of the work that [`Scene`] did so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct SceneStats {
    /// Traversals of levels of detail.
    pub traversals: u64,
    /// Nodes visited by the last traversal.
    pub visited_nodes: usize,
    /// Nodes emitted by the last traversal; where these are left to a test of each, those that are tested.
    pub emitted_voxels: usize,
    /// Duplicates among them, which represent points that another node represents as well.
    pub duplicates: usize,
    /// LOD threshold of the last traversal in pixels; `None` where a level was chosen.
    pub lod_px: Option<f32>,
    /// Time of the last traversal.
    #[serde(skip)]
    pub traverse_time: Duration,
}

/// Makes packets, and cuts levels of detail only when the answer can differ.
#[derive(Debug, Default)]
pub struct Scene {
    last_cut: Option<LastCut>,
    clipping: Remade<Clip>,
    /// The last frame whose points were measured, and how far apart they are.
    spacing: Option<(Arc<Frame>, PointSpacing)>,
    screen: ScreenSurfels,
    sorting: Remade<ViewTransform>,
    remembers: bool,
    affordable: Affordable,
    stats: SceneStats,
}

/// The last cut, its inputs, and its records.
#[derive(Debug)]
struct LastCut {
    from: CutInput,
    /// Level-of-detail cut; `None` where nodes are selected by a test of each.
    cut: Option<Cut>,
    content: Content,
}

/// All that a cut and its records depend on.
#[derive(Debug, Clone)]
struct CutInput {
    levels: Arc<dyn Levels>,
    culls_back_faces: bool,
    view: ViewTransform,
    viewport_px: [u32; 2],
    lod: Lod,
    metric: LodMetric,
    affordable: Affordable,
    clip: Option<Clip>,
    /// True if the renderer keeps the records of all nodes.
    may_select: bool,
}

impl CutInput {
    /// Returns true if the nodes belong to the same structure, selected with the same settings.
    fn has_same_nodes(&self, other: &Self) -> bool {
        ptr::addr_eq(Arc::as_ptr(&self.levels), Arc::as_ptr(&other.levels))
            && self.culls_back_faces == other.culls_back_faces
            && self.lod == other.lod
            && self.metric == other.metric
    }
}

impl CutInput {
    /// Returns the content where nodes are selected by a test of each, and the LOD threshold. Other policies count
    /// nodes.
    fn filtered(&self, view: &SelectView, hints: CutHints<'_>) -> Option<(Content, f32)> {
        let Lod::ThresholdPx(lod_px) = self.lod else {
            return None;
        };
        let view = SelectView { lod_px, ..*view };
        let records = self.may_select.then(|| self.levels.filter(&view, hints))??;
        Some((Content::from(records), lod_px))
    }
}

impl PartialEq for CutInput {
    fn eq(&self, other: &Self) -> bool {
        self.has_same_nodes(other)
            && self.view == other.view
            && self.viewport_px == other.viewport_px
            && self.affordable == other.affordable
            && self.clip == other.clip
            && self.may_select == other.may_select
    }
}

/// Inputs of a requested image.
struct Wanted<'a> {
    frame: &'a PreparedFrame,
    origin: DVec3,
    view: ViewTransform,
    viewport_px: [u32; 2],
    style: &'a Style,
    params: &'a PacketParams,
}

/// The level-of-detail choice for the cube of a frame: levels are counted from the cube of the sequence's first frame.
fn lod_of(style: &Style, frame: &PreparedFrame) -> Lod {
    match style.levels.lod {
        Lod::Level(level) if style.levels_kind().is_some_and(LevelsKind::needs_octree) => {
            Lod::Level(frame.frame.own_level(level))
        }
        lod => lod,
    }
}

/// The disks of the points of a frame, if it has shapes.
fn of_points(frame: &PreparedFrame) -> Option<Surfels> {
    Some(Surfels {
        points: Arc::clone(&frame.points),
        shapes: Arc::clone(frame.shapes.as_ref()?),
    })
}

/// Returns the curved splats for view-dependent texturing, if there are input images and these disks differ.
fn curved(frame: &PreparedFrame) -> Option<Surfels> {
    let posed_images = frame.posed_images.as_ref()?;
    let curved = frame.curved.as_ref().filter(|_| !posed_images.all().is_empty())?;
    Some(Surfels {
        points: Arc::clone(&curved.points),
        shapes: Arc::clone(&curved.shapes),
    })
}

impl Scene {
    /// A scene that remembers which cells it drew, so that levels of detail do not flicker when the camera moves a
    /// little. Its output depends on earlier drawing; that of [`Scene::default`] does not.
    pub fn that_remembers() -> Self {
        Self {
            remembers: true,
            ..Self::default()
        }
    }

    /// Returns the data that a frame must have for an image with these settings.
    pub fn needs(style: &Style) -> Needs {
        // To show the errors of screen-space normals, other normals serve as the reference.
        let is_of_screen = style.has_screen_normals() && !style.shows_normal_errors();
        Needs {
            shapes: style.draws_surfels() && !is_of_screen
                || style.lights_voxels_by_normals()
                || style.has_points_with_shapes(),
            ellipses: style.primitive == Primitive::Ellipse,
            mesh: style.primitive == Primitive::Mesh,
            levels: style.levels_kind().map(|kind| LevelsKey {
                kind,
                stop: style.octree_stop(),
            }),
            colors: style.colors,
            surface: style.estimation.surface(),
            smoothing: style.estimation.smoothing,
            hints: style.of_sequence.color_hints,
        }
    }

    /// The packet for `frame`, whose positions are relative to `origin`, to be shown in an image of `viewport_px`; the
    /// drawn one may be smaller, see [`Style::drawn_px`].
    ///
    /// A frame that lacks data that the primitive needs gives a packet that draws nothing of it; see [`Scene::needs`].
    pub fn packet(
        &mut self,
        frame: &PreparedFrame,
        origin: DVec3,
        camera: &Camera,
        style: &Style,
        viewport_px: [u32; 2],
    ) -> ScenePacket {
        let viewport_px = style.drawn_px(viewport_px);
        let bounds = frame.frame.bounds();
        let view = camera.transform(origin, viewport_px).near_for(&bounds);
        let mut style = *style;
        let clip = style.of_sequence.clip.take().filter(|clip| clip.is_on);
        style.of_sequence.has_photos = frame.posed_images.is_some();
        let posed_images = frame.posed_images.as_ref().filter(|_| style.draws_photos());
        let posed_images = posed_images.map(|posed_images| PhotosInFrame {
            posed_images: Arc::clone(posed_images),
            origin,
            surface: curved(frame).or_else(|| of_points(frame)),
            depths: None,
        });
        if posed_images.is_some() {
            style = style.of_photos();
        }
        if style.shows_normal_errors() {
            style = style.of_normal_errors();
        }
        let params = PacketParams {
            point_spacing: self.point_spacing(frame, &style),
            clip: clip.map(|clip| clip.relative_to(origin)),
        };
        let ground = style.backdrop.grid.then(|| {
            let ground_box = style.of_sequence.ground_box.unwrap_or(bounds);
            GroundPlane::under(&ground_box, origin, camera.up, style.backdrop.background)
        });
        let content = self.content(&Wanted {
            frame,
            origin,
            view,
            viewport_px,
            style: &style,
            params: &params,
        });
        ScenePacket {
            viewport_px,
            view,
            content: if style.sorts_surfels() {
                self.sorting.get(view, content, sorted)
            } else {
                content
            },
            style: style.painted(),
            bounds,
            ground,
            posed_images,
            params,
        }
    }

    /// Returns the content to draw of `frame`. Primitives drawn from levels of detail are drawn from all points if
    /// there are none.
    fn content(&mut self, wanted: &Wanted<'_>) -> Content {
        let &Wanted {
            frame,
            origin,
            view,
            viewport_px,
            style,
            params,
        } = wanted;
        let is_of_screen = style.has_screen_normals();
        if !is_of_screen {
            self.screen.forget();
        }
        // Sorting needs the records here.
        let is_left_to_gpu = style.drawing.renderer == RendererChoice::Gpu && !style.sorts_surfels();
        let kind = style.levels_kind();
        let coded = self.coded(frame, style);
        // Byte codes cannot be clipped: with a clip, all points are drawn.
        if let Some(coded) = coded.filter(|_| params.clip.is_none()) {
            self.stats.emitted_voxels = coded.deepest_nodes();
            return Content::Coded(coded);
        }
        if let Some(levels) = kind.and_then(|kind| frame.levels.get(kind)) {
            return self.cut(CutInput {
                levels,
                culls_back_faces: style.culls_back_faces(),
                view,
                viewport_px,
                lod: lod_of(style, frame),
                metric: style.levels.metric,
                affordable: self.affordable,
                clip: params.clip,
                may_select: is_left_to_gpu && params.clip.is_none(),
            });
        }
        let points = || Arc::clone(&frame.points);
        let surfels = || {
            let curved = curved(frame).filter(|_| style.draws_photos());
            curved.or_else(|| of_points(frame)).map(Content::Surfels)
        };
        let whole = match style.primitive {
            _ if is_of_screen && !style.shows_normal_errors() => Content::Points(points()),
            Primitive::Point if style.has_points_with_shapes() => {
                surfels().unwrap_or_else(|| Content::Points(points()))
            }
            Primitive::Point => Content::Points(points()),
            Primitive::Surfel | Primitive::Ellipse | Primitive::Sprite => surfels().unwrap_or_default(),
            Primitive::Mesh => match frame.triangles() {
                Some(triangles) => Content::Mesh(Arc::clone(triangles)),
                None => Content::Points(points()),
            },
            Primitive::Voxel => Content::Nothing,
        };
        let whole = match params.clip {
            Some(clip) => self.clipping.get(clip, whole, |clip, whole| whole.clipped(clip)),
            None => whole,
        };
        if !is_of_screen {
            return whole;
        }
        let images = images_of(frame, origin).filter(|_| params.clip.is_none());
        self.screen.content(ScreenInput {
            content: whole,
            images,
            view,
            viewport_px,
            cloud: ScreenCloud {
                spacing: params.point_spacing,
                closing: self.spacing.as_ref().map_or(1.0, |(_, spacing)| spacing.closing),
                sensor: frame.frame.sensor(),
            },
            shows_errors: style.shows_normal_errors(),
            is_left_to_card: is_left_to_gpu,
        })
    }

    /// [`PacketParams::point_spacing`] of a frame for a style, if that requires it.
    fn point_spacing(&mut self, frame: &PreparedFrame, style: &Style) -> f32 {
        let is_of_points = style.primitive == Primitive::Point && style.points.sizing != PointSizing::Pixels;
        if !is_of_points && !style.has_screen_normals() {
            return 0.0;
        }
        let known = self.spacing.take().filter(|(of, _)| Arc::ptr_eq(of, &frame.frame));
        let (_, spacing) = self
            .spacing
            .insert(known.unwrap_or_else(|| (Arc::clone(&frame.frame), typical_spacing(&frame.frame))));
        spacing.typical
    }

    /// The byte code of a frame, if it is to be drawn. Any setting but a threshold chooses a level: as the code is
    /// stored breadth-first, that is one of its prefixes.
    fn coded(&self, frame: &PreparedFrame, style: &Style) -> Option<CodedCells> {
        let is_drawn = style.levels_kind() == Some(LevelsKind::Codes);
        let cloud = frame.levels.codes().filter(|_| is_drawn)?;
        let at_most = |nodes: u32| (0.0, cloud.deepest_level_of(nodes as usize));
        let (lod_px, deepest_level) = match lod_of(style, frame) {
            Lod::ThresholdPx(lod_px) => (style.levels.metric.edge_px(lod_px), cloud.depth()),
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

    /// Records how long the last image took to draw, for [`Lod::FrameTimeMs`].
    pub fn note_draw_ms(&mut self, style: &DrawSettings, draw_ms: f64) {
        if let Lod::FrameTimeMs(asked_ms) = style.levels.lod
            && style.levels_kind().is_some()
        {
            let drawn = self.stats.emitted_voxels;
            self.affordable.learn(drawn, draw_ms, f64::from(asked_ms));
        }
    }

    /// Counters since the scene was made.
    pub fn stats(&self) -> SceneStats {
        self.stats
    }

    /// Returns the statistics of screen-space normals computed on the CPU, if the last image has such.
    pub fn screen_stats(&self) -> Option<ScreenStats> {
        self.screen.stats()
    }

    /// The records of a cut for a view; or of the last one if nothing has changed.
    fn cut(&mut self, from: CutInput) -> Content {
        if let Some(last) = &self.last_cut
            && last.from == from
        {
            return last.content.clone();
        }
        let last = self.last_cut.take();
        let start = Instant::now();
        let before = last
            .as_ref()
            .filter(|last| self.remembers && last.from.has_same_nodes(&from));
        let hints = CutHints {
            culls_back_faces: from.culls_back_faces,
            before: before.and_then(|last| last.cut.as_ref()),
        };
        let select_view = SelectView {
            metric: from.metric,
            ..from.view.select_view(0.0)
        };
        let affordable = from.affordable.voxels();
        let levels = &*from.levels;
        if let Some((content, lod_px)) = from.filtered(&select_view, hints) {
            let candidates = content.record_count();
            self.stats = SceneStats {
                traversals: self.stats.traversals + 1,
                visited_nodes: candidates,
                emitted_voxels: candidates,
                duplicates: 0,
                lod_px: Some(lod_px),
                traverse_time: start.elapsed(),
            };
            self.last_cut = Some(LastCut {
                from,
                cut: None,
                content: content.clone(),
            });
            return content;
        }
        let (cut, lod_px) = from.lod.cut(levels, &select_view, hints, affordable);
        let max_records = match from.lod {
            Lod::Budget(max) => max as usize,
            Lod::ThresholdPx(_) | Lod::Level(_) | Lod::FrameTimeMs(_) => usize::MAX,
        };
        // Reuses the memory of the last records, unless a packet still holds them.
        let mut buffers = last.map_or_else(RecordBuffers::default, |last| last.content.into_buffers());
        let selected = from.may_select.then(|| levels.select(&cut, &mut buffers)).flatten();
        let records = selected.unwrap_or_else(|| levels.write(&cut, max_records, buffers));
        let content = Content::from(records);
        let content = match &from.clip {
            Some(clip) => content.clipped(clip),
            None => content,
        };
        let traversed = cut.stats();
        self.stats = SceneStats {
            traversals: self.stats.traversals + 1,
            visited_nodes: traversed.visited_nodes,
            emitted_voxels: traversed.emitted,
            duplicates: traversed.duplicates,
            lod_px,
            traverse_time: start.elapsed(),
        };
        self.last_cut = Some(LastCut {
            from,
            cut: Some(cut),
            content: content.clone(),
        });
        content
    }
}

/// The images that the points of a frame were made from, if these have the colours of the camera or one for all.
fn images_of(frame: &PreparedFrame, origin: DVec3) -> Option<PointImages> {
    let images = DepthFrame::of(&frame.frame)?;
    let one_color = match *frame.paint() {
        Paint::File if images.colors().is_some() => None,
        Paint::Uniform([red, green, blue]) => Some([red, green, blue, 255]),
        _ => return None,
    };
    Some(PointImages {
        frame: images,
        origin: origin.as_vec3(),
        one_color,
    })
}
