//! Image-based lighting: an environment around the scene that lights it from all sides.
//!
//! **How it works.** An environment is a map of linear light by direction. Two things are made of it once
//! ([`EnvironmentMap`]): nine numbers for matt surfaces (Ramamoorthi and Hanrahan 2001), and maps that are blurred as
//! rough surfaces blur what they reflect (Karis 2013). Both renderers read the same numbers.
//!
//! Environments are fixed in the scene, with its up axis: they do not move with the camera, as lamps do. Reflections
//! that slide over a surface while the camera goes around it are what distinguishes polished from painted; and a sky
//! has to stay above. Their light is scaled so that a matt white surface is at most white.

mod built_in;
mod file;
mod harmonics;
mod map;
mod octahedral;
mod prefilter;

pub use file::{EnvironmentError, EnvironmentFile};
pub use harmonics::Harmonics;
pub use map::EnvironmentMap;

use glam::Vec3;
use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::sync::{Arc, LazyLock};

/// Environment around the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Environment {
    /// Grey walls and soft lights on all sides.
    #[default]
    Studio,
    /// A clear sky with the sun, above dry ground.
    Sky,
    /// White from all sides.
    Uniform,
    /// Nothing: lamps alone, and a little light from all sides.
    None,
    /// An equirectangular image of the user.
    File(EnvironmentFile),
}

/// A built-in environment in words.
#[derive(Debug)]
pub struct EnvironmentWord {
    /// Environment that the word names.
    pub environment: Environment,
    /// On the command line and in files.
    pub word: &'static str,
    /// In the window.
    pub title: &'static str,
    /// Description of the environment.
    pub hint: &'static str,
}

impl Environment {
    /// All except files.
    pub const BUILT_IN: &'static [EnvironmentWord] = &[
        EnvironmentWord {
            environment: Self::Studio,
            word: "studio",
            title: "Studio",
            hint: "Grey walls and soft lights on all sides",
        },
        EnvironmentWord {
            environment: Self::Sky,
            word: "sky",
            title: "Sky",
            hint: "A clear sky with the sun, above dry ground",
        },
        EnvironmentWord {
            environment: Self::Uniform,
            word: "uniform",
            title: "Uniform",
            hint: "White from all sides",
        },
        EnvironmentWord {
            environment: Self::None,
            word: "none",
            title: "None",
            hint: "Lamps alone",
        },
    ];

    /// Its light; for an unreadable file, that of [`Environment::Studio`].
    pub fn map(self) -> Arc<EnvironmentMap> {
        static STUDIO: LazyLock<Arc<EnvironmentMap>> = LazyLock::new(|| made(built_in::studio));
        static SKY: LazyLock<Arc<EnvironmentMap>> = LazyLock::new(|| made(built_in::sky));
        static UNIFORM: LazyLock<Arc<EnvironmentMap>> = LazyLock::new(|| made(built_in::uniform));
        match self {
            Self::Studio => Arc::clone(&STUDIO),
            Self::Sky => Arc::clone(&SKY),
            Self::Uniform | Self::None => Arc::clone(&UNIFORM),
            Self::File(file) => file.map().unwrap_or_else(|| Arc::clone(&STUDIO)),
        }
    }
}

fn made(light: fn(Vec3) -> Vec3) -> Arc<EnvironmentMap> {
    Arc::new(EnvironmentMap::new(light))
}

impl fmt::Display for Environment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let built_in = Self::BUILT_IN.iter().find(|word| word.environment == *self);
        match (built_in, self) {
            (Some(word), _) => f.pad(word.word),
            (None, Self::File(file)) => f.pad(&file.path().to_string_lossy()),
            (None, _) => Ok(()),
        }
    }
}

impl FromStr for Environment {
    type Err = EnvironmentError;

    /// A word, or the path of an image, which is read.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match Self::of_word(text) {
            Some(built_in) => Ok(built_in),
            None => EnvironmentFile::open(Path::new(text)).map(Self::File),
        }
    }
}

impl Environment {
    fn of_word(text: &str) -> Option<Self> {
        let word = Self::BUILT_IN.iter().find(|word| word.word == text)?;
        Some(word.environment)
    }
}

impl serde::Serialize for Environment {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.to_string())
    }
}

impl<'de> serde::Deserialize<'de> for Environment {
    /// Images are read when they are needed: settings outlive them.
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = <std::borrow::Cow<'de, str>>::deserialize(deserializer)?;
        let file = || Self::File(EnvironmentFile::named(Path::new(&*text)));
        Ok(Self::of_word(&text).unwrap_or_else(file))
    }
}
