//! Folders, patterns and files → ordered entries.
//!
//! **How it works.** Inputs keep the order in which they were given, with one exception: files named one after the
//! other are sorted, because a shell expands `scan_*.ply` so (it sorts `scan_10` before `scan_2`). A folder or a
//! pattern is sorted in itself, by value or naturally (`names.rs`). A file that was already taken is not taken again.
//! Cost: the names are sorted, O(n log n); no file is opened except those that may hold many frames, whose list of
//! contents is read, and lists of times and poses.
//!
//! **Selection.** From a folder come files with an extension that a decoder knows, in any case, hidden ones skipped;
//! from its sub-folders if it has none itself (`folder.rs`). A pattern is read the same way, unless nothing it matches
//! has a known extension: then those files are meant. A file named outright is always taken; its first bytes decide.
//! Normals in a file next to their points belong to these, and any other file in a folder that shares its number with a
//! frame and holds no points is skipped (`companions.rs`). Of the others, the files of one series are frames
//! (`series.rs`). Times (`times.rs`) and poses (`poses.rs`) are looked for next to them.

use super::companions::{Companions, Known};
use super::folder::{self, FoundFiles};
use super::names::{is_folder_per_frame, sort, telling_name};
use super::numbers::number;
use super::recording::{Recording, topics_of};
use super::refusal;
use super::series::{self, note_of_skipped};
use super::{poses, times};
use crate::assumption::{Assumption, Evidence, Subject};
use crate::io::{self, Format};
use crate::natural::natural_order;
use crate::progress::Progress;
use crate::source::{FrameEntry, OpenOptions, SequenceError};
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Maximum number of sub-folders named in the error message for an empty folder.
const NAMED_SUBFOLDERS: usize = 3;

/// Names that the message of a pattern without a match has.
const NAMED_FILES: usize = 6;

/// More NPY files than these are not opened to see whether each holds several frames, unless the first one does.
const MAX_OPENED: usize = 64;

/// Maximum number of text files that are opened to check for several frames; if there are more, none is opened.
const MAX_OPENED_TEXTS: usize = 16;

/// Discovered frames, recordings and notes of `inputs`.
#[derive(Debug, Default)]
pub(super) struct Discovered {
    /// All frames in order.
    pub(super) entries: Vec<FrameEntry>,
    pub(super) recordings: Vec<Recording>,
    /// Notes on the skipped parts of the inputs, one sentence each.
    pub(super) notes: Vec<String>,
    /// Descriptions of truncated or damaged files, one sentence each; also included in the notes.
    pub(super) damage: Vec<String>,
    pub(super) assumptions: Vec<Assumption>,
}

/// The files that may be frames.
#[derive(Default)]
struct FoundPaths {
    paths: Vec<PathBuf>,
    companions: Companions,
    /// Files next to the frames that are not among them.
    skipped: Vec<PathBuf>,
    assumptions: Vec<Assumption>,
    notes: Vec<String>,
}

/// The ordered frames of `inputs`; see the module's text for the rules. `progress` counts the files that were looked
/// at, and may be cancelled.
pub(super) fn discover(
    inputs: &[PathBuf],
    options: &OpenOptions,
    known: &mut Known,
    progress: &Progress,
) -> Result<Discovered, SequenceError> {
    let FoundPaths {
        paths,
        mut companions,
        skipped,
        assumptions,
        mut notes,
    } = find_paths(inputs, options, known)?;
    notes.extend(companions.note());
    let mut discovered = Discovered {
        notes,
        assumptions,
        ..Discovered::default()
    };
    let count = paths.len();
    let opens_arrays = opens_arrays(&paths);
    let opens_text = count <= MAX_OPENED_TEXTS;
    let is_folder_per_frame = is_folder_per_frame(&paths);
    for (done, path) in paths.into_iter().enumerate() {
        progress.set(done, count);
        if progress.is_cancelled() {
            return Err(SequenceError::Cancelled);
        }
        let normals = companions.normals.remove(&path);
        let folder_name = is_folder_per_frame.then(|| telling_name(&path, true));
        let first = discovered.entries.len();
        discovered.append_frames(path, options, [opens_arrays, opens_text]);
        if let Some(entry) = discovered.entries.get_mut(first) {
            entry.normals = normals;
            if let Some(folder_name) = folder_name {
                entry.name = format!("{folder_name}/{}", entry.name);
            }
        }
    }
    if let Some(topic) = &options.topic {
        discovered.demand(topic)?;
    }
    number(&mut discovered.entries);
    discovered.look_for_sidecars(inputs, options, skipped)?;
    Ok(discovered)
}

