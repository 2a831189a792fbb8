//! Undo and redo of a user's edits in a document, in one order, each change with a name.
//!
//! **How it works.** The document is compared once per pass. Where its undoable parts differ from the last pass, the
//! previous ones are stored as an entry, unless the change continues: with the same button held, or the same fields
//! within half a second of the change before. An entry has the undoable parts alone, and shares large data.

use super::model::Document;
use super::names::{changed_fields, name_of};
use std::collections::VecDeque;
use std::time::Duration;

/// Changes of the same fields within this time are one.
const GESTURE: Duration = Duration::from_millis(500);

/// Max number of entries; the oldest are dropped first.
const MAX_ENTRIES: usize = 200;

/// The document before and after a user's change.
#[derive(Debug, Clone, Default)]
pub struct History {
    past: VecDeque<Change>,
    future: Vec<Change>,
    /// As of the last look; `None` before the first.
    present: Option<Document>,
    last: Option<LastChange>,
}

/// A change that can be undone, or made again.
#[derive(Debug, Clone)]
struct Change {
    /// As it is on the other side of the change.
    document: Document,
    name: String,
}

/// The last change.
#[derive(Debug, Clone)]
struct LastChange {
    at: Duration,
    /// See [`changed_fields`].
    fields: Vec<&'static str>,
    /// Begun by a button that has been held since.
    is_held: bool,
}

impl History {
    /// Compares the document at `now`; `is_held` is true while a mouse button is down.
    pub fn note(&mut self, document: &Document, is_held: bool, now: Duration) {
        let present = self.present.get_or_insert_with(|| document.undone_parts());
        let last = self.last.as_mut();
        let goes_on_by_hand = last.is_some_and(|last| {
            last.is_held &= is_held;
            last.is_held
        });
        if document.is_undone_to(present) {
            return;
        }
        let fields = changed_fields(present, document);
        let before = std::mem::replace(present, document.undone_parts());
        let goes_on = goes_on_by_hand
            || self
                .last
                .as_ref()
                .is_some_and(|last| last.fields == fields && now.saturating_sub(last.at) <= GESTURE);
        if !goes_on {
            if self.past.len() == MAX_ENTRIES {
                self.past.pop_front();
            }
            self.past.push_back(Change {
                document: before,
                name: String::new(),
            });
        }
        // A gesture is named after everything it changed.
        if let Some(change) = self.past.back_mut() {
            change.name = name_of(&change.document, document);
        }
        self.future.clear();
        self.last = Some(LastChange {
            at: now,
            fields,
            is_held,
        });
    }

    /// Compares the document between two user actions: the change continues none before, and none continues it.
    pub fn note_step(&mut self, document: &Document) {
        self.last = None;
        self.note(document, false, Duration::ZERO);
        self.last = None;
    }

    /// Name of the change that [`History::undo`] takes back, as `Lighting Matt`.
    pub fn undo_name(&self) -> Option<&str> {
        self.past.back().map(|change| change.name.as_str())
    }

    /// Name of the change that [`History::redo`] makes again.
    pub fn redo_name(&self) -> Option<&str> {
        self.future.last().map(|change| change.name.as_str())
    }

    /// The document before the last change, which is the present one from now on; `None` if there was none.
    pub fn undo(&mut self) -> Option<Document> {
        let Change { document: before, name } = self.past.pop_back()?;
        let after = self.present.replace(before.clone());
        self.future.extend(after.map(|document| Change { document, name }));
        self.last = None;
        Some(before)
    }

