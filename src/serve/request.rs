//! Requests.
//!
//! **Strictness.** Servers that read the same bytes differently let one request be hidden in another (*smuggling*, RFC
//! 9112 §11.2). So everything that the standard lets a server guess is refused: lines that end in a bare line feed,
//! lines that are folded, spaces before a colon, two lengths, a length that is not only digits, a length with a
//! transfer coding. Requests have no bodies here, and after one that is refused the connection is closed.

/// Headers of a request.
const MAX_HEADERS: usize = 64;

/// A request, as far as it matters here.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Request {
    pub(super) method: Method,
    pub(super) target: String,
    pub(super) range: Option<String>,
    pub(super) if_range: Option<String>,
    /// The origin of the requesting page.
    pub(super) origin: Option<String>,
    pub(super) keeps_open: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    Get,
    Head,
    Options,
    Other,
    /// It is not a request.
    Bad,
}

/// Bytes that are not a request, or an ambiguous one.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct NoRequest;

impl Request {
    /// The request that `bytes` begin with and where it ends; `None` if it has not ended yet.
    pub(super) fn parse(bytes: &[u8]) -> Result<Option<(Self, usize)>, NoRequest> {
        let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
        // A server crate would add an async executor for one file and two methods.
        let mut parsed = httparse::Request::new(&mut headers);
        let status = parsed.parse(bytes).map_err(|_| NoRequest)?;
        let head = match status {
            httparse::Status::Complete(end) => &bytes[..end],
            httparse::Status::Partial => bytes,
        };
        if has_bare_line_end(head) {
            return Err(NoRequest);
        }
        if status.is_partial() {
            return Ok(None);
        }
        let fields = Fields(parsed.headers);
        fields.check()?;
        let is_one_one = parsed.version == Some(1);
        // RFC 9112 §3.2: the host must be given exactly once.
        if fields.count("host") > 1 || (is_one_one && fields.count("host") == 0) {
            return Err(NoRequest);
        }
        let request = Self {
            method: match parsed.method {
                Some("GET") => Method::Get,
                Some("HEAD") => Method::Head,
                Some("OPTIONS") => Method::Options,
                _ => Method::Other,
            },
            target: path_of(parsed.path.unwrap_or_default()).to_owned(),
            range: fields.one("range"),
            if_range: fields.one("if-range"),
            origin: fields.one("origin"),
            keeps_open: is_one_one && !fields.has_token("connection", "close"),
        };
        Ok(Some((request, head.len())))
    }

    /// Returns a placeholder for a malformed request that cannot be parsed.
    pub(super) fn bad() -> Self {
        Self {
            method: Method::Bad,
            target: String::new(),
            range: None,
            if_range: None,
            origin: None,
            keeps_open: false,
        }
    }
}

/// True if a line ends in anything but CR LF, or there is a CR within one.
fn has_bare_line_end(head: &[u8]) -> bool {
    let is_bare = |at: usize, byte: u8| match byte {
        b'\n' => at == 0 || head[at - 1] != b'\r',
        b'\r' => head.get(at + 1).is_some_and(|&next| next != b'\n'),
        _ => false,
    };
    head.iter().enumerate().any(|(at, &byte)| is_bare(at, byte))
}

/// The path of a target: of `http://host/path` the part after the host (RFC 9112 §3.2.2).
fn path_of(target: &str) -> &str {
    let scheme = target.get(..7).filter(|scheme| scheme.eq_ignore_ascii_case("http://"));
    let Some(rest) = scheme.map(|scheme| &target[scheme.len()..]) else {
        return target;
    };
    rest.find('/').map_or("/", |begin| &rest[begin..])
}

