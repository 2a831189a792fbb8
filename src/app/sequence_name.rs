//! Display name of a sequence.

use crate::sequence::Sequence;
use crate::source::FrameEntry;
use std::path::PathBuf;

/// The name of the file or folder that a sequence is from; `None` of an empty one.
pub(in crate::app) fn name_of(sequence: &Sequence) -> Option<String> {
    let last = sequence.len().checked_sub(1)?;
    let source = sequence.source();
    Some(name_of_frames(
        source.inputs(),
        &sequence.entry(0),
        &sequence.entry(last),
    ))
}

/// Frames of one file stand together, so the ends tell. Asked for in every pass: nothing here may grow with the
/// sequence.
fn name_of_frames(inputs: &[PathBuf], first: &FrameEntry, last: &FrameEntry) -> String {
    let of_all = match inputs {
        _ if first.path == last.path => first.path.file_name(),
        // The frames of a recording are in subfolders of it.
        [input] if first.path.starts_with(input) && input.file_name().is_some() => input.file_name(),
        _ => first.path.parent().and_then(|folder| folder.file_name()),
    };
    of_all.map_or_else(|| first.name.clone(), |name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sequence_is_named_after_its_input() {
        let named = |input: &str, first: &str, last: &str| {
            name_of_frames(&[input.into()], &FrameEntry::file(first), &FrameEntry::file(last))
        };
        assert_eq!(named("/a/walk", "/a/walk/1.ply", "/a/walk/9.ply"), "walk");
        let images = ["/a/chair/depth/1.png", "/a/chair/depth/9.png"];
        assert_eq!(named("/a/chair", images[0], images[1]), "chair", "not `depth`");
        assert_eq!(named("/a/walk/*.ply", "/a/walk/1.ply", "/a/walk/9.ply"), "walk");
        assert_eq!(named("/a/walk.reel", "/a/walk.reel", "/a/walk.reel"), "walk.reel");
        assert_eq!(named(".", "./walk/1.ply", "./walk/2.ply"), "walk");
        let [first, last] = ["demo/1.ply", "demo/2.ply"].map(FrameEntry::file);
        assert_eq!(name_of_frames(&[], &first, &last), "demo");
    }
}
