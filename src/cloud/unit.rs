//! Length units: the meaning of one step of a coordinate.

/// The unit of coordinates, where a format or a file defines it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// Metres.
    Metre,
    /// Millimetres.
    Millimetre,
    /// Centimetres.
    Centimetre,
    /// International feet.
    Foot,
    /// Feet of surveys in the United States: two millionths longer.
    SurveyFoot,
}

impl LengthUnit {
    /// Its symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Foot => "ft",
            Self::SurveyFoot => "ftUS",
        }
    }

    /// The unit under a code of the EPSG, as in keys of `GeoTIFF`.
    pub fn of_epsg(code: u16) -> Option<Self> {
        match code {
            9001 => Some(Self::Metre),
            1025 => Some(Self::Millimetre),
            1033 => Some(Self::Centimetre),
            9002 => Some(Self::Foot),
            9003 => Some(Self::SurveyFoot),
            _ => None,
        }
    }

    /// Its length.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Millimetre => 0.001,
            Self::Centimetre => 0.01,
            Self::Foot => 0.3048,
            Self::SurveyFoot => 1200.0 / 3937.0,
        }
    }

    /// The unit of this many metres.
    pub fn of_metres(metres: f64) -> Option<Self> {
        let units = [
            Self::Metre,
            Self::Millimetre,
            Self::Centimetre,
            Self::Foot,
            Self::SurveyFoot,
        ];
        let is = |unit: &Self| (metres / unit.metres() - 1.0).abs() < 1e-7;
        units.into_iter().find(is)
    }
}
