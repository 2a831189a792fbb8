//! Timeline files with range and markers, which were stored per sequence before documents existed. They are still read,
//! but no longer written: the document that is stored next takes precedence over them.
//!
//! **How it works.** Range and markers are parsed independently, so that they outlive versions of this program.

use super::Document;
use super::model::Marker;
use crate::persist::{self, Fields};
use crate::timeline::PlayRange;
use serde_json::Value;
use std::path::Path;
use std::str::FromStr;

/// The last version that was written.
const VERSION: u32 = 1;

/// Name of the contents in messages.
const WHAT: &str = "the markers";

/// Copies the marks stored in `file`, which need not exist, into `document`. Returns a text for a notice about
/// unreadable parts.
pub(super) fn read_into(document: &mut Document, file: &Path) -> Option<String> {
    let read = persist::read_leniently(file, WHAT, |stored, unread| {
        persist::note_later_version(stored, VERSION, unread);
        let markers = persist::entries(stored, "markers", unread);
        let mut markers: Vec<Marker> = markers.iter().filter_map(|stored| marker(stored, unread)).collect();
        markers.sort_by_key(|marker| marker.frame);
        let (up, primitive) = (word(stored, "up", unread), word(stored, "primitive", unread));
        (range(stored, unread), markers, up, primitive)
    });
    let (range, markers, up, primitive) = read.value;
    document.range = range;
    document.markers = markers;
    document.up = up;
    document.settings.primitive = primitive.unwrap_or(document.settings.primitive);
    read.problem
}

fn word<T: FromStr>(stored: &Fields, field: &str, unread: &mut Vec<String>) -> Option<T> {
    let text = stored.get(field)?;
    let value = text.as_str().and_then(|text| text.parse().ok());
    if value.is_none() {
        unread.push(format!("{field}: {text} is not known"));
    }
    value
}

fn range(stored: &Fields, unread: &mut Vec<String>) -> PlayRange {
    let range = match stored.get("range") {
        Some(Value::Object(range)) => persist::fields(range, unread),
        Some(_) => {
            unread.push("range: it is not an object".to_owned());
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

/// A marker that has a frame, if need be without a name.
fn marker(stored: &Value, unread: &mut Vec<String>) -> Option<Marker> {
    let name = stored.get("name").map_or(Some(""), Value::as_str);
    if name.is_none() {
        unread.push("the name of a marker is not a string".to_owned());
    }
    let frame = stored.get("frame").and_then(Value::as_u64);
    let Some(frame) = frame.and_then(|frame| usize::try_from(frame).ok()) else {
        unread.push("a marker has no frame".to_owned());
        return None;
    };
    let name = name.unwrap_or_default().to_owned();
    Some(Marker { frame, name })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Primitive, UpAxis};

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

    fn of_version_1() -> Document {
        let marker = |frame, name: &str| Marker {
            frame,
            name: name.to_owned(),
        };
        Document {
            range: PlayRange::default().beginning_at(3).ending_at(8),
            markers: vec![marker(5, "turn \"left\""), marker(7, "")],
            ..Document::default()
        }
    }

    fn read(file: &Path) -> (Document, Option<String>) {
        let mut document = Document::default();
        let problem = read_into(&mut document, file);
        (document, problem)
    }

    #[test]
    fn chosen_values_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("some.json");
        assert_eq!(read(&file), (Document::default(), None));
        let text = OF_VERSION_1.replacen('{', r#"{"up": "-y", "primitive": "voxel","#, 1);
        std::fs::write(&file, text).unwrap();
        let mut expected = of_version_1();
        expected.up = Some(UpAxis::NegY);
        expected.settings.primitive = Primitive::Voxel.into();
        assert_eq!(read(&file), (expected, None));
    }

    #[test]
    fn each_mark_is_read_independently() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("some.json");
        let copy = folder.path().join("some.json.unreadable");
        let whole = of_version_1();
        let with = |change: &dyn Fn(&mut Document)| {
            let mut document = whole.clone();
            change(&mut document);
            document
        };
        let cases = vec![
            ("{", "{\"of later\": 1,", whole.clone(), true),
            ("\"frame\"", "\"color\": 3, \"frame\"", whole.clone(), true),
            ("\"version\": 1,", "", whole.clone(), true),
            ("\"version\": 1", "\"version\": 2", whole.clone(), false),
            (
                "\"first\": 3",
                "\"first\": 9",
                with(&|document| document.range = PlayRange::default()),
                false,
            ),
            (
                "\"first\": 3",
                "\"first\": -3",
                with(&|document| document.range = PlayRange::default().ending_at(8)),
                false,
            ),
            (
                "\"frame\"",
                "\"fame\"",
                with(&|document| document.markers.retain(|marker| marker.frame != 5)),
                false,
            ),
            (
                "\"turn \\\"left\\\"\"",
                "5",
                with(&|document| document.markers[0].name.clear()),
                false,
            ),
            ("{", "{\"up\": \"-q\", ", whole.clone(), false),
            ("{", "", Document::default(), false),
        ];
        for (from, to, expected, is_whole) in cases {
            let changed = OF_VERSION_1.replacen(from, to, 1);
            assert_ne!(changed, OF_VERSION_1, "{from}");
            std::fs::write(&file, &changed).unwrap();
            let (document, problem) = read(&file);
            assert_eq!(document, expected, "{to}");
            assert_eq!(problem.is_none(), is_whole, "{to}");
            let copied = std::fs::read_to_string(&copy).ok();
            assert_eq!(copied, (!is_whole).then_some(changed), "{to}");
            // A path that is not a file cannot be removed.
            let _ = std::fs::remove_file(&copy);
        }
    }
}
