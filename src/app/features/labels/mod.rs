//! Labels of the open sequence: texts at points, their positions in the shown frame, and their occlusion.
//!
//! **How it works.** The list is the user's work, covered by undo. The position of each label follows from the list and
//! the frame alone ([`Label::place_in`]), so it is looked up once per frame and list ([`Labels::follow`]). Occlusion is
//! tested with the last image, once per image ([`Labels::note_hidden`]).

mod in_window;
pub(in crate::app) mod marks;
pub(in crate::app) mod panel;

use crate::scene::{Camera, Label};
use crate::sequence::PreparedFrame;
use glam::DVec3;
use std::sync::Arc;

/// More than anybody reads.
pub(in crate::app) const MAX_LABELS: usize = 1000;

/// The labels of the window.
#[derive(Debug)]
pub struct Labels {
    /// All of them, oldest first.
    pub list: Arc<Vec<Label>>,
    /// Visibility of the labels in the image and in exports.
    pub is_shown: bool,
    /// The one whose text is to be written next.
    pub(in crate::app) written: Option<usize>,
    /// Key of `places`: the frame and labels they were computed for.
    placed_of: Option<(u64, Arc<Vec<Label>>)>,
    /// Position of each label; `None` where it is not shown.
    places: Vec<Option<DVec3>>,
    /// Key of `hidden`: the view it was computed for.
    hidden_of: Option<(u64, Camera)>,
    /// Occlusion of each label: true if it is behind something.
    hidden: Vec<bool>,
}

impl Default for Labels {
    fn default() -> Self {
        Self {
            list: Arc::default(),
            is_shown: true,
            written: None,
            placed_of: None,
            places: Vec::new(),
            hidden_of: None,
            hidden: Vec::new(),
        }
    }
}

impl Labels {
    /// The labels that are drawn in images.
    pub(in crate::app) fn shown(&self) -> Arc<Vec<Label>> {
        if self.is_shown {
            Arc::clone(&self.list)
        } else {
            Arc::default()
        }
    }

    /// Returns true if any label is visible in the image.
    pub(in crate::app) fn are_shown(&self) -> bool {
        self.is_shown && !self.list.is_empty()
    }

    /// Adds one, whose text is to be written next; false if there are too many.
    pub(in crate::app) fn put(&mut self, label: Label) -> bool {
        if self.list.len() >= MAX_LABELS {
            return false;
        }
        self.written = Some(self.list.len());
        self.is_shown = true;
        self.edit(|list| list.push(label));
        true
    }

    /// Changes the list as one step of undo.
    pub(in crate::app) fn edit(&mut self, change: impl FnOnce(&mut Vec<Label>)) {
        change(Arc::make_mut(&mut self.list));
    }

    /// Replaces the list of labels.
    pub(in crate::app) fn take(&mut self, list: Arc<Vec<Label>>) {
        self.list = list;
        self.written = None;
    }

    /// Forgets all of them; whether they are shown stays.
    pub(in crate::app) fn forget(&mut self) {
        *self = Self {
            is_shown: self.is_shown,
            ..Self::default()
        };
    }

    /// Looks up where they are in a frame, if it or the list is another one.
    pub(in crate::app) fn follow(&mut self, frame: &PreparedFrame, origin: DVec3) {
        let is_known = self
            .placed_of
            .as_ref()
            .is_some_and(|(id, list)| *id == frame.id && Arc::ptr_eq(list, &self.list));
        if !is_known {
            let labels = self.list.iter();
            self.places = labels.map(|label| label.place_in(frame, origin)).collect();
            self.placed_of = Some((frame.id, Arc::clone(&self.list)));
            self.hidden_of = None;
        }
    }

    /// Tests which places are hidden in the image of this number, as `camera` sees it; true if it is a new image.
    pub(in crate::app) fn note_hidden(
        &mut self,
        picture: u64,
        camera: &Camera,
        which_are: impl FnOnce(&[DVec3]) -> Vec<bool>,
    ) -> bool {
        let key = Some((picture, *camera));
        if self.hidden_of == key {
            return false;
        }
        self.hidden_of = key;
        let shown: Vec<DVec3> = self.places.iter().copied().flatten().collect();
        let mut hidden = which_are(&shown).into_iter();
        let places = self.places.iter();
        self.hidden = places
            .map(|place| place.is_some() && hidden.next().unwrap_or(false))
            .collect();
        true
    }

    /// The position and the text of each label in the image, and true if it is hidden; hidden ones first.
    pub(in crate::app) fn in_picture(&self) -> Vec<(DVec3, &str, bool)> {
        if !self.is_shown {
            return Vec::new();
        }
        let all = self.list.iter().zip(&self.places).enumerate();
        let shown = all.filter_map(|(index, (label, place))| {
            let is_hidden = self.hidden.get(index).copied().unwrap_or(false);
            Some(((*place)?, label.text.as_str(), is_hidden))
        });
        let mut shown: Vec<_> = shown.collect();
        shown.sort_by_key(|(.., is_hidden)| !is_hidden);
        shown
    }

    /// Returns the position of a label in the shown frame, or where it was placed.
    pub(in crate::app) fn place(&self, index: usize) -> Option<DVec3> {
        let shown = self.places.get(index).copied().flatten();
        shown.or_else(|| self.list.get(index)?.place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timeline::PlayRange;

    fn label(text: &str) -> Label {
        Label {
            text: text.to_owned(),
            frame: 0,
            point: None,
            place: Some(DVec3::ONE),
            frames: PlayRange::default(),
        }
    }

    #[test]
    fn label_lists_are_bounded_and_can_be_cleared() {
        let mut labels = Labels {
            is_shown: false,
            ..Labels::default()
        };
        for number in 0..MAX_LABELS {
            assert!(labels.put(label(&number.to_string())));
        }
        assert!(!labels.put(label("one more")));
        assert_eq!((labels.list.len(), labels.written), (MAX_LABELS, Some(MAX_LABELS - 1)));
        assert!(labels.are_shown(), "who puts a label wants to see it");
        labels.is_shown = false;
        assert!(labels.shown().is_empty());
        labels.forget();
        assert!(labels.list.is_empty() && !labels.is_shown);
    }
}
