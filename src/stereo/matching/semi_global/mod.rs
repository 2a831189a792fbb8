//! Semi-global matching: the sum of the costs of eight paths to each pixel.
//!
//! Hirschmüller (2008, section 2.3): a path gathers the costs of the pixels along it, and a penalty wherever it changes
//! its label, P1 for a change by one and P2 for more; P2 is less where brightness changes. Sums of eight paths (four
//! axes, both directions) come near the optimum of the whole image, where no line alone would.
//!
//! All sums at once would take two bytes per pixel and label: 640 MB for an image of 1.4 megapixels. Here only those of
//! a *band* of lines are stored, and are exact nonetheless. A first pass takes the three paths that lead down through
//! the image and stores their costs at the last line of each band. The second goes through the bands from the lowest:
//! each repeats its paths down from the stored costs, and goes on with those that lead up. Paths along lines belong to
//! a line alone. So three of eight paths are taken twice, and all sums stay in the caches. A band has about as many
//! lines as there are bands.
//!
//! Threads share lines by columns (paths down and up) or take whole lines (paths along them): sums are integers, so
//! their order changes nothing.

mod across;
mod along;
#[cfg(test)]
mod oracle;
mod penalties;
mod step;

pub use penalties::Penalties;

use super::costs::Costs;
use crate::stereo::GrayImage;
use crate::stereo::StereoError;
use across::{Across, Way};
use rayon::prelude::*;

/// Memory limit for the whole matching.
const MAX_BYTES: u64 = 2 << 30;

/// Sums the costs of eight paths and writes the result of `winners` for the sums of each line (pixel by pixel, label by
/// label; it may change them) to the line of `out`.
///
/// # Errors
/// [`StereoError::NoPenalties`], [`StereoError::TooLarge`].
pub(in crate::stereo) fn semi_global<T: Send>(
    costs: &impl Costs,
    guide: &GrayImage,
    penalties: Penalties,
    out: &mut [T],
    winners: impl Fn(&mut [u16], &mut [T]) + Sync,
) -> Result<(), StereoError> {
    let table = penalties.table()?;
    let [width, height] = costs.size();
    let count = costs.count();
    debug_assert!(out.len() == width * height && guide.width() == width && guide.height() == height);
    // With bands, three of eight paths and the matching costs are computed twice, but the process takes 160 MB, not 640
    // MB for the sums alone (1.4 megapixels), and all sums stay in the caches.
    let band = height.isqrt().max(1);
    check_memory(width, height, count, band)?;

    let line = width * count;
    let mut pixel_costs = vec![0; band.min(height) * line];
    let mut down = Across::new(width, count, Way::Down);
    let mut retained = Vec::with_capacity(height / band);
    for from in (0..height).step_by(band) {
        retained.push(down.paths().clone());
        let to = from + band;
        if to >= height {
            break;
        }
        let pixel_costs = &mut pixel_costs[..(to - from) * line];
        costs.fill(from..to, pixel_costs);
        for (y, pixel_costs) in (from..to).zip(pixel_costs.chunks_exact(line)) {
            down.advance(guide, y, &table, pixel_costs, None);
        }
    }

    let mut up = Across::new(width, count, Way::Up);
    let mut sums = vec![0_u16; band.min(height) * line];
    for from in (0..height).step_by(band).rev() {
        let to = (from + band).min(height);
        let pixel_costs = &mut pixel_costs[..(to - from) * line];
        let sums = &mut sums[..(to - from) * line];
        costs.fill(from..to, pixel_costs);
        let lines = sums.par_chunks_exact_mut(line).zip(pixel_costs.par_chunks_exact(line));
        lines
            .zip(from..to)
            .for_each(|((sums, costs), y)| along::sum(guide.row(y), &table, costs, sums));
        if let Some(paths) = retained.pop() {
            down.return_to(paths);
        }
        let lines = || pixel_costs.chunks_exact(line);
        for ((y, costs), sums) in (from..to).zip(lines()).zip(sums.chunks_exact_mut(line)) {
            down.advance(guide, y, &table, costs, Some(sums));
        }
        for ((y, costs), sums) in (from..to).zip(lines()).zip(sums.chunks_exact_mut(line)).rev() {
            up.advance(guide, y, &table, costs, Some(sums));
        }
        let out = &mut out[from * width..to * width];
        let lines = sums.par_chunks_exact_mut(line).zip(out.par_chunks_exact_mut(width));
        lines.for_each(|(sums, out)| winners(sums, out));
    }
    Ok(())
}

fn check_memory(width: usize, height: usize, count: usize, band: usize) -> Result<(), StereoError> {
    let line = (width * count) as u64;
    // Costs and sums of a band, and three paths per band.
    let needed = line * (3 * band.min(height) + 3 * height.div_ceil(band) + 12) as u64;
    if needed > MAX_BYTES {
        return Err(StereoError::TooLarge {
            needed_mib: needed >> 20,
            max_mib: MAX_BYTES >> 20,
        });
    }
    Ok(())
}
