//! Measured quality of the render modes of the open sequence, from fast to exact, and the budget limits of the user.

mod in_window;
mod panel;

use crate::bench::{LabPoint, Quality, QualityKey};
use crate::sequence::Sequence;

/// Maximum time and error that the user accepts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QualityLimits {
    /// Largest FLIP of the object, 0 to 1.
    pub flip: f64,
    /// Max time of an image, milliseconds.
    pub draw_ms: f64,
}

impl Default for QualityLimits {
    fn default() -> Self {
        // An error of a tenth is visible when one looks for it; 16 ms are one refresh of a 60 Hz screen.
        Self {
            flip: 0.1,
            draw_ms: 16.0,
        }
    }
}

/// Measured quality of the open sequence's render modes.
#[derive(Debug, Default)]
pub struct MeasuredQuality {
    /// The Pareto-optimal modes, once they were measured.
    pub known: Option<Quality>,
    /// Budget limits set by the user.
    pub limits: QualityLimits,
    /// Cache key of the measurement; known once sequence and adapter are.
    key: Option<QualityKey>,
}

impl MeasuredQuality {
    /// Reads earlier measurements, once their key is known. True if there are any.
    pub(in crate::app) fn look(&mut self, adapter: &str, sequence: &Sequence) -> bool {
        if adapter.is_empty() || self.key.is_some() {
            return false;
        }
        let key = QualityKey::new(adapter, sequence);
        self.known = Quality::read(&key);
        self.key = Some(key);
        self.known.is_some()
    }

    /// Takes over the results of a benchmark, and stores them.
    pub(in crate::app) fn learn(&mut self, points: &[LabPoint]) {
        let Some(quality) = Quality::of(points) else {
            return;
        };
        if let Some(key) = &self.key
            && let Err(reason) = quality.write(key)
        {
            log::warn!("the benchmark result could not be saved: {reason}");
        }
        self.known = Some(quality);
    }

    /// Another sequence is opened; the limits stay.
    pub(in crate::app) fn forget(&mut self) {
        *self = Self {
            limits: self.limits,
            ..Self::default()
        };
    }
}
