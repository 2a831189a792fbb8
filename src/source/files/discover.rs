//! Folders, patterns and files → ordered entries, by names alone.
//!
//! **How it works.** Inputs keep the order in which they were given, with one exception: files named one after the
//! other are sorted naturally, because that is what a shell makes of `scan_*.ply` (it sorts `scan_10` before `scan_2`).
//! A folder or a pattern is sorted naturally in itself. A file that was already taken is not taken again. Cost: the
//! names are sorted, O(n log n); no file is opened but those that may hold many frames, whose list of contents is read.
//!
//! **What counts.** From a folder come files with an extension that a decoder knows, in any case, hidden ones left out,
//! no sub-folders. A pattern is read the same way, unless nothing it matches has a known extension: then the person
//! meant those files. A file named outright is always taken; its first bytes decide. Normals in a file beside their
//! points belong to these, and what else in a folder shares its number with a frame and holds no points is left out
//! (`companions.rs`).

use super::companions::{Companions, Known};
use super::recording::{Recording, topics_of};
use super::refusal;
use super::stamps::stamp;
use crate::io::{self, Format};
use crate::natural::{NamePiece, Runs, natural_order, split_name};
use crate::progress::Progress;
use crate::source::{FrameEntry, OpenOptions, SequenceError};
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How many sub-folders the message of an empty folder names.
const NAMED_SUBFOLDERS: usize = 3;

/// What `inputs` hold.
#[derive(Debug, Default)]
pub(super) struct Discovered {
    /// All frames in order.
    pub(super) entries: Vec<FrameEntry>,
    pub(super) recordings: Vec<Recording>,
    /// What of the inputs is left out, a sentence each.
    pub(super) notes: Vec<String>,
}

/// The ordered frames of `inputs`; see the module's text for the rules. `progress` counts the files that were looked
/// at, and may be cancelled.
pub(super) fn discover(
    inputs: &[PathBuf],
    options: &OpenOptions,
    known: &mut Known,
    progress: &Progress,
) -> Result<Discovered, SequenceError> {
    if inputs.is_empty() {
        return Err(SequenceError::NoInput);
    }
    let mut paths = Vec::new();
    let mut listed = Vec::new();
    let mut companions = Companions::default();
    for input in inputs {
        if !input.is_dir() && input.exists() {
            listed.push(input.clone());
            continue;
        }
        companions.take_normals(&mut listed, known);
        append_sorted(&mut paths, &mut listed);
        let mut found = if input.is_dir() {
            scan_folder(input)?
        } else {
            expand_pattern(input)?
        };
        companions.take_normals(&mut found, known);
        companions.leave_out_others(&mut found, known);
        append_sorted(&mut paths, &mut found);
    }
    companions.take_normals(&mut listed, known);
    append_sorted(&mut paths, &mut listed);

    let mut taken = HashSet::with_capacity(paths.len());
    paths.retain(|path| taken.insert(path.clone()));
    let mut discovered = Discovered {
        notes: companions.note().into_iter().collect(),
        ..Discovered::default()
    };
    let count = paths.len();
    for (done, path) in paths.into_iter().enumerate() {
        progress.set(done, count);
        if progress.is_cancelled() {
            return Err(SequenceError::Cancelled);
        }
        let normals = companions.normals.remove(&path);
        let first = discovered.entries.len();
        discovered.append_frames(path, options, count);
        if let Some(entry) = discovered.entries.get_mut(first) {
            entry.normals = normals;
        }
    }
    if let Some(topic) = &options.topic {
        discovered.demand(topic)?;
    }
    number(&mut discovered.entries);
    stamp(&mut discovered.entries);
    Ok(discovered)
}

impl Discovered {
    /// Appends what is in the file at `path`: one frame, or those that [`io::contents`] finds. What cannot be listed is
    /// one frame, which says why when it is decoded.
    ///
    /// It is one of `count` files: of many, text is a frame each, as it would have to be read here to know more.
    fn append_frames(&mut self, path: PathBuf, options: &OpenOptions, count: usize) {
        const MAX_TEXTS: usize = 16;
        let format = Format::of_extension(&path);
        // A file of one frame by its name is not opened here: there may be a hundred thousand.
        let may_hold_many =
            format.is_none_or(|format| format.holds_many() && (count <= MAX_TEXTS || !format.is_rarely_many()));
        let stays_whole = options.merge_scans && format.is_some_and(Format::holds_scans);
        let listed =
            (may_hold_many && !stays_whole).then(|| io::contents(&path, options.topic.as_deref(), &options.read));
        match listed {
            // What holds no frame at all says so when it is decoded.
            Some(Ok(contents)) if contents.entries.is_empty() && options.topic.is_none() => {
                self.entries.push(FrameEntry::file(path));
            }
            Some(Ok(contents)) => {
                let notes = contents.notes.iter();
                self.notes
                    .extend(notes.map(|note| format!("{}: {note}", path.display())));
                let frames = contents.entries.into_iter();
                self.entries.extend(frames.map(|entry| FrameEntry::entry(&path, entry)));
                if !contents.topics.is_empty() {
                    self.recordings.push(Recording {
                        path,
                        topics: contents.topics,
                    });
                }
            }
            None | Some(Err(_)) => self.entries.push(FrameEntry::file(path)),
        }
    }

