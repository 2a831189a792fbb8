//! Assumptions on stderr: one line per guess about an input.

use super::warnings;
use crate::assumption::{Assumption, Subject};
use crate::rgbd::Filters;
use crate::scene::FirstLook;
use crate::sequence::Sequence;
use clap::{Arg, Args, Command};

/// All assumptions about `sequence` so far, by subject.
pub(in crate::cli) fn of(sequence: &Sequence, look: Option<&FirstLook>) -> Vec<Assumption> {
    let mut all = sequence.assumptions();
    all.extend(look.into_iter().flat_map(FirstLook::assumptions));
    all.sort_by_key(|assumption| assumption.subject);
    all
}

/// From the first frame of `sequence` that can be read, and some others; `None` without a point.
pub(in crate::cli) fn first_look(sequence: &Sequence) -> Option<FirstLook> {
    // Images are drawn with the default filters of depth images, without which outliers hide the surface.
    let has_none = sequence.source().filters() == Some(Filters::NONE);
    let filtered = has_none.then(|| sequence.filtered(Filters::USUAL)).flatten();
    let sequence = filtered.as_ref().unwrap_or(sequence);
    let mut refused = None;
    let readable = (0..sequence.len()).find_map(|index| match sequence.frame(index) {
        Ok(frame) => Some(frame),
        Err(error) => {
            refused.get_or_insert(error);
            None
        }
    });
    let Some(frame) = readable else {
        if let Some(error) = refused {
            warnings::warn(&format!("nothing is known of how it is shown: {error}"));
        }
        return None;
    };
    let look = FirstLook::of_sequence(&frame, sequence);
    (!look.trimmed.is_empty()).then_some(look)
}

/// Returns a line with the options named by `assumptions` that the subcommand with the arguments `A` does not have.
pub(in crate::cli) fn options_elsewhere<A: Args>(assumptions: &[Assumption]) -> Option<String> {
    let subcommand = A::augment_args(Command::new("subcommand"));
    let has = |option: &str| {
        let mut names = subcommand.get_arguments().filter_map(Arg::get_long);
        names.any(|name| option.strip_prefix("--") == Some(name))
    };
    let mut options: Vec<&str> = assumptions.iter().filter_map(|assumption| assumption.option).collect();
    options.retain(|option| !has(option));
    options.dedup();
    let are = match options.len() {
        0 => return None,
        1 => "is an option",
        _ => "are options",
    };
    Some(format!("{} {are} of view and render", options.join(", ")))
}

/// Prints those that are guesses and about nothing that was `chosen`. To be called when the frames were read.
pub(in crate::cli) fn print_guesses(sequence: &Sequence, look: Option<&FirstLook>, chosen: &[Subject]) {
    for assumption in of(sequence, look) {
        if assumption.evidence.is_guess() && !chosen.contains(&assumption.subject) {
            warnings::assumed(&assumption.to_string());
        }
    }
}
