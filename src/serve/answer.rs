//! Answers to requests.

use super::cors::{CorsOrigin, cors_fields};
use super::range::{ParsedRange, parsed_range};
use super::request::{Method, Request};
use std::fmt::Write as _;
use std::ops::Range;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// A date in seconds distinguishes versions of a file only if the file is older by this much (RFC 9110 §8.8.2.2).
const DATE_IS_STRONG: Duration = Duration::from_secs(2);

/// Formats a timestamp as HTTP writes it (RFC 9110 §5.6.7); `None` before 1970, which it cannot write.
fn http_date(time: SystemTime) -> Option<String> {
    (time >= UNIX_EPOCH).then(|| httpdate::fmt_http_date(time))
}

/// The file, as it is now.
#[derive(Debug, Clone, Copy)]
pub(super) struct Served<'a> {
    /// Its path in requests: `/` and its name.
    pub(super) target: &'a str,
    pub(super) len: u64,
    pub(super) modified: Option<SystemTime>,
    pub(super) now: SystemTime,
    pub(super) cors: &'a [CorsOrigin],
}

/// HTTP response.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Answer {
    status: &'static str,
    length: u64,
    fields: Vec<(&'static str, String)>,
    /// Byte range of the file that follows.
    pub(super) body: Option<Range<u64>>,
    pub(super) keeps_open: bool,
}

impl Served<'_> {
    fn etag(&self) -> Option<String> {
        let age = self.modified?.duration_since(UNIX_EPOCH).ok()?;
        Some(format!("\"{:x}-{:x}\"", self.len, age.as_nanos()))
    }

    /// True if the file is the one that `If-Range` names (RFC 9110 §13.1.5): else it is sent whole.
    fn is_same(&self, if_range: &str) -> bool {
        if if_range.contains('"') {
            // Nor is a weak tag, W/"…", one of ours.
            return self.etag().is_some_and(|etag| etag == if_range);
        }
        let Some(modified) = self.modified else {
            return false;
        };
        let is_strong = self.now.duration_since(modified).is_ok_and(|age| age >= DATE_IS_STRONG);
        is_strong && http_date(modified).is_some_and(|date| date == if_range)
    }

    /// The answer to `request`.
    pub(super) fn answer(&self, request: &Request) -> Answer {
        let plain = |status| Answer {
            keeps_open: request.keeps_open && request.method != Method::Bad,
            ..Answer::plain(status)
        };
        match request.method {
            Method::Bad => return plain("400 Bad Request"),
            Method::Options => return self.options(request, plain("204 No Content")),
            Method::Other => return plain("405 Method Not Allowed").with([("Allow", "GET, HEAD, OPTIONS".to_owned())]),
            Method::Get | Method::Head => {}
        }
        let path = request.target.split(['?', '#']).next().unwrap_or_default();
        if path != self.target {
            return plain("404 Not Found");
        }
        let len = self.len;
        let is_same = request.if_range.as_deref().is_none_or(|tag| self.is_same(tag));
        // Other methods have no ranges (RFC 9110 §14.2).
        let asked = request
            .range
            .as_deref()
            .filter(|_| is_same && request.method == Method::Get);
        let range = match asked.map(|range| parsed_range(range, len)) {
            None | Some(ParsedRange::Other) => None,
            Some(ParsedRange::Bytes(range)) => Some(range),
            Some(ParsedRange::Outside) => {
                return plain("416 Range Not Satisfiable")
                    .with([("Content-Range", format!("bytes */{len}"))])
                    .with(cors_fields(self.cors, request.origin.as_deref()));
            }
        };
        let of_range = range.as_ref().map(|range| {
            (
                "Content-Range",
                format!("bytes {}-{}/{len}", range.start, range.end - 1),
            )
        });
        let body = range.unwrap_or(0..len);
        let status = if of_range.is_some() {
            "206 Partial Content"
        } else {
            "200 OK"
        };
        Answer {
            length: body.end - body.start,
            body: (request.method == Method::Get).then_some(body),
            ..plain(status)
        }
        .with([
            ("Accept-Ranges", "bytes".to_owned()),
            ("Content-Type", "application/octet-stream".to_owned()),
        ])
        .with(http_date(self.now).map(|date| ("Date", date)))
        .with(self.etag().map(|etag| ("ETag", etag)))
        .with(self.modified.and_then(http_date).map(|date| ("Last-Modified", date)))
        .with(cors_fields(self.cors, request.origin.as_deref()))
        .with(of_range)
    }

    /// The allowed methods; for pages of other origins only if `--cors` names these.
    fn options(&self, request: &Request, answer: Answer) -> Answer {
        let cors = cors_fields(self.cors, request.origin.as_deref());
        let is_allowed = cors.iter().any(|(name, _)| *name == "Access-Control-Allow-Origin");
        let of_pages = is_allowed.then(|| {
            [
                ("Access-Control-Allow-Methods", "GET, HEAD".to_owned()),
                ("Access-Control-Allow-Headers", "Range, If-Range".to_owned()),
            ]
        });
        answer
            .with([("Allow", "GET, HEAD, OPTIONS".to_owned())])
            .with(cors)
            .with(of_pages.into_iter().flatten())
    }
}