    /// The document before the last [`History::undo`]; `None` if something was changed since.
    pub fn redo(&mut self) -> Option<Document> {
        let Change { document: after, name } = self.future.pop()?;
        let before = self.present.replace(after.clone());
        self.past.extend(before.map(|document| Change { document, name }));
        self.last = None;
        Some(after)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Marker;
    use super::*;
    use crate::scene::{Label, Primitive, Settings};
    use proptest::prelude::*;
    use std::sync::Arc;

    fn scaled(splat_scale: f32) -> Document {
        let style = Settings::default().with(|style| style.surfels.splat_scale = splat_scale);
        Document {
            settings: style,
            ..Document::default()
        }
    }

    fn at(millis: u64) -> Duration {
        Duration::from_millis(millis)
    }

    #[test]
    fn a_gesture_is_one_undo_entry() {
        let mut history = History::default();
        history.note(&scaled(1.0), false, at(0));
        // A drag of two seconds, with a pause in it.
        for (millis, scale) in [(100, 1.1), (200, 1.2), (1900, 1.3), (2000, 1.4)] {
            history.note(&scaled(scale), true, at(millis));
        }
        // Released and grabbed again, it is another change once half a second has passed.
        history.note(&scaled(1.4), false, at(2100));
        history.note(&scaled(1.5), true, at(2700));
        history.note(&scaled(1.5), false, at(2800));
        // Repeated keys are one change as well; another field is not.
        history.note(&scaled(2.0), false, at(4000));
        history.note(&scaled(3.0), false, at(4400));
        history.note(&scaled(4.0), false, at(4800));
        let mut points = scaled(4.0);
        points.settings.primitive = Primitive::Point.into();
        history.note(&points, false, at(4900));
        let undone: Vec<_> = std::iter::from_fn(|| history.undo()).collect();
        assert_eq!(undone, [4.0, 1.5, 1.4, 1.0].map(scaled));
        let redone: Vec<_> = std::iter::from_fn(|| history.redo()).collect();
        assert_eq!(redone, [scaled(1.4), scaled(1.5), scaled(4.0), points]);
    }

    #[test]
    fn a_change_after_undo_discards_the_redo_entries() {
        let mut history = History::default();
        for (second, scale) in [1.0, 2.0, 3.0].into_iter().enumerate() {
            history.note(&scaled(scale), false, at(1000 * second as u64));
        }
        assert_eq!(history.undo(), Some(scaled(2.0)));
        // The state set by undo is not a change, and an edit right after it is a separate change.
        history.note(&scaled(2.0), false, at(2100));
        history.note(&scaled(5.0), false, at(2200));
        assert_eq!(history.redo(), None);
        assert_eq!(history.undo(), Some(scaled(2.0)));
        assert_eq!(history.undo(), Some(scaled(1.0)));
        assert_eq!(history.undo(), None);
    }

    #[test]
    fn steps_are_separate_changes() {
        let mut history = History::default();
        for scale in [1.0, 2.0, 2.0, 3.0] {
            history.note_step(&scaled(scale));
        }
        assert_eq!(history.undo(), Some(scaled(2.0)));
        assert_eq!(history.undo(), Some(scaled(1.0)));
        assert_eq!(history.undo(), None);
    }

    #[test]
    fn label_changes_are_undone_with_settings() {
        let label = Label {
            text: "knee".to_owned(),
            frame: 0,
            point: None,
            place: Some(glam::DVec3::ONE),
            frames: crate::timeline::PlayRange::default(),
        };
        let labelled = Document {
            labels: Arc::new(vec![label]),
            ..scaled(1.0)
        };
        let mut history = History::default();
        history.note(&scaled(1.0), false, at(0));
        history.note(&labelled, false, at(1000));
        assert_eq!(history.undo(), Some(scaled(1.0)));
        assert_eq!(history.redo(), Some(labelled.clone()));
        history.note(
            &Document {
                settings: scaled(2.0).settings,
                ..labelled
            },
            false,
            at(3000),
        );
        assert_eq!(history.undo().map(|before| before.labels.len()), Some(1));
        assert_eq!(history.undo(), Some(scaled(1.0)));
        assert_eq!(history.undo_name(), None);
        assert_eq!(history.redo_name(), Some("Label"));
    }

    #[test]
    fn changes_are_named() {
        use crate::scene::Lighting;
        let name = |change: &dyn Fn(&mut Document)| {
            let mut history = History::default();
            let mut document = Document::default();
            history.note(&document, false, at(0));
            assert_eq!(history.undo_name(), None);
            change(&mut document);
            history.note(&document, false, at(1000));
            let name = history.undo_name().map(str::to_owned);
            history.undo();
            assert_eq!(history.redo_name(), name.as_deref());
            name.unwrap()
        };
        assert_eq!(
            name(&|document| document.settings.light.lighting = Lighting::Lambert.into()),
            "Lighting Matt"
        );
        assert_eq!(
            name(&|document| document.settings.surfels.splat_scale = 1.5),
            "Splat scale 1.5"
        );
        assert_eq!(name(&|document| document.settings.backdrop.grid = true), "Grid on");
        assert_eq!(name(&|document| document.notes.push('a')), "Notes");
        let several = name(&|document| {
            document.settings.backdrop.grid = true;
            document.settings.surfels.splat_scale = 1.5;
        });
        assert_eq!(several, "2 settings");
        let marked = name(&|document| {
            document.settings.backdrop.grid = true;
            document.markers = vec![Marker {
                frame: 1,
                name: String::new(),
            }];
        });
        assert_eq!(marked, "Markers, Grid on");
    }

    proptest! {
        /// Held against a list of all settings, each change apart from the others.
        #[test]
        fn undo_and_redo_walk_along_the_list(
            scales in prop::collection::vec(1u32..1000, 1..260), moves in prop::collection::vec(any::<bool>(), 0..40),
        ) {
            let mut history = History::default();
            let mut list: Vec<Document> = Vec::new();
            for (second, &scale) in scales.iter().enumerate() {
                let style = scaled(scale as f32);
                history.note(&style, false, at(1000 * second as u64));
                if list.last() != Some(&style) {
                    list.push(style);
                }
            }
            let oldest = list.len().saturating_sub(1 + MAX_ENTRIES);
            let mut place = list.len() - 1;
            for is_undo in moves {
                let (found, expected) = if is_undo {
                    (history.undo(), place.checked_sub(1).filter(|&place| place >= oldest))
                } else {
                    (history.redo(), Some(place + 1).filter(|&place| place < list.len()))
                };
                prop_assert_eq!(found, expected.map(|place| list[place].clone()));
                place = expected.unwrap_or(place);
            }
        }
    }
}
