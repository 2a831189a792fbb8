//! Assumptions on stderr: whatever was guessed about an input is one line.

use super::warnings;
use crate::assumption::{Assumption, Subject};
use crate::scene::FirstLook;
use crate::sequence::Sequence;

/// All assumptions about `sequence` so far, by subject.
pub(super) fn of(sequence: &Sequence, look: Option<&FirstLook>) -> Vec<Assumption> {
    let mut all = sequence.assumptions();
    all.extend(look.into_iter().flat_map(FirstLook::assumptions));
    all.sort_by_key(|assumption| assumption.subject);
    all
}

/// Prints those that are guesses and about nothing that was `chosen`. To be called when the frames were read.
pub(super) fn print_guesses(sequence: &Sequence, look: Option<&FirstLook>, chosen: &[Subject]) {
    for assumption in of(sequence, look) {
        if assumption.evidence.is_guess() && !chosen.contains(&assumption.subject) {
            warnings::assumed(&assumption.to_string());
        }
    }
}
