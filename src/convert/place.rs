//! What is there already where a conversion would write, for who asks before writing.

use super::conversion::{Conversion, Output};
use super::record::Record;
use super::reel;
use crate::sequence::Sequence;
use std::path::{Path, absolute};

/// What is at the place of an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Nothing in the way.
    Free,
    /// What the same conversion has left when it was interrupted: it goes on from there.
    Interrupted,
    /// A file that would be replaced.
    Taken,
    /// Files of something else, among which frames would be lost.
    Occupied,
    /// What is to be converted.
    Source,
    /// The folder that it would be in is not there.
    NoFolder,
}

impl Place {
    /// Looks for what is there.
    pub fn of(conversion: &Conversion, sequence: &Sequence) -> Self {
        match &conversion.output {
            Output::Reel(path, _) => Self::of_reel(path, conversion, sequence),
            Output::File(path) => Self::of_file(path, sequence),
            Output::Folder(folder) => Self::of_folder(folder, conversion, sequence),
        }
    }

    fn of_file(path: &Path, sequence: &Sequence) -> Self {
        let is_source = |other: &Path| same(other, path);
        if sequence.source().inputs().iter().any(|input| is_source(input))
            || sequence.entries().iter().any(|entry| entry.path == path)
        {
            Self::Source
        } else if path.exists() {
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
        match Self::of_file(path, sequence) {
            Self::Free if reel::is_interrupted(path, &Record::of(conversion, sequence)) => Self::Interrupted,
            place => place,
        }
    }

    fn of_folder(folder: &Path, conversion: &Conversion, sequence: &Sequence) -> Self {
        let entries = sequence.entries();
        let mut folders = entries.iter().filter_map(|entry| entry.path.parent());
        if sequence.source().inputs().iter().any(|input| same(input, folder)) || folders.any(|other| other == folder) {
            return Self::Source;
        }
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

/// Whether both names are of the same file or folder.
fn same(a: &Path, b: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().or_else(|_| absolute(path)).ok();
    real(a).is_some_and(|a| real(b) == Some(a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::{Positions, RawCloud};
    use crate::convert::{Edit, Shard, convert};
    use crate::io::WriteFormat;
    use crate::progress::Progress;
    use crate::reel::ReelOptions;
    use crate::sequence::FrameEntry;
    use std::fs;

    fn conversion(output: Output) -> Conversion {
        Conversion {
            frames: None,
            shard: Shard::WHOLE,
            edit: Edit::default(),
            format: WriteFormat::default(),
            output,
            overwrites: false,
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
    fn files_are_free_then_interrupted_then_taken() {
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
        // With other options it begins anew.
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
    fn folders_are_free_or_of_the_same_conversion() {
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
