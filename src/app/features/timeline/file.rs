//! Range and markers of a sequence, kept between runs in a small JSON file a sequence.
//!
//! **How it works.** Range and markers are each read by themselves, so that they outlive versions of this program. What
//! a later one wrote next to what is known here stays; a file of which something could not be read is copied before a
//! mark is changed (`kept/lenient.rs`). Of two windows with the same sequence the marks of the later change stay.

use super::Markers;
use crate::app::first_look::Chosen;
use crate::document::Marker;
use crate::kept::{self, Fields, Lenient};
use crate::scene::{Primitive, UpAxis};
use crate::sequence::Sequence;
use crate::timeline::PlayRange;
use serde::Serialize;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Changes where the same word would mean something else. Further fields need no other version.
const VERSION: u32 = 1;

/// What messages call it.
const WHAT: &str = "the markers";

/// The fields of [`TimelineFile`].
const FIELDS: [&str; 5] = ["version", "range", "markers", "up", "primitive"];

#[derive(Serialize)]
struct TimelineFile<'a> {
    version: u32,
    range: PlayRange,
    markers: &'a [Marker],
    #[serde(skip_serializing_if = "Option::is_none")]
    up: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    primitive: Option<&'static str>,
}

/// The file in `folder` for `sequence`, which is known by path, name and size of its first frame: frames that are added
/// later leave it the same. `None` without frames.
pub(super) fn file_of(folder: &Path, sequence: &Sequence) -> Option<PathBuf> {
    if sequence.is_empty() {
        return None;
    }
    let entry = sequence.entry(0);
    let path = std::path::absolute(&entry.path).unwrap_or_else(|_| entry.path.clone());
    let bytes = std::fs::metadata(&path).map_or(0, |metadata| metadata.len());
    let mut hash = Sha256::new();
    hash.update(path.as_os_str().as_encoded_bytes());
    // So that no two lists of texts are alike.
    hash.update([0]);
    hash.update(format!("{} {bytes}", entry.name));
    let mut name = String::new();
    for byte in &hash.finalize()[..16] {
        // Writing to a String cannot fail.
        let _ = write!(name, "{byte:02x}");
    }
    Some(folder.join(name + ".json"))
}

/// What was kept in `file`, which need not be there.
pub(super) fn read(file: &Path) -> Lenient<(PlayRange, Markers, Chosen)> {
    kept::read_leniently(file, WHAT, |stored, unread| {
        kept::note_later_version(stored, VERSION, unread);
        let markers = kept::entries(stored, "markers", unread);
        let markers = markers.iter().filter_map(|stored| marker(stored, unread));
        let markers = markers.collect();
        let markers = Markers::of(markers, unread);
        (range(stored, unread), markers, chosen(stored, unread))
    })
}

fn range(stored: &Fields, unread: &mut Vec<String>) -> PlayRange {
    let range = match stored.get("range") {
        Some(Value::Object(range)) => kept::fields(range, unread),
        Some(_) => {
            unread.push("range: it is no object".to_owned());
            PlayRange::default()
        }
        None => PlayRange::default(),
    };
    if !range.is_sound() {
        unread.push("its in point is after its out point".to_owned());
        return PlayRange::default();
    }
    range
}

fn chosen(stored: &Fields, unread: &mut Vec<String>) -> Chosen {
    fn word<T: FromStr>(stored: &Fields, field: &str, unread: &mut Vec<String>) -> Option<T> {
        let text = stored.get(field)?;
        let value = text.as_str().and_then(|text| text.parse().ok());
        if value.is_none() {
            unread.push(format!("{field}: {text} is not known"));
        }
        value
    }
    Chosen {
        up: word(stored, "up", unread),
        primitive: word(stored, "primitive", unread),
    }
}

/// A marker that has a frame, if need be without a name.
fn marker(stored: &Value, unread: &mut Vec<String>) -> Option<Marker> {
    let name = stored.get("name").map_or(Some(""), Value::as_str);
    if name.is_none() {
        unread.push("the name of a marker is no text".to_owned());
    }
    let frame = stored.get("frame").and_then(Value::as_u64);
    let Some(frame) = frame.and_then(|frame| usize::try_from(frame).ok()) else {
        unread.push("a marker has no frame".to_owned());
        return None;
    };
    let name = name.unwrap_or_default().to_owned();
    Some(Marker { frame, name })
}

