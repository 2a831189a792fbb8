//! Natural order of file names: `frame2` before `frame10`, whatever the padding.
//!
//! **How it works.** A name is cut into runs of digits and runs of other characters. Digits compare as numbers of any
//! length, other characters without regard to case. Where that makes two names equal, the exact bytes decide, so
//! that the order is total. Nothing is allocated while comparing valid UTF-8 names.

use std::cmp::Ordering;
use std::path::Path;

/// Compares two paths folder by folder and the file name by its stem, then its extension.
///
/// The extension comes last so that `scan_1.xyz`, `scan_2.ply`, `scan_3.xyz` count through, and `scan.ply` comes before
/// `scan 1.ply`.
pub fn natural_order(left: &Path, right: &Path) -> Ordering {
    let parents = match (left.parent(), right.parent()) {
        (Some(left), Some(right)) => compare_folders(left, right),
        (left, right) => left.is_some().cmp(&right.is_some()),
    };
    parents
        .then_with(|| {
            let (left_stem, left_extension) = split_name(left);
            let (right_stem, right_extension) = split_name(right);
            compare_names(&left_stem, &right_stem).then_with(|| compare_names(&left_extension, &right_extension))
        })
        .then_with(|| left.as_os_str().cmp(right.as_os_str()))
}

fn compare_folders(left: &Path, right: &Path) -> Ordering {
    let mut left = left.components();
    let mut right = right.components();
    loop {
        match (left.next(), right.next()) {
            (None, None) => return Ordering::Equal,
            (None, Some(_)) => return Ordering::Less,
            (Some(_), None) => return Ordering::Greater,
            (Some(left), Some(right)) => {
                let order = compare_names(
                    &left.as_os_str().to_string_lossy(),
                    &right.as_os_str().to_string_lossy(),
                );
                if order != Ordering::Equal {
                    return order;
                }
            }
        }
    }
}

/// Stem and extension; `scan.0001` has no extension but a number.
pub(crate) fn split_name(path: &Path) -> (std::borrow::Cow<'_, str>, std::borrow::Cow<'_, str>) {
    let is_number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    match (path.file_stem(), path.extension()) {
        (Some(stem), Some(extension)) if !is_number(&extension.to_string_lossy()) => {
            (stem.to_string_lossy(), extension.to_string_lossy())
        }
        _ => (path.file_name().unwrap_or_default().to_string_lossy(), "".into()),
    }
}

fn compare_names(left: &str, right: &str) -> Ordering {
    let mut left_runs = Runs(left);
    let mut right_runs = Runs(right);
    loop {
        match (left_runs.next(), right_runs.next()) {
            (None, None) => return Ordering::Equal,
            (None, Some(_)) => return Ordering::Less,
            (Some(_), None) => return Ordering::Greater,
            (Some(left), Some(right)) => {
                let order = match (left, right) {
                    (NamePiece::Digits(left), NamePiece::Digits(right)) => compare_digits(left, right),
                    (NamePiece::Text(left), NamePiece::Text(right)) => compare_text(left, right),
                    // A number sorts before any other character.
                    (NamePiece::Digits(_), NamePiece::Text(_)) => Ordering::Less,
                    (NamePiece::Text(_), NamePiece::Digits(_)) => Ordering::Greater,
                };
                if order != Ordering::Equal {
                    return order;
                }
            }
        }
    }
}

/// Compares the numbers that `left` and `right` write, of any length.
fn compare_digits(left: &str, right: &str) -> Ordering {
    let left = left.trim_start_matches('0');
    let right = right.trim_start_matches('0');
    left.len().cmp(&right.len()).then_with(|| left.cmp(right))
}

fn compare_text(left: &str, right: &str) -> Ordering {
    left.chars()
        .flat_map(char::to_lowercase)
        .cmp(right.chars().flat_map(char::to_lowercase))
}

/// A piece of a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum NamePiece<'a> {
    /// ASCII digits only.
    Digits(&'a str),
    /// No ASCII digit.
    Text(&'a str),
}

/// Cuts a name into runs.
#[derive(Clone)]
pub(crate) struct Runs<'a>(pub(crate) &'a str);

impl<'a> Iterator for Runs<'a> {
    type Item = NamePiece<'a>;

    fn next(&mut self) -> Option<NamePiece<'a>> {
        let is_digits = self.0.bytes().next()?.is_ascii_digit();
        // Digits are single bytes, so splitting next to one never cuts a character.
        let end = self
            .0
            .bytes()
            .position(|byte| byte.is_ascii_digit() != is_digits)
            .unwrap_or(self.0.len());
        let (run, rest) = self.0.split_at(end);
        self.0 = rest;
        Some(if is_digits {
            NamePiece::Digits(run)
        } else {
            NamePiece::Text(run)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sorted(names: &[&'static str]) -> Vec<&'static str> {
        let mut names = names.to_vec();
        names.sort_by(|left, right| natural_order(Path::new(left), Path::new(right)));
        names
    }

    #[test]
    fn numbers_are_compared_regardless_of_padding() {
        assert_eq!(
            sorted(&["f10.ply", "f9.ply", "f1.ply", "f011.ply", "f100.ply"]),
            ["f1.ply", "f9.ply", "f10.ply", "f011.ply", "f100.ply"]
        );
    }

    #[test]
    fn numbers_beyond_64_bits_are_compared() {
        assert_eq!(
            sorted(&["t100000000000000000000000.ply", "t99999999999999999999999.ply"]),
            ["t99999999999999999999999.ply", "t100000000000000000000000.ply"]
        );
    }

    #[test]
    fn case_and_extension_do_not_split_a_sequence() {
        assert_eq!(
            sorted(&["Scan_3.PLY", "scan_2.xyz", "SCAN_1.ply", "scan_10.pcd"]),
            ["SCAN_1.ply", "scan_2.xyz", "Scan_3.PLY", "scan_10.pcd"]
        );
    }

    #[test]
    fn a_bare_name_comes_before_numbered_ones() {
        assert_eq!(
            sorted(&["scan 1.ply", "scan-2.ply", "scan.ply"]),
            ["scan.ply", "scan 1.ply", "scan-2.ply"]
        );
    }

    #[test]
    fn numbers_after_the_dot_count() {
        assert_eq!(
            sorted(&["scan.10", "scan.9", "scan.0008"]),
            ["scan.0008", "scan.9", "scan.10"]
        );
    }

    #[test]
    fn folders_are_compared_too() {
        assert_eq!(
            sorted(&["take10/f1.ply", "take2/f2.ply", "take2/f1.ply"]),
            ["take2/f1.ply", "take2/f2.ply", "take10/f1.ply"]
        );
    }

    proptest! {
        #[test]
        fn the_order_is_total(names in prop::collection::vec("[a-bA-B0-1._é]{0,6}", 3)) {
            let order = |a: usize, b: usize| natural_order(Path::new(&names[a]), Path::new(&names[b]));
            prop_assert_eq!(order(0, 1), order(1, 0).reverse());
            prop_assert_eq!(order(0, 1) == Ordering::Equal, names[0] == names[1]);
            if order(0, 1).is_le() && order(1, 2).is_le() {
                prop_assert!(order(0, 2).is_le(), "{:?}", names);
            }
        }

        #[test]
        fn numbered_names_sort_like_their_numbers(a in any::<u64>(), b in any::<u64>(), pad in 0usize..24) {
            let left = format!("x{a:0pad$}y.ply");
            let right = format!("x{b}y.ply");
            let order = natural_order(Path::new(&left), Path::new(&right));
            if a != b {
                prop_assert_eq!(order, a.cmp(&b));
            }
        }
    }
}
