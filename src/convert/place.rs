//! State of the output location of a conversion, for callers that ask before writing.

use super::conversion::{Conversion, Output};
use super::record::{Record, real};
use super::reel;
use crate::regular_file;
use crate::sequence::{FrameEntry, Sequence};
use crate::source::FrameBytes;
use std::collections::HashSet;
use std::path::{Path, PathBuf, absolute};
use std::sync::Arc;

/// State of an output location.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Nothing exists there.
    Free,
    /// Output of the same conversion, interrupted earlier: it resumes from there.
    Interrupted,
    /// A file that would be replaced.
    Taken,
    /// Files of something else, among which frames would be lost.
    Occupied,
    /// The source of the conversion itself.
    Source,
    /// The folder that it would be in is not there.
    NoFolder,
}

impl Place {
    /// Examines the output location.
    pub fn of(conversion: &Conversion, sequence: &Sequence) -> Self {
        if source_at(&conversion.output, sequence).is_some() {
            return Self::Source;
        }
        match &conversion.output {
            Output::Reel(path, _) => Self::of_reel(path, conversion, sequence),
            Output::File(path) => Self::of_file(path),
            Output::Folder(folder) => Self::of_folder(folder, conversion, sequence),
        }
    }

    fn of_file(path: &Path) -> Self {
        if path.exists() {
            Self::Taken
        } else if path
            .parent()
            .is_none_or(|folder| folder.as_os_str().is_empty() || folder.is_dir())
        {
            Self::Free
        } else {
            Self::NoFolder
        }
    }

    fn of_reel(path: &Path, conversion: &Conversion, sequence: &Sequence) -> Self {
        match Self::of_file(path) {
            Self::Free if reel::is_interrupted(path, &Record::of(conversion, sequence)) => Self::Interrupted,
            place => place,
        }
    }

    fn of_folder(folder: &Path, conversion: &Conversion, sequence: &Sequence) -> Self {
        if folder.is_file() {
            return Self::Occupied;
        }
        let Ok(files) = folder.read_dir() else {
            let is_there = folder
                .parent()
                .is_none_or(|parent| parent.as_os_str().is_empty() || parent.is_dir());
            return if is_there { Self::Free } else { Self::NoFolder };
        };
        match Record::read(folder) {
            Some(record) if record == Record::of(conversion, sequence) => Self::Interrupted,
            None if files.count() == 0 => Self::Free,
            Some(_) | None => Self::Occupied,
        }
    }
}

/// The source files of a sequence, independent of their names: device and inode number, or else the canonical name.
#[derive(Debug, Default)]
pub struct SourceFiles {
    ids: HashSet<(u64, u64)>,
    names: HashSet<PathBuf>,
}

impl SourceFiles {
    /// Returns the source files of `sequence`.
    pub fn of(sequence: &Sequence) -> Self {
        let inputs = sequence.source().inputs().to_vec();
        let entries = sequence.entries();
        let is_file = |entry: &&Arc<FrameEntry>| matches!(entry.content, FrameBytes::File(_));
        let of_entries = entries
            .iter()
            .filter(is_file)
            .flat_map(|entry| std::iter::once(&entry.path).chain(&entry.normals));
        let mut files = Self::default();
        let images = sequence.source().images();
        for file in inputs.iter().chain(of_entries).chain(&images) {
            match regular_file::id(file) {
                // Device and inode, not the path: an output that is an input under another name or link is refused.
                Some(id) => _ = files.ids.insert(id),
                None if file.is_file() => _ = files.names.insert(real(file)),
                None => {}
            }
        }
        files
    }

    /// Returns true if the file at `output`, through links of any kind, is one of the source files.
    pub fn has(&self, output: &Path) -> bool {
        match regular_file::id(output) {
            Some(id) => self.ids.contains(&id),
            None => output.exists() && self.names.contains(&real(output)),
        }
    }
}

