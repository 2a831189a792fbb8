//! A view as a line of text that a person can read, send and paste.

use crate::scene::{Camera, ParseChoiceError, PicturePlane, Projection, UpAxis};
use glam::{DVec2, DVec3};
use std::fmt;
use std::str::FromStr;

/// Prefix of the line, its version included.
const HEAD: &str = "pointreel view 1:";

/// Fields of view allowed in a text, degrees.
const FOV_RANGE_DEG: std::ops::RangeInclusive<f64> = 1.0..=170.0;

/// Distances allowed in a text, scene units: those that f32 near planes can show.
const DISTANCE_RANGE: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// Reasons why a text is not a view.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParseViewError {
    /// Another text, or one of another version.
    #[error(
        "this is not a view: expected a line such as `{HEAD} target 0 0 0 distance 2.5 azimuth 30 elevation 15 fov 45 \
         up y perspective`"
    )]
    NoView,
    /// A part is not there.
    #[error("the view ends before its {what}")]
    Missing {
        /// Expected content.
        what: &'static str,
    },
    /// Another word than the one that stands there.
    #[error("`{}` in a view where `{expected}` was expected", clipped(.found))]
    Word {
        /// Expected content.
        expected: &'static str,
        /// Text found instead.
        found: String,
    },
    /// An invalid number, or not one of these.
    #[error("`{}` is not a valid {what} of a view: expected {expected}", clipped(.found))]
    Number {
        /// The name of the number.
        what: &'static str,
        /// Text found instead.
        found: String,
        /// Expected content.
        expected: &'static str,
    },
    /// A word that names no choice.
    #[error(transparent)]
    Choice(#[from] ParseChoiceError),
    /// Something after the end.
    #[error("`{}` after the end of a view", clipped(.found))]
    TooMuch {
        /// Text found instead.
        found: String,
    },
}

/// The beginning of a word: a clipboard may hold anything.
fn clipped(word: &str) -> String {
    const LONGEST: usize = 24;
    match word.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &word[..end]),
        None => word.to_owned(),
    }
}

impl fmt::Display for Camera {
    /// One line from which [`Camera::from_str`] makes the same camera, to the last bit.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec3 { x, y, z } = self.target_in_world;
        write!(
            f,
            "{HEAD} target {x} {y} {z} distance {} azimuth {} elevation {} fov {} up {} {}",
            self.distance,
            self.azimuth_deg,
            self.elevation_deg,
            self.fov_deg,
            self.up.name(),
            self.projection
        )?;
        let PicturePlane {
            roll_deg,
            shift,
            pixel_aspect,
        } = self.plane;
        if self.plane == PicturePlane::CENTERED {
            return Ok(());
        }
        write!(
            f,
            " roll {roll_deg} shift {} {} aspect {pixel_aspect}",
            shift.x, shift.y
        )
    }
}

impl FromStr for Camera {
    type Err = ParseViewError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parts = text.trim().strip_prefix(HEAD);
        let mut words = TextTokens(parts.ok_or(ParseViewError::NoView)?.split_whitespace());
        words.expect("target")?;
        let finite = |what| Asked::new(what, "a finite number");
        let is_finite = |value: &f64| value.is_finite();
        let mut camera = Self {
            target_in_world: DVec3::new(
                words.number(finite("target"), is_finite)?,
                words.number(finite("target"), is_finite)?,
                words.number(finite("target"), is_finite)?,
            ),
            distance: words.named(Asked::new("distance", "a number above 0"), |value| {
                DISTANCE_RANGE.contains(value)
            })?,
            azimuth_deg: words.named(finite("azimuth"), is_finite)?,
            elevation_deg: words.named(Asked::new("elevation", "degrees from -90 to 90"), |value| {
                (-90.0..=90.0).contains(value)
            })?,
            fov_deg: words.named(Asked::new("fov", "degrees from 1 to 170"), |value| {
                FOV_RANGE_DEG.contains(value)
            })?,
            up: {
                words.expect("up")?;
                clipped(words.next("up axis")?).parse::<UpAxis>()?
            },
            projection: clipped(words.next("projection")?).parse::<Projection>()?,
            plane: PicturePlane::CENTERED,
        };
        let mut rest = words.0.clone();
        if rest.next() == Some("roll") {
            camera.plane = PicturePlane {
                roll_deg: words.named(finite("roll"), is_finite)?,
                shift: {
                    let within = Asked::new("shift", "a number of heights from -10 to 10");
                    let is_within = |value: &f64| (-10.0..=10.0).contains(value);
                    DVec2::new(words.named(within, is_within)?, words.number(within, is_within)?)
                },
                pixel_aspect: words.named(Asked::new("aspect", "a number from 0.01 to 100"), |value| {
                    (0.01..=100.0).contains(value)
                })?,
            };
        }
        match words.0.next() {
            None => Ok(camera),
            Some(found) => Err(ParseViewError::TooMuch {
                found: found.to_owned(),
            }),
        }
    }
}

/// A number of a text, and its requirement.
#[derive(Clone, Copy)]
struct Asked {
    what: &'static str,
    expected: &'static str,
}

impl Asked {
    const fn new(what: &'static str, expected: &'static str) -> Self {
        Self { what, expected }
    }
}

/// Remaining tokens of a text.
struct TextTokens<'a>(std::str::SplitWhitespace<'a>);

