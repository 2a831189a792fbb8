//! The parts of a document that are the user's work, one row per part: its comparison, whether undo restores it, and
//! its name in messages.
//!
//! Inputs, frame and view are not parts: looking around makes nothing.

use super::model::{Document, Measured, MeasuredPoint, ShownTrails};
use crate::messages;
use crate::scene::Settings;

/// A part of a document.
pub(super) struct Part {
    pub(super) name: &'static str,
    /// Equality test that ignores the positions of followed points in the shown frame.
    is_same: fn(&Document, &Document) -> bool,
    /// Copies the part from the second document to the first; `None` for parts that undo does not restore.
    put_back: Option<fn(&mut Document, &Document)>,
    /// Name of the change from the first to the second document, for undo. Settings have their own names.
    change: fn(&Document, &Document) -> &'static str,
    /// Summary of what the first document holds beyond the second, for a message: `2 labels`.
    summary: fn(&Document, &Document) -> Option<String>,
}

/// Name of the row of the settings.
pub(super) const SETTINGS: &str = "settings";

/// All of them, in the order of messages.
pub(super) const PARTS: &[Part] = &[
    Part {
        name: "reading",
        is_same: |one, other| one.reading == other.reading,
        put_back: None,
        change: |_, _| "Reading",
        summary: |_, _| None,
    },
    Part {
        name: SETTINGS,
        is_same: |one, other| one.settings == other.settings,
        put_back: Some(|document, of| document.settings = of.settings),
        change: |_, _| "Settings",
        summary: |document, new| named(document.settings != new.settings, "look"),
    },
    Part {
        name: "up",
        is_same: |one, other| one.up == other.up,
        put_back: None,
        change: |_, _| "Up axis",
        summary: |document, _| named(document.up.is_some(), "up axis"),
    },
    Part {
        name: "clip",
        is_same: |one, other| one.clip == other.clip,
        put_back: Some(|document, of| document.clip = of.clip),
        change: |_, _| "Clipping",
        summary: |document, _| named(document.clip.is_some(), "clip"),
    },
    Part {
        name: "range",
        is_same: |one, other| one.range == other.range,
        put_back: Some(|document, of| document.range = of.range),
        change: |_, _| "In and out point",
        summary: |document, new| named(document.range != new.range, "in and out point"),
    },
    Part {
        name: "markers",
        is_same: |one, other| one.markers == other.markers,
        put_back: Some(|document, of| document.markers.clone_from(&of.markers)),
        change: |_, _| "Markers",
        summary: |document, _| counted(document.markers.len(), "marker"),
    },
    Part {
        name: "labels",
        is_same: |one, other| one.labels == other.labels,
        put_back: Some(|document, of| document.labels.clone_from(&of.labels)),
        change: |before, after| one_or_more([before, after].map(|of| of.labels.len()), ["Label", "Labels"]),
        summary: |document, _| counted(document.labels.len(), "label"),
    },
    Part {
        name: "measurements",
        is_same: |one, other| are_same_measured(&one.measurements, &other.measurements),
        put_back: Some(|document, of| document.measurements.clone_from(&of.measurements)),
        change: |before, after| {
            let counts = [before, after].map(|of| of.measurements.len());
            one_or_more(counts, ["Measurement", "Measurements"])
        },
        summary: |document, _| counted(document.measurements.len(), "measurement"),
    },
    Part {
        name: "trails",
        is_same: |one, other| are_same_trails(&one.trails, &other.trails),
        put_back: Some(|document, of| document.trails.clone_from(&of.trails)),
        change: |_, _| "Trails",
        summary: |document, _| named(document.trails != ShownTrails::default(), "trails"),
    },
    Part {
        name: "path",
        is_same: |one, other| one.path == other.path,
        put_back: Some(|document, of| document.path.clone_from(&of.path)),
        change: |_, _| "Camera path",
        summary: |document, _| named(document.path.path().is_some(), "camera path"),
    },
    Part {
        name: "compare",
        is_same: |one, other| match (&one.compare, &other.compare) {
            (None, None) => true,
            // How frames are paired is the default for the two sequences, or has the same name.
            (Some(one), Some(other)) => {
                (&one.inputs, &one.topic, one.offset_frames) == (&other.inputs, &other.topic, other.offset_frames)
                    && (one.layout, one.line) == (other.layout, other.line)
            }
            _ => false,
        },
        put_back: None,
        change: |_, _| "Second sequence",
        summary: |document, _| named(document.compare.is_some(), "second sequence"),
    },
    Part {
        name: "notes",
        is_same: |one, other| one.notes == other.notes,
        put_back: Some(|document, of| document.notes.clone_from(&of.notes)),
        change: |_, _| "Notes",
        summary: |document, _| named(!document.notes.is_empty(), "notes"),
    },
    Part {
        name: "unknown",
        is_same: |one, other| one.unknown == other.unknown,
        put_back: None,
        change: |_, _| "Other",
        summary: |_, _| None,
    },
];

