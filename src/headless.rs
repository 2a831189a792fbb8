//! Rendering without a window: the same sequence, scene and renderer as in the window, one frame at a time.

use crate::composition::{
    ComposeOptions, Composed, Drawn, Frames, Inputs, PHOTO_BYTES, PictureView, Problem, StandIns, WholeFrame, compose,
    on_surface, packet,
};
use crate::levels::LevelsSize;
use crate::locks::lock;
use crate::math::Aabb;
use crate::photos::{LoadedPhotos, PosedImages, ViewSet};
use crate::progress::Progress;
use crate::render::{AnyRenderer, RenderError, RenderStats, Renderer, scaled_to};
use crate::scene::{
    Camera, FirstLook, Label, LabelOnPicture, LevelStructure, Projection, Scene, ScenePacket, SceneStats, ScreenStats,
    Style, UpAxis, labels_on_picture,
};
use crate::sequence::{ColorSource, FrameError, Loader, Needs, PreparedFrame, Sequence};
use crate::timeline::Direction;
use glam::DVec3;
use image::RgbaImage;
use serde::Serialize;
use std::sync::{Arc, Mutex, OnceLock};

/// Errors of headless rendering.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HeadlessError {
    /// The frame cannot be shown.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The renderer failed.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// The camera as the user specifies it: missing values frame the cloud.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CameraChoice {
    /// The whole camera, except for the other given values.
    pub view: Option<Camera>,
    /// Up axis; guessed from the cloud when not given.
    pub up: Option<UpAxis>,
    /// Rotation about the up axis, degrees.
    pub azimuth_deg: Option<f64>,
    /// Height above the horizon, degrees.
    pub elevation_deg: Option<f64>,
    /// Distance from the centre of the cloud to the eye, in scene units.
    pub distance: Option<f64>,
    /// Vertical field of view, degrees.
    pub fov_deg: Option<f64>,
    /// Camera projection; perspective when not given.
    pub projection: Option<Projection>,
    /// Frames all points, including outliers and far ones.
    pub frames_all: bool,
}

impl CameraChoice {
    /// The camera of `look` for frames relative to `origin`, in an image of `size_px`, except for the given values.
    pub fn camera(&self, look: &FirstLook, origin: DVec3, size_px: [u32; 2]) -> Camera {
        let aspect = f64::from(size_px[0]) / f64::from(size_px[1]);
        let framing = look.camera_with_up(self.up.unwrap_or(look.up), origin, aspect);
        let mut camera = self.view.unwrap_or(framing);
        camera.up = self.up.unwrap_or(camera.up);
        camera.azimuth_deg = self.azimuth_deg.unwrap_or(camera.azimuth_deg);
        camera.elevation_deg = self.elevation_deg.unwrap_or(camera.elevation_deg);
        if let Some(fov_deg) = self.fov_deg {
            camera.set_fov_deg(fov_deg);
        }
        camera.projection = self.projection.unwrap_or(camera.projection);
        if self.view.is_none() {
            if self.frames_all {
                camera.frame_bounds(&look.full, origin);
            } else {
                look.frame(&mut camera, origin, aspect, &Aabb::EMPTY);
            }
        }
        camera.distance = self.distance.unwrap_or(camera.distance);
        camera
    }
}

/// Render statistics of one image, for `--stats`.
#[derive(Debug, Clone, Serialize)]
pub struct PictureStats {
    /// Index of the frame in the sequence.
    pub index: usize,
    /// Its file.
    pub file: String,
    /// Points drawn from.
    pub points: usize,
    /// Points of the file without finite coordinates.
    pub dropped_points: usize,
    /// Triangles drawn from, if they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<usize>,
    /// Milliseconds of decoding.
    pub decode_ms: f32,
    /// Milliseconds of normals and radii.
    pub analysis_ms: f32,
    /// Milliseconds of packing records.
    pub records_ms: f32,
    /// The octree, if the primitive needs one.
    pub octree: Option<OctreeStats>,
    /// The levels of detail that surfels are taken from, if they are.
    pub levels: Option<LevelsStats>,
    /// Visible points and their normals, where these are of the screen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub screen: Option<ScreenStats>,
    /// Counters and times of the renderer.
    pub render: RenderStats,
}

