//! Presenter interface.

use crate::app::meter::GpuWork;
use crate::app::side::Side;
use crate::render::{RenderError, RenderStats};
use crate::scene::ScenePacket;
use egui::epaint::ClippedShape;
use egui::{TextureId, TexturesDelta};
use image::RgbaImage;
use std::time::Duration;

/// Presenter information.
#[derive(Debug, Clone)]
pub(in crate::app) struct PresenterInfo {
    /// Adapter that draws and paints, in a line.
    pub(in crate::app) adapter: String,
    /// True if images are drawn on the CPU by default.
    pub(in crate::app) is_software: bool,
    /// True if the CPU paints the window.
    pub(in crate::app) paints_on_processor: bool,
    /// Max edge of an image.
    pub(in crate::app) max_edge_px: u32,
    /// True if showing a window waits for the screen. Where it does not, the event loop has to.
    pub(in crate::app) waits_for_screen: bool,
}

/// Paint input from egui.
pub(in crate::app) struct Panels<'a> {
    pub(in crate::app) egui: &'a egui::Context,
    pub(in crate::app) shapes: Vec<ClippedShape>,
    /// egui sends a texture once: it is taken in even if nothing can be shown now.
    pub(in crate::app) textures: &'a mut TexturesDelta,
    pub(in crate::app) pixels_per_point: f32,
}

/// Outcome of a paint pass.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::app) struct Painted {
    /// False if it must be tried again.
    pub(in crate::app) presented: bool,
    /// Time spent waiting for the screen.
    pub(in crate::app) waited: Duration,
    /// Time of tessellating, uploading, painting.
    pub(in crate::app) painting: Duration,
    /// Time of handing the window to the window system or the driver.
    pub(in crate::app) presenting: Duration,
    /// Number of repainted pixels.
    pub(in crate::app) repainted_px: u64,
    /// GPU work since the previous paint.
    pub(in crate::app) gpu: GpuWork,
}

/// Brings one window onto the screen.
pub(in crate::app) trait Presenter {
    /// Returns the presenter's description.
    fn info(&self) -> PresenterInfo;

    /// Returns the egui texture of a side's rendered image; `None` until that side has been rendered.
    fn texture(&self, side: Side) -> Option<TextureId>;

    /// Draws the image of a side.
    fn draw(&mut self, side: Side, packet: &ScenePacket) -> Result<(), RenderError>;

    /// Reads the image of a side back, in its shown size, if there is one.
    fn read(&mut self, side: Side, shown_px: [u32; 2]) -> Result<Option<RgbaImage>, RenderError>;

    /// Returns true if the GPU drew the last image of side A.
    fn was_drawn_by_gpu(&self) -> bool;

    /// Counters of the renderer that drew the last image of side A.
    fn stats(&self) -> RenderStats;

    /// Sets the GPU residency budget for points and voxels, in bytes.
    fn set_resident_budget_bytes(&mut self, budget_bytes: u64);

    /// Follows the window's size.
    fn resize(&mut self);

    /// Repaints and presents changes: the rendered images, and the panels if there are new ones. The whole window is
    /// presented again if the window system has lost its contents.
    fn paint(&mut self, panels: Option<Panels<'_>>, is_exposed: bool) -> Result<Painted, RenderError>;

    /// Ends the device as a crashed driver would, where there is one.
    fn simulate_loss(&self);
}
