//! Joining of the parts of a sequence file, written by several machines, into one file.
//!
//! How it works: each part records its share and the conversion it belongs to. Parts that are missing, duplicated, made
//! with other options or incomplete are therefore found before anything is written, and the order of the names does not
//! matter. Groups are appended one after the other without being re-encoded. Files that record no conversion are joined
//! in the order in which they are named.

use super::conversion::Shard;
use super::error::ConvertError;
use super::reel::{Unfinished, Writer, finish};
use crate::reel::{FilePart, ReelFile};
use crate::temporary::Temporary;
use std::fs;
use std::path::{Path, PathBuf};

/// Result of joining.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Joined {
    /// Frames of the file.
    pub frames: usize,
    /// Notes about the result: one sentence each.
    pub notes: Vec<String>,
}

/// The parts of the sequence file `output` that are in its folder, by their names.
///
/// # Errors
/// A folder that cannot be read, and one without a part.
pub fn parts_of(output: &Path) -> Result<Vec<PathBuf>, ConvertError> {
    let folder = match output.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let read_error = |reason| ConvertError::Write {
        path: folder.to_owned(),
        reason,
    };
    let mut parts = Vec::new();
    for entry in fs::read_dir(folder).map_err(read_error)? {
        let name = entry.map_err(read_error)?.file_name();
        let shard = name.to_str().and_then(|name| Shard::of_part_name(name, output));
        parts.extend(shard.map(|shard| (shard.count, shard.index, output.with_file_name(&name))));
    }
    parts.sort_unstable();
    if parts.is_empty() {
        let example = Shard { index: 0, count: 3 }.part_of(output);
        let problem = format!("{} has no part of it, such as {}", folder.display(), example.display());
        return Err(refused(output, problem));
    }
    Ok(parts.into_iter().map(|(_, _, path)| path).collect())
}

/// Joins sequence files into one, frame after frame, without re-encoding anything.
///
/// # Errors
/// Files that are incomplete, and parts of a conversion that do not make up all of it.
pub fn join(parts: &[PathBuf], output: &Path) -> Result<Joined, ConvertError> {
    let mut files = Vec::new();
    for path in parts {
        let file = ReelFile::open_path(path)?;
        if let Some(damage) = file.damage().first() {
            return Err(refused(output, format!("a part is not whole: {damage}")));
        }
        files.push(file);
    }
    let mut notes = Vec::new();
    if files.iter().any(|file| file.part().is_some()) {
        files.sort_by_key(|file| file.part().map(|part| part.index));
        check_parts(&files).map_err(|problem| refused(output, problem))?;
        notes.extend(files.iter().filter_map(note_of_lost));
    } else if files.len() > 1 {
        notes.push(
            "the files do not say which part each is: they are joined in the order in which they are named".to_owned(),
        );
    }
    let unfinished = Unfinished::of(output);
    let _lock = unfinished.lock(output)?;
    // A partial result could not be continued.
    let _new = Temporary::file(&unfinished.file);
    let mut writer: Option<Writer> = None;
    for file in &files {
        let writer = match &mut writer {
            Some(writer) => writer,
            writer => writer.insert(Writer::create_like(&unfinished.file, file)?),
        };
        writer.copy_groups(file)?;
    }
    let Some(writer) = writer else {
        return Err(refused(output, "there is nothing to join".to_owned()));
    };
    let frames = writer.frame_count();
    finish(writer, output, &unfinished)?;
    Ok(Joined { frames, notes })
}

fn refused(output: &Path, problem: String) -> ConvertError {
    ConvertError::Join {
        output: output.to_owned(),
        problem,
    }
}

/// Checks that files, in the order of their parts, make up a whole conversion.
fn check_parts(files: &[ReelFile]) -> Result<(), String> {
    let mut known: Vec<(&ReelFile, &FilePart)> = Vec::new();
    for file in files {
        let path = file.path().display();
        let Some(part) = file.part() else {
            return Err(format!("{path} does not say which part it is, and the others do"));
        };
        if let Some((other, first)) = known.first() {
            let other = other.path().display();
            if part.count != first.count {
                return Err(format!("{other} is {}, and {path} is {}", first.name(), part.name()));
            }
            if part.made_of != first.made_of {
                return Err(format!(
                    "{other} and {path} were made of other frames or with other options: {} and {}",
                    first.made_of, part.made_of
                ));
            }
        }
        if let Some((twin, _)) = known.iter().find(|(_, known)| known.index == part.index) {
            return Err(format!("{} and {path} are both {}", twin.path().display(), part.name()));
        }
        known.push((file, part));
    }
    let Some((_, first)) = known.first() else {
        return Ok(());
    };
    let is_there = |index: &u64| known.iter().any(|(_, part)| part.index == *index);
    let missing: Vec<String> = (0..first.count)
        .filter(|index| !is_there(index))
        .map(|index| (index + 1).to_string())
        .collect();
    if !missing.is_empty() {
        return Err(format!(
            "of {} parts these are missing: {} (convert them with --shard {}/{})",
            first.count,
            missing.join(", "),
            missing[0],
            first.count
        ));
    }
    let mut next = 0;
    for (file, part) in &known {
        if part.frames.start != next {
            let path = file.path().display();
            return Err(format!(
                "{path} begins with frame {} instead of {next}",
                part.frames.start
            ));
        }
        next = part.frames.end;
    }
    if next != first.of_frames {
        return Err(format!("the parts have {next} frames of {}", first.of_frames));
    }
    Ok(())
}

/// A part without some of its frames, as these could not be read.
fn note_of_lost(file: &ReelFile) -> Option<String> {
    let part = file.part()?;
    let frames = part.frames.end - part.frames.start;
    let lost = frames.checked_sub(file.frame_count() as u64).filter(|&lost| lost > 0)?;
    Some(format!(
        "{} has {} of its {frames} frames: the others could not be read",
        file.path().display(),
        frames - lost
    ))
}
