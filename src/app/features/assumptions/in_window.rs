//! Alternatives to assumptions take effect, and are remembered for the open sequence.
//!
//! **How it works.** Up axis and primitive belong to the document (`state/document.rs`). Reading options are stored by
//! input ([`crate::app::ReadingChoices`]), as they have to be known before anything is opened. The inputs are reopened
//! on a thread; if no frame can be decoded with the new options, the open sequence stays, and nothing is stored.

use super::Assumptions;
use super::panel::{CHIP_WIDTH, PANEL, assumptions_ui, chip_ui};
use crate::app::features::assumptions::{Change, FileKind, Given, Group, ReadChange, groups};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::panel_row::{Dock, PanelRow};
use crate::app::reading_choices::first_failure;
use crate::app::recent::entry_name;
use crate::app::side::Side;
use crate::app::state::State;
use crate::app::state::{FoundSequence, NotFound};
use crate::app::work::outcome::{Message, Outcome};
use crate::app::work::works::WorkKind;
use crate::document::{ReadSession, Reading, TextHash, Unsaved};
use crate::playback::Player;
use crate::rgbd::Filters;
use crate::scene::{FirstLook, Primitive};
use crate::sequence::{OpenOptions, Sequence};
use egui::Ui;
use std::path::PathBuf;
use std::sync::Arc;

impl State {
    /// The assumptions about the open sequence with the user's choices; none without a sequence.
    pub(in crate::app) fn assumptions(&self) -> Vec<Group> {
        let Some(player) = &self.player else {
            return Vec::new();
        };
        let sequence = player.sequence();
        let guessed = self.opening.looked.guessed.as_deref();
        let mut assumptions = sequence.assumptions();
        assumptions.extend(guessed.into_iter().flat_map(FirstLook::assumptions));
        let lack = |&primitive: &Primitive| Some((primitive, guessed?.lack_of(primitive)?));
        let has_filters = sequence.source().filters().is_some();
        groups(&Given {
            assumptions,
            guessed_up: guessed.map(|look| (look.up, look.up_why)),
            chosen_up: self.chosen_up(),
            primitive: self.style.primitive,
            guessed_primitive: guessed.map(|look| look.primitive),
            lacks: Primitive::ALL.iter().filter_map(lack).collect(),
            colors: self.style.colors.source,
            offered_colors: guessed.map_or(&[], |look| &look.colors.offered),
            open: self.can_open_again().then(|| self.opened_with()),
            file_kind: sequence
                .frames()
                .next()
                .map_or(FileKind::Other, |first| FileKind::of(&sequence.entry(first).path)),
            has_filters,
        })
    }

    /// The options with which the open sequence was opened.
    pub(in crate::app) fn opened_with(&self) -> &OpenOptions {
        self.opening
            .opened
            .options
            .as_ref()
            .unwrap_or(&self.shared.options.open)
    }

    fn can_open_again(&self) -> bool {
        let has_inputs = |player: &Player| {
            let source = player.sequence().source();
            !source.is_live() && !source.inputs().is_empty()
        };
        self.player.as_ref().is_some_and(has_inputs)
    }

    /// Makes `changes` for the open sequence, now and whenever it is opened again.
    pub(in crate::app) fn choose(&mut self, changes: Vec<Change>) {
        let mut read = Vec::new();
        for change in changes {
            match change {
                Change::Up(Some(up)) => self.choose_up(up),
                Change::Up(None) => self.guess_up(),
                Change::Primitive(primitive) => self.style.primitive = primitive,
                Change::Colors(source) => self.style.colors.source = source,
                Change::Read(change) => read.push(change),
            }
        }
        self.keep_document();
        match &read[..] {
            [] => {}
            // An open source takes filters as given: automatic ones are only determined when it is opened again.
            &[ReadChange::Filters(filters)] if filters != Filters::USUAL || !self.can_open_again() => {
                self.filter_depth(filters);
            }
            _ => self.read_with(read),
        }
    }

    /// Opens the inputs again on a thread.
    fn read_with(&mut self, changes: Vec<ReadChange>) {
        let Some(player) = self.player.as_ref().filter(|_| self.can_open_again()) else {
            return;
        };
        let inputs = match self.named_inputs(player) {
            Ok(inputs) => inputs,
            Err(problem) => return self.notices.error(problem),
        };
        let mut open = self.opened_with().clone();
        for change in &changes {
            change.apply(&mut open);
        }
        self.shared.works.cancel(WorkKind::Open);
        let name = format!("Opening {} again", entry_name(&inputs));
        let progress = self.shared.works.begin(WorkKind::Open, name, self.shared.now);
        self.shared.tasks.start("find frames", move || {
            let opened = Sequence::open_observed(&inputs, &open, &progress);
            let sequence = opened.map_err(NotFound::from).and_then(|sequence| {
                let failure = first_failure(&sequence);
                match failure {
                    _ if progress.is_cancelled() => Err(NotFound::Cancelled),
                    Some(reason) => Err(NotFound::Because(reason, Vec::new())),
                    None => Ok(Arc::new(sequence)),
                }
            });
            let found = FoundSequence {
                inputs,
                open,
                session: None,
                sequence,
                side: Side::A,
                problem: None,
            };
            Reread { found, changes }
        });
    }

