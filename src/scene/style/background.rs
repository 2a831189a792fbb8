//! Background behind the cloud.

use super::parse_error::ParseChoiceError;
use crate::spelling::is_same_word;
use std::str::FromStr;

/// Background behind the cloud: a vertical gradient between two colours, or one colour when they are equal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "StoredBackground")]
pub struct Background {
    /// Red, green, blue at the top edge.
    pub top: [u8; 3],
    /// Red, green, blue at the bottom edge.
    pub bottom: [u8; 3],
}

impl Background {
    /// Words, titles and values of the presets.
    pub const PRESETS: &'static [(&'static str, &'static str, Self)] = &[
        (
            "dusk",
            "Dusk",
            Self {
                top: [44, 52, 66],
                bottom: [17, 20, 26],
            },
        ),
        ("black", "Black", Self::solid([0, 0, 0])),
        ("gray", "Gray", Self::solid([119, 119, 119])),
        ("white", "White", Self::solid([255, 255, 255])),
        (
            "sky",
            "Sky",
            Self {
                top: [120, 165, 214],
                bottom: [235, 240, 245],
            },
        ),
    ];

    /// Background used instead of the default one, which is as dark as a scan at night.
    pub const BEHIND_DARK: Self = Self {
        top: [150, 160, 172],
        bottom: [92, 100, 112],
    };

    /// One colour everywhere.
    pub const fn solid(color: [u8; 3]) -> Self {
        Self {
            top: color,
            bottom: color,
        }
    }
}

/// Luma (BT.601) of a colour, 0 to 255.
pub(in crate::scene) fn luma([red, green, blue]: [u8; 3]) -> f32 {
    0.299 * f32::from(red) + 0.587 * f32::from(green) + 0.114 * f32::from(blue)
}

/// Serialised form of a background: as it is written, or as the word of the command line that `settings.json` once had.
#[derive(serde::Deserialize)]
#[serde(untagged)]
enum StoredBackground {
    Word(String),
    Edges { top: [u8; 3], bottom: [u8; 3] },
}

impl TryFrom<StoredBackground> for Background {
    type Error = ParseChoiceError;

    fn try_from(stored: StoredBackground) -> Result<Self, Self::Error> {
        match stored {
            StoredBackground::Word(text) => text.parse(),
            StoredBackground::Edges { top, bottom } => Ok(Self { top, bottom }),
        }
    }
}

impl Default for Background {
    fn default() -> Self {
        Self::PRESETS[0].2
    }
}

impl FromStr for Background {
    type Err = ParseChoiceError;

    /// Reads a preset's name, `#rrggbb`, or `#rrggbb-#rrggbb` (top to bottom).
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let preset = Self::PRESETS
            .iter()
            .find(|(word, ..)| is_same_word(word, text))
            .map(|&(.., preset)| preset);
        let parsed = preset.or_else(|| match text.split_once('-') {
            Some((top, bottom)) => Some(Self {
                top: parse_hex(top)?,
                bottom: parse_hex(bottom)?,
            }),
            None => parse_hex(text).map(Self::solid),
        });
        parsed.ok_or_else(|| {
            let presets = Self::PRESETS.iter().map(|(word, ..)| *word);
            ParseChoiceError::new("background", text, presets.chain(["#rrggbb", "#rrggbb-#rrggbb"]))
        })
    }
}

fn parse_hex(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let value = u32::from_str_radix(digits, 16).ok()?;
    Some([(value >> 16) as u8, (value >> 8) as u8, value as u8])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backgrounds_are_presets_colors_or_gradients() {
        assert_eq!("black".parse(), Ok(Background::solid([0, 0, 0])));
        assert_eq!("#0a10ff".parse(), Ok(Background::solid([10, 16, 255])));
        assert_eq!(
            "#000000-#ffffff".parse(),
            Ok(Background {
                top: [0; 3],
                bottom: [255; 3]
            })
        );
        for wrong in ["", "#12345", "#12345g", "#é1234", "000000", "#000000-"] {
            assert!(wrong.parse::<Background>().is_err(), "{wrong}");
        }
    }
}
