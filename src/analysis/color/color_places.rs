//! Batch lookup of the positions of many numbers in a colour table.
//!
//! How it works: single precision and no branches where that is as exact as the numbers themselves, so that the
//! compiler vectorises over several numbers; logarithms by a table of 1,025 entries with linear interpolation (error 2
//! · 10⁻⁷, like that of f32). Cases that single precision cannot represent (ends beyond its range, offsets under a
//! logarithm, equal ends) are computed one by one by [`ColorScale`].

use super::color_maps::TABLE_LEN;
use super::color_scale::{ColorScale, Mapper};
use std::sync::OnceLock;

/// The place of NaN: behind the table.
pub(crate) const NO_PLACE: u32 = TABLE_LEN as u32;

/// Bits of a mantissa that choose an entry of the table of logarithms; the rest is for the line to the next.
const LOG_BITS: u32 = 10;

/// Ranges of fewer octaves are computed one by one: f32 would lose digits of the logarithm.
const MIN_OCTAVES: f64 = 0.25;

type Logarithms = [f32; (1 << LOG_BITS) + 1];

/// A scale made ready for many numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Placer {
    Linear { low: f32, factor: f32 },
    Logarithmic { low: f32, factor: f32 },
    Exact(Mapper),
}

impl Placer {
    /// For numbers from which `offset` was taken.
    pub(crate) fn new(scale: &ColorScale, offset: f64) -> Self {
        let [low, high] = scale.ends();
        let is_narrow = |value: f64| (f64::from(f32::MIN_POSITIVE)..1e37).contains(&value.abs());
        if scale.is_logarithmic() {
            let octaves = high.log2() - low.log2();
            if offset == 0.0 && octaves >= MIN_OCTAVES && is_narrow(low) && is_narrow(high) {
                return Self::Logarithmic {
                    low: low.log2() as f32,
                    factor: (1.0 / octaves) as f32,
                };
            }
        } else {
            let extent = high - low;
            let low = low - offset;
            if is_narrow(extent) && (low == 0.0 || is_narrow(low)) && extent < 1e36 {
                return Self::Linear {
                    low: low as f32,
                    factor: (1.0 / extent) as f32,
                };
            }
        }
        Self::Exact(scale.mapper(offset))
    }

    /// The entries of a map's table that are nearest to `values`, one for one; [`NO_PLACE`] for NaN.
    pub(crate) fn place(&self, values: &[f32], places: &mut [u32]) {
        let pairs = places.iter_mut().zip(values);
        match *self {
            Self::Linear { low, factor } => {
                for (place, value) in pairs {
                    *place = nearest((value - low) * factor);
                }
            }
            Self::Logarithmic { low, factor } => {
                let logarithms = logarithms();
                for (place, &value) in pairs {
                    *place = nearest((log2(value, logarithms) - low) * factor);
                }
            }
            Self::Exact(mapper) => {
                for (place, &value) in pairs {
                    *place = nearest(mapper.share(f64::from(value)));
                }
            }
        }
    }
}

/// The entry that is nearest to a share.
#[inline]
fn nearest(share: f32) -> u32 {
    // f32 of this magnitude are whole numbers, and their lowest bits count up from it: adding it rounds, without a
    // conversion that the compiler would not vectorise.
    const WHOLE: f32 = 8_388_608.0;
    const LAST: f32 = (TABLE_LEN - 1) as f32;
    let place = (share * LAST).clamp(0.0, LAST);
    let place = if share.is_nan() { NO_PLACE as f32 } else { place };
    (place + WHOLE).to_bits() - WHOLE.to_bits()
}

fn logarithms() -> &'static Logarithms {
    static LOGARITHMS: OnceLock<Logarithms> = OnceLock::new();
    LOGARITHMS
        .get_or_init(|| std::array::from_fn(|entry| (1.0 + entry as f64 / f64::from(1 << LOG_BITS)).log2() as f32))
}

/// The logarithm to base 2. Zero, negative and subnormal numbers map below all others; NaN stays NaN.
#[inline]
fn log2(value: f32, logarithms: &Logarithms) -> f32 {
    const REST: u32 = f32::MANTISSA_DIGITS - 1 - LOG_BITS;
    // Infinity does not occur among the values, and behaves like a very large number.
    let bits = value.max(f32::MIN_POSITIVE).to_bits();
    let exponent = (bits >> 23) as i32 - 127;
    let mantissa = bits & 0x007f_ffff;
    let entry = (mantissa >> REST) as usize;
    let weight = (mantissa & ((1 << REST) - 1)) as f32 / (1 << REST) as f32;
    let [from, to] = [logarithms[entry], logarithms[entry + 1]];
    let logarithm = exponent as f32 + (from + (to - from) * weight);
    if value.is_nan() { value } else { logarithm }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn places_of(scale: &ColorScale, offset: f64, values: &[f32]) -> Vec<u32> {
        let mut places = vec![0; values.len()];
        Placer::new(scale, offset).place(values, &mut places);
        places
    }

    #[test]
    fn ends_midpoint_and_nan_map_to_their_places() {
        let last = NO_PLACE - 1;
        let linear = ColorScale::new(10.0, 30.0, false);
        let values = [10.0, 20.0, 30.0, -f32::MAX, f32::MAX, f32::NAN];
        let expected = [0, last / 2, last, 0, last, NO_PLACE];
        assert_eq!(places_of(&linear, 0.0, &values), expected);
        let decades = ColorScale::new(1.0, 10_000.0, true);
        let values = [1.0, 100.0, 10_000.0, 0.0, -3.0, f32::NAN];
        let expected = [0, last / 2, last, 0, 0, NO_PLACE];
        assert_eq!(places_of(&decades, 0.0, &values), expected);
        let one = ColorScale::new(5.0, 5.0, false);
        assert_eq!(
            places_of(&one, 0.0, &[4.0, 5.0, 6.0, f32::NAN]),
            [0, last / 2, last, NO_PLACE]
        );
    }

    proptest! {
        #[test]
        fn places_match_the_scale(
            low in prop_oneof![-1e6f64..1e6, 1e-6f64..1.0, Just(0.0)],
            extent in prop_oneof![1e-3f64..1e6, Just(0.0), Just(1e300), Just(1e-300)],
            offset in prop_oneof![Just(0.0), -1e3f64..1e3],
            shares in prop::collection::vec(-0.5f64..1.5, 1..40), is_logarithmic: bool,
        ) {
            let scale = ColorScale::new(low, low + extent, is_logarithmic);
            let mut values: Vec<f32> = shares.iter().map(|&share| (scale.value_at(share) - offset) as f32).collect();
            values.sort_by(f32::total_cmp);
            let places = places_of(&scale, offset, &values);
            prop_assert!(places.is_sorted(), "{:?}", places);
            let [low, high] = scale.ends();
            // Values that f32 cannot distinguish are not counted as errors.
            let ulp = f64::from(f32::EPSILON) * (low - offset).abs().max((high - offset).abs());
            prop_assume!(is_logarithmic || high == low || ulp < 1e-4 * (high - low));
            for (&value, &place) in values.iter().zip(&places) {
                let exact = nearest(scale.mapper(offset).share(f64::from(value)));
                prop_assert!(place.abs_diff(exact) <= 1, "{} {} {}", value, place, exact);
            }
        }

        #[test]
        fn logarithms_are_as_exact_as_single_precision(value in 1e-30f32..1e30) {
            let exact = f64::from(value).log2();
            let found = f64::from(log2(value, logarithms()));
            prop_assert!((found - exact).abs() <= 4e-7 + 1.2e-7 * exact.abs(), "{} {}", found, exact);
        }
    }
}