/// Keeps all. `Err` is a text for a notice.
pub(super) fn write(file: &Path, range: PlayRange, markers: &Markers, chosen: Chosen) -> Result<(), String> {
    let stored = TimelineFile {
        version: VERSION,
        range,
        markers: markers.list(),
        up: chosen.up.map(UpAxis::name),
        primitive: chosen.primitive.map(Primitive::name),
    };
    let written = match serde_json::to_value(&stored) {
        Ok(Value::Object(now)) => kept::update(file, WHAT, |stored, unread| {
            kept::note_later_version(stored, VERSION, unread);
            stored.retain(|name, _| !FIELDS.contains(&name.as_str()));
            stored.extend(now);
        }),
        // It is an object of numbers and words.
        Ok(_) => Ok(()),
        Err(reason) => Err(std::io::Error::other(reason)),
    };
    written.map_err(|reason| {
        let file = file.display();
        format!("{WHAT} could not be written to {file} ({reason}): make room")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As version 0.1 wrote it.
    const OF_VERSION_1: &str = r#"{
  "version": 1,
  "range": {
    "first": 3,
    "last": 8
  },
  "markers": [
    {
      "frame": 5,
      "name": "turn \"left\""
    },
    {
      "frame": 7,
      "name": ""
    }
  ]
}"#;

    fn of_version_1() -> (PlayRange, Markers, Chosen) {
        let range = PlayRange::default().beginning_at(3).ending_at(8);
        let mut markers = Markers::default();
        markers.toggle(5);
        markers.rename(5, "turn \"left\"");
        markers.toggle(7);
        (range, markers, Chosen::default())
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("deeper/some.json");
        assert_eq!(read(&file).value, Default::default());
        let (range, markers, nothing) = of_version_1();
        write(&file, range, &markers, nothing).unwrap();
        let written: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
        assert_eq!(written, serde_json::from_str::<Value>(OF_VERSION_1).unwrap());
        let kept = read(&file);
        assert_eq!((kept.value, kept.problem), (of_version_1(), None));
        let chosen = Chosen {
            up: Some(UpAxis::NegY),
            primitive: Some(Primitive::Voxel),
        };
        write(&file, range, &markers, chosen).unwrap();
        let kept = read(&file);
        assert_eq!((kept.value, kept.problem), ((range, markers, chosen), None));
    }

    #[test]
    fn each_mark_is_read_by_itself() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("some.json");
        let copy = folder.path().join("some.json.unreadable");
        let whole = of_version_1();
        let (range, markers, nothing) = whole.clone();
        let without = |frame| {
            let mut markers = markers.clone();
            markers.toggle(frame);
            markers
        };
        let unnamed = || {
            let mut markers = markers.clone();
            markers.rename(5, "");
            markers
        };
        let open = PlayRange::default();
        for (from, to, expected, is_whole) in [
            ("{", "{\"of later\": 1,", whole.clone(), true),
            ("\"frame\"", "\"color\": 3, \"frame\"", whole.clone(), true),
            ("\"version\": 1,", "", whole.clone(), true),
            ("\"version\": 1", "\"version\": 2", whole.clone(), false),
            ("\"first\": 3", "\"first\": 9", (open, markers.clone(), nothing), false),
            (
                "\"first\": 3",
                "\"first\": -3",
                (open.ending_at(8), markers.clone(), nothing),
                false,
            ),
            ("\"frame\"", "\"fame\"", (range, without(5), nothing), false),
            ("\"turn \\\"left\\\"\"", "5", (range, unnamed(), nothing), false),
            ("{", "{\"up\": \"-q\", ", whole.clone(), false),
            ("{", "", Default::default(), false),
        ] {
            let changed = OF_VERSION_1.replacen(from, to, 1);
            assert_ne!(changed, OF_VERSION_1, "{from}");
            std::fs::write(&file, &changed).unwrap();
            let read = read(&file);
            assert_eq!(read.value, expected, "{to}");
            assert_eq!(read.problem.is_none(), is_whole, "{to}");
            let copied = std::fs::read_to_string(&copy).ok();
            assert_eq!(copied, (!is_whole).then_some(changed), "{to}");
            // What is no file cannot be removed.
            let _ = std::fs::remove_file(&copy);
        }
    }

    #[test]
    fn sequences_are_told_apart_by_their_first_frame() {
        let folder = Path::new("/kept");
        let file = |names: &[&str]| {
            let entries = names
                .iter()
                .map(|name| crate::sequence::FrameEntry::file(format!("/scans/{name}")));
            let decode = |_: &crate::sequence::FrameEntry| Err("unread".into());
            file_of(folder, &Sequence::with_decoder(entries.collect(), decode))
        };
        assert_eq!(file(&[]), None);
        assert_eq!(file(&["a.ply"]), file(&["a.ply", "b.ply"]));
        assert_ne!(file(&["a.ply"]), file(&["b.ply"]));
    }
}
