//! What of a document is work: whether two hold the same, and what one holds in a sentence.

use super::model::{Compared, Document, Measured, MeasuredPoint, ShownTrails};
use crate::scene::Settings;
use glam::DVec3;

impl Document {
    /// A document with nothing in it but default settings.
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            ..Self::default()
        }
    }

    /// Whether `other` holds the same work. Looking around is none: frame and view may differ, and where followed
    /// points are in the shown frame.
    pub fn is_same_work(&self, other: &Self) -> bool {
        self.work() == other.work()
    }

    /// Whether `other` is kept as the same: the work, and the view.
    pub fn is_kept_same(&self, other: &Self) -> bool {
        self.view == other.view && self.is_same_work(other)
    }

    /// What it holds beyond `new`, for a message: `view, look, 2 labels`. Empty if nothing.
    pub fn summary(&self, new: &Self) -> Vec<String> {
        let counted = |count: usize, one: &str| match count {
            0 => None,
            1 => Some(format!("1 {one}")),
            count => Some(format!("{count} {one}s")),
        };
        let named = |is_there: bool, name: &str| is_there.then(|| name.to_owned());
        let parts = [
            named(self.view.is_some(), "view"),
            named(self.settings != new.settings, "look"),
            named(self.up.is_some(), "up axis"),
            named(self.clip.is_some(), "clip"),
            named(self.range != new.range, "in and out point"),
            counted(self.markers.len(), "marker"),
            counted(self.labels.len(), "label"),
            counted(self.measurements.len(), "measurement"),
            named(self.trails != ShownTrails::default(), "trails"),
            named(self.path.is_some(), "camera path"),
            named(self.compare.is_some(), "second sequence"),
            named(!self.notes.is_empty(), "notes"),
        ];
        parts.into_iter().flatten().collect()
    }

    /// The document without what changes by looking around.
    fn work(&self) -> Self {
        let measured = self.measurements.iter().map(|measured| Measured {
            points: measured.points.iter().map(unplaced).collect(),
            ..*measured
        });
        Self {
            inputs: Vec::new(),
            frame: 0,
            view: None,
            measurements: measured.collect(),
            trails: ShownTrails {
                kept: self.trails.kept.iter().map(unplaced).collect(),
                ..self.trails
            },
            compare: self.compare.as_ref().map(|compared| Compared {
                // As default for the two sequences, or the same by name.
                by: None,
                ..compared.clone()
            }),
            ..self.clone()
        }
    }
}

/// A point without its place, which follows the frames.
fn unplaced(point: &MeasuredPoint) -> MeasuredPoint {
    MeasuredPoint {
        frame: 0,
        place: DVec3::ZERO,
        ..*point
    }
}
