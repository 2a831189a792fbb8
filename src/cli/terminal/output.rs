//! Terminal output of a subcommand: its messages to people, and its answers; names that terminals would obey are
//! escaped here.

use crate::locks::lock;
use crate::printable;
use anyhow::anyhow;
use std::io::{self, ErrorKind, Write as _};
use std::sync::Mutex;

/// Why an answer could not be written: the first reason.
static FAILED: Mutex<Option<io::Error>> = Mutex::new(None);

/// Prints one line on stderr. A failure cannot be reported anywhere.
pub(in crate::cli) fn say(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", printable::text(line));
}

/// Writes the answer of a subcommand to stdout. A reader that has left is not a failure; any other error is reported
/// once the subcommand is done ([`check_answers`]).
pub(in crate::cli) fn answer(text: &str) {
    let mut stdout = io::stdout().lock();
    note(writeln!(stdout, "{}", printable::text(text)).and_then(|()| stdout.flush()));
}

/// Notes whether something was written to stdout.
pub(in crate::cli) fn note(written: io::Result<()>) {
    match written {
        Err(reason) if reason.kind() != ErrorKind::BrokenPipe => {
            lock(&FAILED).get_or_insert(reason);
        }
        Ok(()) | Err(_) => {}
    }
}

/// Writer for binary answers: stdout, with failures reported as in [`answer`].
pub(in crate::cli) struct BytesAnswer;

impl io::Write for BytesAnswer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        note(io::stdout().lock().write_all(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        note(io::stdout().lock().flush());
        Ok(())
    }
}

/// Fails if an answer could not be written.
pub(in crate::cli) fn check_answers() -> anyhow::Result<()> {
    match lock(&FAILED).take() {
        Some(reason) => Err(anyhow!(
            "the output could not be written to stdout ({reason}): free disk space, or redirect it elsewhere"
        )),
        None => Ok(()),
    }
}
