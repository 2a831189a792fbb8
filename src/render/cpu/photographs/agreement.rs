//! What several photographs say of one place, where some of them are wrong.
//!
//! How it works: the mean of all is taken, then again with shares by how far each is from it, `1 / (1 + d² / s²)`
//! (Cauchy's weights, Holland and Welsch 1977), twice. So the one photograph of four that shows something else (a
//! person who walked by, what is before or behind an outline, a wrong pose) fades, and noise is averaged as before. No
//! photograph appears or vanishes at once.

use crate::render::constants::{PHOTO_AGREEMENT_ROUNDS, PHOTO_PER_DISAGREEMENT2};
use glam::Vec3;

/// The colour that `shown` agree on, each with its share. Precondition: shares are not negative, and one is above 0.
#[inline(always)]
pub(super) fn agreed(shown: &[(Vec3, f32)]) -> Vec3 {
    let mut agreed = mean(shown, |_, share| share);
    for _ in 0..PHOTO_AGREEMENT_ROUNDS {
        let doubt = |color: Vec3| 1.0 + PHOTO_PER_DISAGREEMENT2 * color.distance_squared(agreed);
        agreed = mean(shown, |color, share| share / doubt(color));
    }
    agreed
}

#[inline(always)]
fn mean(shown: &[(Vec3, f32)], share_of: impl Fn(Vec3, f32) -> f32) -> Vec3 {
    let (mut color, mut sum) = (Vec3::ZERO, 0.0);
    for &(shown, share) in shown {
        let share = share_of(shown, share);
        color += share * shown;
        sum += share;
    }
    color / sum.max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_one_of_four_that_shows_something_else_hardly_counts() {
        let wall = Vec3::new(0.6, 0.5, 0.4);
        let wrong = Vec3::new(0.1, 0.1, 0.9);
        let found = agreed(&[(wall, 1.0), (wall, 0.8), (wrong, 0.9), (wall, 0.5)]);
        assert!(found.distance(wall) < 0.01, "{found}");
        // It is by its own share that it counts alone.
        assert!(agreed(&[(wrong, 0.2), (wall, 0.0)]).distance(wrong) < 1e-6);
    }

    #[test]
    fn what_differs_by_noise_is_averaged() {
        let noise = [-0.006, 0.004, 0.003, -0.001];
        let shown = noise.map(|noise| (Vec3::splat(0.5 + noise), 1.0));
        assert!(agreed(&shown).distance(Vec3::splat(0.5)) < 3e-4);
    }

    #[test]
    fn of_two_that_disagree_the_larger_share_counts_more_and_both_count() {
        let found = agreed(&[(Vec3::ZERO, 1.0), (Vec3::ONE, 0.5)]);
        assert!(found.x > 0.0 && found.x < 1.0 / 3.0, "{found}");
        assert_eq!(agreed(&[(Vec3::ZERO, 1.0), (Vec3::ONE, 1.0)]), Vec3::splat(0.5));
    }

    proptest! {
        /// Between the least and the largest of all, and steady: a little more of one changes little.
        #[test]
        fn colours_are_between_those_shown(
            shown in prop::collection::vec((prop::array::uniform3(0.0_f32..1.0), 0.01_f32..1.0), 1..8),
        ) {
            let shown: Vec<(Vec3, f32)> = shown.into_iter().map(|(color, share)| (color.into(), share)).collect();
            let found = agreed(&shown);
            let least = shown.iter().fold(Vec3::INFINITY, |least, (color, _)| least.min(*color));
            let most = shown.iter().fold(Vec3::NEG_INFINITY, |most, (color, _)| most.max(*color));
            prop_assert!(found.cmpge(least - 1e-5).all() && found.cmple(most + 1e-5).all());
            let mut more = shown.clone();
            more[0].1 += 1e-4;
            prop_assert!(agreed(&more).distance(found) < 0.02);
        }
    }
}