/// The input that would be overwritten, or written next to, at `output`: the same file or folder by any name, and any
/// folder with a file of the input.
pub fn source_at(output: &Output, sequence: &Sequence) -> Option<PathBuf> {
    let (Output::File(path) | Output::Folder(path) | Output::Reel(path, _)) = output;
    let place = real(path);
    let is_folder = matches!(output, Output::Folder(_));
    // Frames in one folder query the same path repeatedly.
    let mut looked_at = HashSet::new();
    let mut is_there = |input: &Path| {
        if real(input) == place || regular_file::are_same(input, path) {
            return true;
        }
        if !is_folder || input.is_dir() {
            return false;
        }
        let folder = |file: &Path| file.parent().map(Path::to_owned);
        // Both the location of its name and, if that is a link, the location of the file.
        [folder(&absolute(input).unwrap_or_default()), folder(&real(input))]
            .into_iter()
            .flatten()
            .any(|folder| looked_at.insert(folder.clone()) && real(&folder) == place)
    };
    let inputs = sequence.source().inputs().to_vec();
    let entries = sequence.entries();
    let is_file = |entry: &&Arc<FrameEntry>| matches!(entry.content, FrameBytes::File(_));
    let files = entries.iter().filter(is_file).map(|entry| &entry.path);
    inputs.iter().chain(files).find(|input| is_there(input)).cloned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Positions, RawCloud};
    use crate::convert::{Edit, Shard, convert};
    use crate::io::WriteFormat;
    use crate::progress::Progress;
    use crate::reel::ReelOptions;
    use std::fs;

    fn conversion(output: Output) -> Conversion {
        Conversion {
            frames: None,
            shard: Shard::WHOLE,
            edit: Edit::default(),
            format: WriteFormat::default(),
            output,
            goal: None,
            overwrites: false,
            reading: String::new(),
        }
    }

    fn sequence(folder: &Path) -> Sequence {
        let entries = (0..6).map(|number| FrameEntry {
            number: Some(number),
            ..FrameEntry::file(folder.join(format!("{number}.ply")))
        });
        Sequence::with_decoder(entries.collect(), |entry| {
            let place = entry.number.unwrap_or(0) as f64;
            Ok(RawCloud::from_positions(Positions::F64(vec![[place; 3]])))
        })
    }

    /// Cancelled once something is written.
    fn interrupted(conversion: &Conversion, sequence: &Sequence) {
        let progress = Progress::told_to(|progress| {
            if progress.done() > 2 {
                progress.cancel();
            }
        });
        assert!(convert(sequence, conversion, &progress).unwrap().is_cancelled);
    }

    #[test]
    fn output_files_are_free_then_interrupted_then_taken() {
        let folder = tempfile::tempdir().unwrap();
        let sequence = sequence(Path::new("/nowhere"));
        let path = folder.path().join("walk.reel");
        let options = ReelOptions {
            keyframes: 1,
            ..ReelOptions::default()
        };
        let into = |options: &ReelOptions| conversion(Output::Reel(path.clone(), options.clone()));
        assert_eq!(Place::of(&into(&options), &sequence), Place::Free);
        interrupted(&into(&options), &sequence);
        assert_eq!(Place::of(&into(&options), &sequence), Place::Interrupted);
        // With other options it starts over.
        assert_eq!(Place::of(&into(&ReelOptions::lossless()), &sequence), Place::Free);
        convert(&sequence, &into(&options), &Progress::default()).unwrap();
        assert_eq!(Place::of(&into(&options), &sequence), Place::Taken);
        let opened = Sequence::discover(std::slice::from_ref(&path)).unwrap();
        assert_eq!(Place::of(&into(&options), &opened), Place::Source);
        let nowhere = folder.path().join("missing/walk.reel");
        let nowhere = conversion(Output::Reel(nowhere, options));
        assert_eq!(Place::of(&nowhere, &sequence), Place::NoFolder);
    }

    #[test]
    fn hard_links_count_as_the_source() {
        let folder = tempfile::tempdir().unwrap();
        let [scan, link, other] = ["0.ply", "link.ply", "other.ply"].map(|name| folder.path().join(name));
        fs::write(&scan, "ply").unwrap();
        fs::hard_link(&scan, &link).unwrap();
        fs::write(&other, "ply").unwrap();
        let sequence = sequence(folder.path());
        let files = SourceFiles::of(&sequence);
        assert!(files.has(&scan) && files.has(&folder.path().join("./0.ply")) && !files.has(&other));
        if cfg!(unix) {
            assert!(files.has(&link));
            assert_eq!(Place::of(&conversion(Output::File(link)), &sequence), Place::Source);
        }
        assert_eq!(Place::of(&conversion(Output::File(other)), &sequence), Place::Taken);
    }

    #[test]
    fn output_folders_are_free_or_belong_to_the_same_conversion() {
        let folder = tempfile::tempdir().unwrap();
        let scans = folder.path().join("scans");
        let sequence = sequence(&scans);
        let into = |name: &str| conversion(Output::Folder(folder.path().join(name)));
        assert_eq!(Place::of(&into("scans"), &sequence), Place::Source);
        assert_eq!(Place::of(&into("out"), &sequence), Place::Free);
        interrupted(&into("out"), &sequence);
        assert_eq!(Place::of(&into("out"), &sequence), Place::Interrupted);
        let ascii = Conversion {
            format: "ply-ascii".parse().unwrap(),
            ..into("out")
        };
        assert_eq!(Place::of(&ascii, &sequence), Place::Occupied);
        fs::create_dir(folder.path().join("full")).unwrap();
        assert_eq!(Place::of(&into("full"), &sequence), Place::Free, "an empty folder");
        fs::write(folder.path().join("full/notes.txt"), "mine").unwrap();
        assert_eq!(Place::of(&into("full"), &sequence), Place::Occupied);
        assert_eq!(Place::of(&into("a/b"), &sequence), Place::NoFolder);
    }
}
