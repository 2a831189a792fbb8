//! Cases: files that are tried together. A fresh one is made from seeds and a number, so that the number is enough to
//! make it again; others are stored in a corpus.

use crate::kinds::{FOLDERS, kind_of};
use crate::nested::mutate_file;
use crate::random::Random;
use std::path::{Path, PathBuf};

/// Files of one case or seed by their names, with `/` between folders; the first is opened, or all of them as a folder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Case {
    pub(crate) set: String,
    pub(crate) name: String,
    pub(crate) files: Vec<(String, Vec<u8>)>,
}

impl Case {
    /// Writes it into a new folder. Returns the path to open.
    pub(crate) fn write(&self, folder: &Path) -> PathBuf {
        // It may not exist.
        let _ = std::fs::remove_dir_all(folder);
        for (name, bytes) in &self.files {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, bytes).unwrap();
        }
        if FOLDERS.contains(&self.set.as_str()) && self.files.len() > 1 {
            folder.to_owned()
        } else {
            folder.join(&self.files[0].0)
        }
    }
}

/// All files below `folder`, named from it, in order.
fn files_below(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            let below = files_below(&path).into_iter();
            files.extend(below.map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else {
            files.push((name, std::fs::read(&path).unwrap()));
        }
    }
    files
}

/// The corpus in `folder`: a folder per set, in it a file per case, or a folder where a case has several.
pub(crate) fn retained_in(folder: &Path) -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for (path, bytes) in files_below(folder) {
        let mut parts = path.splitn(3, '/');
        let (Some(set), Some(name)) = (parts.next(), parts.next()) else {
            continue;
        };
        let file = parts.next().unwrap_or(name).to_owned();
        match cases.last_mut() {
            Some(last) if last.set == set && last.name == name => last.files.push((file, bytes)),
            _ => cases.push(Case {
                set: set.to_owned(),
                name: name.to_owned(),
                files: vec![(file, bytes)],
            }),
        }
    }
    for case in &mut cases {
        let set = case.set.clone();
        // The file with an extension of the set is the one that is opened.
        case.files.sort_by_key(|(name, _)| kind_of(&set, name).set != set);
    }
    cases
}

/// The seed of a fresh case, and the case.
pub(crate) fn fresh(seeds: &[Case], set: &str, run: u64, number: u64) -> Option<(Case, Case)> {
    let mut random = Random::of(run, number);
    let of_set: Vec<&Case> = seeds.iter().filter(|seed| seed.set == set).collect();
    if of_set.is_empty() {
        return None;
    }
    let seed = *random.pick(&of_set);
    let mut case = seed.clone();
    case.name = format!("{set}-{run}-{number}");
    let count = case.files.len();
    let is_folder = FOLDERS.contains(&set);
    let place = if is_folder || random.one_in(4) {
        random.below(count)
    } else {
        0
    };
    let other = &random.pick(&of_set).files;
    let other = other[place.min(other.len() - 1)].1.clone();
    let (name, bytes) = &mut case.files[place];
    mutate_file(kind_of(set, name), bytes, &other, &mut random);
    Some((seed.clone(), case))
}
