//! Mip levels of images: halves, and halves of these down to a pixel.
//!
//! *How it works.* A pixel of the half is the mean of the pixels it covers, each colour weighted by its alpha, so that
//! anything beyond a silhouette does not bleed into it. An odd side of 2n + 1 becomes n pixels that cover 2 + 1/n each:
//! borders stay borders, and positions stay unchanged as fractions of the width. The mean is one of display values, as
//! the filters of GPUs see them; fine bright lines come out darker than a mean of light would make them.

use super::photo_image::{PhotoImage, WeightedColor};
use rayon::prelude::*;

/// Parts that a pixel of the half is made of, along one side: index and length of each.
type Covered = ([(usize, f32); 4], usize);

/// The image of half the width and height, rounded down, and at least a pixel.
pub fn halved(image: &PhotoImage) -> PhotoImage {
    let size_px = image.size_px().map(half);
    let [columns, rows] = size_px.map(|side| side as usize);
    let across = covered(image.size_px()[0] as usize, columns);
    let down = covered(image.size_px()[1] as usize, rows);
    let width = image.width();
    let mut pixels = vec![[0; 4]; columns * rows];
    pixels
        .par_chunks_exact_mut(columns)
        .zip(&down)
        .for_each(|(line, (down, down_count))| {
            for (pixel, (across, across_count)) in line.iter_mut().zip(&across) {
                let mut sum = WeightedColor::default();
                for &(row, height) in &down[..*down_count] {
                    for &(column, share) in &across[..*across_count] {
                        sum.add(image.pixels()[row * width + column], height * share);
                    }
                }
                *pixel = sum.rounded();
            }
        });
    PhotoImage::new(size_px, pixels).unwrap_or_else(|| image.clone())
}

/// The levels of a mipmap below the image itself: halves down to one pixel.
pub fn mips(image: &PhotoImage) -> Vec<PhotoImage> {
    let mut levels: Vec<PhotoImage> = Vec::new();
    loop {
        let last = levels.last().unwrap_or(image);
        if last.size_px() == [1, 1] {
            return levels;
        }
        let next = halved(last);
        levels.push(next);
    }
}

/// A side of the next level.
pub(in crate::photos) fn half(side: u32) -> u32 {
    (side / 2).max(1)
}

/// For each of `count` pixels the pixels of a side of `side` that it covers.
fn covered(side: usize, count: usize) -> Vec<Covered> {
    let length = side as f64 / count as f64;
    let of = |index: usize| {
        let (start, end) = (index as f64 * length, (index + 1) as f64 * length);
        let (mut parts, mut used) = ([(0, 0.0); 4], 0);
        let mut at = (start + 1e-9) as usize;
        while used < parts.len() && at < side && (at as f64) < end - 1e-9 {
            let share = end.min(at as f64 + 1.0) - start.max(at as f64);
            parts[used] = (at, share as f32);
            (used, at) = (used + 1, at + 1);
        }
        (parts, used)
    };
    (0..count).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn half_size_texels_are_means_of_four() {
        let image = PhotoImage::new(
            [2, 2],
            vec![[0, 0, 0, 255], [100, 0, 0, 255], [200, 40, 0, 255], [100, 0, 8, 255]],
        );
        assert_eq!(halved(&image.unwrap()).pixels(), [[100, 10, 2, 255]]);
    }

    #[test]
    fn transparent_texels_do_not_bleed() {
        let image = PhotoImage::new([2, 1], vec![[90, 80, 70, 255], [255, 255, 255, 0]]).unwrap();
        assert_eq!(halved(&image).pixels(), [[90, 80, 70, 128]]);
    }

    #[test]
    fn levels_end_at_one_pixel() {
        let image = PhotoImage::new([13, 4], vec![[9, 8, 7, 255]; 52]).unwrap();
        let sizes: Vec<_> = mips(&image).iter().map(PhotoImage::size_px).collect();
        assert_eq!(sizes, [[6, 2], [3, 1], [1, 1]]);
        assert_eq!(mips(&image)[2].pixels(), [[9, 8, 7, 255]]);
        assert!(mips(&PhotoImage::new([1, 1], vec![[0; 4]]).unwrap()).is_empty());
    }

    proptest! {
        /// Every pixel is covered by as much as any other, and by all of itself.
        #[test]
        fn odd_sizes_are_covered_evenly(side in 1_usize..200) {
            let count = (side / 2).max(1);
            let mut shares = vec![0.0; side];
            for (parts, used) in covered(side, count) {
                let length: f32 = parts[..used].iter().map(|part| part.1).sum();
                prop_assert!((length - side as f32 / count as f32).abs() < 1e-4);
                for &(at, share) in &parts[..used] {
                    shares[at] += share;
                }
            }
            prop_assert!(shares.iter().all(|share: &f32| (share - 1.0).abs() < 1e-4), "{:?}", shares);
        }
    }
}