impl Answer {
    fn plain(status: &'static str) -> Self {
        Self {
            status,
            length: 0,
            fields: Vec::new(),
            body: None,
            keeps_open: false,
        }
    }

    /// The file cannot be opened for now: descriptors are used up, or it is being replaced.
    pub(super) fn unavailable() -> Self {
        Self::plain("503 Service Unavailable").with([("Retry-After", "1".to_owned())])
    }

    fn with(mut self, fields: impl IntoIterator<Item = (&'static str, String)>) -> Self {
        self.fields.extend(fields);
        self
    }

    pub(super) fn head(&self) -> String {
        let mut head = format!("HTTP/1.1 {}\r\n", self.status);
        // RFC 9110 §8.6: no length if content is impossible.
        if !self.status.starts_with("204") {
            // Writing to a String cannot fail.
            let _ = write!(head, "Content-Length: {}\r\n", self.length);
        }
        for (name, value) in &self.fields {
            let _ = write!(head, "{name}: {value}\r\n");
        }
        if !self.keeps_open {
            head.push_str("Connection: close\r\n");
        }
        head.push_str("\r\n");
        head
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

    const MODIFIED: Duration = Duration::from_secs(784_111_777);

    fn answer_of(request: &str, cors: &[CorsOrigin]) -> Answer {
        let (request, _) = Request::parse(request.as_bytes()).unwrap().unwrap();
        let modified = UNIX_EPOCH + MODIFIED;
        let served = Served {
            target: "/a.reel",
            len: 100,
            modified: Some(modified),
            now: modified + Duration::from_mins(1),
            cors,
        };
        served.answer(&request)
    }

    fn answer(request: &str) -> Answer {
        answer_of(request, &[])
    }

    fn get(fields: &str) -> String {
        format!("GET /a.reel HTTP/1.1\r\nHost: x\r\n{fields}\r\n")
    }

    #[test]
    fn a_range_gets_partial_content_and_one_outside_the_file_length() {
        let part = answer(&get("Range: bytes=10-19\r\n"));
        assert_eq!((part.body.clone(), part.length), (Some(10..20), 10));
        assert!(part.head().contains("206 Partial Content") && part.head().contains("Content-Range: bytes 10-19/100"));
        let outside = answer(&get("Range: bytes=100-\r\n"));
        assert!(outside.status.starts_with("416") && outside.head().contains("Content-Range: bytes */100"));
        for whole in ["bytes=0-1,5-6", "bytes=5-4", "lines=1-2"] {
            let answer = answer(&get(&format!("Range: {whole}\r\n")));
            assert_eq!((answer.status, answer.body), ("200 OK", Some(0..100)), "{whole}");
        }
        let twice = answer(&get("Range: bytes=0-1\r\nRange: bytes=5-6\r\n"));
        assert_eq!(twice.body, Some(0..100));
        let head = answer("HEAD /a.reel HTTP/1.1\r\nHost: x\r\nRange: bytes=0-1\r\n\r\n");
        assert_eq!((head.status, head.body, head.length), ("200 OK", None, 100));
    }

    #[test]
    fn a_changed_file_is_sent_completely_despite_a_range() {
        let whole = answer(&get(""));
        let field = |name: &str| {
            let found = whole.fields.iter().find(|(found, _)| *found == name);
            found.map(|(_, value)| value.clone()).unwrap()
        };
        let (etag, date) = (field("ETag"), field("Last-Modified"));
        assert_eq!(date, "Sun, 06 Nov 1994 08:49:37 GMT");
        for (tag, is_same) in [
            (etag.as_str(), true),
            (date.as_str(), true),
            (&format!("W/{etag}"), false),
            ("\"other\"", false),
            ("Sun, 06 Nov 1994 08:49:38 GMT", false),
            ("Sunday, 06-Nov-94 08:49:37 GMT", false),
            ("*", false),
            ("", false),
        ] {
            let answer = answer(&get(&format!("Range: bytes=0-9\r\nIf-Range: {tag}\r\n")));
            let expected = if is_same { 0..10 } else { 0..100 };
            assert_eq!(answer.body, Some(expected), "{tag}");
        }
    }

    #[test]
    fn a_file_just_written_has_no_date_as_validator() {
        let modified = UNIX_EPOCH + MODIFIED;
        let served = Served {
            target: "/a.reel",
            len: 100,
            modified: Some(modified),
            now: modified + Duration::from_secs(1),
            cors: &[],
        };
        assert!(!served.is_same("Sun, 06 Nov 1994 08:49:37 GMT"));
    }

    #[test]
    fn nothing_but_the_file_is_served() {
        for target in [
            "/",
            "/b.reel",
            "/../a.reel",
            "//a.reel",
            "/a.reel/",
            "/etc/passwd",
            "*",
            "/a%2ereel",
        ] {
            let answer = answer(&format!("GET {target} HTTP/1.1\r\nHost: x\r\n\r\n"));
            assert_eq!((answer.status, answer.body), ("404 Not Found", None), "{target}");
        }
        assert_eq!(
            answer("GET http://y/a.reel HTTP/1.1\r\nHost: x\r\n\r\n").body,
            Some(0..100)
        );
        let post = answer("POST /a.reel HTTP/1.1\r\nHost: x\r\n\r\n");
        assert!(post.status.starts_with("405"));
        let head = answer("HEAD /a.reel HTTP/1.1\r\nHost: x\r\n\r\n");
        assert_eq!((head.body, head.length), (None, 100));
    }

    #[test]
    fn other_origins_may_only_read_where_allowed() {
        let request = get("Origin: https://a\r\n");
        assert!(!answer(&request).head().contains("Access-Control"));
        let options = "OPTIONS /a.reel HTTP/1.1\r\nHost: x\r\nOrigin: https://a\r\n\r\n";
        let head = answer(options).head();
        assert!(head.starts_with("HTTP/1.1 204 No Content\r\nAllow: GET") && !head.contains("Access-Control"));
        let allowed = [CorsOrigin::One("https://a".to_owned())];
        assert!(
            answer_of(&request, &allowed)
                .head()
                .contains("Access-Control-Allow-Origin: https://a\r\n")
        );
        assert!(
            answer_of(options, &allowed)
                .head()
                .contains("Access-Control-Allow-Headers: Range")
        );
        let other = options.replace("https://a", "https://b");
        assert!(!answer_of(&other, &allowed).head().contains("Access-Control"));
    }

    #[test]
    fn names_are_encoded() {
        assert_eq!(encoded("walk 1.reel"), "walk%201.reel");
        assert_eq!(encoded("ä"), "%C3%A4");
    }
}
