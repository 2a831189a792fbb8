//! Heuristic test that the points of two frames are in the same order.

use glam::Vec3;

/// Points by which the order of two frames is compared, and fewest that say something.
pub(super) const WITNESSES: usize = 256;
const MIN_WITNESSES: usize = 16;

/// As a share of the median distance between different points, how far points may have moved where the order has
/// stayed.
const FARTHEST_MOVE: f32 = 0.5;

/// Returns true if points of the same indices in two frames appear to be the same points: relative to the centroid of
/// all, they are less than half as far from themselves as from others, in the median. Too few points are no evidence
/// against it.
pub(super) fn keeps_order(before: &[Vec3], now: &[Vec3]) -> bool {
    let pairs = before.iter().zip(now);
    let pairs: Vec<(Vec3, Vec3)> = pairs
        .filter(|(a, b)| a.is_finite() && b.is_finite())
        .map(|(&a, &b)| (a, b))
        .collect();
    let count = pairs.len();
    if count < MIN_WITNESSES {
        return true;
    }
    let shift: Vec3 = pairs.iter().map(|(a, b)| (b - a) / count as f32).sum();
    let moved = pairs.iter().map(|(a, b)| (b - a - shift).length());
    let others = (0..count).map(|i| {
        let other = pairs[(i + count / 2) % count].1;
        (other - pairs[i].0 - shift).length()
    });
    median(moved.collect()) <= FARTHEST_MOVE * median(others.collect())
}

/// Precondition: there are some.
fn median(mut values: Vec<f32>) -> f32 {
    let center = values.len() / 2;
    *values.select_nth_unstable_by(center, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// However points are shuffled, that is noticed; however all of them move together, it is not taken for that.
        #[test]
        fn shuffled_points_are_detected_and_moving_ones_are_not(
            seed in 0u64..1000, shift in prop::array::uniform3(-100f32..100.0), size in 0.9f32..1.1,
            turn_deg in -30f32..30.0,
        ) {
            // Positions without any order, as in some files.
            let fraction = |number: u64| {
                let z = number.wrapping_add(seed << 20).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                let z = (z ^ z >> 31).wrapping_mul(0x94d0_49bb_1331_11eb);
                ((z ^ z >> 29) >> 40) as f32 / (1u64 << 24) as f32
            };
            let place = |i: u64| Vec3::new(fraction(3 * i), fraction(3 * i + 1), fraction(3 * i + 2));
            let before: Vec<Vec3> = (0..256).map(place).collect();
            let turned = glam::Quat::from_rotation_z(turn_deg.to_radians());
            let moved: Vec<Vec3> = before.iter().map(|&at| turned * at * size + Vec3::from_array(shift)).collect();
            prop_assert!(keeps_order(&before, &moved));
            let shuffled: Vec<Vec3> = (0..256).map(|i| moved[(i * 101 + 7) % 256]).collect();
            prop_assert!(!keeps_order(&before, &shuffled));
        }
    }

    #[test]
    fn too_few_points_are_inconclusive() {
        let before: Vec<Vec3> = (0..15).map(|i| Vec3::splat(i as f32)).collect();
        let backwards: Vec<Vec3> = before.iter().rev().copied().collect();
        assert!(keeps_order(&before, &backwards));
        assert!(keeps_order(&[Vec3::ONE; 99], &[Vec3::ONE; 99]), "one place");
    }
}
