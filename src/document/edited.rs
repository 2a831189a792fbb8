//! The parts of a document that undo takes back.

use super::{Draft, Marker};
use crate::scene::{Label, Settings};
use crate::timeline::PlayRange;
use std::sync::Arc;

/// What can be undone.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Edited {
    /// The settings.
    pub style: Settings,
    /// The camera path.
    pub path: Arc<Draft>,
    /// The labels.
    pub labels: Arc<Vec<Label>>,
    /// The markers.
    pub markers: Vec<Marker>,
    /// In and out point.
    pub range: PlayRange,
    /// Free text.
    pub notes: String,
}

/// The settings that differ, by their names in files, and the other parts that do.
pub(super) fn changed_fields(before: &Edited, after: &Edited) -> Vec<&'static str> {
    let parts = [
        ("path", before.path != after.path),
        ("labels", before.labels != after.labels),
        ("markers", before.markers != after.markers),
        ("range", before.range != after.range),
        ("notes", before.notes != after.notes),
        ("clip", before.style.clip != after.style.clip),
    ];
    let parts = parts.into_iter().filter_map(|(name, differs)| differs.then_some(name));
    let style = before.style.settings().into_iter();
    let changed = style
        .zip(after.style.settings())
        .filter(|((_, before), (_, after))| before != after);
    parts.chain(changed.map(|((described, _), _)| described.key)).collect()
}
