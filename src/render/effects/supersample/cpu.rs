//! Supersampling on the CPU (`shaders/effects/supersample.wgsl`).

use crate::scene::Antialiasing;
use image::RgbaImage;
use rayon::prelude::*;

/// Each pixel is the mean of those that were drawn for it, as they are displayed.
pub(super) fn average(drawn: &RgbaImage, shown: &mut RgbaImage) {
    let samples = Antialiasing::Supersample.samples_per_edge() as usize;
    let drawn_row_bytes = 4 * drawn.width() as usize;
    let row_bytes = 4 * shown.width() as usize;
    let count = (samples * samples) as u32;
    let rows = shown.par_chunks_exact_mut(row_bytes);
    rows.zip(drawn.par_chunks_exact(samples * drawn_row_bytes))
        .for_each(|(row, drawn_rows)| {
            for (x, pixel) in row.as_chunks_mut::<4>().0.iter_mut().enumerate() {
                let mut sums = [count / 2; 4];
                for drawn_row in drawn_rows.chunks_exact(drawn_row_bytes) {
                    let (pixels, _) = drawn_row.as_chunks::<4>();
                    for drawn in &pixels[samples * x..samples * (x + 1)] {
                        for (sum, &channel) in sums.iter_mut().zip(drawn) {
                            // Display-referred: averaging linear light would widen the bright sides of edges.
                            *sum += u32::from(channel);
                        }
                    }
                }
                *pixel = sums.map(|sum| (sum / count) as u8);
            }
        });
}
