//! Timeline annotations of the open sequence by the user, and their persistence.

use super::Timeline;
use super::panel::{TimelineContext, TimelineRequest, timeline_ui};
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group, needs_sequence};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::panel_row::{Dock, PanelRow};
use crate::app::state::State;
use crate::document::Document;
use crate::playback::Player;
use crate::scene::Scene;
use crate::timeline::PlayRange;
use egui::Key;
use egui::Ui;

impl State {
    /// The frame at the playhead, or waited for, of the open sequence.
    fn frame_at_playhead(&self) -> Option<usize> {
        let player = self.player.as_ref()?;
        let frame = player.waiting_for().unwrap_or(player.clock().frame());
        (!player.sequence().is_empty()).then_some(frame)
    }

    /// Changes in or out point, given the range and the frame at the playhead.
    pub(in crate::app) fn set_range(&mut self, change: impl FnOnce(PlayRange, usize) -> PlayRange) {
        if let Some(frame) = self.frame_at_playhead() {
            self.play_with(|player, now| {
                player.set_range(change(player.clock().range(), frame), now);
            });
            self.keep_document();
        }
    }

    /// Puts a marker at the playhead, or takes it away.
    pub(in crate::app) fn toggle_marker(&mut self) {
        if let Some(frame) = self.frame_at_playhead() {
            self.features.timeline.toggle_marker(frame);
            self.keep_document();
        }
    }

    /// Goes to the next marker, or to the one before.
    pub(in crate::app) fn go_to_marker(&mut self, is_next: bool) {
        let (Some(frame), Some(player)) = (self.frame_at_playhead(), &self.player) else {
            return;
        };
        let count = player.sequence().len();
        let markers = &self.features.timeline.markers;
        let found = if is_next {
            markers.next_after(frame, count)
        } else {
            markers.last_before(frame, count)
        };
        if let Some(frame) = found {
            self.play_with(|player: &mut Player, now| player.seek(frame, now));
        }
    }
}

const COMMANDS: &[Row] = &[
    Row::new(Command::SET_IN, "Set in point", |state| {
        state.set_range(PlayRange::beginning_at);
    })
    .what("Set in point: play from here")
    .also(&["trim", "range start", "mark in"])
    .keys(group::PLAYING, "Shift+I", &[Chord::shift(Key::I)])
    .applies(needs_sequence),
    Row::new(Command::SET_OUT, "Set out point", |state| {
        state.set_range(PlayRange::ending_at);
    })
    .what("Set out point: play to here")
    .also(&["trim", "range end", "mark out"])
    .keys(group::PLAYING, "Shift+O", &[Chord::shift(Key::O)])
    .applies(needs_sequence),
    Row::new(Command::CLEAR_RANGE, "Clear in and out point", |state| {
        state.set_range(|_, _| PlayRange::default());
    })
    .keys(group::PLAYING, "Shift+X", &[Chord::shift(Key::X)])
    .applies(needs_sequence),
    Row::new(Command::TOGGLE_MARKER, "Add or remove marker", State::toggle_marker)
        .what("Add or remove a marker")
        .also(&["bookmark"])
        .keys(group::PLAYING, "Ctrl+M", &[Chord::ctrl(Key::M)])
        .applies(needs_sequence),
    Row::new(Command::NEXT_MARKER, "Next marker", |state| state.go_to_marker(true))
        .also(&["bookmark"])
        .keys(group::PLAYING, "Shift+M", &[Chord::shift(Key::M)])
        .applies(needs_sequence),
    Row::new(Command::PREVIOUS_MARKER, "Previous marker", |state| {
        state.go_to_marker(false);
    })
    .also(&["bookmark"])
    .keys(group::PLAYING, "Ctrl+Shift+M", &[Chord::ctrl_shift(Key::M)])
    .applies(needs_sequence),
];

impl Feature<State> for FeatureOf<Timeline> {
    fn forget_sequence(&self, state: &mut State) {
        state.features.timeline.forget_playhead();
    }

    fn save(&self, state: &State, document: &mut Document) {
        let markers = state.features.timeline.markers.list();
        if document.markers != markers {
            document.markers = markers.to_vec();
        }
    }

    fn load(&self, state: &mut State, document: &Document) {
        if let Some(problem) = state.features.timeline.take_markers(document.markers.clone()) {
            state.notices.warn(problem);
        }
    }

    fn escape(&self, state: &mut State) -> bool {
        state.features.timeline.renaming.take().is_some()
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow {
            id: None,
            menu: None,
            also: &[],
            place: Dock::Bottom("timeline"),
            show: timeline,
        }];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

fn timeline(ui: &mut Ui, state: &mut State) {
    let mut context = TimelineContext {
        needs: Scene::needs(&state.drawn_style()),
        now: state.now(),
        player: state.player.as_mut(),
        timeline: &mut state.features.timeline,
        thumbnails: &mut state.features.thumbnails,
    };
    for request in timeline_ui(ui, &mut context) {
        match request {
            TimelineRequest::Run(command) => state.run(command),
            TimelineRequest::Keep => state.keep_document(),
        }
    }
}