struct Fields<'a>(&'a [httparse::Header<'a>]);

impl Fields<'_> {
    fn all(&self, name: &str) -> impl Iterator<Item = &[u8]> {
        let of_name = move |header: &&httparse::Header<'_>| header.name.eq_ignore_ascii_case(name);
        self.0.iter().filter(of_name).map(|header| header.value)
    }

    fn count(&self, name: &str) -> usize {
        self.all(name).count()
    }

    /// The value of a field that occurs once: several are ambiguous.
    fn one(&self, name: &str) -> Option<String> {
        let mut all = self.all(name);
        let value = all.next().filter(|_| all.next().is_none())?;
        std::str::from_utf8(value).ok().map(|value| value.trim().to_owned())
    }

    /// True if a list has `token`.
    fn has_token(&self, name: &str, token: &str) -> bool {
        let mut tokens = self.all(name).flat_map(|value| value.split(|&byte| byte == b','));
        tokens.any(|found| found.trim_ascii().eq_ignore_ascii_case(token.as_bytes()))
    }

    /// Refuses a body, and anything that might be one.
    fn check(&self) -> Result<(), NoRequest> {
        let lengths: Vec<&[u8]> = self.all("content-length").collect();
        let has_body = match lengths.as_slice() {
            [] => false,
            [length] => *length != b"0",
            _ => true,
        };
        if has_body || self.count("transfer-encoding") > 0 {
            return Err(NoRequest);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn parsed(request: &str) -> Result<Option<Request>, NoRequest> {
        let parsed = Request::parse(request.as_bytes())?;
        Ok(parsed.map(|(request, _)| request))
    }

    #[test]
    fn ambiguous_requests_are_rejected() {
        let with = |field: &str| format!("GET /a.reel HTTP/1.1\r\nHost: x\r\n{field}\r\n\r\n");
        for field in [
            "Content-Length: 5",
            "Content-Length: +5",
            "Content-Length: 5\r\nContent-Length: 5",
            "Content-Length: 0\r\nContent-Length: 5",
            "Content-Length: 0\r\nContent-Length: 0",
            "Content-Length: 0, 5",
            "Content-Length: -0",
            "Content-Length:",
            "Transfer-Encoding: chunked",
            "Transfer-Encoding: identity",
            "Transfer-Encoding: chunked\r\nContent-Length: 0",
            "Content-Length : 0",
            "Transfer-Encoding : chunked",
            "Host: y",
            "X: a\r\n folded",
            "X: a\r\n\tfolded",
            " X: a",
            "X: a\nContent-Length: 5",
            "X: a\rContent-Length: 5",
            "X: a\0b",
            "X\0: a",
            "X Y: a",
            ": a",
            "X",
        ] {
            assert_eq!(parsed(&with(field)), Err(NoRequest), "{field:?}");
        }
        for request in [
            "GET /a.reel HTTP/1.1\r\n\r\n",
            "GET /a.reel HTTP/1.1\nHost: x\n\n",
            "GET /a.reel HTTP/1.1\r\nHost: x\r\n\n",
            "GET /a.reel HTTP/2.0\r\nHost: x\r\n\r\n",
            "GET /a.reel\r\n\r\n",
            "GET  /a.reel HTTP/1.1\r\nHost: x\r\n\r\n",
            "GET /a reel HTTP/1.1\r\nHost: x\r\n\r\n",
            "GET /a\0.reel HTTP/1.1\r\nHost: x\r\n\r\n",
            "G\0T /a.reel HTTP/1.1\r\nHost: x\r\n\r\n",
            "\u{16}\u{3}\u{1}\u{2}",
        ] {
            assert_eq!(parsed(request), Err(NoRequest), "{request:?}");
        }
        assert!(parsed(&with("Content-Length: 0")).unwrap().is_some());
        assert!(parsed("GET /a.reel HTTP/1.0\r\n\r\n").unwrap().is_some());
    }

    #[test]
    fn an_absolute_url_is_reduced_to_its_path() {
        for (target, path) in [
            ("/a.reel", "/a.reel"),
            ("http://x/a.reel", "/a.reel"),
            ("HTTP://x:80/a.reel?b", "/a.reel?b"),
            ("http://x", "/"),
            ("https://x/a.reel", "https://x/a.reel"),
            ("*", "*"),
        ] {
            let request = parsed(&format!("GET {target} HTTP/1.1\r\nHost: x\r\n\r\n"));
            assert_eq!(request.unwrap().unwrap().target, path);
        }
    }

    #[test]
    fn connections_stay_open_as_long_as_both_sides_want() {
        let keeps_open = |request: &str| parsed(request).unwrap().unwrap().keeps_open;
        assert!(keeps_open("GET / HTTP/1.1\r\nHost: x\r\n\r\n"));
        assert!(!keeps_open("GET / HTTP/1.0\r\n\r\n"));
        for close in ["close", "Close", "keep-alive, close", "x ,close, y"] {
            assert!(!keeps_open(&format!(
                "GET / HTTP/1.1\r\nHost: x\r\nConnection: {close}\r\n\r\n"
            )));
        }
    }

    #[test]
    fn consecutive_requests_are_separated() {
        let one = b"GET /a HTTP/1.1\r\nHost: x\r\n\r\n";
        let bytes = [&one[..], b"HEAD /b HTTP/1.1\r\nHost: x\r\n\r\n"].concat();
        let (first, end) = Request::parse(&bytes).unwrap().unwrap();
        assert_eq!((first.target.as_str(), end), ("/a", one.len()));
        let (second, _) = Request::parse(&bytes[end..]).unwrap().unwrap();
        assert_eq!((second.method, second.target.as_str()), (Method::Head, "/b"));
    }

    proptest! {
        #[test]
        fn any_bytes_give_a_request_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let mut request = b"GET / HTTP/1.1\r\n".to_vec();
            request.extend(&bytes);
            for bytes in [bytes, request] {
                if let Ok(Some((_, end))) = Request::parse(&bytes) {
                    prop_assert!(bytes[..end].ends_with(b"\r\n\r\n"));
                }
            }
        }
    }
}
