//! What becomes of what tasks come to.

use super::State;
use super::failed_opening::FailedOpening;
use super::opened::SessionQuestion;
use super::outcome::{FoundSequence, NotFound, Outcome};
use crate::app::drawing::levels::FrameWithLevels;
use crate::app::recent::entry_name;
use crate::app::side::Side;
use crate::app::work::files::SavedFile;
use crate::app::work::tasks::TaskFailed;

impl State {
    /// Gives what a task came to to the feature that it is of.
    pub(super) fn take_in(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Found(found) => self.take_found(found),
            Outcome::Answered(answer) => self.take_answer(answer),
            Outcome::Saved(SavedFile(path)) => {
                self.notices.info(format!("Saved {}", path.display()));
            }
            Outcome::Path(path) => self.take_path_file(path),
            Outcome::SessionSaved(saved) => self.session_was_saved(saved),
            Outcome::Exported(ended) => self.export_has_ended(ended),
            Outcome::SequenceSaved(ended) => self.save_has_ended(ended),
            Outcome::Estimated(estimated) => self.estimates.take_in(*estimated),
            Outcome::Benchmark(ended) => {
                self.benchmark.finish(ended);
                self.learn_quality();
            }
            Outcome::Compared(difference) => {
                if let Some(pictures) = self.pictures_mut() {
                    pictures.take_in(difference);
                }
            }
            Outcome::Distances(distances) => {
                if let (Some(beside), Some(distances)) = (&mut self.beside, distances) {
                    beside.take_in(distances);
                }
            }
            Outcome::Composed(made) => {
                if let Some(made) = made {
                    self.temporal.take_in(*made);
                }
            }
            Outcome::Photos(loaded) => {
                for note in self.photos.take_in(loaded) {
                    self.notices.warn(note);
                }
            }
            Outcome::Photographed(made) => self.photos.take_frame(made),
            Outcome::Traced(traced) => self.trails.take_in(traced),
            Outcome::Levels(FrameWithLevels(frame)) => {
                self.main.drawing.take_levels(&frame);
                if let Some(beside) = &mut self.beside {
                    beside.drawing.take_levels(&frame);
                }
            }
            Outcome::InView(made) => {
                self.main.drawing.take_surfels_in_view(&made);
                if let Some(beside) = &mut self.beside {
                    beside.drawing.take_surfels_in_view(&made);
                }
            }
            Outcome::Looked(more) => self.take_more(*more),
            Outcome::Thumbnail(delivery) => self.thumbnails.take_in(*delivery),
            Outcome::Failed(TaskFailed(text)) => self.notices.error(text),
        }
    }

    fn take_found(&mut self, found: FoundSequence) {
        if let Some(problem) = found.problem {
            self.notices.warn(problem);
        }
        match found.sequence {
            Ok(sequence) if !found.changes.is_empty() => self.take_changed(sequence, found.open, &found.changes),
            Ok(sequence) => {
                match (found.side, found.session) {
                    (Side::A, Some(session)) => self.open_session(sequence, *session),
                    (Side::A, None) => {
                        self.open(sequence);
                        self.note_opened(found.inputs.clone(), Some(found.open));
                    }
                    (Side::B, _) => self.compare_found(sequence, &found.inputs),
                }
                self.prove(found.inputs, found.side);
            }
            Err(NotFound::Cancelled) => {}
            Err(NotFound::Beyond(beyond)) => {
                self.session_question = Some(SessionQuestion {
                    inputs: found.inputs,
                    open: found.open,
                    side: found.side,
                    beyond,
                });
            }
            Err(NotFound::Because(reason, choices)) => {
                if self.player.is_none() {
                    let name = entry_name(&found.inputs);
                    self.failed = Some(FailedOpening { name, reason, choices });
                } else {
                    self.notices.error(reason);
                }
            }
        }
    }
}
