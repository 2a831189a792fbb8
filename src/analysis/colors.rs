//! Colours for points that have none in the file.

use glam::Vec3;

/// The paper's fake colour (000 §III): the direction of a normal as red, green and blue, each from 0 (facing down the axis)
/// to 255 (facing up). The zero vector is grey.
pub fn fake_color(normal: Vec3) -> [u8; 4] {
    // `as` rounds towards zero and saturates; the half makes it nearest.
    let [red, green, blue] = ((normal + 1.0) * 127.5 + 0.5)
        .to_array()
        .map(|channel| channel as u8);
    [red, green, blue, 255]
}

/// Viridis at ten even steps (Smith, van der Walt and Firing for matplotlib, dedicated to the public domain under CC0):
/// lightness grows evenly, also for the colour-blind and in print.
const VIRIDIS: [[u8; 3]; 10] = [
    [0x44, 0x01, 0x54],
    [0x48, 0x28, 0x78],
    [0x3e, 0x4a, 0x89],
    [0x31, 0x68, 0x8e],
    [0x26, 0x82, 0x8e],
    [0x1f, 0x9e, 0x89],
    [0x35, 0xb7, 0x79],
    [0x6d, 0xcd, 0x59],
    [0xb4, 0xde, 0x2c],
    [0xfd, 0xe7, 0x25],
];

/// Share of the scalars at either end that does not widen the range: reflectors and dropouts.
const TAIL: f64 = 0.02;

/// Colours for scalars, from the 2nd percentile (dark violet) to the 98th (yellow); what is beyond gets the colour of the
/// end. Equal scalars get the middle of the map; scalars must not be NaN.
pub fn scalar_colors(scalars: &[f32]) -> Vec<[u8; 4]> {
    let Some([low, high]) = robust_range(scalars) else {
        return Vec::new();
    };
    // In f64, so that a range over all of f32 does not overflow.
    let (low, extent) = (f64::from(low), f64::from(high) - f64::from(low));
    scalars
        .iter()
        .map(|&scalar| {
            let share = if extent > 0.0 {
                (f64::from(scalar) - low) / extent
            } else {
                0.5
            };
            map_color(share as f32)
        })
        .collect()
}

fn robust_range(scalars: &[f32]) -> Option<[f32; 2]> {
    let last = scalars.len().checked_sub(1)?;
    let mut sorted = scalars.to_vec();
    let mut at = |share: f64| {
        let rank = (share * last as f64).round() as usize;
        *sorted.select_nth_unstable_by(rank, f32::total_cmp).1
    };
    Some([at(TAIL), at(1.0 - TAIL)])
}

/// The colour at `share` of the way through the map of scalars: 0 is dark violet, 1 is yellow; clamped to 0..=1.
pub fn map_color(share: f32) -> [u8; 4] {
    let [red, green, blue] = between_steps(&VIRIDIS, share);
    [red, green, blue, 255]
}

/// A map of ten even steps between them, linearly; `share` is clamped to 0..=1.
pub(crate) fn between_steps(steps: &[[u8; 3]; 10], share: f32) -> [u8; 3] {
    let intervals = steps.len() - 1;
    let place = share.clamp(0.0, 1.0) * intervals as f32;
    let index = (place as usize).min(intervals - 1);
    let weight = place - index as f32;
    std::array::from_fn(|channel| {
        let [from, to] = [steps[index][channel], steps[index + 1][channel]].map(f32::from);
        (from + (to - from) * weight).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_have_their_colors() {
        assert_eq!(fake_color(Vec3::X), [255, 128, 128, 255]);
        assert_eq!(fake_color(Vec3::NEG_Y), [128, 0, 128, 255]);
        assert_eq!(fake_color(Vec3::ZERO), [128, 128, 128, 255]);
    }

    #[test]
    fn the_map_runs_through_its_steps() {
        let scalars: Vec<f32> = (0..10).map(|step| step as f32).collect();
        let colors = scalar_colors(&scalars);
        for (color, step) in colors.iter().zip(VIRIDIS) {
            assert_eq!(color[..3], step);
        }
    }

    #[test]
    fn outliers_do_not_stretch_the_range() {
        let mut scalars: Vec<f32> = (0..=100).map(|i| i as f32).collect();
        scalars[50] = f32::MAX;
        scalars[51] = -f32::MAX;
        let colors = scalar_colors(&scalars);
        assert_eq!(colors[50][..3], VIRIDIS[9]);
        assert_eq!(colors[51][..3], VIRIDIS[0]);
        assert_ne!(colors[20], colors[80]);
        let lightness = |color: [u8; 4]| color[..3].iter().map(|&c| u32::from(c)).sum::<u32>();
        assert!(lightness(colors[80]) > lightness(colors[20]));
    }

    #[test]
    fn equal_and_no_scalars_are_defined() {
        assert!(scalar_colors(&[]).is_empty());
        let colors = scalar_colors(&[3.0; 4]);
        assert!(colors.iter().all(|&color| color == map_color(0.5)));
    }
}
