//! Small embedded example data sets, one for each typical kind of input, so that new users can look at each: an
//! airborne LiDAR survey, a depth image, an animated model. Licences, credits and provenance:
//! `assets/examples/README.md`.

use super::opener::Made;
use super::{FrameEntry, FrameList, Reel, Source};
use std::sync::Arc;

/// The word before their names.
const WORD: &str = "example";

/// The examples, by their names.
pub(super) const EXAMPLES: Made = Made {
    has_word: |word| word == WORD,
    said: || {
        let names = Example::ALL.map(Example::name).join(", ");
        format!("an example ({names}), such as {}", Example::Lidar.input())
    },
    make: |_, name| {
        let example = Example::ALL.into_iter().find(|example| example.name() == name);
        example.map(Example::source)
    },
};

/// Embedded example data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Example {
    /// Fields next to a stadium, an airborne LiDAR scan with colours.
    Lidar,
    /// Depth camera image of a plant, an organised point cloud.
    Depth,
    /// A fox that looks around: points on an animated model.
    Model,
}

/// A file of the examples.
macro_rules! asset {
    ($file:literal) => {
        include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/examples/", $file))
    };
}

impl Example {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Lidar, Self::Depth, Self::Model];

    /// The word behind `example:` on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lidar => "lidar",
            Self::Depth => "depth",
            Self::Model => "model",
        }
    }

    /// Returns the input string that opens the example, as written where an input is expected.
    pub fn input(self) -> String {
        format!("{WORD}:{}", self.name())
    }

    /// Returns a human-readable title describing the kind of data.
    pub fn title(self) -> &'static str {
        match self {
            Self::Lidar => "LiDAR survey",
            Self::Depth => "Depth image",
            Self::Model => "Animated model",
        }
    }

    /// The credit line.
    pub fn credit(self) -> &'static str {
        match self {
            Self::Lidar => "Next to Autzen Stadium, from laspy (BSD-2-Clause, © Grant Brown and others)",
            Self::Depth => "Aloe, Middlebury 2006 (Scharstein and Pal 2007), from OpenCV (Apache-2.0)",
            Self::Model => {
                "Fox by PixelMannen (CC0), rig and animation by tomkranis (CC BY 4.0), glTF by AsoboStudio and scurest"
            }
        }
    }

    /// A small image of it, a PNG.
    pub fn picture(self) -> &'static [u8] {
        match self {
            Self::Lidar => asset!("lidar.png"),
            Self::Depth => asset!("depth.png"),
            Self::Model => asset!("model.png"),
        }
    }

    /// The sequence file.
    fn bytes(self) -> &'static [u8] {
        match self {
            Self::Lidar => asset!("lidar.reel"),
            Self::Depth => asset!("depth.reel"),
            Self::Model => asset!("model.reel"),
        }
    }

    /// Its frames.
    pub fn source(self) -> Arc<dyn Source> {
        match Reel::embedded(&self.input(), self.bytes()) {
            Ok(reel) => Arc::new(reel),
            // A program built with a damaged file reports that as for any other file.
            Err(error) => {
                let problem = error.to_string();
                let entry = FrameEntry::embedded(self.input(), self.bytes());
                Arc::new(FrameList::new(vec![entry], move |_, _| Err(problem.clone().into())))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Progress;

    #[test]
    fn every_example_can_be_read_is_small_and_has_a_thumbnail() {
        for example in Example::ALL {
            assert!(example.bytes().len() <= 500 << 10, "{example:?}");
            assert!(example.picture().len() <= 48 << 10, "{example:?}");
            let picture = image::load_from_memory(example.picture()).unwrap();
            assert_eq!((picture.width(), picture.height()), (280, 210), "{example:?}");
            let source = example.source();
            assert_eq!(source.inputs(), [std::path::PathBuf::from(example.input())]);
            assert!(!source.may_grow() && source.look_again().unwrap() == 0);
            let mut decoder = source.decoder();
            for index in source.frames() {
                let entry = source.entry(index);
                let decoded = decoder.decode(index, &entry, usize::MAX, &Progress::default());
                assert!(decoded.unwrap().cloud.positions.len() > 1000, "{example:?}");
            }
        }
    }

    #[test]
    fn example_names_are_unique() {
        for example in Example::ALL {
            let same = Example::ALL.into_iter().filter(|other| other.name() == example.name());
            assert_eq!(same.count(), 1);
            assert!(!example.credit().is_empty() && !example.title().is_empty());
        }
    }
}
