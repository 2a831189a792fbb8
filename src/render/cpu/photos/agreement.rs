//! Robust mean of the colours of several images at one point, where some of them are wrong.
//!
//! How it works: the mean of all is taken, in which the images nearest to the eye's direction count most. Then it is
//! taken again with weights by how far each is from it, `q = 1 / (1 + d² / s²)` (Cauchy's weights, Holland and Welsch
//! 1977), twice. So the one image of four that shows something else (a person who walked by, the other side of an
//! outline, a wrong pose) fades. No image appears or vanishes at once.
//!
//! An error in the position shows up as a shift that grows with the obliqueness of an image: the variance of its colour
//! grows with the square of its angle θ, and the best mean has weights of `n = (θ₁² + a²) / (θ² + a²)`, θ₁ being the
//! nearest one's (inverse variances; Buehler et al. 2001 take 1/θ). That noise is the same in all images speaks against
//! it. So `q + (1 − q) · n` is taken: where images agree, all of them count, and noise is averaged; where they do not,
//! the nearest is right.

use crate::render::constants::{PHOTO_AGREEMENT_ROUNDS, PHOTO_PER_DISAGREEMENT2};
use glam::Vec3;

/// Colour that one image shows at a point.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shown {
    pub(super) color: Vec3,
    /// Weight relative to the others.
    pub(super) share: f32,
    /// A factor on that where they disagree: 1 of the nearest to the eye's direction, less of others.
    pub(super) nearness: f32,
}

/// The colour that `shown` agree on. Precondition: shares and nearness are not negative, and one of each is above 0.
#[inline(always)]
pub(super) fn agreed(shown: &[Shown]) -> Vec3 {
    let mut agreed = mean(shown, |shown| shown.share * shown.nearness);
    for _ in 0..PHOTO_AGREEMENT_ROUNDS {
        agreed = mean(shown, |shown| {
            let off2 = shown.color.distance_squared(agreed);
            let belief = 1.0 / (1.0 + PHOTO_PER_DISAGREEMENT2 * off2);
            // Nearness everywhere, not only where images disagree, is up to 0.4 dB better for images that COLMAP
            // calibrated, but Redwood's noisy ones have 37.14 dB instead of 37.33; with its square root 37.26. In the
            // first mean only: 30.14 instead of 30.57 dB with every third image (castle).
            shown.share * belief * (belief + (1.0 - belief) * shown.nearness)
        });
    }
    agreed
}

#[inline(always)]
fn mean(shown: &[Shown], share_of: impl Fn(&Shown) -> f32) -> Vec3 {
    let (mut color, mut sum) = (Vec3::ZERO, 0.0);
    for shown in shown {
        let share = share_of(shown);
        color += share * shown.color;
        sum += share;
    }
    color / sum.max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Each with its share, all from as near.
    fn alike<const COUNT: usize>(shown: [(Vec3, f32); COUNT]) -> [Shown; COUNT] {
        shown.map(|(color, share)| Shown {
            color,
            share,
            nearness: 1.0,
        })
    }

    #[test]
    fn one_outlier_of_four_hardly_counts() {
        let wall = Vec3::new(0.6, 0.5, 0.4);
        let wrong = Vec3::new(0.1, 0.1, 0.9);
        let found = agreed(&alike([(wall, 1.0), (wall, 0.8), (wrong, 0.9), (wall, 0.5)]));
        assert!(found.distance(wall) < 0.01, "{found}");
        // Alone, it counts by its own share.
        assert!(agreed(&alike([(wrong, 0.2), (wall, 0.0)])).distance(wrong) < 1e-6);
    }

    #[test]
    fn colors_that_differ_by_noise_are_averaged() {
        let noise = [-0.006, 0.004, 0.003, -0.001];
        let shown = noise.map(|noise| (Vec3::splat(0.5 + noise), 1.0));
        assert!(agreed(&alike(shown)).distance(Vec3::splat(0.5)) < 3e-4);
    }

    #[test]
    fn of_two_that_disagree_the_larger_weight_counts_more() {
        let found = agreed(&alike([(Vec3::ZERO, 1.0), (Vec3::ONE, 0.5)]));
        assert!(found.x > 0.0 && found.x < 1.0 / 3.0, "{found}");
        assert_eq!(agreed(&alike([(Vec3::ZERO, 1.0), (Vec3::ONE, 1.0)])), Vec3::splat(0.5));
    }

    #[test]
    fn disagreement_favours_the_nearest_and_agreement_uses_all() {
        let from_aside = |color: f32| Shown {
            color: Vec3::splat(color),
            share: 0.8,
            nearness: 0.02,
        };
        let nearest = Shown {
            color: Vec3::splat(0.5),
            share: 1.0,
            nearness: 1.0,
        };
        let disagreeing = agreed(&[nearest, from_aside(0.2), from_aside(0.9), from_aside(0.25)]);
        assert!(disagreeing.distance(nearest.color) < 0.02, "{disagreeing}");
        let noisy = agreed(&[nearest, from_aside(0.51), from_aside(0.51), from_aside(0.51)]);
        let mean = (0.5 + 3.0 * 0.8 * 0.51) / (1.0 + 3.0 * 0.8);
        assert!((noisy.x - mean).abs() < 5e-4, "{noisy}");
    }

    proptest! {
        /// Between the least and the largest of all, and steady: a little more of one changes little.
        #[test]
        fn colors_are_between_those_of_the_images(
            shown in prop::collection::vec(
                (prop::array::uniform3(0.0_f32..1.0), 0.01_f32..1.0, 0.05_f32..1.0), 1..8,
            ),
        ) {
            let shown: Vec<Shown> = shown
                .into_iter()
                .map(|(color, share, nearness)| Shown { color: color.into(), share, nearness })
                .collect();
            let found = agreed(&shown);
            let min = shown.iter().fold(Vec3::INFINITY, |min, shown| min.min(shown.color));
            let max = shown.iter().fold(Vec3::NEG_INFINITY, |max, shown| max.max(shown.color));
            prop_assert!(found.cmpge(min - 1e-5).all() && found.cmple(max + 1e-5).all());
            let mut more = shown.clone();
            more[0].share += 1e-4;
            prop_assert!(agreed(&more).distance(found) < 0.02);
        }
    }
}
