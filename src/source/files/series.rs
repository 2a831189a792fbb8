//! Selection of the files of a folder that are frames of one sequence.
//!
//! **How it works.** Files are of three tiers: point cloud formats; arrays and archives; text. Text next to numbered
//! clouds lists times, poses and calibration, so a tier is skipped next to a higher one, unless it has a numbered
//! series of more than twice the files. Within the remaining tier, files whose names differ only in their numbers form
//! a *series*. One series is the sequence, and a few other files next to it are skipped. Two series of similar size are
//! two sequences (two persons, two cameras), which are never played one after the other: the choices are returned to
//! the caller. Names that form no series are frames in the order of their names, which is reported, unless they denote
//! different things, as `before` and `after` do (`kinds.rs`): those are choices too.

use super::kinds;
use super::names::{Minus, SplitName, is_folder_per_frame, telling_name};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::messages::grouped;
use crate::natural::{natural_order, split_name};
use crate::source::error::OpeningChoice;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// A series of at least this share of another is a sequence of its own.
const MIN_SHARE: f64 = 0.1;

/// Single files are skipped next to a series that is this many times larger.
const MIN_SERIES_PER_SINGLE: usize = 2;

/// Names with more different texts are not a series, but happen to be alike.
const MAX_SERIES: usize = 12;

/// A series of a lower tier is the sequence if it has this many times the files.
const MAJORITY: usize = 2;

/// Reliability of an extension, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Tier {
    Cloud,
    Arrays,
    Text,
}

impl Tier {
    /// Precondition: a decoder knows the extension.
    pub(super) fn of(file: &Path) -> Self {
        let extension = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "txt" | "csv" | "asc" => Self::Text,
            "npy" | "npz" | "zip" | "tar" | "tgz" | "gz" => Self::Arrays,
            _ => Self::Cloud,
        }
    }
}

/// The files that are frames, and the others.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Chosen {
    pub(super) frames: Vec<PathBuf>,
    pub(super) skipped: Vec<PathBuf>,
    pub(super) assumption: Option<Assumption>,
}

/// Chooses the frames among `files` with known extensions.
///
/// # Errors
/// The series, if there are several.
pub(super) fn choose(files: Vec<PathBuf>) -> Result<Chosen, Vec<OpeningChoice>> {
    let total = files.len();
    let (files, faces) = without_faces(files);
    let (tier, mut skipped) = of_one_tier(files);
    let has_faces_alone = skipped.is_empty() && !faces.is_empty();
    skipped.extend(faces);
    let (tier, duplicates) = of_one_format(tier);
    let copies = duplicates.len();
    skipped.extend(duplicates);
    let (frames, odd) = of_one_series(tier)?;
    let odd_clouds = odd.len();
    skipped.extend(odd);
    skipped.sort_by(|left, right| natural_order(left, right));
    if skipped.is_empty() {
        let assumption = kinds::without_order(&frames);
        return Ok(Chosen {
            frames,
            skipped,
            assumption,
        });
    }
    let assumption = (!skipped.is_empty()).then(|| {
        let value = format!(
            "{} of {} files, {}",
            grouped(frames.len()),
            grouped(total),
            pattern_of(&frames, &skipped)
        );
        if has_faces_alone && copies + odd_clouds == 0 {
            let why = "an array of mesh faces next to its vertices holds no points";
            Assumption::new(Subject::Frames, value, why, Evidence::Convention)
        } else if copies > 0 && odd_clouds == 0 {
            let why = "the others have the same names in another format";
            Assumption::new(Subject::Frames, value, why, Evidence::Convention)
        } else if odd_clouds > 0 {
            let why = "most files have such names";
            Assumption::new(Subject::Frames, value, why, Evidence::Statistics)
        } else {
            let why = "text and arrays next to point clouds list times, poses and calibration";
            Assumption::new(Subject::Frames, value, why, Evidence::Convention)
        }
    });
    Ok(Chosen {
        frames,
        skipped,
        assumption,
    })
}

/// Files of the best tier, or of a lower one that has far more numbered files.
fn of_one_tier(files: Vec<PathBuf>) -> (Vec<PathBuf>, Vec<PathBuf>) {
    let mut tiers: BTreeMap<Tier, Vec<PathBuf>> = BTreeMap::new();
    for file in files {
        tiers.entry(Tier::of(&file)).or_default().push(file);
    }
    let mut best: Option<(Tier, usize)> = None;
    for (&tier, files) in &tiers {
        let is_chosen = match best {
            None => true,
            Some((best, count)) => {
                let larger = largest_series(files);
                larger.len() > MAJORITY * count && !belong_to(&larger, &tiers[&best])
            }
        };
        if is_chosen {
            best = Some((tier, files.len()));
        }
    }
    let Some((best, _)) = best else {
        return (Vec::new(), Vec::new());
    };
    let mut frames = tiers.remove(&best).unwrap_or_default();
    let mut skipped: Vec<PathBuf> = tiers.into_values().flatten().collect();
    // If the frames are text, a list of times has a different name.
    if best == Tier::Text {
        let series: HashSet<PathBuf> = largest_series(&frames).into_iter().collect();
        if series.len() > 1 {
            skipped.extend(frames.extract_if(.., |file| !series.contains(file) && is_list(file)));
        } else if frames.iter().any(|file| !is_list(file)) {
            skipped.extend(frames.extract_if(.., |file| is_list(file)));
        }
    }
    (frames, skipped)
}