    /// A recording of several files need not have the topic in each of them, but in one.
    fn demand(&self, topic: &str) -> Result<(), SequenceError> {
        let mut known: Vec<String> = Vec::new();
        for found in topics_of(&self.recordings) {
            match found.cloud_count {
                0 => {}
                _ if found.name == topic => return Ok(()),
                count => known.push(format!("{} ({count})", found.name)),
            }
        }
        Err(SequenceError::NoTopic {
            topic: topic.to_owned(),
            hint: if known.is_empty() {
                "no input is a recording with point clouds".to_owned()
            } else {
                format!("name one of {}", known.join(", "))
            },
        })
    }
}

/// Whether nobody writes to the files of `entry` any more, as far as their times say. Its normals are waited for where
/// the frame before it has some, but not for long.
pub(super) fn is_written(entry: &FrameEntry, expects_normals: bool) -> bool {
    /// Who writes a frame has it done in pieces that follow each other faster.
    const QUIET: Duration = Duration::from_millis(500);
    /// Who writes normals behind each frame has them done by then.
    const NORMALS: Duration = Duration::from_secs(10);
    let is_older = |path: &Path, least: Duration| {
        let modified = fs::metadata(path).and_then(|metadata| metadata.modified());
        // A clock that stands before the file's says nothing.
        modified.map_or(true, |at| at.elapsed().map_or(true, |age| age >= least))
    };
    match &entry.normals {
        Some(normals) => is_older(&entry.path, QUIET) && is_older(normals, QUIET),
        None if expects_normals => is_older(&entry.path, NORMALS),
        None => is_older(&entry.path, QUIET),
    }
}

/// Moves `group` to the end of `paths`, in natural order.
fn append_sorted(paths: &mut Vec<PathBuf>, group: &mut Vec<PathBuf>) {
    group.sort_by(|left, right| natural_order(left, right));
    paths.append(group);
}

/// The point clouds directly in `folder`, in no order.
fn scan_folder(folder: &Path) -> Result<Vec<PathBuf>, SequenceError> {
    let unreadable = |reason| SequenceError::Unreadable {
        path: folder.to_path_buf(),
        reason,
    };
    let mut files = Vec::new();
    let mut others = Vec::new();
    let mut subfolders = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let path = entry.path();
        if is_hidden(&path) {
            continue;
        }
        let kind = entry.file_type().map_err(unreadable)?;
        // Only links cost a second look at the file system.
        let is_folder = kind.is_dir() || (kind.is_symlink() && path.is_dir());
        if is_folder {
            subfolders.push(path);
        } else if has_known_extension(&path) {
            files.push(path);
        } else {
            others.push(path);
        }
    }
    leave_out_buffers(&mut files);
    if let Some(refusal) = refusal::of_whole(folder, &files, &others) {
        return Err(refusal);
    }
    if files.is_empty() {
        let hint = if subfolders.is_empty() {
            String::new()
        } else {
            format!("; else {}", empty_folder_hint(subfolders.clone()))
        };
        if let Some(refusal) = refusal::of_files(folder, &mut others, &hint) {
            return Err(refusal);
        }
        return Err(SequenceError::EmptyFolder {
            path: folder.to_path_buf(),
            extensions: known_patterns(),
            hint: empty_folder_hint(subfolders),
        });
    }
    Ok(files)
}

/// Beside a glTF file, what is named `.bin` is a buffer of it and no scan.
fn leave_out_buffers(files: &mut Vec<PathBuf>) {
    let has_extension = |path: &Path, wanted: &str| {
        path.extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
    };
    if files.iter().any(|path| has_extension(path, "gltf")) {
        files.retain(|path| !has_extension(path, "bin"));
    }
}

