//! Filters of depth images are changed.

use super::State;
use crate::rgbd::Filters;
use crate::session::ReadSession;
use std::sync::Arc;

impl State {
    /// Decodes the frames of the open recording anew, with other filters of its depth images. All that a person has
    /// made around it stays, as if it was opened from its session.
    pub fn filter_depth(&mut self, filters: Filters) {
        let Some(player) = &self.player else { return };
        let Some(sequence) = player.sequence().filtered(filters) else {
            return;
        };
        let (plays, follows) = (player.is_playing(), player.follows_newest());
        let mut session = match self.session() {
            Ok(session) => session,
            Err(problem) => return self.notices.error(problem),
        };
        session.reading.rgbd_filters = Some(filters);
        let frame = session.frame;
        let (file, is_damaged) = (self.opened.file.take(), self.opened.is_damaged);
        let read = ReadSession {
            file: file.clone().unwrap_or_default(),
            session,
            warnings: Vec::new(),
        };
        let turns = self.motion.turntable.is_on;
        self.open_session(Arc::new(sequence), read);
        (self.opened.file, self.opened.is_damaged) = (file, is_damaged);
        self.motion.turntable.is_on = turns;
        self.play_with(|player, now| {
            let is_live = player.sequence().source().is_live();
            if is_live && !follows {
                player.follow_newest(false, now);
                player.seek(frame, now);
            }
            if !is_live && plays != player.is_playing() {
                player.toggle(now);
            }
        });
    }
}
