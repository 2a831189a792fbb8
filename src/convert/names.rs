//! Names of the files that frames are written to.
//!
//! **How it works.** The stem of a frame's own file, or of the member that it was in an archive or a sequence file, is
//! retained: `mesh_00012.ply` becomes `mesh_00012.pcd`. That is only right if a folder of such files is the same
//! sequence again, so the names must differ, sort in the order of the frames and, where frames have times, contain
//! them; times that no name contains are appended. Where that fails, as for messages of a recording, frames are
//! numbered.

use crate::io::files::timestamps::times_of_names;
use crate::io::{Part, supported_extensions};
use crate::natural::{natural_order, split_name};
use crate::sequence::{FrameEntry, Sequence};
use crate::source::FrameBytes;
use std::cmp::Ordering;
use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// File names of all frames of a sequence.
#[derive(Debug)]
pub(super) struct FileNames {
    names: Vec<String>,
    /// Reason why they are not those of the source although frames have names there.
    pub(super) note: Option<String>,
}

impl FileNames {
    /// Returns the names of files with `extension`.
    pub(super) fn of(sequence: &Sequence, extension: &str) -> Self {
        Self::of_entries(&sequence.entries(), extension)
    }

    fn of_entries(entries: &[Arc<FrameEntry>], extension: &str) -> Self {
        let times: Vec<Option<Duration>> = entries.iter().map(|entry| entry.time).collect();
        let numbered = || (0..entries.len()).map(|index| format!("frame_{index:06}")).collect();
        let stems: Option<Vec<String>> = entries.iter().map(|entry| stem_of(entry)).collect();
        let (stems, problem) = match stems {
            Some(stems) => match problem_of(&stems, extension) {
                None => (stems, None),
                Some(problem) => (numbered(), Some(problem)),
            },
            None => (numbered(), None),
        };
        let names = match with_times(&stems, &times, extension) {
            Some(names) => names,
            None => with_times(&numbered(), &times, extension).unwrap_or_else(|| plain(&numbered(), extension)),
        };
        Self {
            names,
            note: problem.map(|problem| {
                format!("names of the source are not kept, frames are numbered frame_000000 and on: {problem}")
            }),
        }
    }

    /// The name of frame `index`. Precondition: the sequence had it when the names were made.
    pub(super) fn name(&self, index: usize) -> &str {
        &self.names[index]
    }
}

/// The stem of the file that a frame was; `None` where a frame is a message, a scan, or a part of an array.
fn stem_of(entry: &FrameEntry) -> Option<String> {
    let own = entry.name.rsplit(": ").next().unwrap_or_default();
    let is_member = || {
        let extension = Path::new(own).extension().and_then(|extension| extension.to_str());
        extension.is_some_and(|found| supported_extensions().any(|known| known.eq_ignore_ascii_case(found)))
    };
    let is_whole = matches!(entry.content, FrameBytes::File(Part::Whole | Part::Sole));
    let is_file = is_whole && entry.path.file_name().is_some_and(|file| file == own);
    if !is_file && !is_member() {
        return None;
    }
    let (stem, _) = split_name(Path::new(own));
    let is_fine = !stem.is_empty()
        && !stem.starts_with('.')
        && !stem.ends_with([' ', '.'])
        && !stem.contains(|sign: char| sign.is_control() || "/\\:*?\"<>|".contains(sign));
    is_fine.then(|| stem.into_owned())
}

/// Why a folder of these files would not be the same sequence.
fn problem_of(stems: &[String], extension: &str) -> Option<String> {
    let mut known = HashSet::new();
    if let Some(stem) = stems.iter().find(|stem| !known.insert(stem.to_lowercase())) {
        return Some(format!("several frames are named `{stem}`"));
    }
    let names = plain(stems, extension);
    let is_unsorted = |pair: &&[String]| natural_order(Path::new(&pair[0]), Path::new(&pair[1])) != Ordering::Less;
    names
        .windows(2)
        .find(is_unsorted)
        .map(|pair| format!("`{}` comes before `{}` in it but not by name", pair[0], pair[1]))
}

fn plain(stems: &[String], extension: &str) -> Vec<String> {
    stems.iter().map(|stem| format!("{stem}.{extension}")).collect()
}

