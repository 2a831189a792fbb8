//! Addresses of live streams.

use crate::source::opener::Name;
use std::path::Path;

/// Before the address of a stream.
pub(super) const SCHEME: Name = Name::Scheme("tcp://");

/// `HOST:PORT` of `input`; this machine where no host is named.
///
/// # Errors
/// The fault, as the end of a sentence.
pub(super) fn parse(input: &Path) -> Result<String, String> {
    let address = SCHEME.address(input).unwrap_or_default().trim_end_matches('/');
    let wrong = || {
        format!(
            "`{}` is no address, expected a host and a port, as in tcp://127.0.0.1:9000",
            address.escape_default()
        )
    };
    let (host, port) = address.rsplit_once(':').ok_or_else(wrong)?;
    let is_port = port.parse::<u16>().is_ok_and(|port| port > 0);
    // Colons are within brackets, or belong to an IPv6 address without a port.
    let is_bracketed = host.starts_with('[') && host.ends_with(']');
    if !is_port || host.contains('/') || (host.contains(':') && !is_bracketed) {
        return Err(wrong());
    }
    let host = if host.is_empty() { "127.0.0.1" } else { host };
    Ok(format!("{host}:{port}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_have_a_port_and_may_have_a_host() {
        for (input, address) in [
            ("tcp://127.0.0.1:9000", "127.0.0.1:9000"),
            ("tcp://:9000/", "127.0.0.1:9000"),
            ("tcp://scanner.local:1", "scanner.local:1"),
            ("tcp://[::1]:9000", "[::1]:9000"),
        ] {
            assert_eq!(parse(Path::new(input)).as_deref(), Ok(address));
        }
        for wrong in [
            "tcp://",
            "tcp://host",
            "tcp://host:0",
            "tcp://host:99999",
            "tcp://::1",
            "tcp://a/b:1",
        ] {
            let problem = parse(Path::new(wrong)).unwrap_err();
            assert!(problem.contains("tcp://127.0.0.1:9000"), "{problem}");
        }
        assert_eq!(SCHEME.address(Path::new("tcp://:1")), Some(":1"));
        assert_eq!(SCHEME.address(Path::new("walk.reel")), None);
    }
}
