//! Keyframe interpolation: smooth curves through values at ascending times.
//!
//! **How it works.** Between neighbouring values runs a cubic (Hermite), whose slopes at the values follow Fritsch and
//! Carlson (*Monotone piecewise cubic interpolation*, 1980, with the harmonic mean of Brodlie): 0 where the values turn
//! round or stand still, else a mean of the two slopes that is at most three times the smaller one. So the curve has no
//! corner, and between two values it is never beyond either of them: a value at rest stays at rest, and an elevation
//! does not swing over the pole.

/// One number over time. Precondition of everything here: one value per time, at least one; times ascend.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Curve {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl Curve {
    /// A curve through `values`; `eases` starts and ends it at rest.
    pub(super) fn through(times: &[f64], values: Vec<f64>, eases: bool) -> Self {
        let secants: Vec<f64> = times
            .windows(2)
            .zip(values.windows(2))
            .map(|(time, value)| (value[1] - value[0]) / (time[1] - time[0]))
            .collect();
        let end = |secant: Option<&f64>| match secant {
            Some(&secant) if !eases => secant,
            _ => 0.0,
        };
        let mut slopes = vec![end(secants.first())];
        for (time, secant) in times.windows(3).zip(secants.windows(2)) {
            slopes.push(inner_slope(
                [time[1] - time[0], time[2] - time[1]],
                [secant[0], secant[1]],
            ));
        }
        slopes.extend((values.len() > 1).then(|| end(secants.last())));
        Self { values, slopes }
    }

    /// The value at a fraction, 0 to 1, from value `index` to the next one, `span` seconds later.
    pub(super) fn at(&self, index: usize, share: f64, span: f64) -> f64 {
        let from = self.values[index];
        let Some(&to) = self.values.get(index + 1) else {
            return from;
        };
        let [leave, arrive] = [self.slopes[index], self.slopes[index + 1]].map(|slope| slope * span);
        let (rest, way) = (1.0 - share, to - from);
        // Bernstein form relative to `from`: exact at both ends, and where nothing moves.
        let inner = 3.0 * rest * share;
        let value =
            from + inner * rest * (leave / 3.0) + inner * share * (way - arrive / 3.0) + share * share * share * way;
        value.clamp(from.min(to), from.max(to))
    }
}

/// The slope at a value between two secants over these times.
fn inner_slope([before, after]: [f64; 2], [arriving, leaving]: [f64; 2]) -> f64 {
    // Monotone: with Catmull–Rom a resting camera would not rest, and an elevation could overshoot a pole.
    if arriving * leaving <= 0.0 {
        return 0.0;
    }
    let weights = [before + 2.0 * after, 2.0 * before + after];
    (weights[0] + weights[1]) / (weights[0] / arriving + weights[1] / leaving)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_steps_give_a_straight_line() {
        let curve = Curve::through(&[0.0, 1.0, 2.0], vec![5.0, 7.0, 9.0], false);
        for share in [0.0, 0.25, 0.5, 1.0] {
            assert!((curve.at(0, share, 1.0) - (5.0 + 2.0 * share)).abs() < 1e-12);
            assert!((curve.at(1, share, 1.0) - (7.0 + 2.0 * share)).abs() < 1e-12);
        }
    }

    #[test]
    fn ease_starts_and_ends_at_rest() {
        // Smoothstep, 3t² - 2t³.
        let curve = Curve::through(&[0.0, 4.0], vec![0.0, 1.0], true);
        for share in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let expected = share * share * (3.0 - 2.0 * share);
            assert!((curve.at(0, share, 4.0) - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn slopes_are_weighted_harmonic_means() {
        // Equal times: 2ab / (a + b).
        assert!((inner_slope([1.0, 1.0], [1.0, 3.0]) - 1.5).abs() < 1e-12);
        assert_eq!(inner_slope([1.0, 1.0], [1.0, -3.0]), 0.0);
        assert_eq!(inner_slope([1.0, 1.0], [0.0, 3.0]), 0.0);
    }
}
