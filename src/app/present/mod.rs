//! What brings the window onto the screen: the 3-D pictures, and egui's panels around them.
//!
//! **How it works.** There are two presenters behind one trait. That of the graphics card (`gpu.rs`) paints through
//! egui-wgpu on a surface of the driver. That of the processor (`cpu.rs`) paints into memory which the window system
//! shows as it is. A software driver would do the latter's work too, but compiles shaders, bins triangles and copies
//! textures for it: on two cores that is fifteen windows a second, whatever is in them. So the processor presents
//! wherever no graphics card does.
//!
//! A picture is drawn when there is a new packet, panels are painted when egui has run, and either may come without the
//! other.

mod cpu;
mod gpu;
mod gpu_picture;
mod software;
mod surface;

use super::comparison::Side;
use super::meter::GpuWork;
use super::present_choice::PresentChoice;
use crate::render::gpu::may_have_gpu;
use crate::render::{RenderError, RenderStats};
use crate::scene::ScenePacket;
use cpu::CpuPresenter;
use egui::epaint::ClippedShape;
use egui::{TextureId, TexturesDelta};
use gpu::GpuPresenter;
use image::RgbaImage;
use std::sync::Arc;
use std::time::Duration;
use winit::window::Window;

/// What a presenter says of itself.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "each is a fact of its own")]
pub(super) struct PresenterInfo {
    /// What draws and paints, in a line.
    pub(super) adapter: String,
    /// Whether pictures are drawn on the processor if nobody chooses.
    pub(super) is_software: bool,
    /// Whether the processor paints the window.
    pub(super) paints_on_processor: bool,
    /// Whether GPU time can be measured.
    pub(super) has_timestamps: bool,
    /// Largest edge of a picture.
    pub(super) max_edge_px: u32,
    /// Whether showing a window waits for the screen. Where it does not, the event loop has to.
    pub(super) waits_for_screen: bool,
}

/// What egui wants to be painted.
pub(super) struct Panels<'a> {
    pub(super) egui: &'a egui::Context,
    pub(super) shapes: Vec<ClippedShape>,
    /// egui sends a texture once: it is taken in even if nothing can be shown now.
    pub(super) textures: &'a mut TexturesDelta,
    pub(super) pixels_per_point: f32,
}

/// What painting came to.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Painted {
    /// False if it must be tried again.
    pub(super) presented: bool,
    /// Time spent waiting for the screen.
    pub(super) waited: Duration,
    /// Time of tessellating, uploading, painting.
    pub(super) painting: Duration,
    /// Time of handing the window to the window system or the driver.
    pub(super) presenting: Duration,
    /// Pixels that were painted anew.
    pub(super) repainted_px: u64,
    /// What the graphics card had to do since it was painted before.
    pub(super) gpu: GpuWork,
}

/// Brings one window onto the screen.
pub(super) trait Presenter {
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
    fn paint(
        &mut self,
        panels: Option<Panels<'_>>,
        is_exposed: bool,
    ) -> Result<Painted, RenderError>;

    /// Ends the device as a crashed driver would, where there is one.
    fn simulate_loss(&self);
}

/// Opens what was chosen. Where it may choose, it takes a real graphics card, and else needs no driver at all.
pub(super) fn open(
    choice: PresentChoice,
    window: &Arc<Window>,
) -> Result<Box<dyn Presenter>, RenderError> {
    match choice {
        PresentChoice::Gpu => open_gpu(window),
        PresentChoice::Cpu => open_cpu(window),
        PresentChoice::Auto if may_have_gpu() => match open_gpu(window) {
            Ok(presenter) if !presenter.info().is_software => Ok(presenter),
            Ok(software) => {
                log::info!("{} is no GPU", software.info().adapter);
                // The window can have one surface at a time.
                drop(software);
                open_cpu(window)
            }
            Err(error) => {
                log::info!("{error}");
                open_cpu(window)
            }
        },
        // A display of an odd kind may be one that only a driver can show on.
        PresentChoice::Auto => open_cpu(window).or_else(|error| {
            log::info!("{error}");
            open_gpu(window)
        }),
    }
}

fn open_gpu(window: &Arc<Window>) -> Result<Box<dyn Presenter>, RenderError> {
    Ok(Box::new(GpuPresenter::open(Arc::clone(window))?))
}

fn open_cpu(window: &Arc<Window>) -> Result<Box<dyn Presenter>, RenderError> {
    Ok(Box::new(CpuPresenter::open(Arc::clone(window))?))
}
