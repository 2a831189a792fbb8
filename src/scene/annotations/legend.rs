//! Colour legend of an image, as it is shown alongside it: a ramp with round numbers, or classes.
//!
//! It is text, colours and positions from 0 to 1; the window (`app/panels/legend.rs`) and exports (`export/overlay`)
//! draw it.

use crate::analysis::{ColorMap, ColorScale, NormalErrors, class_color, class_name, class_of};
use crate::cloud::ValueSample;
use crate::sequence::{Paint, PaintValues, PreparedFrame, plain_field_name, value_kind};

/// Maximum number of classes listed.
const MAX_CLASSES: usize = 20;

/// Maximum number of tick labels along a colour ramp.
const MAX_TICKS: usize = 7;

/// Legend of the colours of an image.
#[derive(Debug, Clone, PartialEq)]
pub struct Legend {
    /// Title: the displayed quantity, and its unit if there is one.
    pub title: String,
    /// The colours.
    pub body: LegendBody,
}

/// The colours of a legend.
#[derive(Debug, Clone, PartialEq)]
pub enum LegendBody {
    /// All of a map.
    Ramp {
        /// The map.
        map: ColorMap,
        /// Round numbers and where they stand, 0 to 1, ascending.
        ticks: Vec<(f32, String)>,
    },
    /// A colour for each class that there is.
    Classes(Vec<([u8; 4], String)>),
}

impl Legend {
    /// The legend of a frame, as it is painted; `None` if its colours are neither numbers nor classes.
    pub fn of(frame: &PreparedFrame) -> Option<Self> {
        match frame.paint() {
            Paint::File | Paint::Normal | Paint::Uniform(_) => None,
            Paint::Classes(name) => {
                let values = PaintValues::Field(*name);
                Some(Self {
                    title: field_title(name.as_str()),
                    body: LegendBody::Classes(classes(frame.frame.value_sample(), &values)),
                })
            }
            Paint::Scale { values, map, scale } => Some(Self {
                title: match values {
                    PaintValues::Field(name) => field_title(name.as_str()),
                    PaintValues::Height(_) => "Height".to_owned(),
                    PaintValues::Distance(_) => "Distance".to_owned(),
                    PaintValues::Change => "Change".to_owned(),
                },
                body: LegendBody::Ramp {
                    map: *map,
                    ticks: ticks(scale),
                },
            }),
        }
    }
}

impl Legend {
    /// The legend of an image of normal errors.
    pub fn of_errors(errors: &NormalErrors) -> Self {
        let [none, some, large] = NormalErrors::COLORS;
        let percent = |share: f64| format!("{:.1} %", 1e2 * share);
        let rows = vec![
            (none, format!("up to 1°: {}", percent(errors.below_1_deg))),
            (some, format!("up to 22.5°: {}", percent(errors.below_22_5_deg))),
            (large, format!("more: {}", percent(errors.above_22_5_deg))),
            (
                [0; 4],
                format!("mean {:.2}°, 95 % below {:.1}°", errors.mean_deg, errors.p95_deg),
            ),
        ];
        Self {
            title: "Error of normals".to_owned(),
            body: LegendBody::Classes(rows),
        }
    }
}

/// A field's name as a title, with its unit if the name has it: `gps_time` is "GPS time (s)".
pub fn field_title(name: &str) -> String {
    let name = plain_field_name(name).replace('_', " ");
    if name.eq_ignore_ascii_case("gps time") || name.eq_ignore_ascii_case("gpstime") {
        return "GPS time (s)".to_owned();
    }
    let mut letters = name.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

/// The classes of the sequence's first frame, ascending.
fn classes(sample: &ValueSample, values: &PaintValues) -> Vec<([u8; 4], String)> {
    let Some((kind, _)) = value_kind(values, sample) else {
        return Vec::new();
    };
    let sorted = sample.sorted(kind);
    let mut classes: Vec<i32> = sorted.iter().map(|&value| class_of(value)).collect();
    classes.dedup();
    let more = classes.len().saturating_sub(MAX_CLASSES);
    classes.truncate(MAX_CLASSES);
    let entry = |class: i32| {
        let text = match class_name(class) {
            Some(name) => format!("{class}  {name}"),
            None => class.to_string(),
        };
        (class_color(class), text)
    };
    let mut entries: Vec<_> = classes.into_iter().map(entry).collect();
    if more > 0 {
        entries.push(([0; 4], format!("and {more} more")));
    }
    entries
}

/// Round numbers on a scale and where they stand, ascending; seven at most, and one at least.
fn ticks(scale: &ColorScale) -> Vec<(f32, String)> {
    let [low, high] = scale.ends();
    if low == high {
        return vec![(0.5, number(low, low.abs() * 1e-3))];
    }
    let mut ticks = Vec::new();
    if scale.is_logarithmic() {
        ticks = decades(low, high);
    }
    if ticks.len() < 2 {
        ticks = even_numbers(low, high);
    }
    ticks
        .into_iter()
        .map(|(value, step)| (scale.share(value), number(value, step)))
        .collect()
}

/// Multiples of 1, 2 or 5 times a power of ten between two numbers, with their distance.
fn even_numbers(low: f64, high: f64) -> Vec<(f64, f64)> {
    // Halved first: the difference may overflow f64.
    let min = (high / 2.0 - low / 2.0) / (MAX_TICKS - 1) as f64 * 2.0;
    let power = 10f64.powf(min.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0];
    let steps = factors.map(|factor| factor * power);
    let step = steps.into_iter().find(|&step| step >= min * (1.0 - 1e-9));
    let step = step.unwrap_or(10.0 * power);
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    if !step.is_normal() || !first.is_finite() || last - first > MAX_TICKS as f64 {
        let step = (high / 2.0 - low / 2.0) / 1e3;
        return vec![(low, step), (high, step)];
    }
    (0..=(last - first) as usize)
        .map(|place| ((first + place as f64) * step, step))
        .collect()
}

/// Powers of ten between two positive numbers; where there are few, twice and five times as much as well. Each is as
/// far from the next as it is large.
fn decades(low: f64, high: f64) -> Vec<(f64, f64)> {
    let within = |value: &f64| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(value);
    let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let of = |factors: &'static [f64]| -> Vec<f64> {
        let all = powers
            .clone()
            .flat_map(|power| factors.iter().map(move |factor| factor * 10f64.powi(power)));
        all.filter(within).collect()
    };
    let mut values = of(&[1.0, 2.0, 5.0]);
    if values.len() > MAX_TICKS {
        values = of(&[1.0]);
    }
    let stride = values.len().div_ceil(MAX_TICKS).max(1);
    values.into_iter().step_by(stride).map(|value| (value, value)).collect()
}

