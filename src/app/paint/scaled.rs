//! Images that are enlarged or reduced linearly: a 3-D image drawn at a lower resolution, thumbnails.
//!
//! **How it works.** A row of texels is first mixed along the row, for all columns of the window, and cached until
//! another one is needed: an enlarged image has fewer rows than the window, so this is done less often than there are
//! pixels. Then two such rows are mixed, without texel lookups, in whole registers. Channels are numbers of 16 bits, 64
//! steps to a unit: both roundings together are a 64th of one.

use super::PixelRect;
use super::blend::{OPAQUE, over, times};
use super::canvas::Canvas;
use super::pieces::TexturePlacement;
use super::textures::{BetweenTexels, SampledTexture, Texels, swizzled};

/// Bits of a channel after its point.
const FRACTION: u32 = 6;

/// Bits of a share.
const SHARE: u32 = 15;

/// Two texels along an axis and the share of the second.
#[derive(Debug, Clone, Copy)]
struct Between {
    first: usize,
    second: usize,
    share: i16,
}

/// The columns of the window in texels.
struct Columns {
    between: Vec<Between>,
    /// Weight of the second texel of each column, for each of its channels.
    shares: Vec<i16>,
    /// Texels left and right of each column.
    first: Vec<u32>,
    second: Vec<u32>,
}

/// A row of texels mixed for the columns of the window.
struct TexelRow {
    index: usize,
    channels: Vec<i16>,
}

/// Paints `area` with the source at `place`.
#[inline(always)]
pub(super) fn paint(
    source: &SampledTexture<'_>,
    place: &TexturePlacement,
    tint: u32,
    area: &PixelRect,
    canvas: &mut Canvas<'_>,
) {
    let mut columns = Columns::new(source, place, area);
    let count = columns.between.len();
    let row = || TexelRow {
        index: usize::MAX,
        channels: vec![0; 4 * count],
    };
    let (mut upper, mut lower) = (row(), row());
    let mut mixed = vec![0_u32; count];
    for (y, pixels) in (area.min[1]..).zip(canvas.spans(area)) {
        let at = between(source, place, 1, y);
        if upper.index != at.first {
            // When magnified, the lower row becomes the upper one some rows later.
            std::mem::swap(&mut upper, &mut lower);
        }
        upper.load(at.first, source, &mut columns);
        lower.load(at.second, source, &mut columns);
        let channels: &mut [u8] = bytemuck::cast_slice_mut(&mut mixed);
        let rows = upper.channels.iter().zip(&lower.channels);
        for (channel, (&upper, &lower)) in channels.iter_mut().zip(rows) {
            let exact = mix(upper, lower, at.share);
            *channel = ((exact + (1 << (FRACTION - 1))) >> FRACTION) as u8;
        }
        if tint != u32::MAX {
            for (pixel, &texel) in pixels.iter_mut().zip(&mixed) {
                *pixel = over(times(texel, tint), *pixel);
            }
        } else if source.is_opaque() {
            for (pixel, &texel) in pixels.iter_mut().zip(&mixed) {
                *pixel = texel & !OPAQUE;
            }
        } else {
            for (pixel, &texel) in pixels.iter_mut().zip(&mixed) {
                *pixel = over(texel, *pixel);
            }
        }
    }
}

fn between(source: &SampledTexture<'_>, place: &TexturePlacement, axis: usize, pixel: u32) -> Between {
    let at = place.texel_at(axis, pixel, source.size[axis]);
    let BetweenTexels { first, second, share } = source.between(axis, at);
    Between {
        first,
        second,
        share: (share * f32::from(i16::MAX)).round_ties_even() as i16,
    }
}

impl Columns {
    fn new(source: &SampledTexture<'_>, place: &TexturePlacement, area: &PixelRect) -> Self {
        let columns = area.min[0]..area.max[0];
        let between: Vec<Between> = columns.map(|x| between(source, place, 0, x)).collect();
        let count = between.len();
        Self {
            shares: between.iter().flat_map(|at| [at.share; 4]).collect(),
            first: vec![0; count],
            second: vec![0; count],
            between,
        }
    }

    /// Takes the texels of a row.
    #[inline(always)]
    fn gather(&mut self, texel: impl Fn(usize) -> u32) {
        let both = self.first.iter_mut().zip(&mut self.second);
        for (at, (first, second)) in self.between.iter().zip(both) {
            *first = texel(at.first);
            *second = texel(at.second);
        }
    }
}

impl TexelRow {
    /// Computes it for another row of texels.
    #[inline(always)]
    fn load(&mut self, index: usize, source: &SampledTexture<'_>, columns: &mut Columns) {
        if self.index == index {
            return;
        }
        self.index = index;
        let begin = source.size[0] * index;
        let texels = begin..begin + source.size[0];
        match source.texels {
            Texels::Words(words) => {
                let row = &words[texels];
                columns.gather(|x| row[x]);
            }
            Texels::Picture(pixels) => {
                let row = &pixels[texels];
                columns.gather(|x| swizzled(row[x]) | OPAQUE);
            }
        }
        // All channels are treated alike, regardless of their order.
        let first: &[u8] = bytemuck::cast_slice(&columns.first);
        let second: &[u8] = bytemuck::cast_slice(&columns.second);
        let texels = first.iter().zip(second).zip(&columns.shares);
        for (channel, ((&first, &second), &share)) in self.channels.iter_mut().zip(texels) {
            let (first, second) = (i16::from(first), i16::from(second));
            *channel = mix(first << FRACTION, second << FRACTION, share);
        }
    }
}

#[inline(always)]
fn mix(a: i16, b: i16, share: i16) -> i16 {
    let way = i32::from(b - a) * i32::from(share);
    a + ((way + (1 << (SHARE - 1))) >> SHARE) as i16
}
