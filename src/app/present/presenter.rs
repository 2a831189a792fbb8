//! What every presenter can do.

use crate::app::meter::GpuWork;
use crate::app::side::Side;
use crate::render::{RenderError, RenderStats};
use crate::scene::ScenePacket;
use egui::epaint::ClippedShape;
use egui::{TextureId, TexturesDelta};
use image::RgbaImage;
use std::time::Duration;

/// What a presenter says of itself.
#[derive(Debug, Clone)]
pub(in crate::app) struct PresenterInfo {
    /// What draws and paints, in a line.
    pub(in crate::app) adapter: String,
    /// Whether pictures are drawn on the processor if nobody chooses.
    pub(in crate::app) is_software: bool,
    /// Whether the processor paints the window.
    pub(in crate::app) paints_on_processor: bool,
    /// Largest edge of a picture.
    pub(in crate::app) max_edge_px: u32,
    /// Whether showing a window waits for the screen. Where it does not, the event loop has to.
    pub(in crate::app) waits_for_screen: bool,
}

/// What egui wants to be painted.
pub(in crate::app) struct Panels<'a> {
    pub(in crate::app) egui: &'a egui::Context,
    pub(in crate::app) shapes: Vec<ClippedShape>,
    /// egui sends a texture once: it is taken in even if nothing can be shown now.
    pub(in crate::app) textures: &'a mut TexturesDelta,
    pub(in crate::app) pixels_per_point: f32,
}

/// What painting came to.
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
    /// Pixels that were painted anew.
    pub(in crate::app) repainted_px: u64,
    /// What the graphics card had to do since it was painted before.
    pub(in crate::app) gpu: GpuWork,
}

/// Brings one window onto the screen.
pub(in crate::app) trait Presenter {
    /// What it says of itself.
    fn info(&self) -> PresenterInfo;

    /// What egui shows as the picture of a side; `None` until there was one of it.
    fn texture(&self, side: Side) -> Option<TextureId>;

    /// Draws the picture of a side.
    fn draw(&mut self, side: Side, packet: &ScenePacket) -> Result<(), RenderError>;

    /// Reads the picture of a side back, in the size in which it is shown, if there is one.
    fn read(&mut self, side: Side, shown_px: [u32; 2]) -> Result<Option<RgbaImage>, RenderError>;

    /// Whether the graphics card drew the last picture of side A.
    fn was_drawn_by_gpu(&self) -> bool;

    /// Counters of the renderer that drew the last picture of side A.
    fn stats(&self) -> RenderStats;

    /// Sets how many bytes of points and voxels stay on the graphics card.
    fn set_resident_budget_bytes(&mut self, budget_bytes: u64);

    /// Follows the window's size.
    fn resize(&mut self);

    /// Paints what has changed and shows it: the pictures, and the panels if there are new ones. All of the window is
    /// shown anew if the window system has lost it.
    fn paint(&mut self, panels: Option<Panels<'_>>, is_exposed: bool) -> Result<Painted, RenderError>;

    /// Ends the device as a crashed driver would, where there is one.
    fn simulate_loss(&self);
}
