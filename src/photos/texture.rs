//! A picture with all its mip levels, each half as large as the one before.
//!
//! A texel is the mean of four of the level before, in display values and weighted by their alpha: what is masked out
//! does not bleed into what is shown. An edge of an odd number of texels is halved downwards, and its last texel is
//! the mean of three.

use rayon::prelude::*;

/// Red, green, blue and alpha, display-referred.
pub type Texel = [u8; 4];

/// One level, line by line from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Level {
    /// Width and height.
    pub size: [u32; 2],
    /// As many texels.
    pub texels: Vec<Texel>,
}

/// A picture with all its mip levels, finest first, down to a single texel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texture {
    levels: Vec<Level>,
}

impl Texture {
    /// The picture with its levels; `None` where there are not as many texels as it has pixels, or none.
    pub fn new(size: [u32; 2], texels: Vec<Texel>) -> Option<Self> {
        let count = u64::from(size[0]) * u64::from(size[1]);
        if count == 0 || count != texels.len() as u64 {
            return None;
        }
        let mut levels = vec![Level { size, texels }];
        while let Some(last) = levels.last().filter(|last| last.size != [1, 1]) {
            levels.push(last.halved());
        }
        Some(Self { levels })
    }

    /// All levels, finest first; at least one.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The picture itself.
    pub fn finest(&self) -> &Level {
        &self.levels[0]
    }

    /// The colour at a place, in texels of the finest level from its upper left corner, as level `lod` has it: between
    /// texels and levels. Red, green and blue times alpha, and alpha, 0 to 1. Beyond the border it is that of the
    /// border.
    #[inline(always)]
    pub fn between_texels(&self, place: [f32; 2], lod: f32) -> [f32; 4] {
        let coarsest = self.levels.len() - 1;
        let lod = if lod.is_finite() { lod.max(0.0) } else { coarsest as f32 };
        let finer = (lod as usize).min(coarsest);
        let share = (lod - finer as f32).min(1.0);
        let finest = self.finest().size;
        let fine = self.levels[finer].between_texels(finest, place);
        if share == 0.0 || finer == coarsest {
            return fine;
        }
        let coarse = self.levels[finer + 1].between_texels(finest, place);
        std::array::from_fn(|channel| fine[channel] + share * (coarse[channel] - fine[channel]))
    }

    /// Bytes of its texels.
    pub fn byte_size(&self) -> usize {
        self.levels
            .iter()
            .map(|level| size_of_val(level.texels.as_slice()))
            .sum()
    }
}

impl Level {
    /// Between the four texels around a place that is told in texels of `finest`.
    #[inline(always)]
    fn between_texels(&self, finest: [u32; 2], place: [f32; 2]) -> [f32; 4] {
        let [(left, right, across), (top, bottom, down)] = [0, 1].map(|axis| {
            let edge = self.size[axis];
            let at = place[axis] * (edge as f32 / finest[axis] as f32) - 0.5;
            let at = at.clamp(0.0, edge as f32 - 1.0);
            let before = at as usize;
            (before, (before + 1).min(edge as usize - 1), at - before as f32)
        });
        let width = self.size[0] as usize;
        let texel = |column: usize, row: usize| self.texels[width * row + column];
        let corners = [
            (texel(left, top), (1.0 - across) * (1.0 - down)),
            (texel(right, top), across * (1.0 - down)),
            (texel(left, bottom), (1.0 - across) * down),
            (texel(right, bottom), across * down),
        ];
        let mut sum = [0.0; 4];
        for ([red, green, blue, alpha], weight) in corners {
            let alpha = weight * (1.0 / 255.0) * f32::from(alpha);
            let color = alpha * (1.0 / 255.0);
            sum[0] += color * f32::from(red);
            sum[1] += color * f32::from(green);
            sum[2] += color * f32::from(blue);
            sum[3] += alpha;
        }
        sum
    }

    fn halved(&self) -> Self {
        let size = self.size.map(|edge| (edge / 2).max(1));
        let [width, height] = size.map(|edge| edge as usize);
        let mut texels = vec![[0; 4]; width * height];
        texels.par_chunks_mut(width).enumerate().for_each(|(row, texels)| {
            let rows = halves(self.size[1] as usize, height, row);
            for (column, texel) in texels.iter_mut().enumerate() {
                let columns = halves(self.size[0] as usize, width, column);
                *texel = self.mean(columns, rows.clone());
            }
        });
        Self { size, texels }
    }

    /// The mean of a rectangle of texels. Precondition: it has some.
    fn mean(&self, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> Texel {
        let width = self.size[0] as usize;
        let mut sums = [0_u32; 3];
        let (mut alphas, mut count) = (0_u32, 0_u32);
        for row in rows {
            for texel in &self.texels[width * row..][columns.clone()] {
                let alpha = u32::from(texel[3]);
                for (sum, &channel) in sums.iter_mut().zip(texel) {
                    *sum += alpha * u32::from(channel);
                }
                alphas += alpha;
                count += 1;
            }
        }
        if alphas == 0 {
            return [0; 4];
        }
        let [red, green, blue] = sums.map(|sum| ((sum + alphas / 2) / alphas) as u8);
        [red, green, blue, ((alphas + count / 2) / count) as u8]
    }
}

/// The texels of an edge of `from` that become texel `at` of one of `to`.
fn halves(from: usize, to: usize, at: usize) -> std::ops::Range<usize> {
    if at + 1 == to { 2 * at..from } else { 2 * at..2 * at + 2 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_halved_down_to_a_single_texel() {
        let texture = Texture::new([5, 2], vec![[10, 20, 30, 255]; 10]).unwrap();
        let sizes: Vec<[u32; 2]> = texture.levels().iter().map(|level| level.size).collect();
        assert_eq!(sizes, [[5, 2], [2, 1], [1, 1]]);
        assert!(
            texture
                .levels()
                .iter()
                .all(|level| level.texels.iter().all(|&texel| texel == [10, 20, 30, 255]))
        );
        assert_eq!(texture.byte_size(), 4 * (10 + 2 + 1));
    }

    #[test]
    fn what_is_masked_out_does_not_bleed() {
        let [white, nothing] = [[255, 255, 255, 255], [0, 0, 0, 0]];
        let texture = Texture::new([2, 2], vec![white, nothing, nothing, nothing]).unwrap();
        assert_eq!(texture.levels()[1].texels, [[255, 255, 255, 64]]);
        let empty = Texture::new([2, 1], vec![nothing; 2]).unwrap();
        assert_eq!(empty.levels()[1].texels, [nothing]);
    }

    #[test]
    fn the_last_texel_of_an_odd_edge_is_the_mean_of_three() {
        let grey = |value: u8| [value, value, value, 255];
        let texture = Texture::new([5, 1], [0, 10, 40, 50, 60].map(grey).to_vec()).unwrap();
        assert_eq!(texture.levels()[1].texels, [grey(5), grey(50)]);
    }

    #[test]
    fn pictures_without_pixels_are_none() {
        assert_eq!(Texture::new([0, 3], Vec::new()), None);
        assert_eq!(Texture::new([2, 2], vec![[0; 4]; 3]), None);
    }
}
