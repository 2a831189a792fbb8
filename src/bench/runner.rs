//! The clocks: times of one upload and one image.
//!
//! An image is timed by the wall clock from handing over the packet until the GPU has finished, nothing being read back
//! or shown, and by GPU timestamps around its passes where the adapter has them. Its content is resident before:
//! uploads are timed separately, until their copies have arrived. Compiling pipelines is in neither.

use crate::levels::Selection;
use crate::render::{AnyRenderer, PassTimes, RenderError, Renderer};
use crate::rgbd::DepthFrame;
use crate::scene::{Content, ScenePacket, Selected, Surfels, Voxels};
use crate::stopwatch::milliseconds_since;
use image::RgbaImage;
use std::sync::Arc;
use std::time::Instant;

/// Draw time of one image.
#[derive(Debug, Clone, Copy)]
pub(super) struct DrawTime {
    /// From the packet to the finished image, on the CPU's clock.
    pub(super) wall_ms: f64,
    /// Its passes, on the GPU's clock.
    pub(super) gpu_ms: Option<f64>,
    /// Each of them.
    pub(super) gpu_passes: PassTimes,
}

/// Cost of one upload.
#[derive(Debug, Clone, Copy)]
pub(super) struct Upload {
    pub(super) wall_ms: f64,
    /// 0 when everything was resident already.
    pub(super) bytes: u64,
}

/// Draws packets and measures their times.
#[derive(Debug)]
pub(super) struct Runner {
    renderer: AnyRenderer,
}

impl Runner {
    pub(super) fn new(renderer: AnyRenderer) -> Self {
        Self { renderer }
    }

    /// Returns true if the CPU draws.
    pub(super) fn is_processor(&self) -> bool {
        self.renderer.is_processor()
    }

    /// Sets if an adapter makes surfels of the screen and of byte codes, as hardware GPUs do by default.
    pub(super) fn set_makes_surfels(&mut self, makes_surfels: bool) {
        self.renderer.set_makes_surfels(makes_surfels);
    }

    /// Creates everything that images like `packet` share (pipelines, targets) by drawing a single record of it.
    pub(super) fn warm_up(&mut self, packet: &ScenePacket) -> Result<(), RenderError> {
        self.draw(&single_record(packet)).map(|_| ())
    }

    /// Makes the content of `packet` resident and waits until it has arrived.
    pub(super) fn upload(&mut self, packet: &ScenePacket) -> Result<Upload, RenderError> {
        let before = self.renderer.stats().uploaded_bytes;
        let start = Instant::now();
        self.renderer.prepare(packet)?;
        self.renderer.wait()?;
        let wall_ms = milliseconds_since(start);
        Ok(Upload {
            wall_ms,
            bytes: self.renderer.stats().uploaded_bytes - before,
        })
    }

    /// Draws `packet`, also when it was drawn last.
    pub(super) fn draw(&mut self, packet: &ScenePacket) -> Result<DrawTime, RenderError> {
        self.renderer.invalidate();
        let start = Instant::now();
        self.renderer.prepare(packet)?;
        self.renderer.render()?;
        self.renderer.wait()?;
        let wall_ms = milliseconds_since(start);
        let gpu_ms = self.renderer.wait_gpu_ms();
        Ok(DrawTime {
            wall_ms,
            gpu_ms,
            gpu_passes: self.renderer.stats().gpu_passes,
        })
    }

    /// Returns the pass times that a GPU takes to filter the images of a frame and to create points from them, where it
    /// creates those.
    pub(super) fn depth_image_times(&mut self, frame: &Arc<DepthFrame>) -> Result<Option<PassTimes>, RenderError> {
        self.renderer.depth_image_times(frame)
    }

    /// Returns a description of the renderer.
    pub(super) fn summary(&self) -> String {
        self.renderer.summary()
    }

    /// The image of `packet`.
    pub(super) fn image(&mut self, packet: &ScenePacket) -> Result<RgbaImage, RenderError> {
        self.renderer.prepare(packet)?;
        self.renderer.render()?;
        self.renderer.read_image()
    }

    /// Counters of the renderer.
    pub(super) fn stats(&self) -> crate::render::RenderStats {
        self.renderer.stats()
    }
}

/// `packet` with the first record of each of its streams.
fn single_record(packet: &ScenePacket) -> ScenePacket {
    fn first<T: Copy>(records: &Arc<Vec<T>>) -> Arc<Vec<T>> {
        Arc::new(records.iter().copied().take(1).collect())
    }
    let content = match &packet.content {
        Content::Points(points) => Content::Points(first(points)),
        Content::Surfels(surfels) => Content::Surfels(Surfels {
            points: first(&surfels.points),
            shapes: first(&surfels.shapes),
        }),
        Content::Selected(selected) => Content::Selected(Selected {
            selection: Arc::new(Selection::At(vec![0; 1.min(selected.selection.len())])),
            ..selected.clone()
        }),
        Content::Voxels(voxels) => Content::Voxels(Voxels {
            records: first(&voxels.records),
            normals: voxels.normals.as_ref().map(first),
            cube_edge: voxels.cube_edge,
        }),
        Content::Mesh(mesh) => {
            let first = mesh.triangles.iter().copied().take(1);
            Content::Mesh(Arc::new(mesh.with_triangles(first.collect())))
        }
        // All of these are needed to determine visibility.
        Content::Nothing | Content::Coded(_) | Content::Visible(_) => packet.content.clone(),
    };
    ScenePacket {
        content,
        ..packet.clone()
    }
}