/// A structure of levels of detail in numbers.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct LevelsStats {
    /// Its word on the command line.
    pub structure: LevelStructure,
    /// Nodes and bytes.
    #[serde(flatten)]
    pub size: LevelsSize,
    /// Milliseconds of building.
    pub build_ms: f32,
    /// Milliseconds of the last traversal.
    pub traverse_ms: f64,
    /// Nodes visited and emitted by it.
    #[serde(flatten)]
    pub traversal: SceneStats,
}

/// An octree in numbers (the 4D media paper, Table III).
#[derive(Debug, Clone, Copy, Serialize)]
pub struct OctreeStats {
    /// Deepest level.
    pub depth: u32,
    /// All nodes.
    pub nodes: usize,
    /// Cells of the deepest level.
    pub leaves: usize,
    /// `1 - leaves / points`.
    pub loss: f32,
    /// Milliseconds of building.
    pub build_ms: f32,
    /// Milliseconds of the last traversal.
    pub traverse_ms: f64,
    /// Nodes visited and cells emitted by it.
    #[serde(flatten)]
    pub traversal: SceneStats,
}

/// Renders frames of one sequence.
#[derive(Debug)]
pub struct Headless {
    sequence: Arc<Sequence>,
    loader: Loader,
    renderer: AnyRenderer,
    scene: Scene,
    look: OnceLock<Arc<FirstLook>>,
    /// Labels drawn over images.
    labels: Arc<Vec<Label>>,
    /// Input images that were loaded last.
    posed_images: Mutex<Option<(Arc<ViewSet>, Arc<LoadedPhotos>)>>,
    /// Input images of one static scene that have their own surface.
    surfaced: Mutex<Option<Surfaced>>,
}

/// Input images of one static scene with the surface reconstructed from them.
#[derive(Debug)]
struct Surfaced {
    of: Arc<LoadedPhotos>,
    skipped: Vec<usize>,
    used: Arc<PosedImages>,
}

impl Headless {
    /// Draws the frames that `loader` loads.
    pub fn new(sequence: Arc<Sequence>, loader: Loader, renderer: AnyRenderer) -> Self {
        Self {
            sequence,
            loader,
            renderer,
            scene: Scene::default(),
            look: OnceLock::new(),
            labels: Arc::default(),
            posed_images: Mutex::default(),
            surfaced: Mutex::default(),
        }
    }

    /// Sets the labels of exported images.
    pub fn set_labels(&mut self, labels: Arc<Vec<Label>>) {
        self.labels = labels;
    }

    /// Returns the positions and texts of the labels in an image of `size_px` that is drawn from `packet`. Frame
    /// `index` is shown; ghosts in the packet are of other frames.
    pub fn labels_on(
        &self,
        index: usize,
        style: &Style,
        camera: &Camera,
        packet: &ScenePacket,
        size_px: [u32; 2],
    ) -> Vec<(LabelOnPicture, String)> {
        if self.labels.is_empty() {
            return Vec::new();
        }
        // It has just been drawn, so it is in memory. The plain frame: ghosts and trails introduce other indices.
        let Ok(pose) = self.second_frame(index, style) else {
            return Vec::new();
        };
        let origin = self.sequence.origin();
        let placed = labels_on_picture(&self.labels, &pose, origin, camera, packet, size_px);
        let text = |label: &LabelOnPicture| self.labels[label.label].text.clone();
        placed.into_iter().map(|label| (label.clone(), text(&label))).collect()
    }

    /// Returns the renderer.
    pub fn renderer(&self) -> &AnyRenderer {
        &self.renderer
    }

