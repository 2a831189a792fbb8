//! Parts of a [`super::State`].

use crate::app::meter::Redraw;
use crate::render::RenderStats;
use crate::render::gpu::DEFAULT_RESIDENT_BUDGET_BYTES;
use std::path::PathBuf;

/// Visible change since the last redraw.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum VisibleChange {
    /// Nothing.
    #[default]
    Nothing,
    /// The image alone.
    Picture,
    /// The playing frame, and so the image; of the panels only the position of the playhead.
    Frame,
    /// Anything that panels show.
    Panels,
}

impl VisibleChange {
    /// All, or nothing.
    pub(in crate::app) fn of_panels(is_changed: bool) -> Self {
        if is_changed { Self::Panels } else { Self::Nothing }
    }

    /// Returns true if there is anything to draw.
    pub fn is_visible(self) -> bool {
        self != Self::Nothing
    }
}

/// Counters of the window's work. They prove that an idle window does nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Runs of the panels.
    pub ui_passes: u64,
    /// Packets that differed from the one before: images requested from the renderer.
    pub pictures: u64,
}

/// The image on the screen.
#[derive(Debug, Clone, Copy)]
pub struct Viewport {
    /// Its place in the window, points.
    pub rect: egui::Rect,
    /// Its size in physical pixels.
    pub size_px: [u32; 2],
    /// Rectangle of the other view, where there are two: the same, or next to it.
    pub other_rect: egui::Rect,
    /// The size of the other one in physical pixels.
    pub other_size_px: [u32; 2],
    /// Pointer position, if it is over the rendered image.
    pub pointer: Option<egui::Pos2>,
    /// The texture that holds it; `None` without a GPU.
    pub texture: Option<egui::TextureId>,
    /// The texture with the image of the other side of a comparison.
    pub other_texture: Option<egui::TextureId>,
    /// Largest edge that the adapter can draw.
    pub max_edge_px: Option<u32>,
}

impl Default for Viewport {
    fn default() -> Self {
        Self {
            rect: egui::Rect::ZERO,
            size_px: [0; 2],
            other_rect: egui::Rect::ZERO,
            other_size_px: [0; 2],
            pointer: None,
            texture: None,
            other_texture: None,
            max_edge_px: None,
        }
    }
}

/// GPU information shown in the statistics panel, and the GPU memory budget.
#[derive(Debug, Clone)]
pub struct GraphicsInfo {
    /// Max bytes of points and voxels that stay in its memory for later images.
    pub budget_bytes: u64,
    /// Name, type and driver.
    pub adapter: String,
    /// True if the adapter is a software renderer, running on the CPU.
    pub is_software: bool,
    /// True if the CPU paints the window.
    pub paints_on_processor: bool,
    /// Counters of the renderer.
    pub render: RenderStats,
    /// Time of the last redraw: panels, image, painting and presenting, and any wait beyond the regular one for the
    /// screen.
    pub frame_ms: f64,
    /// Its parts.
    pub redraw: Redraw,
}

impl Default for GraphicsInfo {
    fn default() -> Self {
        Self {
            budget_bytes: DEFAULT_RESIDENT_BUDGET_BYTES,
            adapter: String::new(),
            is_software: false,
            paints_on_processor: false,
            render: RenderStats::default(),
            frame_ms: 0.0,
            redraw: Redraw::default(),
        }
    }
}

impl GraphicsInfo {
    /// Returns the time of the last image: the longer of CPU and GPU time, as the two work in parallel.
    pub(in crate::app) fn picture_ms(&self) -> f64 {
        self.frame_ms.max(self.render.gpu_ms.unwrap_or(0.0))
    }
}

/// Request that only the window itself can serve.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum WindowRequest {
    /// Read the image back and write it to this file, or to a new one.
    Screenshot(Option<PathBuf>),
    /// Read the images of both sides of a comparison back.
    Compare,
    /// Put this text on the clipboard.
    Copy(String),
    /// Read the clipboard, for [`super::State::paste_view`].
    PasteView,
    /// Full screen and back.
    FullScreen,
    /// End the program.
    Quit,
}