/// File names that tell the times, if any frame has one; `None` if they would tell others.
fn with_times(stems: &[String], times: &[Option<Duration>], extension: &str) -> Option<Vec<String>> {
    let names = plain(stems, extension);
    if times.iter().all(Option::is_none) {
        return Some(names);
    }
    let told = |names: &[String]| {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        times_of_names(&names)
    };
    if told(&names) == times {
        return Some(names);
    }
    let stamped: Vec<String> = stems
        .iter()
        .zip(times)
        .map(|(stem, time)| match time {
            // Padded to the length of seconds since 1970, so that it is read as a time and not as a number.
            Some(time) => format!("{stem}_{:010}.{:09}.{extension}", time.as_secs(), time.subsec_nanos()),
            None => format!("{stem}.{extension}"),
        })
        .collect();
    // Times that do not increase, or that some frames lack, cannot be read from names.
    let can_be_told = times.len() > 1 && times.windows(2).all(|pair| pair[0].is_some() && pair[0] < pair[1]);
    (!can_be_told || told(&stamped) == times).then_some(stamped)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(files: &[&str]) -> (Vec<String>, bool) {
        let entries: Vec<Arc<FrameEntry>> = files.iter().map(|file| Arc::new(FrameEntry::file(file))).collect();
        let FileNames { names, note } = FileNames::of_entries(&entries, "pcd");
        (names, note.is_some())
    }

    #[test]
    fn stems_and_numbers_are_retained() {
        for (files, expected) in [
            (
                ["a/mesh_00000.ply", "a/mesh_00001.ply"],
                ["mesh_00000.pcd", "mesh_00001.pcd"],
            ),
            (["scan 9.xyz", "scan 10.xyz"], ["scan 9.pcd", "scan 10.pcd"]),
            (["d/f.001", "d/f.002"], ["f.001.pcd", "f.002.pcd"]),
            (["7.bin", "9.bin"], ["7.pcd", "9.pcd"]),
        ] {
            assert_eq!(
                names(&files),
                (expected.map(str::to_owned).to_vec(), false),
                "{files:?}"
            );
        }
    }

    #[test]
    fn frames_with_colliding_or_unsortable_names_are_renumbered_with_a_note() {
        let numbered = ["frame_000000.pcd", "frame_000001.pcd"].map(str::to_owned).to_vec();
        for files in [
            ["a/cloud.ply", "b/cloud.ply"],
            ["a/Cloud.ply", "a/cloud.ply"],
            ["a.ply", "a.obj"],
            ["b.ply", "a.ply"],
            ["x/scan_10.ply", "y/scan_9.ply"],
        ] {
            assert_eq!(names(&files), (numbered.clone(), true), "{files:?}");
        }
    }

    #[test]
    fn parts_of_files_are_numbered_and_members_keep_their_names() {
        let of = |own: [&str; 2]| {
            let entries = own.map(|own| {
                Arc::new(FrameEntry {
                    name: format!("walk.zip: {own}"),
                    ..FrameEntry::file("walk.zip")
                })
            });
            FileNames::of_entries(&entries, "ply").names
        };
        assert_eq!(of(["m_07.ply", "m_08.ply"]), ["m_07.ply", "m_08.ply"]);
        assert_eq!(of(["scan 7", "scan 8"]), ["frame_000000.ply", "frame_000001.ply"]);
    }

    #[test]
    fn times_missing_from_names_are_appended() {
        let of = |files: [&str; 2], millis: [u64; 2]| {
            let entries = [0, 1].map(|place| {
                Arc::new(FrameEntry {
                    time: Some(Duration::from_millis(millis[place])),
                    ..FrameEntry::file(files[place])
                })
            });
            FileNames::of_entries(&entries, "ply").names
        };
        let stamped = ["scan_1_0000000000.040000000.ply", "scan_2_0000000000.120000000.ply"];
        assert_eq!(of(["scan_1.pcd", "scan_2.pcd"], [40, 120]), stamped);
        let own = ["1305031102.175.pcd", "1305031102.275.pcd"];
        let retained = ["1305031102.175.ply", "1305031102.275.ply"];
        assert_eq!(of(own, [1_305_031_102_175, 1_305_031_102_275]), retained);
    }
}
