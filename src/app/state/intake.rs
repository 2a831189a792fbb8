//! Handling of task outcomes.

use super::State;
use super::failed_opening::FailedOpening;
use super::opened::SessionQuestion;
use super::outcome::{FoundSequence, NotFound};
use crate::app::drawing::in_view::InView;
use crate::app::drawing::levels::FrameWithLevels;
use crate::app::features::Features;
use crate::app::first_look::RefinedLook;
use crate::app::recent::entry_name;
use crate::app::side::Side;
use crate::app::work::files::SavedFile;
use crate::app::work::outcome::Outcome;
use crate::app::work::tasks::TaskFailed;
use std::ops::ControlFlow;
use std::sync::Arc;

impl State {
    /// Gives the result of a task to its feature.
    pub(in crate::app) fn take_in(&mut self, outcome: Outcome) {
        let mut features = Features::rows::<Self>().into_iter();
        let left = features.try_fold(outcome, |outcome, feature| match feature.take(self, outcome) {
            Ok(()) => ControlFlow::Break(()),
            Err(outcome) => ControlFlow::Continue(outcome),
        });
        let left = left.continue_value().map(|outcome| self.take_own(outcome));
        if let Some(Err(outcome)) = left {
            debug_assert!(false, "no feature takes {outcome:?}");
            log::error!("no feature takes {outcome:?}");
        }
    }

    /// Takes results of no feature.
    fn take_own(&mut self, outcome: Outcome) -> Result<(), Outcome> {
        outcome
            .give(|found| self.take_found(found))
            .or_else(|outcome| outcome.give(|answer| self.take_answer(answer)))
            .or_else(|outcome| outcome.give(|saved| self.session_was_saved(saved)))
            .or_else(|outcome| outcome.give(|more: Box<RefinedLook>| self.take_more(*more)))
            .or_else(|outcome| outcome.give(|TaskFailed(text)| self.notices.error(text)))
            .or_else(|outcome| outcome.give(|SavedFile(path)| self.notices.info(format!("Saved {}", path.display()))))
            .or_else(|outcome| {
                outcome.give(|FrameWithLevels(frame)| {
                    self.main.drawing.take_levels(&frame);
                    if let Some(split_view) = &mut self.features.split_view {
                        split_view.drawing.take_levels(&frame);
                    }
                })
            })
            .or_else(|outcome| {
                outcome.give(|made: Arc<InView>| {
                    self.main.drawing.take_surfels_in_view(&made);
                    if let Some(split_view) = &mut self.features.split_view {
                        split_view.drawing.take_surfels_in_view(&made);
                    }
                })
            })
    }

    pub(in crate::app) fn take_found(&mut self, found: FoundSequence) {
        if let Some(problem) = found.problem {
            self.notices.warn(problem);
        }
        match found.sequence {
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
                self.opening.session_question = Some(SessionQuestion {
                    inputs: found.inputs,
                    open: found.open,
                    side: found.side,
                    beyond,
                });
            }
            Err(NotFound::Because(reason, choices)) => {
                if self.player.is_none() {
                    let name = entry_name(&found.inputs);
                    self.opening.failed = Some(FailedOpening { name, reason, choices });
                } else {
                    self.notices.error(reason);
                }
            }
        }
    }
}
