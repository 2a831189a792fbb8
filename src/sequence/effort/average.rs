//! Moving averages that follow recent measurements.

/// Weight of the newest measurement in an average.
const NEWEST: f64 = 0.25;

/// A moving average, and the worst of its fading values.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Average {
    pub(super) mean: Option<f64>,
    pub(super) worst: f64,
}

impl Average {
    pub(super) fn add(&mut self, value: f64) {
        if value.is_finite() {
            let mean = self.mean.unwrap_or(value);
            self.mean = Some(mean + NEWEST * (value - mean));
            // The worst value decays at a tenth of that rate.
            self.worst = value.max(self.worst * (1.0 - 0.1 * NEWEST));
        }
    }
}
