//! Overlays on exported images: the legend of their colours, and labels at points.
//!
//! How it works: an overlay knows the whole image and draws into one strip of it after the other, so that images of any
//! size can have it. It is as large relative to the image as in a window of 720 pixels. Where the background is
//! transparent it has its own alpha.

mod canvas;
mod labels;
mod legend;
mod text;

pub(super) use canvas::OverlayCanvas;
pub(super) use labels::PaintedLabels;
pub use labels::draw_labels;
pub(super) use legend::draw_legend;