/// Returns true if nearly all of `clouds` have a file of the same stem among `others`, which therefore describe the
/// clouds.
fn belong_to(others: &[PathBuf], clouds: &[PathBuf]) -> bool {
    let stems: HashSet<String> = others.iter().map(|file| split_name(file).0.into_owned()).collect();
    let paired = clouds
        .iter()
        .filter(|file| stems.contains(split_name(file).0.as_ref()))
        .count();
    clouds.len() > 1 && 2 * paired > clouds.len()
}

/// Returns true if `file` has the name of a list of times, poses or settings.
pub(super) fn is_list(file: &Path) -> bool {
    const WORDS: [&str; 17] = [
        "time",
        "stamp",
        "pose",
        "calib",
        "traj",
        "readme",
        "license",
        "licence",
        "size",
        "label",
        "groundtruth",
        "intrinsic",
        "extrinsic",
        "odom",
        "metadata",
        "info",
        "config",
    ];
    if Tier::of(file) == Tier::Cloud {
        return false;
    }
    let stem = split_name(file).0.to_lowercase();
    WORDS.iter().any(|word| stem.contains(word)) || stem == "gt" || stem == "imu"
}

/// Files of the format that most have, where two formats hold the same frames.
fn of_one_format(files: Vec<PathBuf>) -> (Vec<PathBuf>, Vec<PathBuf>) {
    let extension = |file: &PathBuf| split_name(file).1.to_lowercase();
    let mut by_extension: BTreeMap<String, HashSet<(PathBuf, String)>> = BTreeMap::new();
    for file in &files {
        let place = (
            file.parent().unwrap_or(Path::new("")).to_owned(),
            split_name(file).0.into_owned(),
        );
        by_extension.entry(extension(file)).or_default().insert(place);
    }
    // With equally many files, formats with a header are preferred, and those come later in the order, except for `bin`
    // and `las`.
    let rank = |(name, stems): &(&String, &HashSet<(PathBuf, String)>)| (stems.len(), *name != "bin" && *name != "xyz");
    let Some((retained, stems)) = by_extension.iter().max_by_key(rank) else {
        return (files, Vec::new());
    };
    let is_copy = |(name, others): &(&String, &HashSet<(PathBuf, String)>)| {
        let shared = others.intersection(stems).count();
        // One file in two formats is one scan.
        let is_one_scan = shared == 1 && stems.len() == 1 && others.len() == 1;
        *name != retained && (is_one_scan || (shared > 1 && 2 * shared > others.len()))
    };
    let copies: HashSet<&String> = by_extension.iter().filter(is_copy).map(|(name, _)| name).collect();
    files.into_iter().partition(|file| !copies.contains(&extension(file)))
}

/// The files of one series, and few others that are skipped.
fn of_one_series(files: Vec<PathBuf>) -> Result<(Vec<PathBuf>, Vec<PathBuf>), Vec<OpeningChoice>> {
    let mut series: Vec<Vec<PathBuf>> = Vec::new();
    let mut singles = Vec::new();
    for group in groups_of(&files) {
        if group.len() > 1 {
            series.extend(by_number_of_camera(group));
        } else {
            singles.extend(group);
        }
    }
    series.sort_by(|left, right| {
        right
            .len()
            .cmp(&left.len())
            .then_with(|| natural_order(&left[0], &right[0]))
    });
    let Some(largest) = series.first().map(Vec::len) else {
        return alone(files);
    };
    if series.len() == 1 && singles.is_empty() && kinds::are_levels(&series[0]) {
        return alone(files);
    }
    let in_series: usize = series.iter().map(Vec::len).sum();
    if in_series < MIN_SERIES_PER_SINGLE * singles.len() || series.len() > MAX_SERIES {
        return Ok((files, Vec::new()));
    }
    let is_large = |one: &&Vec<PathBuf>| one.len() as f64 >= MIN_SHARE * largest as f64;
    let rivals: Vec<&Vec<PathBuf>> = series.iter().filter(is_large).collect();
    if rivals.len() > 1 {
        return Err(rivals.into_iter().map(|one| choice_of(one, &files)).collect());
    }
    let frames = series.swap_remove(0);
    let skipped = series.into_iter().flatten().chain(singles).collect();
    Ok((frames, skipped))
}

