//! What a person calls a sequence.

use crate::sequence::Sequence;

/// The name of the file or folder that a sequence is from; `None` of an empty one.
pub(in crate::app) fn name_of(sequence: &Sequence) -> Option<String> {
    let last = sequence.len().checked_sub(1)?;
    let entry = sequence.entry(0);
    // Frames of one file stand together, so the ends tell. Asked for in every pass: nothing here may grow with the
    // sequence.
    let is_one_file = sequence.entry(last).path == entry.path;
    let of_all = if is_one_file {
        entry.path.file_name()
    } else {
        entry.path.parent().and_then(|folder| folder.file_name())
    };
    Some(of_all.map_or_else(|| entry.name.clone(), |name| name.to_string_lossy().into_owned()))
}
