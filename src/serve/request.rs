//! What is asked for, and what is answered.

use std::fmt::Write as _;
use std::ops::Range;
use std::time::{SystemTime, UNIX_EPOCH};

/// Headers of a request.
const MOST_HEADERS: usize = 64;

/// A request, as far as it matters here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Request {
    method: Method,
    target: String,
    range: Option<String>,
    keeps_open: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Method {
    Get,
    Head,
    Other,
    /// It is no request.
    Bad,
}

impl Request {
    /// The request that `bytes` begin with and where it ends; `None` if it has not ended yet.
    pub(super) fn parse(bytes: &[u8]) -> Result<Option<(Self, usize)>, httparse::Error> {
        let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
        let mut parsed = httparse::Request::new(&mut headers);
        let httparse::Status::Complete(end) = parsed.parse(bytes)? else {
            return Ok(None);
        };
        let header = |name: &str| {
            let found = parsed
                .headers
                .iter()
                .find(|header| header.name.eq_ignore_ascii_case(name));
            found
                .and_then(|header| std::str::from_utf8(header.value).ok())
                .map(str::trim)
        };
        let has_body =
            header("content-length").is_some_and(|length| length != "0") || header("transfer-encoding").is_some();
        let closes = header("connection").is_some_and(|value| value.eq_ignore_ascii_case("close"));
        let request = Self {
            method: match parsed.method {
                // What follows would be taken for a request.
                _ if has_body => Method::Bad,
                Some("GET") => Method::Get,
                Some("HEAD") => Method::Head,
                _ => Method::Other,
            },
            target: parsed.path.unwrap_or_default().to_owned(),
            range: header("range").map(str::to_owned),
            keeps_open: parsed.version == Some(1) && !closes,
        };
        Ok(Some((request, end)))
    }

    /// What cannot be understood.
    pub(super) fn bad() -> Self {
        Self {
            method: Method::Bad,
            target: String::new(),
            range: None,
            keeps_open: false,
        }
    }

    /// The answer where there is a file of `len` bytes called `target`.
    pub(super) fn answer(&self, target: &str, len: u64, modified: Option<SystemTime>) -> Answer {
        let plain = |status| Answer {
            status,
            length: 0,
            fields: Vec::new(),
            body: None,
            keeps_open: self.keeps_open && self.method != Method::Bad,
        };
        match self.method {
            Method::Bad => return plain("400 Bad Request"),
            Method::Other => {
                let mut answer = plain("405 Method Not Allowed");
                answer.fields.push(("Allow", "GET, HEAD".to_owned()));
                return answer;
            }
            Method::Get | Method::Head => {}
        }
        let path = self.target.split(['?', '#']).next().unwrap_or_default();
        if path != target {
            return plain("404 Not Found");
        }
        let (status, range) = match self.range.as_deref().map(|range| parsed_range(range, len)) {
            // Ranges of another form are answered by the whole.
            None | Some(ParsedRange::Other) => ("200 OK", 0..len),
            Some(ParsedRange::Bytes(range)) => ("206 Partial Content", range),
            Some(ParsedRange::Outside) => {
                let mut answer = plain("416 Range Not Satisfiable");
                answer.fields.push(("Content-Range", format!("bytes */{len}")));
                return answer;
            }
        };
        let mut answer = plain(status);
        answer.length = range.end - range.start;
        answer.fields.push(("Accept-Ranges", "bytes".to_owned()));
        answer
            .fields
            .push(("Content-Type", "application/octet-stream".to_owned()));
        // A picture of points in a page of somebody else's may read it.
        answer.fields.push(("Access-Control-Allow-Origin", "*".to_owned()));
        if let Some(age) = modified.and_then(|time| time.duration_since(UNIX_EPOCH).ok()) {
            answer
                .fields
                .push(("ETag", format!("\"{len:x}-{:x}\"", age.as_nanos())));
        }
        if status.starts_with("206") {
            let last = range.end - 1;
            answer
                .fields
                .push(("Content-Range", format!("bytes {}-{last}/{len}", range.start)));
        }
        answer.body = (self.method == Method::Get).then_some(range);
        answer
    }
}

/// What is sent back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Answer {
    status: &'static str,
    length: u64,
    fields: Vec<(&'static str, String)>,
    /// Which bytes of the file follow.
    pub(super) body: Option<Range<u64>>,
    pub(super) keeps_open: bool,
}

impl Answer {
    pub(super) fn head(&self) -> String {
        let mut head = format!("HTTP/1.1 {}\r\nContent-Length: {}\r\n", self.status, self.length);
        for (name, value) in &self.fields {
            // Writing to a String cannot fail.
            let _ = write!(head, "{name}: {value}\r\n");
        }
        if !self.keeps_open {
            head.push_str("Connection: close\r\n");
        }
        head.push_str("\r\n");
        head
    }
}

