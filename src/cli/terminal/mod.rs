//! Answers on stdout; progress, waits, warnings and assumptions on stderr.

pub(super) mod assumptions;
pub(super) mod output;
pub(super) mod progress;
pub(super) mod stream;
pub(super) mod waits;
pub(super) mod warnings;