impl<'a> TextTokens<'a> {
    fn next(&mut self, what: &'static str) -> Result<&'a str, ParseViewError> {
        self.0.next().ok_or(ParseViewError::Missing { what })
    }

    fn expect(&mut self, expected: &'static str) -> Result<(), ParseViewError> {
        let found = self.next(expected)?;
        if found == expected {
            return Ok(());
        }
        Err(ParseViewError::Word {
            expected,
            found: found.to_owned(),
        })
    }

    /// The next number, checked by `is_valid`.
    fn number(&mut self, asked: Asked, is_valid: impl Fn(&f64) -> bool) -> Result<f64, ParseViewError> {
        let Asked { what, expected } = asked;
        let found = self.next(what)?;
        let number = found.parse().ok().filter(is_valid);
        number.ok_or_else(|| ParseViewError::Number {
            what,
            found: found.to_owned(),
            expected,
        })
    }

    /// A number after its name.
    fn named(&mut self, asked: Asked, is_valid: impl Fn(&f64) -> bool) -> Result<f64, ParseViewError> {
        self.expect(asked.what)?;
        self.number(asked, is_valid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn camera() -> Camera {
        Camera {
            target_in_world: DVec3::new(4_510_731.25, -0.1, 1e-7),
            distance: 2.5,
            azimuth_deg: -30.0,
            elevation_deg: 15.0,
            fov_deg: 45.0,
            up: UpAxis::NegY,
            projection: Projection::Orthographic,
            plane: PicturePlane::CENTERED,
        }
    }

    #[test]
    fn a_sensor_view_is_written_with_additional_words() {
        let plane = PicturePlane {
            roll_deg: -3.5,
            shift: DVec2::new(0.0125, -0.03),
            pixel_aspect: 0.998,
        };
        let text = Camera { plane, ..camera() }.to_string();
        assert!(
            text.ends_with("orthographic roll -3.5 shift 0.0125 -0.03 aspect 0.998"),
            "{text}"
        );
        assert_eq!(text.parse(), Ok(Camera { plane, ..camera() }));
        for (from, to, message) in [
            (
                "aspect 0.998",
                "aspect 0",
                "`0` is not a valid aspect of a view: expected a number from 0.01 to 100",
            ),
            ("shift 0.0125", "shift nan", "`nan` is not a valid shift of a view"),
            ("aspect 0.998", "", "the view ends before its aspect"),
            ("0.998", "0.998 on", "`on` after the end of a view"),
        ] {
            let error = text.replacen(from, to, 1).parse::<Camera>().unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn a_view_is_one_readable_line() {
        let text = camera().to_string();
        assert_eq!(
            text,
            "pointreel view 1: target 4510731.25 -0.1 0.0000001 distance 2.5 azimuth -30 elevation 15 fov 45 up -y \
             orthographic"
        );
        assert_eq!(format!("  {text}\n").parse(), Ok(camera()));
    }

    proptest! {
        #[test]
        fn every_view_round_trips_bit_for_bit(
            target in prop::array::uniform3(-1e12f64..1e12),
            distance_exponent in -29f64..29.0,
            angles in (-180f64..180.0, -90f64..=90.0, 1f64..=170.0),
            up in 0..6usize,
            roll in prop_oneof![Just((0.0, 0.0)), (-180f64..180.0, -1f64..1.0)],
            is_orthographic: bool,
        ) {
            let camera = Camera {
                target_in_world: DVec3::from_array(target),
                distance: 10f64.powf(distance_exponent),
                azimuth_deg: angles.0,
                elevation_deg: angles.1,
                fov_deg: angles.2,
                up: UpAxis::ALL[up].1,
                projection: Projection::ALL[usize::from(is_orthographic)],
                plane: PicturePlane {
                    roll_deg: roll.0,
                    shift: DVec2::new(roll.1, -roll.1),
                    pixel_aspect: 1.0 + 0.5 * roll.1,
                },
            };
            prop_assert_eq!(camera.to_string().parse(), Ok(camera));
        }

        #[test]
        fn no_text_causes_a_panic(text in ".*", cut in 0usize..200) {
            let _ = text.parse::<Camera>();
            let whole = camera().to_string();
            // The text is ASCII.
            prop_assert!(whole[..cut.min(whole.len() - 13)].parse::<Camera>().is_err());
        }
    }

    #[test]
    fn errors_state_what_was_expected() {
        let good = camera().to_string();
        for (from, to, message) in [
            ("view 1", "view 2", "this is not a view"),
            (
                "-0.1",
                "nan",
                "`nan` is not a valid target of a view: expected a finite number",
            ),
            ("-0.1 ", "", "`distance` is not a valid target of a view"),
            ("distance 2.5", "distance 0", "`0` is not a valid distance of a view"),
            ("distance", "length", "`length` in a view where `distance` was expected"),
            ("elevation 15", "elevation 91", "degrees from -90 to 90"),
            ("fov 45", "fov 171", "degrees from 1 to 170"),
            ("-y", "w", "unknown up axis `w`"),
            ("orthographic", "fisheye", "unknown projection `fisheye`"),
            ("orthographic", "", "the view ends before its projection"),
            ("orthographic", "orthographic 1", "`1` after the end"),
        ] {
            let damaged = good.replacen(from, to, 1);
            assert_ne!(damaged, good);
            let error = damaged.parse::<Camera>().unwrap_err().to_string();
            assert!(error.contains(message), "{damaged}: {error}");
        }
    }
}