    /// Returns the default view and appearance of the sequence where nothing is chosen, determined by its first
    /// readable frame and some others.
    pub fn first_look(&self) -> Result<Arc<FirstLook>, FrameError> {
        if let Some(look) = self.look.get() {
            return Ok(Arc::clone(look));
        }
        // Other needs of the image are only known after this.
        let needs = Needs {
            colors: ColorSource::Uniform.into(),
            ..Needs::default()
        };
        let mut failure = None;
        for index in 0..self.sequence.len() {
            match self.loader.wait(index, &needs) {
                Ok(frame) => {
                    let look = FirstLook::of_sequence(&frame.frame, &self.sequence);
                    return Ok(Arc::clone(self.look.get_or_init(|| Arc::new(look))));
                }
                Err(error) => failure = failure.or(Some(error)),
            }
        }
        match failure {
            Some(error) => Err(error),
            None => Ok(Arc::new(FirstLook::of(&[], self.sequence.origin()))),
        }
    }

    /// Waits for frame `index` with all that `style` needs; later frames are prepared meanwhile.
    pub fn frame(&self, index: usize, style: &Style) -> Result<Arc<PreparedFrame>, FrameError> {
        self.frame_on_the_way(index, Direction::Forward, style)
    }

    /// [`Headless::frame`], where those that follow in `direction` are prepared meanwhile.
    pub fn frame_on_the_way(
        &self,
        index: usize,
        direction: Direction,
        style: &Style,
    ) -> Result<Arc<PreparedFrame>, FrameError> {
        let needs = self.needs(style);
        self.loader.request(index, direction, &needs);
        self.loader.wait(index, &needs)
    }

    /// [`Headless::frame`] for an image of another frame: frames being prepared are not affected.
    pub fn second_frame(&self, index: usize, style: &Style) -> Result<Arc<PreparedFrame>, FrameError> {
        self.loader.wait(index, &self.needs(style))
    }

    /// Returns the input images of the scene that frame `index` shows, if there are any. They are loaded once.
    fn loaded_photos(&self, index: usize) -> Option<Arc<LoadedPhotos>> {
        let set = self.sequence.source().posed_images(index)?;
        let mut known = lock(&self.posed_images);
        if let Some((of, loaded)) = &*known
            && Arc::ptr_eq(of, &set)
        {
            return Some(Arc::clone(loaded));
        }
        let loaded = Arc::new(LoadedPhotos::of(&set, PHOTO_BYTES, &Progress::default()));
        *known = Some((set, Arc::clone(&loaded)));
        Some(loaded)
    }

    /// Returns the input images that are not excluded, on the surface reconstructed from them if they are of one static
    /// scene.
    fn photos_without(&self, index: usize, skipped: &[usize]) -> Option<Arc<PosedImages>> {
        let loaded = self.loaded_photos(index)?;
        let set = self.sequence.source().posed_images(index)?;
        let mut known = lock(&self.surfaced);
        if let Some(surfaced) = &*known
            && Arc::ptr_eq(&surfaced.of, &loaded)
            && surfaced.skipped == skipped
        {
            return Some(Arc::clone(&surfaced.used));
        }
        let used = if skipped.is_empty() {
            Arc::clone(&loaded.posed_images)
        } else {
            Arc::new(loaded.posed_images.without(skipped))
        };
        let used = on_surface(used, &set, &self.sequence, &Progress::default());
        *known = Some(Surfaced {
            of: loaded,
            skipped: skipped.to_vec(),
            used: Arc::clone(&used),
        });
        Some(used)
    }

    /// `pose` with everything that `options` request. Missing inputs (a frame beyond the ends, a broken one) are
    /// skipped, and reported as problems, after the faults of the frame's own file.
    ///
    /// # Errors
    /// If the result has more points than a frame can have.
    pub fn compose(
        &self,
        pose: &Arc<PreparedFrame>,
        options: &ComposeOptions,
        style: &Style,
    ) -> Result<(Composed, Vec<String>), FrameError> {
        let style = style.drawn_by(self.renderer.is_processor());
        let inputs = Inputs {
            pose,
            options,
            style: &style,
            frames: self,
            stand_ins: StandIns::default(),
        };
        let composed = compose(pose, &inputs).map_err(|reason| FrameError::Invalid {
            index: pose.index,
            path: self.sequence.entry(pose.index).path.clone(),
            reason,
        })?;
        let mut problems = pose.frame.warnings().to_vec();
        let count = self.sequence.len();
        problems.extend(composed.problems.iter().map(|problem: &Problem| problem.text(count)));
        Ok((composed, problems))
    }

