//! Numbers as display text.

use crate::cloud::LengthUnit;

/// Parses the output of [`counted`](crate::messages::counted), or a bare number.
pub(in crate::app) fn parse_counted(text: &str) -> Option<f64> {
    text.split_whitespace().next()?.replace(',', "").parse().ok()
}

/// Bytes with a binary unit.
pub(in crate::app) fn bytes(count: u64) -> String {
    const UNITS: [&str; 5] = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut value = count as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    if unit == 0 {
        format!("{count} B")
    } else {
        format!("{value:.1} {}", UNITS[unit])
    }
}

/// Nine digits, which is more than f32 positions hold.
pub(in crate::app) fn significant(value: f64) -> String {
    rounded_to(value, 9)
}

/// Four digits, for display; copying a number gives all of them.
pub(in crate::app) fn readable(value: f64) -> String {
    rounded_to(value, 4)
}

/// A length to be read, with its unit where it is known.
pub(in crate::app) fn with_unit(value: f64, unit: Option<LengthUnit>) -> String {
    let symbol = unit.map_or_else(String::new, |unit| format!(" {}", unit.symbol()));
    readable(value) + &symbol
}

/// A number rounded to this many digits, at least 1.
pub(in crate::app) fn rounded_to(value: f64, digits: i32) -> String {
    let magnitude = value.abs().log10().floor();
    if !(-6.0..12.0).contains(&magnitude) {
        return if value == 0.0 {
            "0".to_owned()
        } else {
            format!("{value:.0$e}", (digits - 1) as usize)
        };
    }
    let decimals = (digits - 1 - magnitude as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        assert_eq!(parse_counted("-12 frames"), Some(-12.0));
        assert_eq!(parse_counted("1,234 frames"), Some(1234.0));
        assert_eq!(bytes(1023), "1023 B");
        assert_eq!(bytes(1024), "1.0 KiB");
        assert_eq!(bytes(3 << 29), "1.5 GiB");
    }

    #[test]
    fn numbers_have_at_most_nine_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.1 + 0.2, "0.3"),
            (1.0 / 3.0, "0.333333333"),
            (-1234.5, "-1234.5"),
            (4_510_731.123_456, "4510731.12"),
            (1e15, "1.00000000e15"),
            (1.5e-9, "1.50000000e-9"),
            (100.0, "100"),
        ] {
            assert_eq!(significant(value), text);
        }
        for (value, text) in [(2.0 / 3.0, "0.6667"), (12_345.6, "12346"), (1.5e-9, "1.500e-9")] {
            assert_eq!(rounded_to(value, 4), text);
        }
    }
}