/// Files that are not a series: a question if their names denote different things.
fn alone(files: Vec<PathBuf>) -> Result<(Vec<PathBuf>, Vec<PathBuf>), Vec<OpeningChoice>> {
    let is_question = files.len() > 1 && files.len() <= MAX_SERIES;
    if !is_question || !(kinds::are_different_things(&files) || kinds::are_levels(&files)) {
        return Ok((files, Vec::new()));
    }
    let choices = files.iter().map(|file| choice_of(std::slice::from_ref(file), &files));
    Err(choices.collect())
}

/// Splits the files into those retained and the face arrays of a mesh whose vertices are in companion files.
fn without_faces(files: Vec<PathBuf>) -> (Vec<PathBuf>, Vec<PathBuf>) {
    const VERTICES: [&str; 7] = ["v", "verts", "vertices", "points", "xyz", "coords", "positions"];
    const FACES: [&str; 9] = [
        "f",
        "faces",
        "face",
        "triangles",
        "tris",
        "edges",
        "cells",
        "elements",
        "weights",
    ];
    let is_named = |file: &PathBuf, names: &[&str]| {
        Tier::of(file) == Tier::Arrays && names.contains(&split_name(file).0.to_lowercase().as_str())
    };
    if !files.iter().any(|file| is_named(file, &VERTICES)) {
        return (files, Vec::new());
    }
    files.into_iter().partition(|file| !is_named(file, &FACES))
}

/// Files with numbers whose names have the same letters, and each of the others alone.
fn groups_of(files: &[PathBuf]) -> Vec<Vec<PathBuf>> {
    let is_folder_per_frame = is_folder_per_frame(files);
    let mut by_letters: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    let mut by_name: BTreeMap<PathBuf, Vec<PathBuf>> = BTreeMap::new();
    for file in files {
        let name = SplitName::of(&telling_name(file, is_folder_per_frame), Minus::AfterSeparator);
        if name.numbers.is_empty() {
            // The same name in several numbered folders: `000/body.ply`, `001/body.ply`.
            let name = if is_folder_per_frame {
                file.into()
            } else {
                file.file_name().unwrap_or_default().into()
            };
            by_name.entry(name).or_default().push(file.clone());
        } else {
            by_letters.entry(name.letters()).or_default().push(file.clone());
        }
    }
    let mut alone: Vec<Vec<PathBuf>> = by_name.into_values().collect();
    // `scan.ply`, `scan 1.ply`, `scan 2.ply`: a file manager numbers copies like this.
    alone.retain(|file| {
        let letters = SplitName::of(&telling_name(&file[0], is_folder_per_frame), Minus::AfterSeparator).letters();
        let numbered = by_letters.get_mut(&letters).filter(|_| !letters.is_empty());
        numbered.is_none_or(|numbered| {
            numbered.extend_from_slice(file);
            false
        })
    });
    by_letters.into_values().chain(alone).collect()
}

/// The series of each camera in names such as `cam0_17`: one number follows letters directly and has few values, and
/// the other numbers repeat for each of them.
fn by_number_of_camera(group: Vec<PathBuf>) -> Vec<Vec<PathBuf>> {
    let names: Vec<SplitName> = group
        .iter()
        .map(|file| SplitName::of(&split_name(file).0, Minus::AfterSeparator))
        .collect();
    let is_alike = names.windows(2).all(|pair| pair[0].skeleton == pair[1].skeleton);
    let [first, .., last] = names[0].numbers.as_slice() else {
        return vec![group];
    };
    if !is_alike || !(first.follows_letter || last.follows_letter) {
        return vec![group];
    }
    let last = names[0].numbers.len() - 1;
    let distinct = |column: usize| {
        let values = names.iter().map(|name| name.numbers[column].value.to_bits());
        values.collect::<HashSet<_>>().len()
    };
    let (camera, frame) = if distinct(0) <= distinct(last) {
        (0, last)
    } else {
        (last, 0)
    };
    let mut cameras: BTreeMap<u64, (HashSet<u64>, Vec<PathBuf>)> = BTreeMap::new();
    for (name, file) in names.iter().zip(&group) {
        let (numbers, files) = cameras.entry(name.numbers[camera].value.to_bits()).or_default();
        numbers.insert(name.numbers[frame].value.to_bits());
        files.push(file.clone());
    }
    let mut sets = cameras.values().map(|(numbers, _)| numbers);
    let repeats = match (sets.next(), sets.next()) {
        (Some(one), Some(other)) => 2 * one.intersection(other).count() >= one.len().min(other.len()),
        _ => false,
    };
    if !repeats || cameras.values().any(|(_, files)| files.len() < 2) {
        return vec![group];
    }
    cameras.into_values().map(|(_, files)| files).collect()
}

