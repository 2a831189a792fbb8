//! View-dependent texturing of all pixels, with surfaces not seen in the input images filled from their surroundings
//! (push–pull: Gortler et al. 1996, *The Lumigraph*, §3.5; how it works: `render/cpu/photos/push_pull.rs`).
//!
//! A pass writes the sampled results; then there is a pass for each level of half the size, up to a single pixel, and
//! one for each level down again. Levels are textures of their own, since mip levels are rounded down, and a pass that
//! reads one level draws into another. Lighting is applied to the filled result.

use super::context::Context;
use super::textures::{texture, view};

/// Half floats: every adapter blends them, and images have 8 bits.
pub(super) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Textures of the view-dependent texturing results for one viewport size.
#[derive(Debug)]
pub(super) struct PhotoAnswers {
    /// Colours times their confidence, and the confidence: of the size of the image, and each of half the size of the
    /// one before.
    levels: Vec<wgpu::TextureView>,
    /// Normals, and the known data of the pixel.
    normals: wgpu::TextureView,
}

impl PhotoAnswers {
    pub(super) fn new(context: &Context, size_px: [u32; 2]) -> Self {
        let made = |label, size_px| {
            let none = wgpu::TextureUsages::empty();
            view(&texture(context, size_px, label, FORMAT, none))
        };
        Self {
            levels: level_sizes(size_px)
                .map(|size_px| made("colors of images", size_px))
                .collect(),
            normals: made("normals of images", size_px),
        }
    }

    /// The last one, of a single pixel.
    pub(super) fn coarsest(&self) -> usize {
        self.levels.len() - 1
    }

    /// The level of this number; finest first.
    pub(super) fn level(&self, level: usize) -> &wgpu::TextureView {
        &self.levels[level]
    }

    /// Colours and normals of the size of the image.
    pub(super) fn finest(&self) -> [&wgpu::TextureView; 2] {
        [&self.levels[0], &self.normals]
    }
}

/// Down to a single pixel, rounded up.
fn level_sizes(size_px: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    std::iter::successors(Some(size_px), |&size_px| {
        (size_px != [1, 1]).then(|| size_px.map(|edge| edge.div_ceil(2)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mip_levels_end_at_a_single_pixel() {
        let sizes = |size_px| level_sizes(size_px).collect::<Vec<_>>();
        assert_eq!(sizes([1, 1]), [[1, 1]]);
        assert_eq!(sizes([5, 2]), [[5, 2], [3, 1], [2, 1], [1, 1]]);
    }
}
