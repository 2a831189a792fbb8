//! Serialised form of a colouring in persistent files: as its parts, or as one word, which is the form in older files
//! and where nothing else was chosen, so that earlier versions read that too.

use super::{ColorRange, ColorSource, Coloring};
use crate::analysis::ColorMap;
use serde::ser::SerializeStruct as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// As it is read.
#[derive(Deserialize)]
#[serde(untagged)]
enum StoredColoring {
    Word(ColorSource),
    Parts(Parts),
}

/// Serialised parts; missing ones take their defaults.
#[derive(Deserialize)]
#[serde(default)]
struct Parts {
    source: ColorSource,
    map: ColorMap,
    range: ColorRange,
    logarithmic: bool,
    one_color: [u8; 3],
}

impl Default for Parts {
    fn default() -> Self {
        let usual = Coloring::default();
        Self {
            source: usual.source,
            map: usual.map,
            range: usual.range,
            logarithmic: usual.is_logarithmic,
            one_color: usual.one_color,
        }
    }
}

impl From<StoredColoring> for Coloring {
    fn from(stored: StoredColoring) -> Self {
        match stored {
            StoredColoring::Word(source) => Self::of(source),
            StoredColoring::Parts(parts) => Self {
                source: parts.source,
                map: parts.map,
                range: parts.range,
                is_logarithmic: parts.logarithmic,
                one_color: parts.one_color,
            },
        }
    }
}

impl<'de> Deserialize<'de> for Coloring {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        StoredColoring::deserialize(deserializer).map(Self::from)
    }
}

impl Serialize for Coloring {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if *self == Self::of(self.source) {
            return self.source.serialize(serializer);
        }
        let mut parts = serializer.serialize_struct("Coloring", 5)?;
        parts.serialize_field("source", &self.source)?;
        parts.serialize_field("map", &self.map)?;
        parts.serialize_field("range", &self.range)?;
        parts.serialize_field("logarithmic", &self.is_logarithmic)?;
        parts.serialize_field("one_color", &self.one_color)?;
        parts.end()
    }
}

impl Serialize for ColorRange {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for ColorRange {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::FieldName;
    use proptest::prelude::*;

    fn read(text: &str) -> Option<Coloring> {
        serde_json::from_str(text).ok()
    }

    #[test]
    fn words_of_older_versions_keep_their_meaning() {
        for (word, source) in [
            ("auto", ColorSource::Auto),
            ("file", ColorSource::File),
            ("normal", ColorSource::Normal),
            ("scalar", ColorSource::Scalar(None)),
            ("uniform", ColorSource::Uniform),
        ] {
            assert_eq!(read(&format!("\"{word}\"")), Some(Coloring::of(source)));
            // And earlier versions can read the written form.
            let written = serde_json::to_string(&Coloring::of(source)).unwrap();
            assert_eq!(written, format!("\"{word}\""));
        }
    }

    #[test]
    fn missing_parts_are_defaults_and_unknown_ones_are_ignored() {
        let turbo = Coloring {
            map: ColorMap::Turbo,
            ..Coloring::default()
        };
        assert_eq!(read(r#"{"map": "turbo", "palette": 7}"#), Some(turbo));
        assert_eq!(read("{}"), Some(Coloring::default()));
        for wrong in [
            r#""sound""#,
            r#"{"map": "jet"}"#,
            r#"{"range": "9..1"}"#,
            r#"{"range": "p1..p101"}"#,
            "7",
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }

    proptest! {
        #[test]
        fn every_choice_round_trips(
            map in 0usize..5, low in -1e12f64..1e12, extent in 0f64..1e12,
            percent in prop::array::uniform2(0f64..=50.0),
            is_fixed: bool, is_logarithmic: bool, one_color: [u8; 3], name in "[a-z (:]{1,20}",
        ) {
            let coloring = Coloring {
                source: ColorSource::Scalar(Some(FieldName::new(&name))),
                map: ColorMap::ALL[map],
                range: if is_fixed {
                    ColorRange::Fixed { low, high: low + extent }
                } else {
                    ColorRange::Percentiles { low: percent[0], high: 100.0 - percent[1] }
                },
                is_logarithmic,
                one_color,
            };
            let written = serde_json::to_string(&coloring).unwrap();
            prop_assert_eq!(read(&written), Some(coloring));
        }
    }
}
