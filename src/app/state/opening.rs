//! Sequences are found and opened.

use super::State;
use super::connection::Connection;
use super::outcome::{FoundSequence, NotFound};
use crate::app::reading_choices::open_as_chosen;
use crate::app::recent::entry_name;
use crate::app::side::Side;
use crate::app::work::works::WorkKind;
use crate::document::{Document, session_of};
use crate::playback::Player;
use crate::progress::Progress;
use crate::scene::Settings;
use crate::sequence::{OpenOptions, Sequence, watch};
use crate::source::SessionReach;
use std::path::PathBuf;
use std::sync::Arc;

impl State {
    /// Opens the document of `sequence`, replacing the open one: the stored document, or a new one. Loop mode and speed
    /// stay: they are choices of the user, not of the document.
    pub fn open(&mut self, sequence: Arc<Sequence>) {
        self.keep_document();
        let found = self.find_document(&sequence);
        if self.show(sequence, found.document.style()) {
            self.open_document(found);
        }
    }

    /// Shows `sequence`, replacing the open one, whose document is closed. Returns false if it cannot be shown.
    pub(super) fn show(&mut self, sequence: Arc<Sequence>, style: Settings) -> bool {
        let loader_options = self.loader_options(self.budget_bytes());
        let mut player = match Player::new(sequence, loader_options, !self.shared.options.paused) {
            Ok(player) => player,
            Err(error) => {
                self.notices.error(error.to_string());
                return false;
            }
        };
        if let Err(error) = watch(player.sequence(), self.wake()) {
            self.notices.error(error.to_string());
        }
        for note in player.sequence().source().notes() {
            self.notices.warn(note.clone());
        }
        if self.shared.options.follow || player.sequence().source().is_live() {
            player.follow_newest(true, self.shared.now);
        }
        let (loop_mode, speed) = match &self.player {
            Some(before) => (before.clock().loop_mode(), before.clock().speed()),
            None => (
                self.shared.options.preferences.loop_mode,
                self.shared.options.preferences.speed,
            ),
        };
        player.set_loop_mode(loop_mode, self.shared.now);
        player.set_speed(speed, self.shared.now);
        // The window may take a while to open.
        player.begin(&style.decided().drawn_by(self.draws_on_processor()));
        if let Some(before) = self.player.replace(player) {
            self.leave(before);
        }
        self.style = style;
        self.features.timeline.begin();
        self.opening.failed = None;
        self.opening.connection = Connection::default();
        self.note_unnamed();
        self.prove(Vec::new(), Side::A);
        true
    }

    /// Shows `sequence` drawn as `style`, as a window does that has just been opened with it, playing or not.
    pub(in crate::app) fn open_fresh(&mut self, sequence: Arc<Sequence>, style: Settings, plays: bool) {
        self.shared.options.paused = !plays;
        if self.show(sequence, style) {
            self.apply_document(Document::new(style));
        }
    }

    /// Finds the frames of `inputs` on a thread and opens them.
    pub fn open_paths(&mut self, inputs: Vec<PathBuf>) {
        self.open_with_topic(inputs, None);
    }

    /// Opens the open recording again, with the point clouds of another topic.
    pub fn open_topic(&mut self, topic: &str) {
        if let Some(player) = &self.player {
            let inputs = player.sequence().source().inputs().to_vec();
            self.open_with_topic(inputs, Some(topic.into()));
        }
    }

    /// A topic is a choice for one recording: the next one has others.
    fn open_with_topic(&mut self, inputs: Vec<PathBuf>, topic: Option<Arc<str>>) {
        let open = self.shared.options.open.clone();
        self.find(inputs, OpenOptions { topic, ..open }, Side::A);
    }

    /// Finds the frames of `inputs` on a thread.
    pub(in crate::app) fn find(&mut self, inputs: Vec<PathBuf>, open: OpenOptions, side: Side) {
        if inputs.is_empty() {
            return;
        }
        // The latest request wins.
        self.opening.session_question = None;
        self.shared.works.cancel(WorkKind::Open);
        let name = format!("Opening {}", entry_name(&inputs));
        let progress = self.shared.works.begin(WorkKind::Open, name, self.shared.now);
        let chosen = self.chosen_reading(&inputs);
        let is_fresh = self.shared.options.is_fresh;
        let documents = self.shared.options.documents.clone().filter(|_| !is_fresh);
        self.shared.tasks.start("find frames", move || {
            let mut problem = None;
            let (open, session, sequence) = match session_of(&inputs) {
                Ok(Some(mut read)) => {
                    let beyond = read.beyond(open.session_reach);
                    // The user's changes may be stored elsewhere.
                    if let Some(documents) = documents.filter(|_| beyond.is_empty()) {
                        documents.restore(&mut read);
                    }
                    let open = read.document.reading.over(&open);
                    let sequence = if beyond.is_empty() {
                        found(&read.document.inputs, &open, &progress)
                    } else {
                        Err(NotFound::Beyond(beyond))
                    };
                    (open, Some(Box::new(read)), sequence)
                }
                Ok(None) => {
                    let as_chosen = chosen.map(|chosen| open_as_chosen(&inputs, &chosen, &open, &progress));
                    match as_chosen {
                        _ if progress.is_cancelled() => (open, None, Err(NotFound::Cancelled)),
                        Some(Ok((sequence, chosen))) => (chosen, None, Ok(Arc::new(sequence))),
                        failed => {
                            problem = failed.and_then(Result::err);
                            let sequence = found(&inputs, &open, &progress);
                            (open, None, sequence)
                        }
                    }
                }
                Err(reason) => (open, None, Err(NotFound::Because(reason.to_string(), Vec::new()))),
            };
            FoundSequence {
                inputs,
                open,
                session,
                sequence,
                side,
                problem,
            }
        });
    }

    /// Opens the session of [`super::OpeningFacts::session_question`], which may open all that it names now.
    pub fn trust_session(&mut self) {
        if let Some(question) = self.opening.session_question.take() {
            let open = OpenOptions {
                session_reach: SessionReach::ANYWHERE,
                ..question.open
            };
            self.find(question.inputs, open, question.side);
        }
    }

    /// Sets the memory for prepared frames, now and for sequences opened later.
    pub fn set_budget_bytes(&mut self, budget_bytes: usize) {
        self.shared.options.budget_bytes = Some(budget_bytes);
        self.share_budget();
    }
}

fn found(inputs: &[PathBuf], open: &OpenOptions, progress: &Progress) -> Result<Arc<Sequence>, NotFound> {
    let sequence = Sequence::open_observed(inputs, open, progress)?;
    // If it was cancelled during the last file, the result is not wanted either.
    if progress.is_cancelled() {
        return Err(NotFound::Cancelled);
    }
    Ok(Arc::new(sequence))
}
