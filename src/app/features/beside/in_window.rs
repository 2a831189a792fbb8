//! Second sequence for comparison next to the open one: opening and closing it, its images, its fraction of the memory.

use super::FrameDistances;
use super::panel::{BesideRequest, beside_ui};
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group, needs_sequence, of_point_clouds};
use crate::app::features::beside::{Beside, Layout};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::panel_row::{Dock, PanelRow};
use crate::app::sequence_name::name_of;
use crate::app::side::Side;
use crate::app::state::document::{chosen_topic, inputs_of};
use crate::app::state::{Dialog, State};
use crate::app::widgets::numbers::significant;
use crate::app::work::outcome::Outcome;
use crate::app::work::tasks::close;
use crate::composition::{Composed, PictureView};
use crate::document::{Compared, ComparedBy, ComparedLayout, Document};
use crate::math::Aabb;
use crate::playback::{Companion, PairBy, PlayerChange};
use crate::scene::ScenePacket;
use crate::sequence::{LoaderOptions, OpenOptions, Sequence, watch};
use egui::Key;
use egui::Ui;
use image::{RgbaImage, imageops};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

impl State {
    /// The second sequence as a document has it; `None` if there is none that could be opened again.
    fn compared(&self) -> Option<Compared> {
        let beside = self.features.beside.as_ref()?;
        let companion = &beside.companion;
        // Where there was no choice, the user made none.
        let has_choice = companion.times().is_some() || companion.numbers().is_some();
        Some(Compared {
            inputs: inputs_of(companion.sequence())?,
            topic: chosen_topic(companion.sequence()),
            by: has_choice.then(|| match companion.paired_by() {
                PairBy::Index => ComparedBy::Index,
                PairBy::Number => ComparedBy::Number,
                PairBy::Time => ComparedBy::Time,
            }),
            offset_frames: companion.offset_frames(),
            layout: match beside.layout {
                Layout::SideBySide => ComparedLayout::SideBySide,
                Layout::Wipe => ComparedLayout::Line,
            },
            line: (1e4 * f64::from(beside.pictures.split)).round() / 1e4,
        })
    }

    /// Shows `sequence` for comparison next to the open one, replacing the previous comparison, with the same layout.
    /// The camera stays.
    pub fn compare_with(&mut self, sequence: Arc<Sequence>) {
        let Some(player) = &self.player else {
            let text = "There is nothing to compare with yet: open a sequence first";
            return self.notices.error(text);
        };
        let leader = Arc::clone(player.sequence());
        let before = self.features.beside.as_ref();
        let laid_out = before.map(|before| (before.layout, before.pictures.split));
        self.close_beside();
        self.end_comparison(Side::A);
        let [_, share] = Companion::shares(self.budget_bytes());
        let options = self.loader_options(share);
        let companion = match Companion::new(&leader, sequence, options) {
            Ok(companion) => companion,
            Err(error) => return self.notices.error(error.to_string()),
        };
        let sequence = companion.sequence();
        if let Err(error) = watch(sequence, self.wake()) {
            self.notices.error(error.to_string());
        }
        let name = name_of(sequence).unwrap_or_default();
        let mut beside = Beside::new(companion, name);
        if let Some((layout, split)) = laid_out {
            beside.pictures.split = split;
            beside.lay_out(layout);
        }
        self.features.beside = Some(beside);
        self.share_budget();
    }

    /// Finds the frames of `inputs` on a thread and shows them next to the open sequence for comparison.
    pub fn compare_paths(&mut self, inputs: Vec<PathBuf>) {
        self.find(inputs, self.shared.options.open.clone(), Side::B);
    }

    /// Reopens the compared recording next to the open sequence, with the point clouds of another topic.
    pub fn compare_topic(&mut self, topic: &str) {
        if let Some(beside) = &self.features.beside {
            let inputs = beside.companion.sequence().source().inputs().to_vec();
            let topic = Some(topic.into());
            let open = self.shared.options.open.clone();
            self.find(inputs, OpenOptions { topic, ..open }, Side::B);
        }
    }

    /// Shows the open sequence alone. Its memory is all its own again.
    pub(in crate::app) fn close_beside(&mut self) {
        if let Some(beside) = self.features.beside.take() {
            // Its threads end after the frame they are on; nobody waits for that here.
            close(beside);
            self.features.inspection.forget_points_of_b();
            self.share_budget();
        }
    }

    /// Side by side, or one over the other.
    pub(in crate::app) fn next_layout(&mut self) {
        match &mut self.features.beside {
            Some(beside) => {
                let layout = match beside.layout {
                    Layout::SideBySide => Layout::Wipe,
                    Layout::Wipe => Layout::SideBySide,
                };
                beside.lay_out(layout);
            }
            None => self
                .notices
                .hint("One sequence is open: File, Compare with… opens another next to it"),
        }
    }

