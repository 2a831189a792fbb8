//! Warnings on stderr: one line with a count per kind.
//!
//! They come from subcommands and, through the log, from anywhere. They are held until the subcommand is done, when the
//! count is known; a window may stay open for days, so there the first of each kind is printed at once. `--verbose`
//! prints all at once.

use super::output::say;
use crate::locks::lock;
use crate::messages::kind_of;
use std::sync::Mutex;

/// When warnings are said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::cli) enum When {
    /// One line for each kind when the subcommand is done.
    AtTheEnd,
    /// The first one of each kind at once, the count of the others at the end.
    FirstAtOnce,
    /// Each one at once.
    AllAtOnce,
}

/// The log is one for the whole program, and so is this.
static WARNINGS: Mutex<Warnings> = Mutex::new(Warnings {
    when: When::AtTheEnd,
    kinds: Vec::new(),
});

/// Max number of held kinds; further ones are printed at once.
const MAX_KINDS: usize = 256;

#[derive(Debug)]
struct Warnings {
    when: When,
    kinds: Vec<MessageGroup>,
}

#[derive(Debug)]
struct MessageGroup {
    /// Message text without numbers and file names.
    says: String,
    first: String,
    is_said: bool,
    more: usize,
    /// Noun of the counted items.
    noun: &'static str,
}

/// Says from now on when warnings are said.
pub(in crate::cli) fn say_them(when: When) {
    lock(&WARNINGS).when = when;
}

/// Warns of something.
pub(in crate::cli) fn warn(message: &str) {
    note(format!("warning: {message}"), "like it");
}

/// Warns of a frame, which gives the same warning only once.
pub(in crate::cli) fn warn_of_frame(message: &str) {
    note(format!("warning: {message}"), "frames");
}

/// Prints something that a written file does not hold.
pub(in crate::cli) fn lost(message: &str) {
    note(format!("not kept: {message}"), "like it");
}

/// Prints something that was decided in the user's place.
pub(in crate::cli) fn assumed(message: &str) {
    note(format!("assumed {message}"), "like it");
}

/// Prints a remark about an earlier message.
pub(in crate::cli) fn remark(message: String) {
    note(message, "like it");
}

/// Warns of a failure while the subcommand continues.
pub(in crate::cli) fn warn_of_error(message: &str) {
    note(format!("error: {message}"), "like it");
}

fn note(line: String, noun: &'static str) {
    let said = lock(&WARNINGS).note(line, noun);
    if let Some(line) = said {
        say(&line);
    }
}

/// Prints the held warnings. To be called when the subcommand is done, before the error that it may have ended with.
pub(in crate::cli) fn finish() {
    let lines = lock(&WARNINGS).finish();
    for line in lines {
        say(&line);
    }
}

impl Warnings {
    /// The line to say at once, if there is one.
    fn note(&mut self, line: String, noun: &'static str) -> Option<String> {
        if self.when == When::AllAtOnce {
            return Some(line);
        }
        let says = kind_of(&line);
        if let Some(known) = self.kinds.iter_mut().find(|known| known.says == says) {
            known.more += 1;
            return None;
        }
        if self.kinds.len() == MAX_KINDS {
            return Some(line);
        }
        let is_said = self.when == When::FirstAtOnce;
        self.kinds.push(MessageGroup {
            says,
            first: line.clone(),
            is_said,
            more: 0,
            noun,
        });
        is_said.then_some(line)
    }

    fn finish(&mut self) -> Vec<String> {
        let held = self.kinds.drain(..);
        let untold = held.filter(|kind| !kind.is_said || kind.more > 0);
        let line = |kind: MessageGroup| kind.first + &more(kind.more, kind.noun);
        untold.map(line).collect()
    }
}

/// Returns the suffix of a message with `count` more like it.
pub(in crate::cli) fn more(count: usize, noun: &str) -> String {
    match count {
        0 => String::new(),
        1 => format!(" (and 1 more {}; --verbose lists them)", singular(noun)),
        count => format!(" (and {count} more {noun}; --verbose lists them)"),
    }
}

fn singular(noun: &str) -> &str {
    noun.strip_suffix('s').unwrap_or(noun)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn warnings(when: When) -> Warnings {
        Warnings {
            when,
            kinds: Vec::new(),
        }
    }

    /// A hundred frames with one fault, and something else between them.
    fn note_many(warnings: &mut Warnings) -> Vec<String> {
        let mut said = Vec::new();
        for frame in 0..100 {
            let line = format!("warning: f_{frame}.ply, face {frame}: it is broken");
            said.extend(warnings.note(line, "frames"));
            if frame == 50 {
                said.extend(warnings.note("warning: the disk is full".to_owned(), "like it"));
            }
        }
        said
    }

    #[test]
    fn a_hundred_warnings_of_one_kind_are_one_line() {
        let mut warnings = warnings(When::AtTheEnd);
        assert_eq!(note_many(&mut warnings), [""; 0]);
        let expected = [
            "warning: f_0.ply, face 0: it is broken (and 99 more frames; --verbose lists them)",
            "warning: the disk is full",
        ];
        assert_eq!(warnings.finish(), expected);
        assert_eq!(warnings.finish(), [""; 0]);
    }

    #[test]
    fn a_window_prints_the_first_warning_at_once() {
        let mut warnings = warnings(When::FirstAtOnce);
        let first = "warning: f_0.ply, face 0: it is broken";
        assert_eq!(note_many(&mut warnings), [first, "warning: the disk is full"]);
        let counted = format!("{first} (and 99 more frames; --verbose lists them)");
        assert_eq!(warnings.finish(), [counted]);
    }

    #[test]
    fn verbose_prints_all_warnings() {
        let mut warnings = warnings(When::AllAtOnce);
        assert_eq!(note_many(&mut warnings).len(), 101);
        assert_eq!(warnings.finish(), [""; 0]);
    }

    #[test]
    fn the_number_of_stored_kinds_is_bounded() {
        let mut warnings = warnings(When::AtTheEnd);
        let word = |number: usize| "x".repeat(number + 1);
        let said = (0..MAX_KINDS + 2).filter_map(|number| warnings.note(word(number), "like it"));
        assert_eq!(said.count(), 2);
        assert_eq!(warnings.finish().len(), MAX_KINDS);
    }

    #[test]
    fn one_more_is_singular() {
        assert_eq!(more(0, "frames"), "");
        assert_eq!(more(1, "frames"), " (and 1 more frame; --verbose lists them)");
        assert_eq!(more(1, "like it"), " (and 1 more like it; --verbose lists them)");
    }
}