    /// Returns the needs of a frame: the data it must have to be drawn here with these settings.
    pub fn needs(&self, style: &Style) -> Needs {
        Scene::needs(&style.drawn_by(self.renderer.is_processor()))
    }

    /// The frames.
    pub fn sequence(&self) -> &Arc<Sequence> {
        &self.sequence
    }

    /// Draws a frame.
    pub fn draw(
        &mut self,
        frame: &PreparedFrame,
        camera: &Camera,
        style: &Style,
        size_px: [u32; 2],
    ) -> Result<RgbaImage, RenderError> {
        let packet = self.packet(frame, camera, style, size_px);
        Ok(scaled_to(self.draw_packet(&packet)?, size_px))
    }

    /// All that [`Headless::draw`] draws from.
    pub fn packet(&mut self, frame: &PreparedFrame, camera: &Camera, style: &Style, size_px: [u32; 2]) -> ScenePacket {
        let view = PictureView {
            camera,
            origin: self.sequence.origin(),
            size_px,
        };
        let style = style.drawn_by(self.renderer.is_processor());
        packet(&mut self.scene, Drawn::from(frame), &view, &style)
    }

    /// Draws a packet, in its size.
    pub fn draw_packet(&mut self, packet: &ScenePacket) -> Result<RgbaImage, RenderError> {
        self.renderer.prepare(packet)?;
        self.renderer.render()?;
        self.renderer.wait_gpu_ms();
        self.renderer.read_image()
    }

    /// Returns the statistics of screen-space normals, if the last packet has any.
    pub fn screen_stats(&self) -> Option<ScreenStats> {
        self.scene.screen_stats().or(self.renderer.stats().screen)
    }

    /// Returns the render statistics of the last [`Headless::draw`] of `frame`.
    pub fn stats(&self, frame: &PreparedFrame) -> PictureStats {
        let traversal = self.scene.stats();
        let traverse_ms = traversal.traverse_time.as_secs_f64() * 1e3;
        let build_ms = frame.timings.octree_ms;
        PictureStats {
            index: frame.index,
            file: self.sequence.entry(frame.index).path.display().to_string(),
            points: frame.frame.len(),
            dropped_points: frame.frame.dropped_points(),
            triangles: frame.mesh.as_ref().map(|mesh| mesh.mesh().triangles().len()),
            decode_ms: frame.timings.decode_ms,
            analysis_ms: frame.timings.analysis_ms,
            records_ms: frame.timings.records_ms,
            octree: frame.levels.octree().map(|octree| OctreeStats {
                depth: octree.depth(),
                nodes: octree.node_count(),
                leaves: octree.leaf_count(),
                loss: octree.loss(),
                build_ms,
                traverse_ms,
                traversal,
            }),
            levels: frame.levels.of_surfels().map(|(kind, levels)| LevelsStats {
                structure: LevelStructure::of(kind),
                size: levels.size(),
                build_ms,
                traverse_ms,
                traversal,
            }),
            screen: self.screen_stats(),
            render: self.renderer.stats(),
        }
    }
}

/// Waits for frames; frames being prepared are not affected.
impl Frames for Headless {
    fn frame_count(&self) -> usize {
        self.sequence.len()
    }

    fn whole(&self, index: usize, needs: &Needs) -> Result<WholeFrame, FrameError> {
        self.loader.wait(index, needs).map(WholeFrame::InMemory)
    }

    fn drawable(&self, index: usize, needs: &Needs) -> Result<Option<Arc<PreparedFrame>>, FrameError> {
        self.loader.wait(index, needs).map(Some)
    }

    fn posed_images(&self, index: usize, skipped: &[usize]) -> Option<LoadedPhotos> {
        let notes = self.loaded_photos(index)?.notes.clone();
        let posed_images = self.photos_without(index, skipped)?;
        Some(LoadedPhotos { posed_images, notes })
    }
}