    /// Takes notice that the first of two pictures is another one.
    pub(in crate::app) fn note_picture(&mut self) {
        if let Some(beside) = &mut self.features.beside {
            beside.note_change(self.shared.now);
        }
        if let Some(comparison) = &mut self.features.comparison {
            comparison.pictures.note_change(self.shared.now);
        }
    }

    /// Measures the distances of the two shown frames.
    pub(in crate::app) fn measure_distances(&mut self) {
        if let (Some(beside), Some(player)) = (&mut self.features.beside, &self.player) {
            beside.measure(player, &self.shared.tasks);
        }
    }

    /// Memory for the prepared frames of all that is open.
    pub fn budget_bytes(&self) -> usize {
        let default = || LoaderOptions::default().budget_bytes;
        self.shared.options.budget_bytes.unwrap_or_else(default)
    }

    pub(in crate::app) fn loader_options(&self, budget_bytes: usize) -> LoaderOptions {
        LoaderOptions {
            shows_stages: true,
            wake: self.wake(),
            keeps_coarse_frames: true,
            budget_bytes,
            ..LoaderOptions::default()
        }
    }

    /// Divides the memory between what is open.
    pub(in crate::app) fn share_budget(&self) {
        let whole = self.budget_bytes();
        let [a, b] = match self.features.beside {
            Some(_) => Companion::shares(whole),
            None => [whole, 0],
        };
        if let Some(player) = &self.player {
            player.loader().set_budget_bytes(a);
        }
        if let Some(beside) = &self.features.beside {
            beside.companion.loader().set_budget_bytes(b);
        }
    }

    /// Takes in what has changed about the other sequence. True if something can be seen.
    pub(in crate::app) fn follow_beside(&mut self, change: PlayerChange) -> bool {
        let (Some(beside), Some(player)) = (&mut self.features.beside, &self.player) else {
            return false;
        };
        let sequence = beside.companion.sequence();
        if let Some(failure) = change.new_failure {
            let place = failure.index() + 1;
            let (count, name) = (sequence.len(), &beside.name);
            self.notices
                .error(format!("Frame {place} of {count} of B ({name}) is skipped. {failure}"));
        }
        for warning in change.new_warnings {
            self.notices.warn(format!("B: {warning}"));
        }
        if let Some(frame) = beside.companion.shown() {
            self.features.inspection.follow(Side::B, frame, sequence.origin());
        }
        if let Some(gap) = beside.take_gap(player) {
            let a = name_of(player.sequence()).unwrap_or_default();
            self.notices.warn(format!(
                "B ({}) is {} away from A ({a}): both are drawn where their files say. R shows both; \
                 `pointreel convert --transform` moves the points of one",
                beside.name,
                significant(gap),
            ));
        }
        change.visible
    }

    /// The box around the shown frame of the other sequence, relative to the origin of the open one; empty without any.
    pub(in crate::app) fn bounds_beside(&self) -> Aabb {
        let (Some(beside), Some(player)) = (&self.features.beside, &self.player) else {
            return Aabb::EMPTY;
        };
        let Some(frame) = beside.companion.shown() else {
            return Aabb::EMPTY;
        };
        let shift = beside.shift_from(player).as_vec3();
        let Aabb { min, max } = frame.frame.bounds();
        Aabb {
            min: min + shift,
            max: max + shift,
        }
    }

    /// The packet of the other sequence, if it differs from the last one.
    pub(in crate::app) fn next_packet_beside(&mut self) -> Option<ScenePacket> {
        let style = self.drawn_style();
        let beside = self.features.beside.as_mut()?;
        let Some(frame) = beside.companion.shown() else {
            beside.pictures.forget_difference();
            return None;
        };
        if self.viewport.other_size_px.contains(&0) {
            return None;
        }
        let view = PictureView {
            camera: &self.camera,
            origin: beside.companion.sequence().origin(),
            size_px: self.viewport.other_size_px,
        };
        let composed = Composed::of(Arc::clone(frame));
        let packet = beside.drawing.next_packet(composed, &view, &style, self.shared.now)?;
        beside.note_change(self.shared.now);
        Some(packet)
    }

    /// Returns true if all visible images have been drawn from frames that are due.
    pub(in crate::app) fn is_drawn(&self) -> bool {
        let is_drawn_beside = |beside: &Beside| {
            beside.companion.waiting_for().is_none()
                && (beside.drawing.is_drawn() || beside.companion.shown().is_none())
        };
        self.main.drawing.is_drawn() && self.features.beside.as_ref().is_none_or(is_drawn_beside)
    }

