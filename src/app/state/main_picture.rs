//! The picture of the open sequence, and who draws it.

use crate::app::drawing::Drawing;
use crate::scene::{Choice, RendererChoice};
use crate::sequence::Paint;

/// What is drawn of the open sequence.
#[derive(Debug, Default)]
pub(in crate::app) struct MainPicture {
    pub(in crate::app) drawing: Drawing,
    /// Who was chosen to draw when the graphics card's device was lost: the processor draws until that is chosen anew.
    pub(in crate::app) without_gpu: Option<Choice<RendererChoice>>,
    /// What the drawn frame was painted with when this was last looked at: the panels say it.
    pub(in crate::app) painted_with: Option<Paint>,
}

impl MainPicture {
    /// Takes notice of what is chosen: the graphics card may draw again once somebody has chosen anew.
    pub(in crate::app) fn note_choice(&mut self, chosen: Choice<RendererChoice>) {
        self.without_gpu.take_if(|before| *before != chosen);
    }

    /// Who draws where `chosen` is what a person chose.
    pub(in crate::app) fn renderer(&self, chosen: Choice<RendererChoice>) -> Choice<RendererChoice> {
        if self.without_gpu == Some(chosen) {
            RendererChoice::Cpu.into()
        } else {
            chosen
        }
    }
}
