//! Post-processing effects: an effect is a row with the condition under which a packet has it, its position among the
//! steps of an image, and its implementation on both the CPU and the GPU.

#[cfg(feature = "gpu")]
use crate::render::gpu::passes::ScreenPass;
use crate::scene::ScenePacket;
use fearless_simd::Level;
use image::RgbaImage;
use std::fmt;

/// A row of [`EFFECTS`](super::EFFECTS).
#[derive(Debug)]
pub(in crate::render) struct Effect {
    pub(in crate::render) stage: Stage,
    /// Returns true if a packet has the effect, as it is drawn ([`ScenePacket::as_drawn`]).
    pub(in crate::render) is_on: fn(&ScenePacket) -> bool,
    #[cfg(feature = "gpu")]
    /// GPU passes: one pass, or one for each target that it may be drawn into.
    pub(in crate::render) passes: &'static [&'static ScreenPass],
    pub(in crate::render) on_cpu: OnCpu,
}

/// Stage of an effect among the steps of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::render) enum Stage {
    /// Before all that is drawn.
    Behind,
    /// On the drawn surface, before the background shines through it: on sums where these are drawn, else on the image.
    Drawn,
    /// On the complete image.
    Picture,
    /// From the drawn image to the one shown.
    Shown,
}

/// Implementation of an effect in the software renderer.
#[derive(Debug)]
pub(in crate::render) enum OnCpu {
    /// No step in addition to its work on each tile.
    InTiles,
    /// A step that changes rows when all tiles are drawn.
    Rows(fn(&ScenePacket) -> Option<Box<dyn RowStep>>),
    /// A step that makes the image shown from the drawn one.
    Shown(fn(&RgbaImage, &mut RgbaImage)),
}

/// A step from row to row of an image that is drawn.
pub(in crate::render) trait RowStep: fmt::Debug + Send + Sync {
    /// Changes a row.
    fn draw(&self, row: &mut PictureRow<'_>);
}

/// A row of an image, with the depths of all of it.
pub(in crate::render) struct PictureRow<'a> {
    pub(in crate::render) level: Level,
    pub(in crate::render) y: usize,
    pub(in crate::render) size_px: [usize; 2],
    /// The fourth byte is the fraction of the background that a pixel hides until [`Stage::Drawn`] is done, and unused
    /// afterwards.
    pub(in crate::render) pixels: &'a mut [[u8; 4]],
    /// Reversed depths of the image; 0 where it is empty.
    pub(in crate::render) depths: &'a [f32],
}
