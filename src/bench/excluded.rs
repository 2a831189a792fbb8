//! Hold-out selection: images that are held out, to be compared with.

use std::str::FromStr;

/// Selection of held-out images.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Excluded {
    /// The first, and every n-th after it.
    Every(usize),
    /// Images with these numbers, counted from 0.
    Numbers(Vec<usize>),
}

impl Excluded {
    /// Their numbers in a set of `count`.
    pub fn of(&self, count: usize) -> Vec<usize> {
        match self {
            Self::Every(step) => (0..count).step_by((*step).max(1)).collect(),
            Self::Numbers(numbers) => numbers.iter().copied().filter(|&number| number < count).collect(),
        }
    }
}

impl Default for Excluded {
    fn default() -> Self {
        Self::Every(8)
    }
}

/// Parse error for a text that names no images.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a list of images: expected numbers counted from 0 such as 2,5, or every:8")]
pub struct ParseExcludedError(String);

impl FromStr for Excluded {
    type Err = ParseExcludedError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || ParseExcludedError(text.to_owned());
        if let Some(step) = text.strip_prefix("every:") {
            let step: usize = step.parse().map_err(|_| wrong())?;
            return if step > 1 { Ok(Self::Every(step)) } else { Err(wrong()) };
        }
        let numbers: Result<Vec<usize>, _> = text.split(',').map(|number| number.trim().parse()).collect();
        numbers.map(Self::Numbers).map_err(|_| wrong())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_and_numbers_select_images() {
        let of = |text: &str| text.parse::<Excluded>().map(|choice| choice.of(10));
        assert_eq!(of("every:4"), Ok(vec![0, 4, 8]));
        assert_eq!(of("2, 5,17"), Ok(vec![2, 5]));
        for wrong in ["", "every:", "every:1", "every:0", "a", "1,,2", "-1"] {
            assert!(of(wrong).unwrap_err().to_string().contains("every:8"), "{wrong}");
        }
        assert_eq!(Excluded::default().of(3), [0]);
    }
}
