//! Companion files next to the frames that are not frames themselves: their normals, masks, labels.
//!
//! **How it works.** File names decide which files to check, headers decide their contents. `7_normal.pcd` is checked,
//! as its name ends like one of normals; so is `7_mask.ply` next to `7.ply`, since two files share the number 7. Of
//! files whose names are alike except for their numbers, one is enough if it has points. Normals are attached to the
//! frame of their name; files that hold no points are skipped and reported in a sentence. A folder in which every file
//! has a number of its own is not checked: there may be a hundred thousand.
//!
//! Results for a file are cached ([`Known`]): a folder that grows is listed every second.

use crate::io::Format;
use crate::io::normals::{RowContents, rows_of};
use crate::natural::{NamePiece, Runs, natural_order, split_name};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Suffixes that follow the stem of a frame in the stem of its normals file, in lower case.
const SUFFIXES: [&str; 6] = ["_normal", "_normals", "-normal", "-normals", ".normal", ".normals"];

/// Maximum number of files named in a note.
const NAMED_FILES: usize = 3;

/// Cache of the row contents of files. Files whose contents cannot be determined, such as those still being written,
/// are checked again.
#[derive(Debug, Default)]
pub(super) struct Known(HashMap<PathBuf, RowContents>);

impl Known {
    fn rows_of(&mut self, path: &Path) -> Option<RowContents> {
        if let Some(&rows) = self.0.get(path) {
            return Some(rows);
        }
        let rows = rows_of(path)?;
        self.0.insert(path.to_owned(), rows);
        Some(rows)
    }
}

/// Companion files and the frames they belong to.
#[derive(Debug, Default)]
pub(super) struct Companions {
    /// Companion normals of each file that has some.
    pub(super) normals: HashMap<PathBuf, PathBuf>,
    /// Files that are neither frames nor belong to one.
    pub(super) skipped: Vec<PathBuf>,
}

impl Companions {
    /// Removes from `files` the normals files that accompany their points.
    pub(super) fn take_normals(&mut self, files: &mut Vec<PathBuf>, known: &mut Known) {
        let bases: Vec<Option<(PathBuf, String)>> = files.iter().map(|file| base_of(file)).collect();
        if bases.iter().all(Option::is_none) || bases.iter().all(Option::is_some) {
            return;
        }
        let mut by_stem: HashMap<(PathBuf, String), Vec<PathBuf>> = HashMap::new();
        for file in files.iter().filter(|file| may_have_normals_sidecar(file)) {
            by_stem.entry(place_of(file)).or_default().push(file.clone());
        }
        let mut bases = bases.into_iter();
        files.retain(|file| {
            let Some(base) = bases.next().flatten() else {
                return true;
            };
            match known.rows_of(file) {
                Some(RowContents::Normals) => {}
                Some(RowContents::Points) | None => return true,
                Some(RowContents::Other) => {
                    self.skipped.push(file.clone());
                    return false;
                }
            }
            let of_same_kind = |frame: &&PathBuf| frame.extension() == file.extension();
            let frames = by_stem.get(&base).map(Vec::as_slice).unwrap_or_default();
            let frame = frames.iter().find(of_same_kind).or(frames.first());
            match frame.filter(|frame| !self.normals.contains_key(*frame)) {
                Some(frame) => {
                    self.normals.insert(frame.clone(), file.clone());
                }
                None => self.skipped.push(file.clone()),
            }
            false
        });
    }

    /// Leaves files without points out of `files` that share their number with one that has points.
    pub(super) fn skip_others(&mut self, files: &mut Vec<PathBuf>, known: &mut Known) {
        let mut by_number: HashMap<(PathBuf, String), Vec<usize>> = HashMap::new();
        for (index, file) in files.iter().enumerate() {
            let digits = numbers_of(file);
            if !digits.is_empty() {
                by_number.entry((folder_of(file), digits)).or_default().push(index);
            }
        }
        // The first file of each name pattern that shares a number with another pattern.
        let mut first_of: BTreeMap<String, &PathBuf> = BTreeMap::new();
        for indices in by_number.values().filter(|indices| indices.len() > 1) {
            for &index in indices {
                let first = first_of.entry(pattern_of(&files[index])).or_insert(&files[index]);
                if natural_order(&files[index], first).is_lt() {
                    *first = &files[index];
                }
            }
        }
        let has_no_points = |rows: Option<RowContents>| matches!(rows, Some(RowContents::Normals | RowContents::Other));
        let odd: HashSet<String> = first_of
            .iter()
            .filter(|(_, first)| has_no_points(known.rows_of(first)))
            .map(|(pattern, _)| pattern.clone())
            .collect();
        // If nothing has points, each file reports why when it is read.
        if odd.len() == first_of.len() {
            return;
        }
        files.retain(|file| {
            let stays = !odd.contains(&pattern_of(file)) || !has_no_points(known.rows_of(file));
            if !stays {
                self.skipped.push(file.clone());
            }
            stays
        });
    }