/// The files of `inputs`, in order.
fn find_paths(inputs: &[PathBuf], options: &OpenOptions, known: &mut Known) -> Result<FoundPaths, SequenceError> {
    if inputs.is_empty() {
        return Err(SequenceError::NoInput);
    }
    let mut found = FoundPaths::default();
    let mut listed = Vec::new();
    for input in inputs {
        if !input.is_dir() && input.exists() {
            listed.push(input.clone());
            continue;
        }
        found.append_listed(&mut listed, known);
        let files = if input.is_dir() {
            find_in_folder(input, options.waits_for_first)?
        } else {
            FoundFiles {
                files: expand_pattern(input)?,
                ..FoundFiles::default()
            }
        };
        found.append_found(input, files, options.only.as_deref(), known)?;
    }
    found.append_listed(&mut listed, known);
    let mut taken = HashSet::with_capacity(found.paths.len());
    found.paths.retain(|path| taken.insert(path.clone()));
    Ok(found)
}

impl FoundPaths {
    /// Moves files that were named outright to the end of the frames.
    fn append_listed(&mut self, listed: &mut Vec<PathBuf>, known: &mut Known) {
        self.companions.take_normals(listed, known);
        sort(listed);
        self.paths.append(listed);
    }

    /// Appends the files of `input` that are frames.
    fn append_found(
        &mut self,
        input: &Path,
        found: FoundFiles,
        only: Option<&str>,
        known: &mut Known,
    ) -> Result<(), SequenceError> {
        let FoundFiles {
            mut files,
            below,
            skipped,
            note,
        } = found;
        self.notes.extend(note);
        self.skipped.extend(skipped);
        if let Some(only) = only {
            keep_only(&mut files, only)?;
        }
        self.companions.take_normals(&mut files, known);
        self.companions.skip_others(&mut files, known);
        let chosen = series::choose(files).map_err(|choices| SequenceError::Several {
            path: input.to_owned(),
            choices,
        })?;
        self.skipped.extend(chosen.skipped);
        self.assumptions.extend(chosen.assumption);
        if let Some(below) = below {
            let value = format!("{} files in {}", chosen.frames.len(), below.display());
            let why = "the folder that was named has its clouds there";
            self.assumptions
                .push(Assumption::new(Subject::Frames, value, why, Evidence::Convention).with_option(None));
        }
        let mut frames = chosen.frames;
        sort(&mut frames);
        self.paths.append(&mut frames);
        Ok(())
    }
}

/// Keeps the files whose names match the pattern `only`.
fn keep_only(files: &mut Vec<PathBuf>, only: &str) -> Result<(), SequenceError> {
    let pattern = glob::Pattern::new(only).map_err(|error| SequenceError::BadPattern {
        pattern: only.to_owned(),
        reason: error.msg.to_owned(),
    })?;
    let name = |file: &PathBuf| file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut names: Vec<String> = files.iter().map(name).collect();
    files.retain(|file| pattern.matches(&name(file)));
    if files.is_empty() && !names.is_empty() {
        names.sort_by(|left, right| natural_order(Path::new(left), Path::new(right)));
        names.dedup();
        let more = if names.len() > NAMED_FILES { ", …" } else { "" };
        names.truncate(NAMED_FILES);
        return Err(SequenceError::NothingOnly {
            pattern: only.to_owned(),
            found: format!("{}{more}", names.join(", ")),
        });
    }
    Ok(())
}

/// Returns true if NPY files are opened to check if each holds several frames.
fn opens_arrays(paths: &[PathBuf]) -> bool {
    let mut arrays = paths.iter().filter(|path| is_array(path));
    let Some(first) = arrays.next() else { return false };
    arrays.count() < MAX_OPENED || io::list(first, &io::ReadOptions::default()).is_ok_and(|entries| entries.len() > 1)
}

fn is_array(path: &Path) -> bool {
    let extension = path.extension();
    extension.is_some_and(|extension| extension.eq_ignore_ascii_case("npy"))
}

impl Discovered {
    /// Looks for times and poses next to the frames, and reports unused files.
    fn look_for_sidecars(
        &mut self,
        inputs: &[PathBuf],
        options: &OpenOptions,
        mut skipped: Vec<PathBuf>,
    ) -> Result<(), SequenceError> {
        let is_sequence = self.entries.len() > 1 || inputs.iter().any(|input| input.is_dir());
        let folders = if is_sequence && self.entries.iter().all(FrameEntry::is_file) {
            sibling_folders(&self.entries, inputs)
        } else {
            Vec::new()
        };
        let times = times::stamp(&mut self.entries, &folders);
        let poses = poses::place(
            &mut self.entries,
            &folders,
            options.rgbd.poses.as_deref(),
            options.rgbd.invert_poses,
        )?;
        if let Some((stamps, list)) = &poses.times {
            for (entry, time) in self.entries.iter_mut().zip(stamps) {
                entry.time = Some(*time);
            }
            self.assumptions.push(times::listed(stamps, list));
        }
        let used: HashSet<&PathBuf> = times.used.iter().chain(&poses.used).collect();
        skipped.retain(|file| !used.contains(file));
        self.notes.extend(times.notes);
        self.notes.extend(poses.notes);
        // Earlier reports about a list are not repeated.
        skipped.retain(|file| {
            let name = file.display().to_string();
            !self.notes.iter().any(|note| note.starts_with(&name))
        });
        self.notes.extend(note_of_skipped(&skipped));
        self.assumptions.extend(times.assumption);
        self.assumptions.extend(poses.assumption);
        Ok(())
    }

