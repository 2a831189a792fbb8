//! Onion skin: neighbouring poses around one, and how faint.

/// Past poses are warm, those to come are cool.
const PAST_TINT: [u8; 3] = [255, 150, 60];
const FUTURE_TINT: [u8; 3] = [70, 160, 255];

/// Neighbouring frames in the same image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnionSkin {
    /// Visibility of the onion skin.
    pub is_on: bool,
    /// Number of onion-skin frames before the shown one.
    pub before: usize,
    /// Number of onion-skin frames after the shown one.
    pub after: usize,
    /// Frames from one to the next.
    pub step: usize,
    /// The share of their points that is drawn of the nearest ones; it falls to the farthest.
    pub strength: f32,
}

impl OnionSkin {
    /// Most ghosts on either side.
    pub const MAX_GHOSTS: usize = 8;

    /// The frames of `frame_count` drawn around `index`: index, share of points and colour of each.
    pub fn around(&self, index: usize, frame_count: usize) -> Vec<(usize, f32, [u8; 3])> {
        let side = |count: usize, tint, is_past: bool| {
            (1..=count).filter_map(move |place| {
                let away = place * self.step.max(1);
                let other = if is_past {
                    index.checked_sub(away)?
                } else {
                    index.checked_add(away)?
                };
                let share = self.strength * (count + 1 - place) as f32 / count as f32;
                (other < frame_count).then_some((other, share, tint))
            })
        };
        let past = side(self.before, PAST_TINT, true);
        past.chain(side(self.after, FUTURE_TINT, false)).collect()
    }
}

impl Default for OnionSkin {
    fn default() -> Self {
        Self {
            is_on: false,
            before: 2,
            after: 2,
            step: 1,
            strength: 0.5,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ghosts_fade_on_both_sides_and_stop_at_the_ends() {
        let onion = OnionSkin {
            before: 3,
            after: 2,
            step: 2,
            strength: 0.6,
            ..OnionSkin::default()
        };
        let found = onion.around(5, 8);
        let shares: Vec<(usize, f32)> = found.iter().map(|&(index, share, _)| (index, share)).collect();
        // The fourth, 11, as well as 9, are past the end.
        assert_eq!(shares, [(3, 0.6), (1, 0.6 * 2.0 / 3.0), (7, 0.6)]);
        assert_eq!(found[0].2, PAST_TINT);
        assert_eq!(found[2].2, FUTURE_TINT);
        assert_eq!(onion.around(0, 1), []);
    }
}
