//! Structural similarity: how much of the luminance, contrast and structure of an image another one preserves.
//!
//! How it works (Wang, Bovik, Sheikh, Simoncelli: *Image Quality Assessment: From Error Visibility to Structural
//! Similarity*, IEEE TIP 2004, §III): means, variances and covariance of both images under a Gaussian window of 11×11
//! pixels give one number per window; the measure is their mean. As in the authors' `ssim_index.m`, only windows that
//! lie wholly inside the image count (nothing is made up beyond its border), and the image is not downscaled first.
//!
//! The window is a product of two rows of weights, so each row of answers adds up eleven rows of pixels once, and then
//! eleven of these sums for each answer. All sums are f64: variances are small differences of large means of squares.
//!
//! When it wins: over mean squares, which see no difference between noise and a slight change of brightness.

use super::{SizeMismatch, check_sizes, size_px};
use image::RgbaImage;
use rayon::prelude::*;
use std::array::from_fn;

/// Edge of the window, and so of the smallest image that has one.
pub const SSIM_WINDOW_PX: u32 = 11;

const WINDOW: usize = SSIM_WINDOW_PX as usize;

/// Standard deviation of the window's Gaussian, pixels.
// `image-compare` 0.5 uses separate 8×8 squares without Gaussian weights, and sums, not variances: its results are not
// the published ones, except for flat images.
const SIGMA_PX: f64 = 1.5;

/// (K1 L)² and (K2 L)² of the paper, with K1 = 0.01, K2 = 0.03 and L = 255: they keep quotients of dark or flat windows
/// defined.
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// Weights of red, green and blue in luma (ITU-R BT.601), as in `MATLAB`'s `rgb2gray`, which published figures come
/// from.
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

/// Reasons why two images have no structural similarity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SsimError {
    /// They differ in size.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// No window fits in.
    #[error(
        "a picture of {}x{} pixels has no window of {SSIM_WINDOW_PX}x{SSIM_WINDOW_PX}",
        size_px[0], size_px[1]
    )]
    TooSmall {
        /// Width and height of both.
        size_px: [u32; 2],
    },
}

/// The mean structural similarity of two images, −1 to 1 (equal).
///
/// Compared is luma, 0.299 R + 0.587 G + 0.114 B of the values as they are stored (display-referred, not rounded to
/// whole steps). Alpha is ignored. The same bits for any number of threads.
pub fn ssim(reference: &RgbaImage, test: &RgbaImage) -> Result<f64, SsimError> {
    let size_px = size_px(reference);
    check_sizes(size_px, self::size_px(test))?;
    if size_px.iter().any(|&edge| edge < SSIM_WINDOW_PX) {
        return Err(SsimError::TooSmall { size_px });
    }
    let width = reference.width() as usize;
    let pixels: Vec<[f64; 2]> = luma(reference).zip(luma(test)).map(<[f64; 2]>::from).collect();
    let weights = weights();
    let [columns, rows] = size_px.map(|edge| edge as usize + 1 - WINDOW);
    // One sum per row, added up in order.
    let sums: Vec<f64> = (0..rows)
        .into_par_iter()
        .map(|row| sum_of_row(&pixels[row * width..][..WINDOW * width], width, &weights))
        .collect();
    Ok(sums.iter().sum::<f64>() / (columns * rows) as f64)
}

fn luma(image: &RgbaImage) -> impl Iterator<Item = f64> {
    image
        .pixels()
        .map(|pixel| (0..3).map(|channel| LUMA[channel] * f64::from(pixel[channel])).sum())
}

/// The Gaussian along one axis; its weights add up to 1.
fn weights() -> [f64; WINDOW] {
    let raw: [f64; WINDOW] = from_fn(|place| {
        let offset = place as f64 - (WINDOW / 2) as f64;
        (-0.5 * (offset / SIGMA_PX).powi(2)).exp()
    });
    let sum: f64 = raw.iter().sum();
    raw.map(|weight| weight / sum)
}

/// Sums the similarities of all windows in eleven rows of pixels (reference and test next to each other).
fn sum_of_row(rows: &[[f64; 2]], width: usize, weights: &[f64; WINDOW]) -> f64 {
    // The weighted sums of x, y, x², y² and x y for each column.
    let mut columns = vec![[0.0; 5]; width];
    for (row, &weight) in rows.chunks_exact(width).zip(weights) {
        for (sums, &[x, y]) in columns.iter_mut().zip(row) {
            for (sum, moment) in sums.iter_mut().zip([x, y, x * x, y * y, x * y]) {
                *sum += weight * moment;
            }
        }
    }
    columns
        .windows(WINDOW)
        .map(|window| {
            let mut moments = [0.0; 5];
            for (column, &weight) in window.iter().zip(weights) {
                for (moment, sum) in moments.iter_mut().zip(column) {
                    *moment += weight * sum;
                }
            }
            similarity(moments)
        })
        .sum()
}

