//! The gradient on the CPU: tiles begin with it, and it shines through.

use crate::scene::{Background, ScenePacket};

/// The vertical gradient.
#[derive(Debug, Clone, Copy)]
pub(in crate::render) struct Gradient {
    background: Background,
    /// Shares of the whole image's height, at the top of the first row and a row's.
    first_row: f32,
    per_row: f32,
}

impl Gradient {
    pub(in crate::render) fn of(packet: &ScenePacket) -> Self {
        let [top, bottom] = packet.view.rows_of_whole;
        Self {
            background: packet.style.backdrop.background,
            first_row: top,
            per_row: (bottom - top) / packet.viewport_px[1] as f32,
        }
    }

    /// The colour of a row, 0 to 1.
    pub(in crate::render) fn at_row(&self, y: i32) -> [f32; 3] {
        let share = self.first_row + (y as f32 + 0.5) * self.per_row;
        let Background { top, bottom } = self.background;
        std::array::from_fn(|channel| {
            let [top, bottom] = [top, bottom].map(|color| f32::from(color[channel]) / 255.0);
            top * (1.0 - share) + bottom * share
        })
    }
}
