//! Depths of pixels that stereo has none for, from those around them.
//!
//! How it works: inverse depths of a plane are linear in pixels, so these are continued. A pixel without a depth has
//! the mean of its four neighbours, those of its own colour counting most (Levin et al. 2004, *Colorization using
//! optimization*): depths stop where colours do, which is where surfaces end. The linear system is solved by
//! over-relaxation, from a pyramid's estimate (push–pull), so that the far end of a large hole is not late.
//!
//! It wins on walls and floors that show too little for matching, and cannot know of a step in them.

use glam::Vec3;

/// Difference of colours, of 1, at which a neighbour counts 1/e.
const PER_COLOR: f32 = 1.0 / 0.03;

/// Minimum weight of a neighbour of any other colour: no pixel is without neighbours.
const MIN_SHARE: f32 = 1e-3;

/// Rounds of over-relaxation, and by how much each goes beyond the mean.
const ROUNDS: usize = 120;
const BEYOND: f32 = 1.8;

/// Fills zeros in `inverse`, row by row of `width`, by their surroundings in an image of `colors`. Nothing is changed
/// without known values. Precondition: both have the same number of pixels.
pub(super) fn complete(inverse: &mut [f32], colors: &[[u8; 3]], width: usize) {
    let height = inverse.len() / width.max(1);
    let unknown: Vec<usize> = (0..inverse.len()).filter(|&at| inverse[at] == 0.0).collect();
    if unknown.is_empty() || unknown.len() == inverse.len() {
        return;
    }
    let color = |at: usize| Vec3::from_array(colors[at].map(|channel| f32::from(channel) / 255.0));
    let start = pulled(inverse, width, height);
    for &at in &unknown {
        inverse[at] = start[at];
    }
    let around: Vec<[(usize, f32); 4]> = unknown
        .iter()
        .map(|&at| {
            let (row, column) = (at / width, at % width);
            let neighbor = [
                (column > 0).then(|| at - 1),
                (column + 1 < width).then_some(at + 1),
                (row > 0).then(|| at - width),
                (row + 1 < height).then_some(at + width),
            ];
            let share = |other: usize| (-PER_COLOR * color(at).distance(color(other))).exp() + MIN_SHARE;
            let shares = neighbor.map(|other| other.map_or((at, 0.0), |other| (other, share(other))));
            let sum = shares
                .iter()
                .map(|(_, share)| share)
                .sum::<f32>()
                .max(f32::MIN_POSITIVE);
            shares.map(|(other, share)| (other, share / sum))
        })
        .collect();
    for _ in 0..ROUNDS {
        for (&at, around) in unknown.iter().zip(&around) {
            let mean: f32 = around.iter().map(|&(other, share)| share * inverse[other]).sum();
            inverse[at] += BEYOND * (mean - inverse[at]);
        }
    }
    // Over-relaxation can overshoot below zero.
    let min = start.iter().copied().fold(f32::INFINITY, f32::min);
    for &at in &unknown {
        inverse[at] = inverse[at].max(min);
    }
}

/// The mean of the known values around each pixel, in the smallest power-of-two square that has any.
fn pulled(inverse: &[f32], width: usize, height: usize) -> Vec<f32> {
    if width <= 1 && height <= 1 {
        return inverse.to_vec();
    }
    let (half_width, half_height) = (width.div_ceil(2), height.div_ceil(2));
    let mut sums = vec![(0.0, 0.0); half_width * half_height];
    for (at, &value) in inverse.iter().enumerate().filter(|(_, value)| **value > 0.0) {
        let (sum, count) = &mut sums[at / width / 2 * half_width + at % width / 2];
        *sum += value;
        *count += 1.0;
    }
    let halved: Vec<f32> = sums
        .into_iter()
        .map(|(sum, count)| sum / f32::max(count, 1.0))
        .collect();
    let coarser = if halved.contains(&0.0) {
        pulled(&halved, half_width, half_height)
    } else {
        halved
    };
    let filled = inverse.iter().enumerate().map(|(at, &value)| match value {
        0.0 => coarser[at / width / 2 * half_width + at % width / 2],
        known => known,
    });
    filled.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 40;

    /// Inverse depths of a plane that is seen from the side.
    fn plane(at: usize) -> f32 {
        0.5 + 0.004 * (at % WIDTH) as f32 + 0.002 * (at / WIDTH) as f32
    }

    fn is_in_hole(at: usize) -> bool {
        (12..28).contains(&(at % WIDTH)) && (10..22).contains(&(at / WIDTH))
    }

    #[test]
    fn a_hole_in_a_plane_is_filled_on_the_plane() {
        let all: Vec<f32> = (0..WIDTH * 30).map(plane).collect();
        let mut inverse = all.clone();
        (0..inverse.len())
            .filter(|&at| is_in_hole(at))
            .for_each(|at| inverse[at] = 0.0);
        complete(&mut inverse, &vec![[90; 3]; all.len()], WIDTH);
        for (at, (found, expected)) in inverse.iter().zip(&all).enumerate() {
            assert!((found - expected).abs() < 1e-3, "{at}: {found}, expected {expected}");
        }
    }

    #[test]
    fn a_depth_step_in_a_hole_follows_the_color_edge() {
        // Known on both sides, unknown from 4 to 35; the colour changes at 30.
        let color = |at: usize| if at % WIDTH < 30 { [200, 60, 60] } else { [60, 60, 200] };
        let known = |at: usize| match at % WIDTH {
            0..4 => 1.0,
            36.. => 0.5,
            _ => 0.0,
        };
        let mut inverse: Vec<f32> = (0..WIDTH * 20).map(known).collect();
        let colors: Vec<[u8; 3]> = (0..WIDTH * 20).map(color).collect();
        complete(&mut inverse, &colors, WIDTH);
        for (at, found) in inverse.iter().enumerate() {
            let expected = if at % WIDTH < 30 { 1.0 } else { 0.5 };
            assert!((found - expected).abs() < 0.03, "{}: {found}", at % WIDTH);
        }
    }

    #[test]
    fn empty_maps_stay_empty() {
        let mut nothing = vec![0.0; 12];
        complete(&mut nothing, &[[0; 3]; 12], 4);
        assert_eq!(nothing, [0.0; 12]);
        complete(&mut [], &[], 0);
        let mut one = vec![0.0, 0.0, 2.0];
        complete(&mut one, &[[0; 3], [250; 3], [0; 3]], 3);
        assert!(one.iter().all(|&value| (value - 2.0).abs() < 1e-3), "{one:?}");
    }
}