    /// Returns a note listing the skipped files, as a sentence.
    pub(super) fn note(&self) -> Option<String> {
        let mut skipped: Vec<&PathBuf> = self.skipped.iter().collect();
        skipped.sort_by(|one, other| natural_order(one, other));
        let named: Vec<String> = skipped
            .iter()
            .take(NAMED_FILES)
            .filter_map(|path| path.file_name())
            .map(|name| name.to_string_lossy().into_owned())
            .collect();
        let more = if skipped.len() > NAMED_FILES { ", …" } else { "" };
        let named = named.join(", ");
        match skipped.len() {
            0 => None,
            1 => Some(format!(
                "{named} lies next to the frames and holds no points: it is skipped"
            )),
            count => Some(format!(
                "{count} files next to the frames hold no points ({named}{more}): they are skipped"
            )),
        }
    }
}

/// A file of one frame, whose rows can be counted.
fn may_have_normals_sidecar(file: &Path) -> bool {
    Format::of_extension(file).is_some_and(|format| !format.holds_many() || format.is_rarely_many())
}

fn folder_of(file: &Path) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).to_owned()
}

/// Folder and stem.
fn place_of(file: &Path) -> (PathBuf, String) {
    (folder_of(file), split_name(file).0.into_owned())
}

/// Folder and stem of the frame whose normals `file` would hold by its name.
fn base_of(file: &Path) -> Option<(PathBuf, String)> {
    if !Format::of_extension(file).is_some_and(Format::names_columns) {
        return None;
    }
    let (folder, stem) = place_of(file);
    let lower = stem.to_lowercase();
    let suffix = SUFFIXES.iter().find(|suffix| lower.ends_with(*suffix))?;
    // Suffixes are ASCII, so the stem ends with the same number of bytes in upper and lower case.
    let base = stem.get(..stem.len() - suffix.len())?;
    (!base.is_empty()).then(|| (folder, base.to_owned()))
}

/// The numbers in a name, one after the other.
fn numbers_of(file: &Path) -> String {
    let name = split_name(file).0;
    let digits = Runs(&name).filter_map(|run| match run {
        NamePiece::Digits(digits) => Some(digits),
        NamePiece::Text(_) => None,
    });
    digits.collect::<Vec<_>>().join(" ")
}

