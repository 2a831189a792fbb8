//! Filling of the holes that images leave, from their surroundings (Gortler et al. 1996, *The Lumigraph*, §3.5:
//! push–pull).
//!
//! How it works: the image samples of all pixels are stored separately from the rendered frame. Going up (pull), each
//! pixel of a level of half the size has the mean colour of its four, weighted by confidence, and has the confidence of
//! all of them together, at most 1. Going down (push), a pixel that is not fully confident takes the rest from the
//! level above, between whose pixels it lies. So a small hole has the colour of its edge, and a large one is smooth;
//! the work equals a third more pixels. Pixels that are not surface neither give nor take.

use super::PhotoAnswer;
use rayon::prelude::*;

/// Red, green and blue times how sure they are, and that, 0 to 1.
type Sure = [f32; 4];

/// An image of a level of the pyramid.
struct Level {
    size: [usize; 2],
    pixels: Vec<Sure>,
}

/// Fills pixels that no image sees with the colours around them. Precondition: `found` has `size_px` pixels, rows of
/// which follow each other. If no image sees anything, nothing changes.
pub(in crate::render::cpu) fn fill_holes(found: &mut [PhotoAnswer], size_px: [u32; 2]) {
    let is_hole = |found: &PhotoAnswer| *found == PhotoAnswer::Unseen;
    if !found.par_iter().any(is_hole) {
        return;
    }
    let size = size_px.map(|edge| edge as usize);
    let seen = found.par_iter().map(|found| match found {
        PhotoAnswer::Shown {
            color: [red, green, blue],
            ..
        } => [*red, *green, *blue, 1.0],
        PhotoAnswer::Unseen | PhotoAnswer::Clipped => [0.0; 4],
    });
    let mut levels = vec![Level {
        size,
        pixels: seen.collect(),
    }];
    while let Some(coarser) = levels.last().and_then(Level::coarser) {
        levels.push(coarser);
    }
    while let Some(coarser) = levels.pop() {
        if let Some(finer) = levels.last_mut() {
            finer.complete(&coarser);
        } else {
            let filled = found.par_iter_mut().zip(&coarser.pixels);
            filled.for_each(|(found, &[red, green, blue, sure])| {
                if is_hole(found) && sure > 0.0 {
                    *found = PhotoAnswer::Shown {
                        color: [red, green, blue].map(|channel| (channel / sure).min(1.0)),
                        normal: [0.0; 3],
                    };
                }
            });
        }
    }
}

impl Level {
    /// Half as wide and high; `None` of a single pixel.
    fn coarser(&self) -> Option<Self> {
        if self.size == [1, 1] {
            return None;
        }
        let size = self.size.map(|edge| edge.div_ceil(2));
        let mut pixels = vec![[0.0; 4]; size[0] * size[1]];
        pixels.par_chunks_mut(size[0]).enumerate().for_each(|(row, line)| {
            for (column, pixel) in line.iter_mut().enumerate() {
                let rows = 2 * row..(2 * row + 2).min(self.size[1]);
                let columns = 2 * column..(2 * column + 2).min(self.size[0]);
                let mut sum = [0.0; 4];
                for row in rows {
                    for finer in &self.pixels[self.size[0] * row..][columns.clone()] {
                        add(&mut sum, *finer, 1.0);
                    }
                }
                *pixel = sum.map(|value| value / sum[3].max(1.0));
            }
        });
        Some(Self { size, pixels })
    }

    /// Completes pixels that are not fully confident by interpolating between the pixels of `coarser`.
    fn complete(&mut self, coarser: &Self) {
        let [width, _] = self.size;
        self.pixels.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
            for (column, pixel) in line.iter_mut().enumerate() {
                let missing = 1.0 - pixel[3];
                if missing > 0.0 {
                    add(pixel, coarser.between([column, row]), missing);
                }
            }
        });
    }

    /// Interpolates at a pixel of the next finer level: its centre lies a quarter of a pixel from the centre of the one
    /// it is in, towards one on each axis.
    fn between(&self, finer: [usize; 2]) -> Sure {
        let [columns, rows] = [0, 1].map(|axis| {
            let own = finer[axis] / 2;
            let neighbor = if finer[axis].is_multiple_of(2) {
                own.saturating_sub(1)
            } else {
                own + 1
            };
            [(own, 0.75), (neighbor.min(self.size[axis] - 1), 0.25)]
        });
        let mut sum = [0.0; 4];
        for (row, down) in rows {
            for (column, across) in columns {
                add(&mut sum, self.pixels[self.size[0] * row + column], across * down);
            }
        }
        sum
    }
}

