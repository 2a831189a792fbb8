//! The list of stages.

use super::step::Stage;
use super::{change, in_view, levels, onion, photos, trails};

/// All that is between a pose and its packet, in order.
pub const STAGES: &[Stage] = &[
    change::STAGE,
    onion::STAGE,
    trails::STAGE,
    photos::STAGE,
    in_view::STAGE,
    levels::STAGE,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_are_consecutive_and_names_match_the_table() {
        assert!(STAGES.is_sorted_by_key(|stage| stage.lane), "{STAGES:?}");
        let table = include_str!("mod.rs");
        let mut from = 0;
        for stage in STAGES {
            let row = format!("//! | {} |", stage.name);
            from += table[from..]
                .find(&row)
                .unwrap_or_else(|| panic!("{stage:?} is no row in order"));
        }
    }
}