    /// Appends the contents of the file at `path`: one frame, or those that [`io::contents`] finds. An unlistable file
    /// is one frame, which reports the reason when it is decoded.
    ///
    /// With many files, text and arrays are one frame each, as they would have to be read here to know more: `opens`
    /// enables opening of arrays, and of text.
    fn append_frames(&mut self, path: PathBuf, options: &OpenOptions, opens: [bool; 2]) {
        let [opens_arrays, opens_text] = opens;
        let format = Format::of_extension(&path);
        // A file that its name identifies as a single frame is not opened here: there may be a hundred thousand.
        let may_hold_many = format.is_none_or(|format| format.holds_many() && (opens_text || !format.is_rarely_many()))
            && (opens_arrays || !is_array(&path));
        let stays_whole = options.merge_scans && format.is_some_and(Format::holds_scans);
        let listed =
            (may_hold_many && !stays_whole).then(|| io::contents(&path, options.topic.as_deref(), &options.read));
        match listed {
            // A file without any frame reports that when it is decoded.
            Some(Ok(contents)) if contents.entries.is_empty() && options.topic.is_none() => {
                self.entries.push(FrameEntry::file(path));
            }
            Some(Ok(contents)) => {
                let of_file = |note: &String| format!("{}: {note}", path.display());
                let damage = contents.damage.iter().map(of_file);
                let first = self.damage.len();
                self.damage.extend(damage);
                self.notes.extend(contents.notes.iter().map(of_file));
                self.notes.extend_from_slice(&self.damage[first..]);
                let frames = contents.entries.into_iter();
                self.entries.extend(frames.map(|entry| FrameEntry::entry(&path, entry)));
                if !contents.topics.is_empty() {
                    self.recordings.push(Recording {
                        path,
                        topics: contents.topics,
                    });
                }
            }
            Some(Err(_)) => self.entries.push(FrameEntry::unlisted(path)),
            None => self.entries.push(FrameEntry::file(path)),
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

/// Folders in which lists of the frames may be: the frames' own, and those above it as far as they belong to the same
/// recording.
fn sibling_folders(entries: &[FrameEntry], inputs: &[PathBuf]) -> Vec<PathBuf> {
    /// `velodyne_points/data` in the folder of a drive.
    const MAX_FOLDERS: usize = 4;
    let Some(mut folder) = common_folder(entries) else {
        return Vec::new();
    };
    let root = inputs.iter().find(|input| input.is_dir() && folder.starts_with(input));
    let mut folders = vec![folder.clone()];
    while folders.len() < MAX_FOLDERS {
        let is_below = root.is_some_and(|root| folder != *root && folder.starts_with(root));
        if !is_below && !folder::is_frame_folder(&folder) {
            break;
        }
        let above = match folder.parent() {
            Some(above) if !above.as_os_str().is_empty() => above.to_owned(),
            _ => folder.join(".."),
        };
        if above == folder {
            break;
        }
        folders.push(above.clone());
        folder = above;
    }
    // KITTI scans are in a folder of any name, with the list of their times next to it.
    let has_time_sidecar = |entry: &FrameEntry| Format::of_extension(&entry.path).is_some_and(Format::has_time_sidecar);
    if folders.len() == 1 && entries.iter().all(has_time_sidecar) {
        folders.push(folders[0].join(".."));
    }
    folders
}

/// The folder of all files, or that above them where each has one of its own.
fn common_folder(entries: &[FrameEntry]) -> Option<PathBuf> {
    let parents: HashSet<&Path> = entries.iter().map(|entry| entry.path.parent()).collect::<Option<_>>()?;
    let mut folders = parents.iter();
    let first = folders.next()?;
    if parents.len() == 1 {
        return Some((*first).to_owned());
    }
    let above = first.parent()?;
    folders
        .all(|folder| folder.parent() == Some(above))
        .then(|| above.to_owned())
}

/// The files in or below `folder`. An empty one may be waited for.
fn find_in_folder(folder: &Path, may_be_empty: bool) -> Result<FoundFiles, SequenceError> {
    let mut others = Vec::new();
    let (mut subfolders, mut own) = (Vec::new(), Vec::new());
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if folder::is_hidden(&path) {
            continue;
        }
        if path.is_dir() {
            subfolders.push(path);
        } else if has_known_extension(&path) {
            own.push(path);
        } else {
            others.push(path);
        }
    }
    if let Some(refusal) = refusal::of_whole(folder, &own, &others) {
        return Err(refusal);
    }
    let found = folder::find(folder)?;
    if found.files.is_empty() && !may_be_empty {
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
    Ok(found)
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

fn has_known_extension(path: &Path) -> bool {
    Format::of_extension(path).is_some()
}

fn known_patterns() -> String {
    let patterns: Vec<String> = io::supported_extensions()
        .map(|extension| format!("*.{extension}"))
        .collect();
    patterns.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    #[test]
    fn opening_reports_each_file_and_can_be_cancelled() {
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
}
