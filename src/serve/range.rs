//! Ranges of bytes (RFC 9110 §14.1.2).

use std::ops::Range;

/// The meaning of a `Range` field.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum ParsedRange {
    Bytes(Range<u64>),
    /// Nothing of the file is in it.
    Outside,
    /// Several ranges, another unit, or no range at all: answered by the whole file, as the standard allows. So no
    /// list of a thousand ranges makes a server send the file a thousand times.
    Other,
}

/// `bytes=0-99`, `bytes=100-` and `bytes=-100` of a file of `len` bytes.
pub(super) fn parsed_range(text: &str, len: u64) -> ParsedRange {
    let Some((unit, bounds)) = text.split_once('=') else {
        return ParsedRange::Other;
    };
    let Some((first, last)) = bounds
        .trim()
        .split_once('-')
        .filter(|_| unit.eq_ignore_ascii_case("bytes"))
    else {
        return ParsedRange::Other;
    };
    let range = match (digits(first), digits(last)) {
        (None, Some(count)) if first.is_empty() => len.saturating_sub(count)..len,
        (Some(first), Some(last)) if last >= first => first..len.min(last.saturating_add(1)),
        (Some(first), None) if last.is_empty() => first..len,
        _ => return ParsedRange::Other,
    };
    if range.is_empty() {
        ParsedRange::Outside
    } else {
        ParsedRange::Bytes(range)
    }
}

/// A number of digits alone; one that is larger than all is the largest.
fn digits(text: &str) -> Option<u64> {
    let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| text.parse().unwrap_or(u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ranges_follow_the_standard() {
        for (range, expected) in [
            ("bytes=0-0", 0..1),
            ("bytes=10-19", 10..20),
            ("Bytes=10-", 10..100),
            ("bytes=-10", 90..100),
            ("bytes=-1000", 0..100),
            ("bytes=90-1000", 90..100),
            ("bytes=90-99999999999999999999999", 90..100),
        ] {
            assert_eq!(parsed_range(range, 100), ParsedRange::Bytes(expected), "{range}");
        }
        for outside in ["bytes=100-", "bytes=-0", "bytes=99999999999999999999999-"] {
            assert_eq!(parsed_range(outside, 100), ParsedRange::Outside, "{outside}");
        }
        assert_eq!(parsed_range("bytes=0-", 0), ParsedRange::Outside);
        for other in [
            "bytes=5-4",
            "bytes=a-b",
            "lines=1-2",
            "bytes=0-1,5-6",
            "bytes",
            "bytes=-",
            "bytes=+1-+5",
            "bytes=--5",
            "bytes=0x1-5",
        ] {
            assert_eq!(parsed_range(other, 100), ParsedRange::Other, "{other}");
        }
    }

    proptest! {
        #[test]
        fn any_text_gives_a_range_within_the_file_or_none(text in "(bytes=)?[-0-9, +a]{0,30}", len: u64) {
            if let ParsedRange::Bytes(range) = parsed_range(&text, len) {
                prop_assert!(range.start < range.end && range.end <= len);
            }
        }
    }
}
