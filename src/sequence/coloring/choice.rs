//! The choice of colours.

use super::range::ColorRange;
use super::source::ColorSource;
use crate::analysis::ColorMap;

/// The default colour of every point under [`ColorSource::Uniform`]: a light grey that shows shading in both
/// directions.
pub const UNIFORM_COLOR: [u8; 4] = [200, 200, 200, 255];

/// Uniform colour without alpha.
pub(in crate::sequence) const UNIFORM_RGB: [u8; 3] = [200, 200, 200];

/// Colouring of points. A missing colour source is replaced as [`ColorSource::Auto`] would.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coloring {
    /// Colour source: the attribute that the colours show.
    pub source: ColorSource,
    /// Colour map from numbers to colours.
    pub map: ColorMap,
    /// The numbers in the first and the last colour.
    pub range: ColorRange,
    /// Steps of colour are steps of the logarithm; evenly where no number is above zero.
    pub is_logarithmic: bool,
    /// Red, green and blue of [`ColorSource::Uniform`].
    pub one_color: [u8; 3],
}

impl Coloring {
    /// A source, and the rest as usual.
    pub const fn of(source: ColorSource) -> Self {
        Self {
            source,
            map: ColorMap::Viridis,
            range: ColorRange::USUAL,
            is_logarithmic: false,
            one_color: UNIFORM_RGB,
        }
    }

    /// Changes the source. Numbers of one source mean nothing for another: the range is the default one then.
    pub fn choose(&mut self, source: ColorSource) {
        if self.source != source {
            self.source = source;
            self.range = ColorRange::USUAL;
            self.is_logarithmic = false;
        }
    }
}

impl Default for Coloring {
    fn default() -> Self {
        Self::of(ColorSource::Auto)
    }
}

impl From<ColorSource> for Coloring {
    fn from(source: ColorSource) -> Self {
        Self::of(source)
    }
}