    fn take_reread(&mut self, Reread { found, changes }: Reread) {
        match &found.sequence {
            Ok(sequence) if !changes.is_empty() => {
                let sequence = Arc::clone(sequence);
                self.take_changed(sequence, found.open, &changes);
            }
            _ => self.take_found(found),
        }
    }

    /// Shows `sequence`, the open one read with `changes`.
    pub(in crate::app) fn take_changed(&mut self, sequence: Arc<Sequence>, open: OpenOptions, changes: &[ReadChange]) {
        let keeps_places = !changes.iter().any(ReadChange::moves_points);
        if self.open_again(sequence, open, keeps_places) {
            self.remember(changes);
        }
    }

    /// Remembers `changes` for the inputs of the open sequence.
    pub(in crate::app) fn remember(&mut self, changes: &[ReadChange]) {
        let apply = |open: &mut OpenOptions| changes.iter().for_each(|change| change.apply(open));
        if let Err(problem) = self.stored.reading_choices.change(&self.opening.opened.inputs, apply) {
            self.notices.warn(problem);
        }
    }

    /// The options of reading that were chosen for `inputs`.
    pub(in crate::app) fn chosen_reading(&self, inputs: &[PathBuf]) -> Option<Reading> {
        self.stored.reading_choices.of(inputs).cloned()
    }

    /// Shows `sequence`, the open one read with the options `open`. Everything that the user has made around it stays,
    /// as if it was opened from its session; without `keeps_places`, items at positions of points are dropped. False if
    /// nothing was opened.
    pub(in crate::app) fn open_again(
        &mut self,
        sequence: Arc<Sequence>,
        open: OpenOptions,
        keeps_places: bool,
    ) -> bool {
        let Some(player) = &self.player else { return false };
        let (plays, follows) = (player.is_playing(), player.follows_newest());
        let mut session = match self.session() {
            Ok(session) => session,
            Err(problem) => {
                self.notices.error(problem);
                return false;
            }
        };
        let topic = session.reading.topic.take();
        session.reading = Reading {
            topic,
            ..Reading::of(&open)
        };
        if !keeps_places {
            session.view = None;
            session.clip = None;
            session.measurements.clear();
        }
        let frame = session.frame;
        let (file, is_damaged) = (self.opening.opened.file.take(), self.opening.opened.is_damaged);
        let read = ReadSession {
            file: file.clone().unwrap_or_default(),
            document: session,
            warnings: Vec::new(),
            text_hash: TextHash::default(),
            unsaved: Unsaved::None,
        };
        let turns = self.motion.turntable.is_on;
        self.with_document_stored(|state| state.open_session(sequence, read));
        (self.opening.opened.file, self.opening.opened.is_damaged) = (file, is_damaged);
        // A choice in the window overrides the command line.
        self.opening.opened.options = Some(open);
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
        true
    }
}

/// Result of detecting the open inputs again with other read options.
struct Reread {
    found: FoundSequence,
    changes: Vec<ReadChange>,
}

impl Message for Reread {}

impl Feature<State> for FeatureOf<Assumptions> {
    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|reread| state.take_reread(reread))
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[
            PanelRow::in_menu(PANEL, "Assumptions…", assumptions).also(&[
                "guesses",
                "guessed",
                "depth scale",
                "columns",
                "intrinsics",
                "no-data",
                "import options",
                "units",
                "coordinate system",
                "detected",
            ]),
            PanelRow {
                id: None,
                menu: None,
                also: &[],
                place: Dock::Chip(CHIP_WIDTH),
                show: chip,
            },
        ];
        PANELS
    }
}

/// The list of assumptions.
fn assumptions(ui: &mut Ui, state: &mut State) {
    if !state.panels.has(PANEL) {
        return;
    }
    let groups = state.assumptions();
    let corner = state.viewport.rect.right_top();
    let mut is_open = true;
    let changes = assumptions_ui(ui, &mut is_open, &groups, corner);
    state.panels.set(PANEL, is_open);
    state.choose(changes);
}

/// The chip with the number of assumptions about the open sequence.
fn chip(ui: &mut Ui, state: &mut State) {
    let groups = state.assumptions();
    if !groups.is_empty() && chip_ui(ui, &groups, state.panels.has(PANEL)) {
        state.panels.toggle(PANEL);
    }
}
