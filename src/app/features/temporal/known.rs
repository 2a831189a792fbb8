//! Distances that were measured: they take longest, colours follow from them.

use crate::measure::Change;
use std::collections::VecDeque;
use std::sync::Arc;

/// Max bytes of cached distances.
const MAX_RETAINED_BYTES: usize = 256 << 20;

/// The distances of one pose to another: the frames, and how many points of the first there are.
pub(super) type ChangeKey = (usize, usize, usize);

/// Cached distances, oldest first.
#[derive(Debug, Default)]
pub(super) struct Known(VecDeque<(ChangeKey, Arc<Change>)>);

impl Known {
    pub(super) fn find(&self, key: &ChangeKey) -> Option<Arc<Change>> {
        let known = self.0.iter().find(|(known, _)| known == key);
        known.map(|(_, change)| Arc::clone(change))
    }

    /// Keeps `change`, and lets the oldest ones go.
    pub(super) fn keep(&mut self, key: ChangeKey, change: &Arc<Change>) {
        if self.find(&key).is_some() {
            return;
        }
        self.0.push_back((key, Arc::clone(change)));
        while self.0.len() > 1 && self.byte_size() > MAX_RETAINED_BYTES {
            self.0.pop_front();
        }
    }

    fn byte_size(&self) -> usize {
        self.0.iter().map(|(_, change)| change.byte_size()).sum()
    }
}
