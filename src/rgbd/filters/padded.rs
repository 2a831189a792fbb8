//! A copy of an image with a border, so that windows need no tests at its edges, padded for whole registers.

use crate::rgbd::DepthImage;
use fearless_simd::{Simd, SimdBase, f32x8};
use rayon::prelude::*;

/// Pixels that are worked out together.
pub(super) const LANES: usize = 8;

/// See the module's text.
pub(super) struct Padded {
    values: Vec<f32>,
    stride: usize,
    border: usize,
}

impl Padded {
    /// `depth` with `border` more pixels around it, and `hole` there and where nothing was measured. Down 0 of
    /// [`Self::around`] is `border` rows above a pixel.
    pub(super) fn of(depth: &DepthImage, border: usize, hole: f32) -> Self {
        let (width, height) = (depth.width(), depth.height());
        let stride = width.next_multiple_of(LANES) + 2 * border;
        let mut values = vec![hole; stride * (height + 2 * border)];
        let lines = values.par_chunks_exact_mut(stride).skip(border);
        lines
            .zip(depth.metres().par_chunks_exact(width))
            .for_each(|(padded, line)| {
                for (padded, &depth) in padded[border..].iter_mut().zip(line) {
                    if depth > 0.0 {
                        *padded = depth;
                    }
                }
            });
        Self { values, stride, border }
    }

    /// Returns the neighbourhood of the eight pixels that begin at `column` of a row, in the row that is `down` rows
    /// further down: N pixels, the first as far to the left as the border is wide. Precondition: N is [`LANES`] and two
    /// borders.
    #[inline(always)]
    pub(super) fn around<const N: usize>(&self, [column, row]: [usize; 2], down: usize) -> &[f32; N] {
        debug_assert_eq!(N, LANES + 2 * self.border);
        let first = (row + down) * self.stride + column;
        self.values[first..].first_chunk().unwrap_or(&[0.0; N])
    }
}

/// Eight pixels of a row, from one of those that [`Padded::around`] gives.
#[inline(always)]
pub(super) fn load<S: Simd, const N: usize>(simd: S, around: &[f32; N], first: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &around[first..first + LANES])
}

/// A new image of the size of `depth`; `block` gives eight pixels of a row at a time, including those past the end of
/// the row.
#[inline(always)]
pub(super) fn by_blocks<S: Simd>(
    simd: S,
    depth: &DepthImage,
    block: impl Fn([usize; 2]) -> f32x8<S> + Sync,
) -> DepthImage {
    let width = depth.width();
    let mut metres = vec![0.0; depth.metres().len()];
    metres.par_chunks_exact_mut(width).enumerate().for_each(|(row, line)| {
        simd.vectorize(
            #[inline(always)]
            || {
                for (number, pixels) in line.chunks_mut(LANES).enumerate() {
                    let result = block([number * LANES, row]);
                    pixels.copy_from_slice(&result.as_slice()[..pixels.len()]);
                }
            },
        );
    });
    depth.with_metres(metres)
}
