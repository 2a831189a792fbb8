//! Share of the points of a frame, in the words of the command line.

use std::str::FromStr;

/// Share of the points of a frame, in percent of all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(transparent)]
pub struct PointShare {
    percent: u8,
}

/// Parse error for a text that is not a share of points.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a share of points: expected a whole percentage from 1% to 99%, such as 10%")]
pub struct ParsePointShareError(String);

impl PointShare {
    /// Number of points that this is of `count`; at least 1.
    pub fn of(self, count: usize) -> usize {
        let share = count as u64 * u64::from(self.percent) / 100;
        (share as usize).max(1)
    }
}

impl FromStr for PointShare {
    type Err = ParsePointShareError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = text.trim().trim_end_matches('%').trim_end();
        let percent = number.parse().ok().filter(|percent| (1..100).contains(percent));
        let percent = percent.ok_or_else(|| ParsePointShareError(text.to_owned()))?;
        Ok(Self { percent })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_whole_percentages() {
        let of = |text: &str, count: usize| text.parse::<PointShare>().map(|share| share.of(count));
        assert_eq!(of("10%", 35_947), Ok(3_594));
        assert_eq!(of(" 99 % ", 1000), Ok(990));
        assert_eq!(of("1", 5), Ok(1));
        for wrong in ["", "%", "0%", "100%", "-5%", "1/10", "12.5%", "300"] {
            let error = of(wrong, 10).unwrap_err().to_string();
            assert!(error.contains("such as 10%"), "{error}");
        }
    }
}
