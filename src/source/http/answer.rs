//! Fields of an answer that describe the file.

use std::ops::Range;
use ureq::http::{HeaderMap, header};

/// The bytes that are sent and the length of the file, of `bytes 0-99/1234`; `None` if invalid.
pub(super) fn content_range(headers: &HeaderMap) -> Option<(Range<u64>, u64)> {
    let range = headers.get(header::CONTENT_RANGE)?.to_str().ok()?;
    let (part, whole) = range.strip_prefix("bytes ")?.split_once('/')?;
    let (first, last) = part.split_once('-')?;
    let number = |text: &str| text.trim().parse::<u64>().ok();
    let (first, last, whole) = (number(first)?, number(last)?, number(whole)?);
    (first <= last && last < whole).then(|| (first..last + 1, whole))
}

/// The version tag that identifies an unchanged file.
pub(super) fn version_of(headers: &HeaderMap) -> Option<String> {
    let header = headers.get(header::ETAG).or(headers.get(header::LAST_MODIFIED))?;
    header.to_str().ok().map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_within_their_file() {
        let parsed = |text: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::CONTENT_RANGE, text.parse().unwrap());
            content_range(&headers)
        };
        assert_eq!(parsed("bytes 0-0/1"), Some((0..1, 1)));
        assert_eq!(parsed("bytes 5-9/1234"), Some((5..10, 1234)));
        assert_eq!(parsed("bytes 0-0/18446744073709551615"), Some((0..1, u64::MAX)));
        for wrong in [
            "bytes 0-0/*",
            "bytes 0-0/0",
            "bytes 5-4/10",
            "bytes 0-10/10",
            "bytes 0-18446744073709551615/18446744073709551615",
            "bytes */10",
            "lines 0-1/10",
            "bytes -1-5/10",
            "",
        ] {
            assert_eq!(parsed(wrong), None, "{wrong}");
        }
    }
}