/// Equation 13 of the paper, from the means of x, y, x², y² and x y.
fn similarity([x, y, xx, yy, xy]: [f64; 5]) -> f64 {
    let [variance_x, variance_y, covariance] = [xx - x * x, yy - y * y, xy - x * y];
    (2.0 * (x * y) + C1) * (2.0 * covariance + C2) / ((x * x + y * y + C1) * (variance_x + variance_y + C2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgba;
    use proptest::prelude::*;

    fn gray(size: [u32; 2], value: impl Fn(u32, u32) -> u8) -> RgbaImage {
        RgbaImage::from_fn(size[0], size[1], |x, y| {
            let value = value(x, y);
            Rgba([value, value, value, 255])
        })
    }

    fn waves(x: u32, y: u32) -> u8 {
        (x * x * 7 + y * 31 + x * y) as u8
    }

    /// The definition, word by word: for every window its weights in two dimensions, means, and sums of deviations.
    fn by_definition(reference: &RgbaImage, test: &RgbaImage) -> f64 {
        let gauss = |d: i32| (-f64::from(d * d) / (2.0 * 1.5 * 1.5)).exp();
        let value = |image: &RgbaImage, x: i32, y: i32| {
            let [r, g, b, _] = image.get_pixel(x as u32, y as u32).0.map(f64::from);
            0.299 * r + 0.587 * g + 0.114 * b
        };
        let (c1, c2) = (6.502_5, 58.522_5);
        let (mut sum, mut count) = (0.0, 0);
        for center_y in 5..reference.height() as i32 - 5 {
            for center_x in 5..reference.width() as i32 - 5 {
                let mut window = Vec::new();
                for dy in -5..=5 {
                    for dx in -5..=5 {
                        let [x, y] = [center_x + dx, center_y + dy];
                        let weight = gauss(dx) * gauss(dy);
                        window.push((weight, value(reference, x, y), value(test, x, y)));
                    }
                }
                let total: f64 = window.iter().map(|entry| entry.0).sum();
                let mean =
                    |of: &dyn Fn(f64, f64) -> f64| window.iter().map(|&(w, x, y)| w * of(x, y)).sum::<f64>() / total;
                let [mx, my] = [mean(&|x, _| x), mean(&|_, y| y)];
                let vx = mean(&|x, _| (x - mx).powi(2));
                let vy = mean(&|_, y| (y - my).powi(2));
                let cov = mean(&|x, y| (x - mx) * (y - my));
                sum += (2.0 * mx * my + c1) * (2.0 * cov + c2) / ((mx.powi(2) + my.powi(2) + c1) * (vx + vy + c2));
                count += 1;
            }
        }
        sum / f64::from(count)
    }

    #[test]
    fn equal_images_are_exactly_1() {
        for size in [[11, 11], [37, 20]] {
            let image = gray(size, waves);
            assert_eq!(ssim(&image, &image), Ok(1.0));
        }
    }

    #[test]
    fn flat_images_match_the_closed_form() {
        for [a, b] in [[0u8, 255], [100, 120], [0, 0], [254, 255]] {
            let found = ssim(&gray([16, 13], |_, _| a), &gray([16, 13], |_, _| b)).unwrap();
            let [a, b] = [a, b].map(f64::from);
            let expected = (2.0 * a * b + 6.5025) / (a * a + b * b + 6.5025);
            assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
        }
    }

    #[test]
    fn a_negative_is_dissimilar_and_alpha_is_ignored() {
        let image = gray([32, 32], waves);
        let mut negative = image.clone();
        for pixel in negative.pixels_mut() {
            *pixel = Rgba([255 - pixel[0], 255 - pixel[1], 255 - pixel[2], 255]);
        }
        assert!(ssim(&image, &negative).unwrap() < -0.5);
        let mut clear = image.clone();
        clear.pixels_mut().for_each(|pixel| pixel[3] = 0);
        assert_eq!(ssim(&image, &clear), Ok(1.0));
    }

    #[test]
    fn a_brightness_shift_is_more_similar_than_noise_of_equal_mse() {
        let image = gray([48, 48], |x, y| (60 + x + 2 * y) as u8);
        let brighter = gray([48, 48], |x, y| (68 + x + 2 * y) as u8);
        let noisy = gray([48, 48], |x, y| {
            let value = 60 + x + 2 * y;
            (if (x + y) % 2 == 0 { value + 8 } else { value - 8 }) as u8
        });
        assert!(ssim(&image, &brighter).unwrap() > 0.98);
        assert!(ssim(&image, &noisy).unwrap() < 0.9);
    }

    #[test]
    fn incomparable_images_are_reported() {
        let error = ssim(&RgbaImage::new(20, 10), &RgbaImage::new(20, 10)).unwrap_err();
        assert_eq!(error, SsimError::TooSmall { size_px: [20, 10] });
        assert_eq!(error.to_string(), "a picture of 20x10 pixels has no window of 11x11");
        let error = ssim(&RgbaImage::new(20, 12), &RgbaImage::new(20, 13)).unwrap_err();
        assert!(matches!(error, SsimError::Size(_)), "{error}");
    }

    #[test]
    fn results_do_not_depend_on_thread_count() {
        let [reference, test] = [gray([90, 70], waves), gray([90, 70], |x, y| waves(y, x))];
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let alone = pool.unwrap().install(|| ssim(&reference, &test));
        assert_eq!(ssim(&reference, &test), alone);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn random_images_match_the_definition(
            size in prop::array::uniform2(11u32..22),
            bytes in prop::collection::vec(any::<[u8; 2]>(), 4 * 21 * 21),
        ) {
            let picture = |which: usize| {
                let taken = bytes.iter().take(4 * (size[0] * size[1]) as usize);
                let raw: Vec<u8> = taken.map(|pair| pair[which]).collect();
                RgbaImage::from_raw(size[0], size[1], raw).unwrap()
            };
            let [reference, test] = [picture(0), picture(1)];
            let found = ssim(&reference, &test).unwrap();
            let expected = by_definition(&reference, &test);
            prop_assert!((found - expected).abs() < 1e-11, "{found} for {expected}");
        }
    }
}
