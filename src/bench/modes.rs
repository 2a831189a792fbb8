//! Selection of the render modes to compare, in the words of the command line.
//!
//! Words of one group are alternatives, groups must all be met: renderer (cpu, gpu), primitive (surfel, mesh, voxel,
//! point, or surfels of one splatting mode), and how instances reach the GPU (storage, uniform …). A group without
//! words is not a condition.

use crate::scene::{Primitive, RendererChoice, Splatting, Strategy, Style};
use std::str::FromStr;

/// Selection of render modes; the default is all.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct Modes {
    renderers: Vec<RendererChoice>,
    primitives: Vec<Primitive>,
    splattings: Vec<Splatting>,
    strategies: Vec<Strategy>,
}

/// Parse error for a word that names no render mode.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is not a mode: expected cpu, gpu, a primitive (surfel, mesh, voxel, point), a splatting mode (regular, \
     two-pass-enlarged …) or an instancing strategy (storage, vertex …), separated by commas"
)]
pub struct ParseModeError(String);

impl Modes {
    /// All modes of one renderer.
    pub fn of_renderer(renderer: RendererChoice) -> Self {
        Self {
            renderers: vec![renderer],
            ..Self::default()
        }
    }

    /// Returns true if `style`, which names the renderer, is among the selected modes.
    pub fn admit(&self, style: &Style) -> bool {
        let is_gpu = style.drawing.renderer == RendererChoice::Gpu;
        let is_surfel = style.draws_surfels();
        let primitive = style.primitive;
        let any_what = self.primitives.is_empty() && self.splattings.is_empty();
        let what = if is_surfel && !self.splattings.is_empty() {
            self.splattings.contains(&style.surfels.splatting)
        } else {
            any_what || self.primitives.contains(&primitive)
        };
        let how = self.strategies.is_empty() || is_gpu && self.strategies.contains(&style.drawing.strategy);
        let who = self.renderers.is_empty() || self.renderers.contains(&style.drawing.renderer);
        who && what && how
    }
}

impl FromStr for Modes {
    type Err = ParseModeError;

    /// Reads words with commas between them.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut modes = Self::default();
        for word in text.split(',').map(str::trim) {
            if let Ok(renderer) = word.parse::<RendererChoice>() {
                modes.renderers.push(renderer);
            } else if let Ok(primitive) = word.parse::<Primitive>() {
                modes.primitives.push(primitive);
            } else if let Ok(splatting) = word.parse::<Splatting>() {
                modes.splattings.push(splatting);
            } else if let Ok(strategy) = word.parse::<Strategy>() {
                modes.strategies.push(strategy);
            } else {
                return Err(ParseModeError(word.to_owned()));
            }
        }
        Ok(modes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_a_group_are_alternatives_and_groups_are_conditions() {
        let surfel = |renderer, splatting| {
            Style::default().with(|style| {
                style.surfels.splatting = splatting;
                style.drawing.renderer = renderer;
            })
        };
        let voxel = Style::default().with(|style| {
            style.primitive = Primitive::Voxel;
            style.drawing.renderer = RendererChoice::Cpu;
        });
        let (cpu, gpu) = (RendererChoice::Cpu, RendererChoice::Gpu);
        let admits = |text: &str, style: &Style| text.parse::<Modes>().unwrap().admit(style);
        assert!(Modes::default().admit(&voxel));
        assert!(admits("cpu", &voxel) && !admits("gpu", &voxel));
        // Surfels in one splatting mode, and voxels.
        let words = "cpu, two-pass,voxel";
        assert!(admits(words, &voxel) && admits(words, &surfel(cpu, Splatting::TwoPass)));
        assert!(!admits(words, &surfel(cpu, Splatting::Regular)));
        assert!(!admits(words, &surfel(gpu, Splatting::TwoPass)));
        // The CPU has no strategies.
        assert!(admits("storage", &surfel(gpu, Splatting::Regular)));
        assert!(!admits("vertex", &surfel(gpu, Splatting::Regular)));
        assert!(!admits("storage", &voxel));
    }

    #[test]
    fn unknown_modes_are_reported() {
        for wrong in ["auto", "", "cpu,", "disks of surfels"] {
            let error = wrong.parse::<Modes>().unwrap_err().to_string();
            assert!(error.contains("is not a mode: expected cpu, gpu"), "{error}");
        }
    }
}
