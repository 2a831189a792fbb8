//! Images for the tests of filters, here and on the GPU.

use crate::rgbd::{Bilateral, DepthImage};

/// Numbers from 0 to 1 without any order, the same every time.
pub(crate) fn random(at: u32) -> f32 {
    let mut bits = at.wrapping_mul(0x9E37_79B9) ^ 0x85EB_CA6B;
    for shift in [15, 13, 16] {
        bits = (bits ^ bits >> shift).wrapping_mul(0x2C1B_3C6D);
    }
    (bits >> 8) as f32 / (1 << 24) as f32
}

/// Depths from 0.5 to 2.5 m, each near one of a few surfaces, and this share of holes.
pub(super) fn noise([width, height]: [u32; 2], hole_share: f32) -> DepthImage {
    let depth = |at: u32| {
        if random(3 * at + 1) < hole_share {
            return 0.0;
        }
        let surface = 0.5 + ((at % width) / 11) as f32 * 0.3 % 2.0;
        surface + 0.02 * random(3 * at) + if random(3 * at + 2) < 0.05 { 0.4 } else { 0.0 }
    };
    DepthImage::new([width, height], (0..width * height).map(depth).collect()).unwrap()
}

/// One depth, and holes of one pixel, of many, and at the border.
pub(super) fn plane_with_holes([width, height]: [u32; 2], depth_m: f32) -> DepthImage {
    let is_hole = |x: u32, y: u32| {
        let is_block = (10..17).contains(&x) && (5..14).contains(&y);
        is_block || (x * 7 + y * 13).is_multiple_of(31) || x + y < 6 || x == width - 1
    };
    let metres = (0..height).flat_map(|y| (0..width).map(move |x| if is_hole(x, y) { 0.0 } else { depth_m }));
    DepthImage::new([width, height], metres.collect()).unwrap()
}

/// Computes the bilateral filter [`Bilateral`] by its definition (Hofer et al. 2018, Eq. 3), in double precision.
pub(crate) fn bilateral_by_definition(depth: &DepthImage, bilateral: &Bilateral) -> Vec<f64> {
    let (width, height) = (depth.width() as isize, depth.height() as isize);
    let pixel = |x: isize, y: isize| {
        let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
        let z = f64::from(if is_inside {
            depth.metres()[(y * width + x) as usize]
        } else {
            0.0
        });
        (z > 0.0).then_some(z)
    };
    let space = f64::from(bilateral.space_px);
    let mean = |x: isize, y: isize| {
        let Some(center) = pixel(x, y) else { return 0.0 };
        let sigma = match bilateral.depth_m {
            Some(sigma) => f64::from(sigma),
            None => f64::from(bilateral.noise_factor) * (0.0012 + 0.0019 * (center - 0.4).powi(2)),
        };
        let (mut weights, mut sum) = (0.0, 0.0);
        for (dx, dy) in (-4..=4).flat_map(|dy| (-4..=4).map(move |dx| (dx, dy))) {
            let Some(z) = pixel(x + dx, y + dy) else { continue };
            let by_depth = -(z - center).powi(2) / (2.0 * sigma * sigma);
            let by_space = -((dx * dx + dy * dy) as f64) / (2.0 * space * space);
            let weight = by_depth.exp() * by_space.exp();
            weights += weight;
            sum += weight * z;
        }
        sum / weights
    };
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| mean(x, y))
        .collect()
}