fn empty_folder_hint(mut subfolders: Vec<PathBuf>) -> String {
    if subfolders.is_empty() {
        return "name another folder, or the files themselves if they have another extension".into();
    }
    subfolders.sort_by(|left, right| natural_order(left, right));
    let named: Vec<String> = subfolders
        .iter()
        .take(NAMED_SUBFOLDERS)
        .filter_map(|path| path.file_name())
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    let more = if subfolders.len() > NAMED_SUBFOLDERS {
        ", …"
    } else {
        ""
    };
    format!("name one of its sub-folders ({}{more})", named.join(", "))
}

/// The files that match `input` as a pattern, in no order.
fn expand_pattern(input: &Path) -> Result<Vec<PathBuf>, SequenceError> {
    let missing = || SequenceError::Missing {
        path: input.to_path_buf(),
    };
    let pattern = input.to_str().ok_or_else(missing)?;
    if !pattern.contains(['*', '?', '[']) {
        return Err(missing());
    }
    let options = glob::MatchOptions {
        require_literal_leading_dot: true,
        ..glob::MatchOptions::default()
    };
    let matches = glob::glob_with(pattern, options).map_err(|error| SequenceError::BadPattern {
        pattern: pattern.to_owned(),
        reason: error.msg.to_owned(),
    })?;
    let mut files = Vec::new();
    for found in matches {
        let path = found.map_err(|error| SequenceError::Unreadable {
            path: error.path().to_path_buf(),
            reason: error.into(),
        })?;
        if !path.is_dir() {
            files.push(path);
        }
    }
    if files.is_empty() {
        return Err(SequenceError::NoMatch {
            pattern: pattern.to_owned(),
        });
    }
    if files.iter().any(|path| has_known_extension(path)) {
        files.retain(|path| has_known_extension(path));
    }
    Ok(files)
}

fn is_hidden(path: &Path) -> bool {
    path.file_name()
        .is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}

fn has_known_extension(path: &Path) -> bool {
    Format::of_extension(path).is_some()
}

fn known_patterns() -> String {
    let patterns: Vec<String> = io::supported_extensions()
        .map(|extension| format!("*.{extension}"))
        .collect();
    patterns.join(", ")
}

/// Gives every entry the number in its name that counts the frames: the last run of digits that every name has and
/// that grows from each name to the next. Without such a run nobody gets a number; a single file gets its last run.
pub(in crate::source) fn number(entries: &mut [FrameEntry]) {
    let numbers_of = |entry: &FrameEntry| -> Vec<Option<u64>> {
        Runs(&split_name(Path::new(&entry.name)).0)
            .filter_map(|run| match run {
                NamePiece::Digits(digits) => Some(digits.parse().ok()),
                NamePiece::Text(_) => None,
            })
            .collect()
    };
    let Some(first) = entries.first() else {
        return;
    };
    // Which of the first name's runs still count, and their values in the name before.
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
        return;
    };
    for entry in entries {
        entry.number = numbers_of(entry).get(counting).copied().flatten();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    fn numbers(names: &[&str]) -> Vec<Option<u64>> {
        let mut entries: Vec<FrameEntry> = names.iter().map(FrameEntry::file).collect();
        number(&mut entries);
        entries.iter().map(|entry| entry.number).collect()
    }

    #[test]
    fn buffers_of_gltf_files_are_no_scans() {
        let left_of = |names: &[&str]| {
            let mut files = names.iter().map(PathBuf::from).collect();
            leave_out_buffers(&mut files);
            files
        };
        assert_eq!(left_of(&["a/Fox.bin", "a/Fox.GLTF"]), [Path::new("a/Fox.GLTF")]);
        assert_eq!(left_of(&["a/0.bin", "a/1.bin"]).len(), 2);
    }

    #[test]
    fn opening_tells_of_each_file_and_can_be_cancelled() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a_1.ply", "a_2.ply", "a_3.ply"] {
            fs::write(folder.path().join(name), "ply").unwrap();
        }
        let inputs = [folder.path().to_owned()];
        let told = Arc::new(Mutex::new(Vec::new()));
        let mut known = Known::default();
        let mut open = |progress: &Progress| discover(&inputs, &OpenOptions::default(), &mut known, progress);
        let hears = Arc::clone(&told);
        let progress = Progress::told_to(move |progress| {
            hears.lock().unwrap().push((progress.done(), progress.of()));
        });
        assert_eq!(open(&progress).unwrap().entries.len(), 3);
        progress.cancel();
        assert!(matches!(open(&progress), Err(SequenceError::Cancelled)));
        assert_eq!(*told.lock().unwrap(), [0, 1, 2, 0].map(|done| (done, Some(3))));
    }

    #[test]
    fn the_run_that_counts_is_the_number() {
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
    fn names_without_a_counting_run_have_no_number() {
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