    /// Composes both visible images into one: side by side, or on both sides of the line. The first one alone if there
    /// is no other sequence, or no frame of it. With the labels that are in the window.
    pub fn joined(&self, a: RgbaImage, b: Option<RgbaImage>) -> RgbaImage {
        let Some((beside, b)) = self.features.beside.as_ref().zip(b) else {
            return self.with_labels(a);
        };
        if beside.companion.shown().is_none() {
            return self.with_labels(a);
        }
        match beside.layout {
            Layout::SideBySide => {
                let left = a.width();
                let mut joined = RgbaImage::new(left + b.width(), a.height().max(b.height()));
                imageops::replace(&mut joined, &self.with_labels(a), 0, 0);
                imageops::replace(&mut joined, &b, i64::from(left), 0);
                joined
            }
            Layout::Wipe => {
                let mut joined = a;
                let width = joined.width().min(b.width());
                let line = (beside.pictures.split * width as f32).round() as u32;
                let right = imageops::crop_imm(&b, line, 0, width - line, b.height());
                imageops::replace(&mut joined, &right.to_image(), i64::from(line), 0);
                self.with_labels(joined)
            }
        }
    }
}

impl Beside {
    /// Lays both out, and pairs their frames, as a document says.
    pub(in crate::app) fn arrange(&mut self, compared: &Compared) {
        self.companion.set_offset_frames(compared.offset_frames);
        if let Some(by) = compared.by {
            self.companion.pair_by(match by {
                ComparedBy::Index => PairBy::Index,
                ComparedBy::Number => PairBy::Number,
                ComparedBy::Time => PairBy::Time,
            });
        }
        self.pictures.split = compared.line as f32;
        self.lay_out(match compared.layout {
            ComparedLayout::SideBySide => Layout::SideBySide,
            ComparedLayout::Line => Layout::Wipe,
        });
    }

    /// Returns true if the layout is side by side, with half of the space for each.
    pub(in crate::app) fn is_side_by_side(&self) -> bool {
        self.layout == Layout::SideBySide
    }
}

const COMMANDS: &[Row] = &[
    Row::new(Command::NEXT_LAYOUT, "Side by side, or a line", State::next_layout)
        .what("Compared sequences: side by side, or split by a line")
        .also(&["swipe", "split view", "layout", "dual view"])
        .keys(group::VIEW, "Shift+C", &[Chord::shift(Key::C)])
        .applies(|state| match state.features.beside {
            Some(_) => Ok(()),
            None => Err("One sequence is open: File, Compare with… opens another next to it"),
        }),
    Row::new(Command::COMPARE_FILES, "Compare with files…", |state| {
        let dialog = Dialog::files("Compare with point clouds", State::compare_paths);
        state.ask(of_point_clouds(dialog));
    })
    .what("Compare with files…")
    .also(&["diff", "side by side", "second cloud"])
    .keys(group::FILE, "Ctrl+Shift+O", &[Chord::ctrl_shift(Key::O)])
    .applies(needs_sequence),
    Row::new(Command::COMPARE_FOLDER, "Compare with a folder…", |state| {
        state.ask(Dialog::folder(
            "Compare with a folder of frames",
            |state: &mut State, folder| {
                state.compare_paths(vec![folder]);
            },
        ));
    })
    .what("Compare with a folder…")
    .also(&["diff", "side by side"])
    .applies(needs_sequence),
    Row::new(Command::CLOSE_COMPARISON, "Close comparison", |state| {
        state.opening.opened.compared = None;
        state.close_beside();
        state.end_comparison(Side::A);
    })
    .applies(|state| match state.pictures() {
        Some(_) => Ok(()),
        None => Err("Nothing is compared"),
    }),
];

impl Feature<State> for FeatureOf<Option<Beside>> {
    fn save(&self, state: &State, document: &mut Document) {
        let wanted = || state.opening.opened.compared.clone();
        document.compare = state.compared().or_else(wanted);
    }

    fn next_deadline(&self, state: &State) -> Option<Duration> {
        let beside = state.features.beside.as_ref();
        beside.and_then(|beside| beside.drawing.next_deadline())
    }

    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|distances: Option<FrameDistances>| {
            if let (Some(beside), Some(distances)) = (&mut state.features.beside, distances) {
                beside.take_in(distances);
            }
        })
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow {
            id: None,
            menu: None,
            also: &[],
            place: Dock::Top("beside", |state: &State| state.features.beside.is_some()),
            show: bar,
        }];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

fn bar(ui: &mut Ui, state: &mut State) {
    if let (Some(beside), Some(player)) = (&mut state.features.beside, &state.player) {
        match beside_ui(ui, beside, player) {
            Some(BesideRequest::Measure) => state.measure_distances(),
            Some(BesideRequest::Close) => state.run(Command::CLOSE_COMPARISON),
            None => {}
        }
    }
}