/// A name without its numbers.
fn pattern_of(file: &Path) -> String {
    let (stem, extension) = split_name(file);
    let runs = Runs(&stem).map(|run| match run {
        NamePiece::Digits(_) => "#",
        NamePiece::Text(text) => text,
    });
    format!("{}.{extension}", runs.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn ply(names: &[&str]) -> String {
        let properties = names.iter().map(|name| format!("property float {name}\n"));
        let row = vec!["0"; names.len()].join(" ");
        format!(
            "ply\nformat ascii 1.0\nelement vertex 1\n{}end_header\n{row}\n",
            properties.collect::<String>()
        )
    }

    /// Result for the files of one folder: those that stay, normals with their frames, skipped ones.
    fn grouped(files: &[(&str, &[&str])]) -> (Vec<String>, Vec<String>, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let mut paths = Vec::new();
        for (name, fields) in files {
            let path = folder.path().join(name);
            fs::write(&path, ply(fields)).unwrap();
            paths.push(path);
        }
        let (mut companions, mut known) = (Companions::default(), Known::default());
        companions.take_normals(&mut paths, &mut known);
        companions.skip_others(&mut paths, &mut known);
        let name = |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().to_owned();
        let sorted = |mut names: Vec<String>| {
            names.sort();
            names
        };
        let pairs = companions.normals.iter();
        (
            paths.iter().map(name).collect(),
            sorted(
                pairs
                    .map(|(frame, sidecar)| format!("{} + {}", name(frame), name(sidecar)))
                    .collect(),
            ),
            sorted(companions.skipped.iter().map(name).collect()),
        )
    }

    const POINTS: &[&str] = &["x", "y", "z"];
    const NORMALS: &[&str] = &["nx", "ny", "nz"];
    const LABELS: &[&str] = &["label"];

    #[test]
    fn normals_go_to_the_frame_of_their_name() {
        let (stay, pairs, skipped) = grouped(&[
            ("1.ply", POINTS),
            ("1_normal.ply", NORMALS),
            ("2_Normals.PLY", NORMALS),
            ("2.ply", POINTS),
            ("scan.ply", POINTS),
            ("scan-normals.ply", NORMALS),
            ("3.xyz", POINTS),
            ("3.normal.ply", NORMALS),
        ]);
        assert_eq!(stay, ["1.ply", "2.ply", "scan.ply", "3.xyz"]);
        assert_eq!(
            pairs,
            [
                "1.ply + 1_normal.ply",
                "2.ply + 2_Normals.PLY",
                "3.xyz + 3.normal.ply",
                "scan.ply + scan-normals.ply"
            ]
        );
        assert_eq!(skipped, [""; 0]);
    }

    #[test]
    fn contents_decide_not_names() {
        let all = &["x", "y", "z", "nx", "ny", "nz"];
        let (stay, pairs, skipped) = grouped(&[("1.ply", POINTS), ("1_normal.ply", all), ("2_normal.ply", POINTS)]);
        assert_eq!(stay, ["1.ply", "1_normal.ply", "2_normal.ply"]);
        assert_eq!(pairs, [""; 0]);
        assert_eq!(skipped, [""; 0]);
    }

    #[test]
    fn normals_without_points_and_duplicate_normals_are_skipped() {
        let (stay, pairs, skipped) = grouped(&[
            ("1.ply", POINTS),
            ("1_normal.ply", NORMALS),
            ("1_normals.ply", NORMALS),
            ("2_normal.ply", NORMALS),
            ("1-normals.ply", LABELS),
        ]);
        assert_eq!(stay, ["1.ply"]);
        assert_eq!(pairs, ["1.ply + 1_normal.ply"]);
        assert_eq!(skipped, ["1-normals.ply", "1_normals.ply", "2_normal.ply"]);
    }

    #[test]
    fn files_without_points_next_to_a_frame_are_skipped() {
        let (stay, _, skipped) = grouped(&[
            ("1.ply", POINTS),
            ("1_mask.ply", LABELS),
            ("2.ply", POINTS),
            ("2_mask.ply", LABELS),
            ("3_mask.ply", LABELS),
            ("cam_2.ply", POINTS),
        ]);
        assert_eq!(stay, ["1.ply", "2.ply", "cam_2.ply"]);
        assert_eq!(skipped, ["1_mask.ply", "2_mask.ply", "3_mask.ply"]);
    }

    #[test]
    fn files_sharing_no_number_are_not_examined_and_fail_on_their_own() {
        let (stay, _, skipped) = grouped(&[("1.ply", POINTS), ("2.ply", LABELS), ("mask_3.ply", LABELS)]);
        assert_eq!(stay.len(), 3);
        assert_eq!(skipped, [""; 0]);
        let (stay, _, _) = grouped(&[("1.ply", LABELS), ("1_mask.ply", LABELS)]);
        assert_eq!(stay.len(), 2);
        // All files are named like normals: then they are the frames.
        let (stay, _, _) = grouped(&[("1_normal.ply", NORMALS), ("2_normal.ply", NORMALS)]);
        assert_eq!(stay.len(), 2);
    }

    #[test]
    fn skipped_files_are_reported_in_one_sentence() {
        let note = |names: &[&str]| {
            let skipped = names.iter().map(PathBuf::from).collect();
            let companions = Companions {
                skipped,
                ..Companions::default()
            };
            companions.note()
        };
        assert_eq!(note(&[]), None);
        assert_eq!(
            note(&["a/1_mask.ply"]).unwrap(),
            "1_mask.ply lies next to the frames and holds no points: it is skipped"
        );
        assert_eq!(
            note(&["m10.ply", "m2.ply", "m1.ply", "m3.ply"]).unwrap(),
            "4 files next to the frames hold no points (m1.ply, m2.ply, m3.ply, …): they are skipped"
        );
    }
}