/// The numbered files among `files` whose names are alike, of the most frequent kind.
pub(super) fn largest_series(files: &[PathBuf]) -> Vec<PathBuf> {
    let numbered = groups_of(files).into_iter().filter(|group| group.len() > 1);
    numbered.max_by_key(Vec::len).unwrap_or_default()
}

fn choice_of(series: &[PathBuf], all: &[PathBuf]) -> OpeningChoice {
    let others: Vec<PathBuf> = {
        let own: HashSet<&PathBuf> = series.iter().collect();
        all.iter().filter(|file| !own.contains(file)).cloned().collect()
    };
    let pattern = pattern_of(series, &others);
    let folder = series[0].parent().unwrap_or(Path::new(""));
    let is_in_one = series.iter().all(|file| file.parent() == Some(folder));
    let escaped = if is_in_one {
        glob::Pattern::escape(&folder.to_string_lossy())
    } else {
        let above = folder.parent().unwrap_or(Path::new(""));
        format!("{}/*", glob::Pattern::escape(&above.to_string_lossy()))
    };
    OpeningChoice {
        label: match series {
            [one] => one.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            _ => format!("{pattern} ({} files)", series.len()),
        },
        option: Some(format!("--only '{pattern}'")),
        input: Path::new(&escaped).join(&pattern),
    }
}

/// A pattern for the names of `files` that matches none of `others`, if there is one.
pub(super) fn pattern_of(files: &[PathBuf], others: &[PathBuf]) -> String {
    let names = |files: &[PathBuf]| -> Vec<String> {
        let names = files.iter().filter_map(|file| file.file_name());
        names.map(|name| name.to_string_lossy().into_owned()).collect()
    };
    let (names, others) = (names(files), names(others));
    if let [one] = names.as_slice() {
        return glob::Pattern::escape(one);
    }
    let is_digit = |c: char| c.is_ascii_digit();
    let prefix = common(&names, false).trim_end_matches(is_digit).to_owned();
    let suffix = common(&names, true).trim_start_matches(is_digit).to_owned();
    let (prefix, suffix) = (glob::Pattern::escape(&prefix), glob::Pattern::escape(&suffix));
    let candidates = [
        format!("{prefix}*"),
        format!("*{suffix}"),
        format!("{prefix}[0-9]*{suffix}"),
        format!("{prefix}*{suffix}"),
        format!("{prefix}*[0-9]{suffix}"),
        format!("{prefix}[!a-zA-Z]*[0-9]{suffix}"),
    ];
    let separates = |pattern: &&String| {
        let parsed = glob::Pattern::new(pattern);
        parsed.is_ok_and(|parsed| {
            names.iter().all(|name| parsed.matches(name)) && !others.iter().any(|other| parsed.matches(other))
        })
    };
    let found = candidates.iter().find(separates);
    found.unwrap_or(&candidates[3]).clone()
}

/// The longest common beginning of `names`, or their longest common end.
fn common(names: &[String], from_end: bool) -> String {
    let chars = |name: &String| -> Vec<char> {
        if from_end {
            name.chars().rev().collect()
        } else {
            name.chars().collect()
        }
    };
    let mut names = names.iter();
    let mut common = names.next().map(chars).unwrap_or_default();
    for name in names {
        let shared = common
            .iter()
            .zip(chars(name))
            .take_while(|(left, right)| **left == *right);
        let length = shared.count();
        common.truncate(length);
    }
    if from_end {
        common.reverse();
    }
    common.into_iter().collect()
}

/// A sentence about files that are not frames, and that nothing else has a use for.
pub(super) fn note_of_skipped(skipped: &[PathBuf]) -> Option<String> {
    const NAMED_FILES: usize = 4;
    let mut counts: HashMap<String, usize> = HashMap::new();
    let mut names: Vec<String> = Vec::new();
    for file in skipped {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let count = counts.entry(name.clone()).or_default();
        *count += 1;
        if *count == 1 {
            names.push(name);
        }
    }
    let more = if names.len() > NAMED_FILES { ", …" } else { "" };
    let named = names.iter().take(NAMED_FILES).cloned().collect::<Vec<_>>().join(", ");
    match skipped.len() {
        0 => None,
        1 => Some(format!("{named} next to the frames is skipped: it is not one of them")),
        count => Some(format!(
            "{count} files next to the frames are skipped, as they are not among them ({named}{more})"
        )),
    }
}

#[cfg(test)]
#[path = "series_tests.rs"]
mod tests;
