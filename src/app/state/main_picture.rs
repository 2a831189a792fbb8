//! The image of the open sequence, and its renderer.

use crate::app::drawing::Drawing;
use crate::scene::{Choice, RendererChoice};
use crate::sequence::Paint;

/// Drawing state of the open sequence.
#[derive(Debug, Default)]
pub(in crate::app) struct MainPicture {
    pub(in crate::app) drawing: Drawing,
    /// Renderer choice in effect when the GPU device was lost: the CPU draws until a renderer is chosen again.
    pub(in crate::app) without_gpu: Option<Choice<RendererChoice>>,
    /// Paint source of the drawn frame when last checked, as displayed by the panels.
    pub(in crate::app) painted_with: Option<Paint>,
}

impl MainPicture {
    /// Takes note of the renderer choice: the GPU may draw again once a renderer has been chosen again.
    pub(in crate::app) fn note_choice(&mut self, chosen: Choice<RendererChoice>) {
        self.without_gpu.take_if(|before| *before != chosen);
    }

    /// Returns the effective renderer for the user's choice `chosen`.
    pub(in crate::app) fn renderer(&self, chosen: Choice<RendererChoice>) -> Choice<RendererChoice> {
        if self.without_gpu == Some(chosen) {
            RendererChoice::Cpu.into()
        } else {
            chosen
        }
    }
}
