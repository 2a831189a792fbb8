//! Filters of depth images are changed.

use crate::app::features::assumptions::ReadChange;
use crate::app::state::State;
use crate::rgbd::Filters;
use std::sync::Arc;

impl State {
    /// Decodes the frames of the open recording again, with other filters of its depth images. All that the user has
    /// made around it stays. The choice is remembered.
    pub fn filter_depth(&mut self, filters: Filters) {
        let Some(player) = &self.player else { return };
        let Some(sequence) = player.sequence().filtered(filters) else {
            return;
        };
        let change = ReadChange::Filters(filters);
        let mut open = self.opened_with().clone();
        change.apply(&mut open);
        self.take_changed(Arc::new(sequence), open, &[change]);
    }
}
