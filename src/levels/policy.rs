//! Level-of-detail policy, i.e. the fineness of a cut: by size on the screen, level, number or time.

use super::cut::{Cut, CutHints, SelectView};
use super::structure::Levels;

/// Level-of-detail policy that selects the nodes representing the cloud.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lod {
    /// Cells whose edge projects below this many pixels are not divided; 0 always descends to the leaves.
    ThresholdPx(f32),
    /// All cells of one level, and the leaves above it.
    Level(u32),
    /// The finest image of at most this many voxels: the smallest threshold that draws no more.
    Budget(u32),
    /// As many voxels as are drawn in this many milliseconds. The number follows the times of earlier images, so the
    /// result depends on the machine.
    FrameTimeMs(f32),
}

impl Default for Lod {
    fn default() -> Self {
        Self::ThresholdPx(1.0)
    }
}

impl Lod {
    /// The nodes of `levels` that represent the cloud in `view`, and the threshold in pixels that they come from, if
    /// they come from one. `affordable` is their number for [`Lod::FrameTimeMs`].
    pub fn cut(
        self,
        levels: &dyn Levels,
        view: &SelectView,
        hints: CutHints<'_>,
        affordable: u32,
    ) -> (Cut, Option<f32>) {
        let at_most = |max_nodes: u32| {
            let view = SelectView {
                lod_px: FINEST_USEFUL_PX,
                ..*view
            };
            let cut = levels.cut_at_most(max_nodes as usize, &view, hints);
            let lod_px = cut.lod_px();
            (cut, Some(lod_px))
        };
        match self {
            Self::ThresholdPx(lod_px) => {
                let cut = levels.cut(&SelectView { lod_px, ..*view }, hints);
                (cut, Some(lod_px))
            }
            Self::Level(deepest_level) => {
                let view = SelectView {
                    lod_px: 0.0,
                    deepest_level,
                    ..*view
                };
                (levels.cut(&view, hints), None)
            }
            Self::Budget(max_nodes) => at_most(max_nodes),
            Self::FrameTimeMs(_) => at_most(affordable),
        }
    }
}

/// Minimum useful voxel size in pixels for a voxel count budget: voxels are not divided below it, as smaller ones add
/// no visible detail.
const FINEST_USEFUL_PX: f32 = 0.5;

/// Number of voxels that a time budget affords, learnt from the render times of frames.
///
/// It changes in steps of an eighth of an octave, and only once a frame took a quarter longer or shorter than
/// requested, so that the image does not flicker between two levels of detail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Affordable {
    /// Eighths of an octave above one voxel.
    step: i32,
}

impl Default for Affordable {
    /// Returns a default of a hundred thousand voxels: a tenth of the number that GPUs draw in a frame, and the number
    /// that CPUs draw in one.
    fn default() -> Self {
        Self { step: 133 }
    }
}

impl Affordable {
    const RANGE: std::ops::RangeInclusive<i32> = 53..=205;

    /// The number of voxels.
    pub fn voxels(self) -> u32 {
        (f64::from(self.step) / 8.0).exp2() as u32
    }

    /// Records that an image of `drawn` voxels took `measured_ms` where `asked_ms` are wanted.
    pub fn learn(&mut self, drawn: usize, measured_ms: f64, asked_ms: f64) {
        let ratio = asked_ms / measured_ms;
        if !ratio.is_finite() || ratio <= 0.0 {
            return;
        }
        // An image that could not use its budget says nothing about larger ones.
        let used_up = drawn as f64 >= 0.7 * f64::from(self.voxels());
        if ratio < 0.8 || ratio > 1.25 && used_up {
            // Halfway, at most an octave: part of the time does not depend on the voxels.
            let octaves = (0.5 * ratio.log2()).clamp(-1.0, 1.0);
            let steps = (8.0 * octaves).round() as i32;
            let step = self.step
                + if steps == 0 {
                    ratio.log2().signum() as i32
                } else {
                    steps
                };
            self.step = step.clamp(*Self::RANGE.start(), *Self::RANGE.end());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_budget_is_approached_from_both_sides_and_then_held() {
        // A machine that takes 2 ms, plus 1 ms per 10,000 voxels.
        let time_ms = |voxels: u32| 2.0 + f64::from(voxels) / 10_000.0;
        for (asked_ms, begin) in [(20.0, 60), (20.0, 200), (5.0, 133)] {
            let mut affordable = Affordable { step: begin };
            for _ in 0..40 {
                let voxels = affordable.voxels();
                affordable.learn(voxels as usize, time_ms(voxels), asked_ms);
            }
            let settled = affordable;
            let measured_ms = time_ms(settled.voxels());
            assert!((0.75..=1.3).contains(&(measured_ms / asked_ms)), "{measured_ms} ms");
            affordable.learn(settled.voxels() as usize, measured_ms, asked_ms);
            assert_eq!(affordable, settled, "it stays");
        }
    }

    #[test]
    fn unusable_measurements_change_nothing() {
        let mut affordable = Affordable::default();
        for measured_ms in [0.0, f64::NAN, f64::INFINITY] {
            affordable.learn(1000, measured_ms, 16.0);
        }
        // A scene of a thousand voxels is fast regardless of the budget.
        affordable.learn(1000, 1.0, 16.0);
        assert_eq!(affordable, Affordable::default());
        for _ in 0..100 {
            affordable.learn(usize::MAX, 1e9, 1.0);
        }
        assert!(affordable.voxels() >= 90);
    }
}
