//! Filters for disparity and depth maps: remove specks, and single pixels unlike their surroundings.

use rayon::prelude::*;

/// Applies a median filter: the median of the 3×3 neighbourhood of each pixel that has a value, over the pixels that
/// have one. NaN stays NaN. For an even number the lower of the two central values is used, so that every value is one
/// that was found. Preconditions: whole lines.
pub(in crate::stereo) fn median(values: &[f32], width: usize) -> Vec<f32> {
    let height = values.len() / width;
    let mut out = vec![f32::NAN; values.len()];
    out.par_chunks_exact_mut(width).enumerate().for_each(|(y, out)| {
        let rows = &values[y.saturating_sub(1) * width..(y + 2).min(height) * width];
        for (x, (out, value)) in out.iter_mut().zip(&values[y * width..]).enumerate() {
            if value.is_nan() {
                continue;
            }
            let mut around = [0.0; 9];
            let mut count = 0;
            for row in rows.chunks_exact(width) {
                for &value in &row[x.saturating_sub(1)..(x + 2).min(width)] {
                    around[count] = value;
                    count += usize::from(!value.is_nan());
                }
            }
            let around = &mut around[..count];
            let center = (count - 1) / 2;
            *out = *around.select_nth_unstable_by(center, f32::total_cmp).1;
        }
    });
    out
}

/// Takes out connected pixels that are fewer than `min`. Neighbours in a line or a column are connected if `is_near` is
/// true for their values. Preconditions: whole lines; `is_near` is false for NaN.
pub(in crate::stereo) fn remove_specks(
    values: &mut [f32],
    width: usize,
    min: usize,
    is_near: impl Fn(f32, f32) -> bool,
) {
    let mut sets = Sets::new(values.len());
    for at in 0..values.len() {
        if at % width > 0 && is_near(values[at - 1], values[at]) {
            sets.join(at as u32 - 1, at as u32);
        }
        if at >= width && is_near(values[at - width], values[at]) {
            sets.join((at - width) as u32, at as u32);
        }
    }
    let mut sizes = vec![0_u32; values.len()];
    for at in 0..values.len() as u32 {
        sizes[sets.first(at) as usize] += 1;
    }
    for (at, value) in values.iter_mut().enumerate() {
        if (sizes[sets.first(at as u32) as usize] as usize) < min {
            *value = f32::NAN;
        }
    }
}

/// Connected pixels: each leads to an earlier one of its set, the first to itself.
struct Sets(Vec<u32>);

impl Sets {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn first(&mut self, mut at: u32) -> u32 {
        while self.0[at as usize] != at {
            let next = self.0[at as usize];
            // Path halving: every second step is skipped next time.
            self.0[at as usize] = self.0[next as usize];
            at = next;
        }
        at
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.first(a), self.first(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NONE: f32 = f32::NAN;

    fn is_near(a: f32, b: f32) -> bool {
        (a - b).abs() <= 1.0
    }

    #[test]
    fn an_isolated_pixel_takes_the_surrounding_value() {
        let mut values = vec![5.0; 25];
        values[12] = 90.0;
        values[0] = NONE;
        let filtered = median(&values, 5);
        assert!(filtered[0].is_nan());
        assert!(filtered[1..].iter().all(|&value| value == 5.0), "{filtered:?}");
    }

    #[test]
    fn specks_are_removed_and_larger_areas_stay() {
        // Three pixels connected along a column, a single one, and two that touch only at a corner.
        let mut values = vec![
            1.0, NONE, 9.0, NONE, //
            1.5, NONE, NONE, 4.0, //
            2.0, NONE, 4.0, NONE,
        ];
        remove_specks(&mut values, 4, 3, is_near);
        let left: Vec<usize> = (0..12).filter(|&at| !values[at].is_nan()).collect();
        assert_eq!(left, [0, 4, 8]);
    }

    #[test]
    fn a_step_separates_two_areas() {
        let mut values = vec![1.0, 1.0, 8.0, 1.0, 1.0, 8.0];
        remove_specks(&mut values, 3, 3, is_near);
        assert_eq!(values.iter().filter(|value| !value.is_nan()).count(), 4);
    }

    proptest! {
        #[test]
        fn areas_match_a_flood_fill(
            labels in proptest::collection::vec(0_u8..4, 1..120),
            width in 1_usize..12,
            min in 1_usize..9,
        ) {
            let height = labels.len() / width;
            prop_assume!(height > 0);
            let values: Vec<f32> = labels[..width * height]
                .iter()
                .map(|&label| if label == 3 { NONE } else { 5.0 * f32::from(label) })
                .collect();
            let mut left = values.clone();
            remove_specks(&mut left, width, min, is_near);
            for start in 0..values.len() {
                let mut seen = vec![false; values.len()];
                let mut open = vec![start];
                seen[start] = true;
                let mut size = 0;
                while let Some(at) = open.pop() {
                    size += 1;
                    let (x, y) = (at % width, at / width);
                    let mut near = Vec::new();
                    if x > 0 { near.push(at - 1); }
                    if x + 1 < width { near.push(at + 1); }
                    if y > 0 { near.push(at - width); }
                    if y + 1 < height { near.push(at + width); }
                    for next in near {
                        if !seen[next] && is_near(values[at], values[next]) {
                            seen[next] = true;
                            open.push(next);
                        }
                    }
                }
                let stays = !values[start].is_nan() && size >= min;
                prop_assert_eq!(!left[start].is_nan(), stays, "pixel {}", start);
            }
        }
    }
}