impl Part {
    /// Name of the change from `before` to `after`, if that is one.
    pub(super) fn change(&self, before: &Document, after: &Document) -> Option<&'static str> {
        (!(self.is_same)(before, after)).then(|| (self.change)(before, after))
    }

    /// Returns true if undo reverts this part.
    pub(super) fn is_undone(&self) -> bool {
        self.put_back.is_some()
    }
}

impl Document {
    /// A document with nothing in it but default settings.
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            ..Self::default()
        }
    }

    /// Returns true if `other` holds the same work. Navigation does not count as work: frame and view may differ, and
    /// so may the positions of followed points in the shown frame.
    pub fn is_same_work(&self, other: &Self) -> bool {
        PARTS.iter().all(|part| (part.is_same)(self, other))
    }

    /// Returns true if `other` would be stored as the same document: the same work, and the same view.
    pub fn is_stored_same(&self, other: &Self) -> bool {
        self.view == other.view && self.is_same_work(other)
    }

    /// Returns true if nothing can be undone between this document and `other`.
    pub(super) fn is_undone_to(&self, other: &Self) -> bool {
        let mut undone = PARTS.iter().filter(|part| part.is_undone());
        undone.all(|part| (part.is_same)(self, other))
    }

    /// A document with only the undoable parts.
    pub(super) fn undone_parts(&self) -> Self {
        let mut parts = Self::default();
        parts.put_back(self);
        parts
    }

    /// Restores the undoable parts from `other`.
    pub fn put_back(&mut self, other: &Self) {
        for put_back in PARTS.iter().filter_map(|part| part.put_back) {
            put_back(self, other);
        }
    }

    /// Returns a summary of what the document holds beyond `new`, for a message: `view, look, 2 labels`. Empty if
    /// nothing.
    pub fn summary(&self, new: &Self) -> Vec<String> {
        let view = named(self.view.is_some(), "view");
        let parts = PARTS.iter().filter_map(|part| (part.summary)(self, new));
        view.into_iter().chain(parts).collect()
    }
}

fn named(is_there: bool, name: &str) -> Option<String> {
    is_there.then(|| name.to_owned())
}

fn counted(count: usize, one: &str) -> Option<String> {
    (count > 0).then(|| messages::counted(count as i64, one))
}

/// The name of a change of one item, or of more.
fn one_or_more([before, after]: [usize; 2], [one, more]: [&'static str; 2]) -> &'static str {
    if before.abs_diff(after) > 1 { more } else { one }
}

fn are_same_measured(one: &[Measured], other: &[Measured]) -> bool {
    let same = |(one, other): (&Measured, &Measured)| one.is_of_same(other);
    one.len() == other.len() && one.iter().zip(other).all(same)
}

fn are_same_trails(one: &ShownTrails, other: &ShownTrails) -> bool {
    (one.of_picked, one.spread) == (other.of_picked, other.spread) && are_same_points(&one.pinned, &other.pinned)
}

fn are_same_points(one: &[MeasuredPoint], other: &[MeasuredPoint]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(one, other)| one.point == other.point)
}

impl Measured {
    /// Returns true if both measurements are of the same kind and of the same points, wherever these are in the shown
    /// frame.
    pub fn is_of_same(&self, other: &Self) -> bool {
        self.kind == other.kind && are_same_points(&self.points, &other.points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{FollowedPoint, MeasurementKind};
    use glam::DVec3;

    fn point(index_in_file: u32, frame: usize) -> MeasuredPoint {
        let point = FollowedPoint {
            index_in_file,
            points_in_file: Some(9),
        };
        let place = DVec3::splat(frame as f64);
        MeasuredPoint { frame, point, place }
    }

    fn measured(indices: [u32; 2], frame: usize) -> Document {
        let kind = MeasurementKind::Distance;
        let points = indices.map(|index| point(index, frame)).to_vec();
        Document {
            measurements: vec![Measured { kind, points }],
            ..Document::default()
        }
    }

    #[test]
    fn moved_points_do_not_count_as_unsaved_work() {
        let before = measured([2, 3], 0);
        let moved = Document {
            frame: 4,
            ..measured([2, 3], 4)
        };
        assert!(before.is_same_work(&moved) && before.is_undone_to(&moved));
        assert!(!before.is_same_work(&measured([2, 4], 0)));
        let trail = |frame| Document {
            trails: ShownTrails {
                pinned: vec![point(5, frame)],
                ..ShownTrails::default()
            },
            ..Document::default()
        };
        assert!(trail(1).is_same_work(&trail(2)));
        assert!(!trail(1).is_same_work(&Document::default()));
    }

    #[test]
    fn only_undoable_parts_are_restored() {
        let now = Document {
            frame: 7,
            up: Some(crate::scene::UpAxis::NegY),
            notes: "now".to_owned(),
            ..measured([1, 2], 7)
        };
        let mut document = now.clone();
        document.put_back(&measured([2, 3], 0));
        let expected = Document {
            notes: String::new(),
            measurements: measured([2, 3], 0).measurements,
            ..now
        };
        assert_eq!(document, expected);
    }
}
