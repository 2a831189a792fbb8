//! A live stream is recorded.

use super::State;
use super::dialogs::DialogKind;
use crate::source::Source;
use std::path::Path;
use std::sync::Arc;

impl State {
    fn stream(&self) -> Option<Arc<dyn Source>> {
        let source = self.player.as_ref()?.sequence().source();
        source.live().is_some().then(|| Arc::clone(source))
    }

    /// Asks where to record to, or ends the recording.
    pub(super) fn toggle_recording(&mut self) {
        let Some(source) = self.stream() else {
            return self
                .notices
                .error("Only live streams (tcp://…) are recorded, and none is open");
        };
        let Some(live) = source.live() else { return };
        match live.stop_recording() {
            Ok(None) => self.ask(DialogKind::RecordTo, Some("live.pointreel-stream".to_owned())),
            Ok(Some(recording)) => {
                self.notices
                    .info(format!("{} has {} frames", recording.path.display(), recording.frames));
            }
            Err(problem) => self.notices.error(problem),
        }
    }

    /// Records to a new file.
    pub(super) fn record_to(&mut self, path: &Path) {
        let started = self
            .stream()
            .and_then(|source| Some(source.live()?.start_recording(path)));
        match started {
            Some(Ok(())) => self.notices.info(format!("Recording to {}", path.display())),
            Some(Err(problem)) => self.notices.error(problem),
            None => self.notices.error("The stream was closed meanwhile"),
        }
    }
}
