//! What one step of a coordinate means.

/// The unit of coordinates, where a format or a file says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthUnit {
    /// Metres.
    Metre,
    /// Millimetres.
    Millimetre,
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
            Self::Foot => "ft",
            Self::SurveyFoot => "ftUS",
        }
    }

    /// The unit under a code of the EPSG, as in keys of `GeoTIFF`.
    pub fn of_epsg(code: u16) -> Option<Self> {
        match code {
            9001 => Some(Self::Metre),
            1025 => Some(Self::Millimetre),
            9002 => Some(Self::Foot),
            9003 => Some(Self::SurveyFoot),
            _ => None,
        }
    }

    /// The unit of so many metres.
    pub fn of_metres(metres: f64) -> Option<Self> {
        let units = [
            (1.0, Self::Metre),
            (0.001, Self::Millimetre),
            (0.3048, Self::Foot),
            (1200.0 / 3937.0, Self::SurveyFoot),
        ];
        let is = |length: f64| (metres / length - 1.0).abs() < 1e-7;
        units.into_iter().find(|(length, _)| is(*length)).map(|(_, unit)| unit)
    }
}
