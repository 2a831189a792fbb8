//! What a verb says to a person, and what it answers; names that terminals would obey are escaped here.

use crate::printable;
use std::io::Write as _;

/// One line on stderr.
#[expect(clippy::print_stderr, reason = "the command line speaks to a person here")]
pub(super) fn say(line: &str) {
    eprintln!("{}", printable::text(line));
}

/// The answer of a verb on stdout. A reader that has left is no failure.
pub(super) fn answer(text: &str) {
    let _ = writeln!(std::io::stdout().lock(), "{}", printable::text(text));
}
