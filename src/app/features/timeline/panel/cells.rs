//! Layout of the frames on the timeline in the window.

use egui::Rect;
use std::ops::Range;

/// Cells of equal width for frames, from the left to the right of a rectangle.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    pub(super) rect: Rect,
    /// The frames that are shown.
    pub(super) frames: Range<usize>,
}

impl Cells {
    /// The left edge of a frame, which is the right one of that before it; of frames that are not shown beyond the
    /// edges.
    pub(super) fn x(&self, frame: usize) -> f32 {
        let from_first = frame as f32 - self.frames.start as f32;
        self.rect.left() + from_first * self.width()
    }

    /// Returns the horizontal position of a frame, clamped to the edges.
    pub(super) fn x_within(&self, frame: usize) -> f32 {
        self.x(frame).clamp(self.rect.left(), self.rect.right())
    }

    /// Returns the width of a cell.
    pub(super) fn width(&self) -> f32 {
        self.rect.width() / self.frames.len().max(1) as f32
    }

    /// Returns the position of `x` from the left, as a fraction of the width.
    pub(super) fn share(&self, x: f32) -> f32 {
        ((x - self.rect.left()) / self.rect.width().max(1.0)).clamp(0.0, 1.0)
    }

    /// The frame whose cell is at `x`.
    pub(super) fn frame_at(&self, x: f32) -> usize {
        let cell = (self.share(x) * self.frames.len() as f32) as usize;
        (self.frames.start + cell).min(self.frames.end.saturating_sub(1))
    }

    /// The edge that is nearest to `x`: that on the left of a frame.
    pub(super) fn edge_at(&self, x: f32) -> usize {
        self.frames.start + (self.share(x) * self.frames.len() as f32).round() as usize
    }
}