enum ParsedRange {
    Bytes(Range<u64>),
    /// Beyond the end.
    Outside,
    /// Several ranges, or another unit.
    Other,
}

/// `bytes=0-99`, `bytes=100-` and `bytes=-100` of a file of `len` bytes.
fn parsed_range(text: &str, len: u64) -> ParsedRange {
    let bounds = text.strip_prefix("bytes=").and_then(|range| range.split_once('-'));
    let Some((first, last)) = bounds.filter(|(_, last)| !last.contains(',')) else {
        return ParsedRange::Other;
    };
    let number = |text: &str| text.trim().parse::<u64>();
    let range = match (first.trim().is_empty(), number(first), number(last)) {
        (true, _, Ok(count)) => len.saturating_sub(count)..len,
        (false, Ok(first), Ok(last)) if last >= first => first..len.min(last.saturating_add(1)),
        (false, Ok(first), Err(_)) if last.trim().is_empty() => first..len,
        _ => return ParsedRange::Other,
    };
    if range.is_empty() {
        ParsedRange::Outside
    } else {
        ParsedRange::Bytes(range)
    }
}

/// A name as it stands in a URL: all but letters, digits and `-._~` as `%` and two digits (RFC 3986 §2.1).
pub(super) fn encoded(name: &str) -> String {
    let mut encoded = String::new();
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            encoded.push(byte.into());
        } else {
            // Writing to a String cannot fail.
            let _ = write!(encoded, "%{byte:02X}");
        }
    }
    encoded
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answer(request: &str, len: u64) -> Answer {
        let (request, end) = Request::parse(request.as_bytes()).unwrap().unwrap();
        assert!(end > 0);
        request.answer("/a.reel", len, None)
    }

    fn get(range: &str) -> String {
        format!("GET /a.reel HTTP/1.1\r\nHost: x\r\nRange: {range}\r\n\r\n")
    }

    #[test]
    fn ranges_are_those_of_the_standard() {
        let cases = [
            ("bytes=0-0", Some(0..1)),
            ("bytes=10-19", Some(10..20)),
            ("bytes=10-", Some(10..100)),
            ("bytes=-10", Some(90..100)),
            ("bytes=-1000", Some(0..100)),
            ("bytes=90-1000", Some(90..100)),
            ("bytes=100-", None),
            ("bytes=-0", None),
        ];
        for (range, expected) in cases {
            let answer = answer(&get(range), 100);
            assert_eq!(answer.body, expected, "{range}");
            let status = if expected.is_some() { "206" } else { "416" };
            assert!(answer.status.starts_with(status), "{range}: {}", answer.status);
        }
        for other in ["bytes=5-4", "bytes=a-b", "lines=1-2", "bytes=0-1,5-6", "bytes"] {
            let answer = answer(&get(other), 100);
            assert_eq!((answer.status, answer.body), ("200 OK", Some(0..100)), "{other}");
        }
        assert!(answer(&get("bytes=0-"), 0).status.starts_with("416"));
    }

    #[test]
    fn nothing_but_the_file_is_served() {
        for target in ["/", "/b.reel", "/../a.reel", "//a.reel", "/a.reel/", "/etc/passwd", "*"] {
            let answer = answer(&format!("GET {target} HTTP/1.1\r\n\r\n"), 100);
            assert_eq!((answer.status, answer.body), ("404 Not Found", None), "{target}");
        }
        let post = answer("POST /a.reel HTTP/1.1\r\n\r\n", 100);
        assert!(post.status.starts_with("405"));
        let body = answer("GET /a.reel HTTP/1.1\r\nContent-Length: 5\r\n\r\n", 100);
        assert!(body.status.starts_with("400") && !body.keeps_open);
        let head = answer("HEAD /a.reel HTTP/1.1\r\n\r\n", 100);
        assert_eq!((head.body, head.length), (None, 100));
    }

    #[test]
    fn connections_stay_open_as_long_as_both_want() {
        assert!(answer("GET /a.reel HTTP/1.1\r\n\r\n", 1).keeps_open);
        assert!(!answer("GET /a.reel HTTP/1.0\r\n\r\n", 1).keeps_open);
        assert!(!answer("GET /a.reel HTTP/1.1\r\nConnection: close\r\n\r\n", 1).keeps_open);
    }

    #[test]
    fn names_are_encoded() {
        assert_eq!(encoded("walk 1.reel"), "walk%201.reel");
        assert_eq!(encoded("ä"), "%C3%A4");
    }
}
