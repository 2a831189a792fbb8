//! External references of a session, beyond its folder, for prompts and errors.

use std::fmt;
use std::path::PathBuf;

/// Max names in a sentence.
const MAX_NAMED: usize = 5;

/// External references that a session names, beyond its folder.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Beyond {
    /// Addresses, as they are written.
    pub addresses: Vec<String>,
    /// Files, folders and patterns outside of its folder.
    pub outside: Vec<PathBuf>,
}

impl Beyond {
    /// Nothing.
    pub fn is_empty(&self) -> bool {
        self.addresses.is_empty() && self.outside.is_empty()
    }

    /// The options that allow it.
    pub fn options(&self) -> &'static str {
        match (self.addresses.is_empty(), self.outside.is_empty()) {
            (false, false) => "--allow-network and --allow-outside",
            (false, true) => "--allow-network",
            _ => "--allow-outside",
        }
    }
}

/// `the address udp://:2368 (a connection or a port) and the file /etc/scan.ply outside of its folder`.
impl fmt::Display for Beyond {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let listed = |names: &[String]| {
            let more = if names.len() > MAX_NAMED { ", …" } else { "" };
            names[..names.len().min(MAX_NAMED)].join(", ") + more
        };
        let outside: Vec<String> = self.outside.iter().map(|path| path.display().to_string()).collect();
        let mut parts = Vec::new();
        if !self.addresses.is_empty() {
            parts.push(format!("{} (a connection or a port)", listed(&self.addresses)));
        }
        if !outside.is_empty() {
            parts.push(format!("{} outside of its folder", listed(&outside)));
        }
        formatter.write_str(&parts.join(" and "))
    }
}
