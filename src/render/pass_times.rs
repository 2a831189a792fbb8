//! GPU timings of each pass of an image.

use serde::{Serialize, Serializer};
use std::ops::Deref;

/// The time of one pass.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct PassTime {
    /// Its name; `compute` amplifies once for every pass over records.
    pub pass: &'static str,
    /// `None` where its timestamps make no sense.
    pub gpu_ms: Option<f64>,
}

/// The passes of one image, in their order: the timed ones, which are all on adapters with timestamps.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PassTimes {
    passes: [PassTime; Self::MAX],
    count: usize,
}

impl PassTimes {
    /// Maximum number of passes of an image.
    pub const MAX: usize = 16;

    /// Returns true if it is empty.
    pub fn are_none(&self) -> bool {
        self.count == 0
    }
}

impl Deref for PassTimes {
    type Target = [PassTime];

    fn deref(&self) -> &[PassTime] {
        &self.passes[..self.count]
    }
}

impl FromIterator<PassTime> for PassTimes {
    /// The first [`PassTimes::MAX`] of them.
    fn from_iter<I: IntoIterator<Item = PassTime>>(times: I) -> Self {
        let mut all = Self::default();
        for (place, time) in all.passes.iter_mut().zip(times) {
            *place = time;
            all.count += 1;
        }
        all
    }
}

impl Serialize for PassTimes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pass_times_are_stored_up_to_capacity() {
        let time = |gpu_ms: f64| PassTime {
            pass: "x",
            gpu_ms: Some(gpu_ms),
        };
        let few: PassTimes = [1.0, 2.0].map(time).into_iter().collect();
        assert_eq!(&*few, [time(1.0), time(2.0)]);
        let many: PassTimes = (0..100).map(|i| time(f64::from(i))).collect();
        assert_eq!(many.len(), PassTimes::MAX);
        assert_eq!(
            serde_json::to_string(&few).unwrap(),
            r#"[{"pass":"x","gpu_ms":1.0},{"pass":"x","gpu_ms":2.0}]"#
        );
    }
}
