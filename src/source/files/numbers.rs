//! Numbers of frames by their names.

use crate::natural::{NamePiece, Runs, split_name};
use crate::source::FrameEntry;
use std::path::Path;

/// Gives every entry the number in its name that counts the frames: the last run of digits that every name has and that
/// grows from each name to the next. Without such a run there are no numbers; a single file gets its last run.
pub(in crate::source) fn number(entries: &mut [FrameEntry]) {
    let of_names = |entry: &FrameEntry| numbers_in(&split_name(Path::new(&entry.name)).0);
    // If each frame has its own folder, the number of the folder.
    let of_folders = |entry: &FrameEntry| {
        let folder = Path::new(&entry.name).parent().unwrap_or(Path::new(""));
        numbers_in(&folder.to_string_lossy())
    };
    if !number_by(entries, of_names) && entries.len() > 1 {
        number_by(entries, of_folders);
    }
}

fn numbers_in(name: &str) -> Vec<Option<u64>> {
    let digits = Runs(name).filter_map(|run| match run {
        NamePiece::Digits(digits) => Some(digits.parse().ok()),
        NamePiece::Text(_) => None,
    });
    digits.collect()
}

fn number_by(entries: &mut [FrameEntry], numbers_of: impl Fn(&FrameEntry) -> Vec<Option<u64>>) -> bool {
    let Some(first) = entries.first() else {
        return false;
    };
    // The digit runs of the first name that still increase, and their values in the previous name.
    let mut before = numbers_of(first);
    for entry in &entries[1..] {
        let numbers = numbers_of(entry);
        before.truncate(numbers.len());
        for (previous, number) in before.iter_mut().zip(numbers) {
            *previous = match (*previous, number) {
                (Some(previous), Some(number)) if number > previous => Some(number),
                _ => None,
            };
        }
    }
    let Some(counting) = before.iter().rposition(Option::is_some) else {
        return false;
    };
    for entry in entries {
        entry.number = numbers_of(entry).get(counting).copied().flatten();
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(names: &[&str]) -> Vec<Option<u64>> {
        let mut entries: Vec<FrameEntry> = names.iter().map(FrameEntry::file).collect();
        number(&mut entries);
        entries.iter().map(|entry| entry.number).collect()
    }

    #[test]
    fn the_counting_run_of_digits_is_the_number() {
        assert_eq!(
            numbers(&["cam0_7.ply", "cam0_9.ply", "cam0_10.ply"]),
            [Some(7), Some(9), Some(10)]
        );
        assert_eq!(
            numbers(&["scan1_v2.ply", "scan2_v2.ply", "scan5_v2.ply"]),
            [Some(1), Some(2), Some(5)]
        );
        assert_eq!(numbers(&["tomato_03-05.xyz", "tomato_03-08.ply"]), [Some(5), Some(8)]);
    }

    #[test]
    fn names_without_a_counting_run_of_digits_have_no_number() {
        assert_eq!(numbers(&["a.ply", "b.ply"]), [None, None]);
        assert_eq!(numbers(&["03-30.ply", "04-02.ply"]), [Some(3), Some(4)]);
        assert_eq!(numbers(&["a_1.ply", "b_1.ply"]), [None, None]);
        assert_eq!(numbers(&["still.ply", "a_1.ply"]), [None, None]);
    }

    #[test]
    fn a_single_file_has_its_last_number() {
        assert_eq!(numbers(&["longdress_vox10_1051.ply"]), [Some(1051)]);
        assert_eq!(numbers(&["99999999999999999999999.ply"]), [None]);
    }
}