/// A number with the digits that distinguish it from one `step` away.
fn number(value: f64, step: f64) -> String {
    /// Beyond, and for smaller steps, with an exponent.
    const PLAIN: std::ops::Range<f64> = 1e-5..1e13;
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits_below = (-step.abs().max(f64::MIN_POSITIVE).log10() - 1e-9).ceil();
    if value.abs() < PLAIN.end && step.abs() >= PLAIN.start {
        return format!("{value:.0$}", digits_below.clamp(0.0, 6.0) as usize);
    }
    let digits = value.abs().log10().floor() + digits_below;
    format!("{value:.0$e}", digits.clamp(0.0, 6.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn texts(low: f64, high: f64, is_logarithmic: bool) -> Vec<String> {
        let scale = ColorScale::new(low, high, is_logarithmic);
        ticks(&scale).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_at_round_numbers() {
        assert_eq!(texts(0.0, 255.0, false), ["0", "50", "100", "150", "200", "250"]);
        assert_eq!(texts(-0.31, 0.52, false), ["-0.2", "0", "0.2", "0.4"]);
        assert_eq!(texts(1.0, 1000.0, true), ["1", "10", "100", "1000"]);
        assert_eq!(texts(1.5, 30.0, true), ["2", "5", "10", "20"]);
        assert_eq!(texts(7.0, 7.0, false), ["7.000"]);
        let gps = texts(3.1e8, 3.1e8 + 55.0, false);
        assert_eq!(gps[1], "310000010");
        let tiny = texts(0.0, 3e-9, false);
        assert_eq!(tiny[1], "5e-10");
    }

    #[test]
    fn names_become_titles() {
        assert_eq!(field_title("scalar_Roughness"), "Roughness");
        assert_eq!(field_title("gps_time"), "GPS time (s)");
        assert_eq!(field_title("éclat"), "Éclat");
        assert_eq!(field_title(""), "");
    }

    #[test]
    fn normal_errors_are_shown_in_per_cent() {
        let errors = NormalErrors {
            points: 8,
            below_1_deg: 0.5,
            below_22_5_deg: 0.375,
            above_22_5_deg: 0.125,
            mean_deg: 4.125,
            p95_deg: 31.0,
        };
        let LegendBody::Classes(rows) = Legend::of_errors(&errors).body else {
            panic!("no list");
        };
        let texts: Vec<&str> = rows.iter().map(|(_, text)| text.as_str()).collect();
        let shares = ["up to 1°: 50.0 %", "up to 22.5°: 37.5 %", "more: 12.5 %"];
        assert_eq!(texts[..3], shares);
        assert_eq!(texts[3], "mean 4.12°, 95 % below 31.0°");
    }

    proptest! {
        #[test]
        fn ticks_are_few_ascending_and_on_the_scale(
            low in prop_oneof![-1e9f64..1e9, -1f64..1.0, Just(-f64::MAX), Just(0.0)],
            extent in prop_oneof![1e-9f64..1e9, Just(0.0), Just(f64::MAX), Just(5e-324)], is_logarithmic: bool,
        ) {
            let scale = ColorScale::new(low, low + extent, is_logarithmic);
            let ticks = ticks(&scale);
            prop_assert!((1..=MAX_TICKS + 1).contains(&ticks.len()), "{:?}", ticks);
            prop_assert!(ticks.is_sorted_by(|a, b| a.0 <= b.0));
            prop_assert!(ticks.iter().all(|(share, _)| (0.0..=1.0).contains(share)));
            prop_assert!(ticks.iter().all(|(_, text)| text.len() <= 24), "{:?}", ticks);
        }
    }
}
