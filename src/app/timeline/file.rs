//! Range and markers of a sequence, kept between runs in a small JSON file a sequence.

use super::Markers;
use super::markers::Marker;
use crate::kept;
use crate::sequence::{PlayRange, Sequence};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Changes with every change of [`Stored`] that older programs, or newer ones, would misread.
const VERSION: u32 = 1;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    version: u32,
    range: PlayRange,
    markers: Vec<Marker>,
}

/// The file in `folder` for `sequence`, which is known by path, name and size of its first frame: frames that are added later
/// leave it the same. `None` without frames.
pub(super) fn file_of(folder: &Path, sequence: &Sequence) -> Option<PathBuf> {
    if sequence.is_empty() {
        return None;
    }
    let source = sequence.source(0);
    let path = std::path::absolute(&source.path).unwrap_or_else(|_| source.path.clone());
    let bytes = std::fs::metadata(&path).map_or(0, |metadata| metadata.len());
    let mut hash = Sha256::new();
    hash.update(path.as_os_str().as_encoded_bytes());
    // So that no two lists of texts are alike.
    hash.update([0]);
    hash.update(format!("{} {bytes}", source.name));
    let mut name = String::new();
    for byte in &hash.finalize()[..16] {
        // Writing to a String cannot fail.
        let _ = write!(name, "{byte:02x}");
    }
    Some(folder.join(name + ".json"))
}

/// What was kept in `file`, which need not be there. A file that cannot be used is told of in the log.
pub(super) fn read(file: &Path) -> (PlayRange, Markers) {
    let read = kept::read(file).and_then(|bytes| bytes.map_or(Ok(None), |b| parse(&b).map(Some)));
    read.unwrap_or_else(|reason| {
        log::warn!(
            "the markers in {} cannot be used ({reason}): the timeline begins without",
            file.display()
        );
        None
    })
    .unwrap_or_default()
}

fn parse(bytes: &[u8]) -> Result<(PlayRange, Markers), String> {
    let stored: Stored = serde_json::from_slice(bytes).map_err(|reason| reason.to_string())?;
    if stored.version != VERSION {
        let version = stored.version;
        return Err(format!("it has version {version} instead of {VERSION}"));
    }
    if !stored.range.is_sound() {
        return Err("its in point is after its out point".to_owned());
    }
    Ok((stored.range, Markers::of(stored.markers)?))
}

/// Keeps both. `Err` is a text for a notice.
pub(super) fn write(file: &Path, range: PlayRange, markers: &Markers) -> Result<(), String> {
    let stored = Stored {
        version: VERSION,
        range,
        markers: markers.list().to_vec(),
    };
    serde_json::to_vec_pretty(&stored)
        .map_err(std::io::Error::other)
        .and_then(|bytes| kept::replace(file, &bytes))
        .map_err(|reason| {
            let file = file.display();
            format!("the markers could not be written to {file} ({reason}): make room")
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_damage_is_left_aside() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("deeper/some.json");
        assert_eq!(read(&file), Default::default());
        let range = PlayRange::default().beginning_at(3).ending_at(8);
        let mut markers = Markers::default();
        markers.toggle(5);
        markers.rename(5, "turn \"left\"");
        write(&file, range, &markers).unwrap();
        assert_eq!(read(&file), (range, markers));

        let text = std::fs::read_to_string(&file).unwrap();
        for (from, to) in [
            ("\"version\": 1", "\"version\": 2"),
            ("\"first\": 3", "\"first\": 9"),
            ("\"first\": 3", "\"first\": -3"),
            ("\"frame\"", "\"fame\""),
            ("{", ""),
        ] {
            let damaged = text.replacen(from, to, 1);
            assert_ne!(damaged, text, "{from}");
            std::fs::write(&file, damaged).unwrap();
            assert_eq!(read(&file), Default::default(), "{to}");
        }
    }

    #[test]
    fn sequences_are_told_apart_by_their_first_frame() {
        let folder = Path::new("/kept");
        let file = |names: &[&str]| {
            let sources = names
                .iter()
                .map(|name| crate::sequence::Source::file(format!("/scans/{name}")));
            let decode = |_: &crate::sequence::Source| Err("unread".into());
            file_of(folder, &Sequence::with_decoder(sources.collect(), decode))
        };
        assert_eq!(file(&[]), None);
        assert_eq!(file(&["a.ply"]), file(&["a.ply", "b.ply"]));
        assert_ne!(file(&["a.ply"]), file(&["b.ply"]));
    }
}
