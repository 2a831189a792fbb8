//! Classification of file names without a common number: different things (`before`, `after`), levels of detail, or
//! nothing.

use super::names::{Minus, SplitName, hexadecimal};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::natural::split_name;
use std::collections::HashSet;
use std::path::PathBuf;

/// Keywords in the names of clouds that are not frames of one sequence: results of SLAM programs, stages of a
/// reconstruction, clouds compared with each other.
const THINGS: [&str; 42] = [
    "after",
    "aligned",
    "before",
    "clean",
    "corner",
    "dense",
    "denoised",
    "downsampled",
    "edge",
    "filtered",
    "fused",
    "global",
    "ground",
    "groundtruth",
    "gt",
    "input",
    "map",
    "mesh",
    "meshed",
    "model",
    "moving",
    "original",
    "output",
    "planar",
    "poisson",
    "pred",
    "prediction",
    "raw",
    "ref",
    "reference",
    "registered",
    "result",
    "source",
    "sparse",
    "static",
    "surf",
    "target",
    "template",
    "trajectory",
    "transformations",
    "truth",
    "unaligned",
];

/// More files with a number are a sequence, with any text before it.
const MAX_LEVELS: usize = 8;

/// Returns true if the names of `files` denote different things.
pub(super) fn are_different_things(files: &[PathBuf]) -> bool {
    let words: Vec<HashSet<String>> = files.iter().map(|file| words_of(&split_name(file).0)).collect();
    let is_common = |word: &str| words.iter().all(|others| others.contains(word));
    let mut all = words.iter().flatten();
    all.any(|word| THINGS.contains(&word.as_str()) && !is_common(word))
}

/// Returns true if the numbers of `files` are levels of detail or point counts: `lod0`, `100k`.
pub(super) fn are_levels(files: &[PathBuf]) -> bool {
    if files.len() < 2 || files.len() > MAX_LEVELS {
        return false;
    }
    let is_level = |file: &PathBuf| {
        let skeleton = SplitName::of(&split_name(file).0, Minus::AfterSeparator).skeleton;
        let skeleton = skeleton.replace(['_', '-', ' '], "");
        ["lod#", "level#", "#k", "#mio"]
            .iter()
            .any(|end| skeleton.ends_with(end))
    };
    files.iter().all(is_level)
}

/// Returns the assumption reported for frames whose order comes from their names alone: names without numbers, or
/// hexadecimal ones.
pub(super) fn without_order(frames: &[PathBuf]) -> Option<Assumption> {
    let names: Vec<String> = frames.iter().map(|file| split_name(file).0.into_owned()).collect();
    let distinct: HashSet<&String> = names.iter().collect();
    if frames.len() < 2 || distinct.len() < frames.len() {
        return None;
    }
    if hexadecimal(&names).is_some() {
        let value = format!("{} files in the order of hexadecimal numbers", frames.len());
        let why = "their names are such numbers, and follow each other closely";
        return Some(Assumption::new(Subject::Frames, value, why, Evidence::Statistics));
    }
    let has_digit = |name: &String| name.contains(|c: char| c.is_ascii_digit());
    if names.iter().any(has_digit) {
        return None;
    }
    let value = format!("{} files in the order of their names", frames.len());
    let why = "the names have no numbers: nothing says that the files are one sequence";
    Some(Assumption::new(Subject::Frames, value, why, Evidence::Fallback))
}

/// The words of a name in lower case: parts between separators, and parts that begin with a capital.
fn words_of(stem: &str) -> HashSet<String> {
    let mut words = HashSet::new();
    let mut word = String::new();
    let mut was_lower = false;
    for c in stem.chars() {
        if !c.is_alphabetic() || (c.is_uppercase() && was_lower) {
            words.insert(std::mem::take(&mut word));
        }
        if c.is_alphabetic() {
            word.extend(c.to_lowercase());
        }
        was_lower = c.is_lowercase();
    }
    words.insert(word);
    words.remove("");
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(names: &[&str]) -> Vec<PathBuf> {
        names.iter().map(PathBuf::from).collect()
    }

    #[test]
    fn different_words_mark_different_things() {
        for names in [
            &["cloudCorner.pcd", "cloudGlobal.pcd", "cloudSurf.pcd", "trajectory.pcd"][..],
            &["corner_map.pcd", "GlobalMap.pcd"],
            &["before.ply", "after.ply"],
            &["scan.ply", "model.ply", "target.ply"],
            &["dense.ply", "fused.ply", "meshed-poisson.ply"],
            &["map_downsampled.pcd", "scans.pcd"],
        ] {
            assert!(are_different_things(&paths(names)), "{names:?}");
        }
        for names in [
            &["alice.ply", "bob.ply", "carol.ply"][..],
            &["model_red.ply", "model_blue.ply"],
            &["a.ply", "b.ply"],
        ] {
            assert!(!are_different_things(&paths(names)), "{names:?}");
            assert_eq!(without_order(&paths(names)).unwrap().evidence, Evidence::Fallback);
        }
    }

    #[test]
    fn levels_of_detail_are_not_time_steps() {
        assert!(are_levels(&paths(&["cloud_lod0.ply", "cloud_lod1.ply"])));
        assert!(are_levels(&paths(&["scan_1000k.ply", "scan_100k.ply", "scan_10k.ply"])));
        assert!(!are_levels(&paths(&["scan_1.ply", "scan_2.ply"])));
    }

    #[test]
    fn the_order_of_hexadecimal_names_is_reported() {
        let order = without_order(&paths(&["9.ply", "a.ply", "10.ply"])).unwrap();
        assert_eq!(order.evidence, Evidence::Statistics);
    }
}
