//! Pages of other origins that may read the served files (the Fetch standard, *CORS protocol*).

use std::str::FromStr;

/// An origin whose pages may read the file, or all: `--cors`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CorsOrigin {
    /// Pages of any origin.
    Any,
    /// Pages of this one, such as `https://example.org`.
    One(String),
}

impl FromStr for CorsOrigin {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "*" {
            return Ok(Self::Any);
        }
        let authority = text.split_once("://").map(|(_, authority)| authority);
        // It becomes a line of a response.
        let is_plain = |text: &str| text.bytes().all(|byte| byte.is_ascii_graphic() && byte != b'/');
        match authority {
            Some(authority) if !authority.is_empty() && is_plain(authority) && text.is_ascii() => {
                Ok(Self::One(text.to_owned()))
            }
            _ => {
                Err("expected an origin such as https://example.org or http://localhost:3000, or * for all".to_owned())
            }
        }
    }
}

/// The fields of an answer to a request of a page of `origin`, where `allowed` may read.
pub(super) fn cors_fields(allowed: &[CorsOrigin], origin: Option<&str>) -> Vec<(&'static str, String)> {
    let mut fields = Vec::new();
    let is_any = allowed.contains(&CorsOrigin::Any);
    let is_one = |origin: &&str| {
        allowed
            .iter()
            .any(|one| matches!(one, CorsOrigin::One(one) if one == origin))
    };
    let found = if is_any { Some("*") } else { origin.filter(is_one) };
    if !allowed.is_empty() && !is_any {
        // Caches keep responses for different origins apart.
        fields.push(("Vary", "Origin".to_owned()));
    }
    if let Some(origin) = found {
        fields.push(("Access-Control-Allow-Origin", origin.to_owned()));
        let exposed = "Accept-Ranges, Content-Length, Content-Range, ETag, Last-Modified";
        fields.push(("Access-Control-Expose-Headers", exposed.to_owned()));
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origins_are_validated_before_entering_a_response() {
        assert_eq!("*".parse(), Ok(CorsOrigin::Any));
        let local = CorsOrigin::One("http://localhost:3000".to_owned());
        assert_eq!("http://localhost:3000".parse(), Ok(local));
        for wrong in [
            "",
            "example.org",
            "https://",
            "https://a/b",
            "https://a\r\nX: y",
            "https://a b",
            "https://ä",
        ] {
            let problem = wrong.parse::<CorsOrigin>().unwrap_err();
            assert!(problem.contains("https://example.org"), "{wrong}: {problem}");
        }
    }

    #[test]
    fn only_listed_origins_may_read() {
        let one = [CorsOrigin::One("https://a".to_owned())];
        assert_eq!(cors_fields(&[], Some("https://a")), []);
        let allowed = cors_fields(&one, Some("https://a"));
        assert!(
            allowed.contains(&("Access-Control-Allow-Origin", "https://a".to_owned())),
            "{allowed:?}"
        );
        let others = vec![("Vary", "Origin".to_owned())];
        assert_eq!(cors_fields(&one, Some("https://b")), others);
        assert_eq!(cors_fields(&one, None), others);
        let any = cors_fields(&[CorsOrigin::Any], Some("https://b"));
        assert!(
            any.contains(&("Access-Control-Allow-Origin", "*".to_owned())),
            "{any:?}"
        );
    }
}
