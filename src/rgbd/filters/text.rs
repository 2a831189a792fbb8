//! Filters as text: `near:from=0.3:to=4,median,bilateral`. Defaults are omitted.

use super::Filters;
use super::parameters::{FilterKind, FilterParameter, KINDS};
use std::fmt;
use std::str::FromStr;

/// The names of all filters, for messages.
const NAMES: &str = "near, median, bilateral, flying and temporal";

/// Text that does not describe filters.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParseFiltersError {
    /// A word that is not a filter.
    #[error("`{0}` is not a depth filter: expected {NAMES}, separated by commas, or none")]
    Filter(String),
    /// A word that is not a parameter of its filter.
    #[error("`{word}` cannot be set of {filter}: expected {expected}")]
    Parameter {
        /// The word.
        word: String,
        /// The filter.
        filter: &'static str,
        /// Adjustable parameters, with ranges.
        expected: String,
    },
    /// A range without anything in it.
    #[error("near:from={from}:to={to} keeps nothing: the first has to be below the second")]
    Empty {
        /// Start of the range, metres.
        from: f32,
        /// End of the range, metres.
        to: f32,
    },
}

impl fmt::Display for Filters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut between = "";
        for kind in KINDS.iter().filter(|kind| (kind.is_on)(self)) {
            write!(f, "{between}{}", kind.name)?;
            between = ",";
            let mut usual = Self::NONE;
            (kind.set_on)(&mut usual, true);
            for parameter in kind.parameters {
                if let Some(value) = parameter
                    .get(self)
                    .filter(|_| parameter.get(self) != parameter.get(&usual))
                {
                    write!(f, ":{}={value}", parameter.name)?;
                }
            }
        }
        f.write_str(if between.is_empty() { "none" } else { "" })
    }
}

impl FromStr for Filters {
    type Err = ParseFiltersError;

    /// The filters that are named, with their default parameters unless others are given; their order is always the
    /// same.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut filters = Self::NONE;
        if text == "none" {
            return Ok(filters);
        }
        for words in text.split(',') {
            let mut words = words.split(':');
            let name = words.next().unwrap_or_default();
            let kind = KINDS.iter().find(|kind| kind.name == name);
            let kind = kind.ok_or_else(|| ParseFiltersError::Filter(name.to_owned()))?;
            (kind.set_on)(&mut filters, true);
            for word in words {
                let (parameter, value) = parameter(kind, word).ok_or_else(|| ParseFiltersError::Parameter {
                    word: word.to_owned(),
                    filter: kind.name,
                    expected: expected(kind),
                })?;
                parameter.set(&mut filters, value);
            }
        }
        match filters.near.filter(|_| !filters.keep_any()) {
            None => Ok(filters),
            Some(near) => Err(ParseFiltersError::Empty {
                from: near.near_m,
                to: near.far_m,
            }),
        }
    }
}

/// `NAME=NUMBER` of a filter.
fn parameter(kind: &FilterKind, word: &str) -> Option<(&'static FilterParameter, f32)> {
    let (name, value) = word.split_once('=')?;
    let parameter = kind.parameters.iter().find(|parameter| parameter.name == name)?;
    let value = value.parse().ok().filter(|value| parameter.range.contains(value))?;
    Some((parameter, value))
}

fn expected(kind: &FilterKind) -> String {
    let names = kind.parameters.iter().map(|parameter| {
        let (min, max) = (parameter.range.start(), parameter.range.end());
        format!("{}={min} to {max}{}", parameter.name, parameter.unit)
    });
    let names: Vec<String> = names.collect();
    match names.as_slice() {
        [] => "nothing".to_owned(),
        names => names.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn names_round_trip() {
        for text in [
            "none",
            "near",
            "median,bilateral",
            "near,median,bilateral,flying,temporal",
            "near:from=0.3:to=4,median,bilateral:px=1.5:noise=2,temporal:fill=3",
            "flying:m=0.02:share=0.1:neighbours=6:erosion=1",
        ] {
            assert_eq!(text.parse::<Filters>().unwrap().to_string(), text);
        }
        assert_eq!("flying,near".parse::<Filters>().unwrap().to_string(), "near,flying");
        assert_eq!("near:to=10".parse::<Filters>().unwrap().to_string(), "near", "as usual");
        assert_eq!(Filters::USUAL.to_string(), "near,median,bilateral,flying");
        assert_eq!(Filters::default(), Filters::NONE);
        let filters: Filters = "near:from=0.5,temporal:share=0.25".parse().unwrap();
        assert_eq!(filters.near.unwrap().near_m, 0.5);
        assert_eq!(filters.temporal.unwrap().share, 0.25);
    }

    #[test]
    fn errors_state_what_is_expected() {
        for (text, expected) in [
            ("", "expected near, median"),
            ("median,", "expected near, median"),
            ("none,median", "expected near, median"),
            ("blur", "`blur` is not a depth filter"),
            (
                "near:far=3",
                "`far=3` cannot be set of near: expected from=0 to 1000 m, to=0 to 1000 m",
            ),
            ("near:from", "`from` cannot be set"),
            ("near:from=x", "`from=x` cannot be set"),
            ("near:from=-1", "`from=-1` cannot be set"),
            ("near:from=NaN", "`from=NaN` cannot be set"),
            ("median:px=3", "expected nothing"),
            ("temporal:share=0", "share=0.1 to 1"),
            ("near:from=5:to=4", "keeps nothing"),
        ] {
            let error = text.parse::<Filters>().unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }

    #[test]
    fn names_and_titles_are_unique() {
        let titles = |kind: &FilterKind| {
            let parameters = kind.parameters.iter().map(|parameter| parameter.title);
            std::iter::once(kind.title).chain(parameters).collect::<Vec<_>>()
        };
        let mut all: Vec<&str> = KINDS.iter().flat_map(titles).collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
        for kind in &KINDS {
            let mut names: Vec<&str> = kind.parameters.iter().map(|parameter| parameter.name).collect();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), kind.parameters.len(), "{}", kind.name);
            // A disabled filter has no values, and none can be set.
            let mut none = Filters::NONE;
            for parameter in kind.parameters {
                parameter.set(&mut none, *parameter.range.end());
                assert_eq!(parameter.get(&none), None);
            }
            assert_eq!(none, Filters::NONE);
        }
    }

    proptest! {
        #[test]
        fn any_filters_round_trip(
            chosen in prop::collection::vec(any::<bool>(), KINDS.len()),
            values in prop::collection::vec(0f32..1.0, 12),
        ) {
            let mut filters = Filters::NONE;
            let mut values = values.into_iter();
            for (kind, is_on) in KINDS.iter().zip(chosen) {
                (kind.set_on)(&mut filters, is_on);
                for parameter in kind.parameters {
                    let (min, max) = (parameter.range.start(), parameter.range.end());
                    parameter.set(&mut filters, min + values.next().unwrap_or_default() * (max - min));
                }
            }
            let read = filters.to_string().parse::<Filters>();
            prop_assert_eq!(read.is_ok(), filters.keep_any());
            if let Ok(read) = read {
                prop_assert_eq!(read, filters);
            }
        }

        #[test]
        fn any_text_is_parsed_or_rejected(text in "[a-z:=,0-9.\\-]{0,40}") {
            if let Ok(filters) = text.parse::<Filters>() {
                prop_assert_eq!(filters.to_string().parse::<Filters>(), Ok(filters));
            }
        }
    }
}
