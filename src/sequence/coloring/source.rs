//! Colour source: the attribute that colours show.

use super::{FieldName, ParseColoringError};
use crate::spelling::is_same_word;
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// Colour source: the attribute that colours show.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ColorSource {
    /// The file's colours if they differ, else its intensity if that does, else its classes if they do, else the height
    /// where a scene was scanned, else the direction of the normal (the paper's fake colour).
    #[default]
    Auto,
    /// The colours of the file.
    File,
    /// The paper's fake colour: the direction of the normal.
    Normal,
    /// A scalar field of the file through a colour map: the one of this name, else the best to colour by (intensity and
    /// the like).
    Scalar(Option<FieldName>),
    /// Height of the point in file coordinates, through a colour map.
    Height(HeightAxis),
    /// Distance of the point from somewhere, through a colour map.
    Distance(DistanceFrom),
    /// The scalar field for the time of measurement of a point, through a colour map; without one as
    /// [`ColorSource::Scalar`].
    Time,
    /// The class of the point in its usual colour.
    Class,
    /// One colour for all points.
    Uniform,
}

/// Up axis for [`ColorSource::Height`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum HeightAxis {
    /// As for the image.
    #[default]
    Auto,
    /// An axis of the file: 0, 1 or 2, and whether it points down.
    Axis(u8, bool),
}

/// From where distances are taken.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum DistanceFrom {
    /// The sensor, if the file has its position, else the origin of the file's coordinates.
    #[default]
    Sensor,
    /// A place in file coordinates.
    Place(DVec3),
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl ColorSource {
    /// One of each kind, in the order in which a list shows them.
    pub const ALL: [Self; 9] = [
        Self::Auto,
        Self::File,
        Self::Scalar(None),
        Self::Height(HeightAxis::Auto),
        Self::Normal,
        Self::Distance(DistanceFrom::Sensor),
        Self::Time,
        Self::Class,
        Self::Uniform,
    ];

    /// The source that other programs have under a word.
    fn of_synonym(word: &str) -> Option<Self> {
        const SYNONYMS: [(&str, ColorSource); 7] = [
            ("rgb", ColorSource::File),
            ("intensity", ColorSource::Scalar(None)),
            ("elevation", ColorSource::Height(HeightAxis::Auto)),
            ("x", ColorSource::Height(HeightAxis::Axis(0, false))),
            ("y", ColorSource::Height(HeightAxis::Axis(1, false))),
            ("z", ColorSource::Height(HeightAxis::Axis(2, false))),
            ("classification", ColorSource::Class),
        ];
        let found = SYNONYMS.iter().find(|(synonym, _)| is_same_word(synonym, word));
        found.map(|(_, source)| *source)
    }

    /// The first word of it on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::File => "file",
            Self::Normal => "normal",
            Self::Scalar(_) => "scalar",
            Self::Height(_) => "height",
            Self::Distance(_) => "distance",
            Self::Time => "time",
            Self::Class => "class",
            Self::Uniform => "uniform",
        }
    }
}

impl fmt::Display for ColorSource {
    /// As on the command line and in files.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())?;
        match self {
            Self::Scalar(Some(name)) => write!(formatter, ":{name}"),
            Self::Height(HeightAxis::Axis(axis, is_down)) => {
                let sign = if *is_down { "-" } else { "" };
                write!(formatter, ":{sign}{}", AXES[usize::from(*axis).min(2)])
            }
            Self::Distance(DistanceFrom::Place(DVec3 { x, y, z })) => {
                write!(formatter, ":{x},{y},{z}")
            }
            _ => Ok(()),
        }
    }
}

impl FromStr for ColorSource {
    type Err = ParseColoringError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parse = || {
            let (word, detail) = match text.split_once(':') {
                Some((word, detail)) => (word, Some(detail)),
                None => (text, None),
            };
            match (word, detail) {
                ("scalar", Some(name)) if !name.is_empty() => Some(Self::Scalar(Some(FieldName::new(name)))),
                ("height", Some(axis)) => {
                    let (is_down, name) = match axis.strip_prefix('-') {
                        Some(name) => (true, name),
                        None => (false, axis),
                    };
                    let axis = AXES.iter().position(|axis| *axis == name)?;
                    Some(Self::Height(HeightAxis::Axis(axis as u8, is_down)))
                }
                ("distance", Some(place)) => {
                    let numbers = place.split(',').map(|number| number.trim().parse().ok());
                    let numbers: Option<Vec<f64>> = numbers.collect();
                    let place = DVec3::from_array(numbers?.try_into().ok()?);
                    let source = Self::Distance(DistanceFrom::Place(place));
                    place.is_finite().then_some(source)
                }
                (word, None) => Self::ALL
                    .into_iter()
                    .find(|source| is_same_word(source.name(), word))
                    .or_else(|| Self::of_synonym(word)),
                _ => None,
            }
        };
        parse().ok_or_else(|| ParseColoringError {
            what: "colour source",
            text: text.to_owned(),
            expected: "auto, file, scalar or scalar:NAME, height or height:z, normal, distance or distance:X,Y,Z, \
                time, class or uniform",
        })
    }
}

impl serde::Serialize for ColorSource {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> serde::Deserialize<'de> for ColorSource {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_round_trip_through_their_words() {
        let further = [
            ColorSource::Scalar(Some(FieldName::new("Roughness (0.1): é"))),
            ColorSource::Height(HeightAxis::Axis(2, false)),
            ColorSource::Height(HeightAxis::Axis(1, true)),
            ColorSource::Distance(DistanceFrom::Place(DVec3::new(0.1, -2e9, 3.0))),
        ];
        for source in ColorSource::ALL.into_iter().chain(further) {
            assert_eq!(source.to_string().parse(), Ok(source));
        }
        assert_eq!("height:-y".parse(), Ok(further[2]));
        for wrong in [
            "",
            "sound",
            "scalar:",
            "file:x",
            "height:w",
            "height:",
            "height:--x",
            "distance:1,2",
            "distance:1,2,nan",
        ] {
            assert!(wrong.parse::<ColorSource>().is_err(), "{wrong}");
        }
    }
}