fn add(sum: &mut Sure, value: Sure, share: f32) {
    for (sum, value) in sum.iter_mut().zip(value) {
        *sum += share * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn shown(color: [f32; 3]) -> PhotoAnswer {
        PhotoAnswer::Shown {
            color,
            normal: [0.0, 0.0, 1.0],
        }
    }

    fn color(found: PhotoAnswer) -> [f32; 3] {
        match found {
            PhotoAnswer::Shown { color, .. } => color,
            PhotoAnswer::Unseen | PhotoAnswer::Clipped => panic!("{found:?} has no colour"),
        }
    }

    #[test]
    fn a_hole_has_the_colors_of_its_border() {
        // The left is red and the right green; two columns between them are unseen.
        let row = |column: usize| match column {
            0..7 => shown([1.0, 0.0, 0.0]),
            7..9 => PhotoAnswer::Unseen,
            _ => shown([0.0, 1.0, 0.0]),
        };
        let mut found: Vec<PhotoAnswer> = (0..16 * 16).map(|at| row(at % 16)).collect();
        let before = found.clone();
        fill_holes(&mut found, [16, 16]);
        for (at, (found, before)) in found.iter().zip(&before).enumerate() {
            if *before != PhotoAnswer::Unseen {
                assert_eq!(found, before);
                continue;
            }
            let [red, green, blue] = color(*found);
            assert!((red + green - 1.0).abs() < 1e-5 && blue == 0.0);
            assert!(
                if at % 16 == 7 { red > 0.5 } else { green > 0.5 },
                "{at}: {red} {green}"
            );
        }
    }

    #[test]
    fn clipped_pixels_are_neither_sources_nor_filled() {
        let mut found = vec![PhotoAnswer::Clipped; 30 * 7];
        found[3] = shown([0.25, 0.5, 0.75]);
        found[30 * 6 + 29] = PhotoAnswer::Unseen;
        fill_holes(&mut found, [30, 7]);
        let [red, green, blue] = color(found[30 * 6 + 29]);
        assert!((red - 0.25).abs() < 1e-5 && (green - 0.5).abs() < 1e-5 && (blue - 0.75).abs() < 1e-5);
        assert_eq!(
            found.iter().filter(|&&found| found == PhotoAnswer::Clipped).count(),
            30 * 7 - 2
        );
    }

    #[test]
    fn an_empty_image_is_unchanged() {
        for size in [[1, 1], [5, 3], [64, 1]] {
            let mut found = vec![PhotoAnswer::Unseen; (size[0] * size[1]) as usize];
            fill_holes(&mut found, size);
            assert!(found.iter().all(|found| *found == PhotoAnswer::Unseen));
        }
        fill_holes(&mut [], [0, 0]);
    }

    proptest! {
        /// Colours lie between the two, and all pixels that can be filled are.
        #[test]
        fn holes_have_colors_between_those_around(
            width in 1_u32..40,
            height in 1_u32..40,
            kinds in prop::collection::vec(0_u8..4, 40 * 40),
            values in prop::collection::vec(0.2_f32..0.7, 40 * 40),
        ) {
            let count = (width * height) as usize;
            let mut found: Vec<PhotoAnswer> = kinds[..count].iter().zip(&values).map(|(kind, &value)| match kind {
                0 => PhotoAnswer::Clipped,
                1 => shown([value, 0.9 - value, 0.5]),
                _ => PhotoAnswer::Unseen,
            }).collect();
            let before = found.clone();
            fill_holes(&mut found, [width, height]);
            let is_seen = |found: &PhotoAnswer| matches!(found, PhotoAnswer::Shown { .. });
            let sees = before.iter().any(is_seen);
            for (found, before) in found.iter().zip(&before) {
                prop_assert_eq!(is_seen(found), is_seen(before) || sees && *before == PhotoAnswer::Unseen);
                if let PhotoAnswer::Shown { color: [red, green, blue], .. } = found {
                    prop_assert!((0.199..0.701).contains(red) && (red + green - 0.9).abs() < 1e-3);
                    prop_assert!((blue - 0.5).abs() < 1e-3);
                }
            }
            let mut again = before;
            rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap()
                .install(|| fill_holes(&mut again, [width, height]));
            prop_assert_eq!(found, again);
        }
    }
}
