//! Second sequence for comparison next to the open one: opening and closing it, its images, its fraction of the memory.

use super::FrameDistances;
use super::panel::{SplitViewRequest, split_view_ui};
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group, needs_sequence, of_point_clouds};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::features::split_view::{Layout, SplitView};
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
use crate::messages::grouped;
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
        let split_view = self.features.split_view.as_ref()?;
        let companion = &split_view.companion;
        // Without alternatives, the user made no choice.
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
            layout: match split_view.layout {
                Layout::SideBySide => ComparedLayout::SideBySide,
                Layout::Wipe => ComparedLayout::Line,
            },
            line: (1e4 * f64::from(split_view.pictures.split)).round() / 1e4,
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
        let before = self.features.split_view.as_ref();
        let laid_out = before.map(|before| (before.layout, before.pictures.split));
        self.close_split_view();
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
        let mut split_view = SplitView::new(companion, name);
        if let Some((layout, split)) = laid_out {
            split_view.pictures.split = split;
            split_view.lay_out(layout);
        }
        self.features.split_view = Some(split_view);
        self.share_budget();
    }

    /// Finds the frames of `inputs` on a thread and shows them next to the open sequence for comparison.
    pub fn compare_paths(&mut self, inputs: Vec<PathBuf>) {
        self.find(inputs, self.shared.options.open.clone(), Side::B);
    }

    /// Reopens the compared recording next to the open sequence, with the point clouds of another topic.
    pub fn compare_topic(&mut self, topic: &str) {
        if let Some(split_view) = &self.features.split_view {
            let inputs = split_view.companion.sequence().source().inputs().to_vec();
            let topic = Some(topic.into());
            let open = self.shared.options.open.clone();
            self.find(inputs, OpenOptions { topic, ..open }, Side::B);
        }
    }

    /// Shows the open sequence alone. Its memory is all its own again.
    pub(in crate::app) fn close_split_view(&mut self) {
        if let Some(split_view) = self.features.split_view.take() {
            // Its threads end after the frame they are working on; nothing waits for that here.
            close(split_view);
            self.features.inspection.forget_points_of_b();
            self.share_budget();
        }
    }

    /// Side by side, or one over the other.
    pub(in crate::app) fn next_layout(&mut self) {
        match &mut self.features.split_view {
            Some(split_view) => {
                let layout = match split_view.layout {
                    Layout::SideBySide => Layout::Wipe,
                    Layout::Wipe => Layout::SideBySide,
                };
                split_view.lay_out(layout);
            }
            None => self
                .notices
                .hint("One sequence is open: File, Compare with… opens another next to it"),
        }
    }

    /// Records that the first of two images changed.
    pub(in crate::app) fn note_picture(&mut self) {
        if let Some(split_view) = &mut self.features.split_view {
            split_view.note_change(self.shared.now);
        }
        if let Some(comparison) = &mut self.features.comparison {
            comparison.pictures.note_change(self.shared.now);
        }
    }

    /// Measures the distances of the two shown frames.
    pub(in crate::app) fn measure_distances(&mut self) {
        if let (Some(split_view), Some(player)) = (&mut self.features.split_view, &self.player) {
            split_view.measure(player, &self.shared.tasks);
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

    /// Divides the memory between the open sequences.
    pub(in crate::app) fn share_budget(&self) {
        let whole = self.budget_bytes();
        let [a, b] = match self.features.split_view {
            Some(_) => Companion::shares(whole),
            None => [whole, 0],
        };
        if let Some(player) = &self.player {
            player.loader().set_budget_bytes(a);
        }
        if let Some(split_view) = &self.features.split_view {
            split_view.companion.loader().set_budget_bytes(b);
        }
    }

    /// Applies changes of the other sequence. True if they are visible.
    pub(in crate::app) fn follow_second(&mut self, change: PlayerChange) -> bool {
        let (Some(split_view), Some(player)) = (&mut self.features.split_view, &self.player) else {
            return false;
        };
        let sequence = split_view.companion.sequence();
        if let Some(failure) = change.new_failure {
            let [place, count] = [failure.index() + 1, sequence.len()].map(grouped);
            let name = &split_view.name;
            self.notices
                .error(format!("Frame {place} of {count} of B ({name}) is skipped. {failure}"));
        }
        for warning in change.new_warnings {
            self.notices.warn(format!("B: {warning}"));
        }
        if let Some(frame) = split_view.companion.shown() {
            self.features.inspection.follow(Side::B, frame, sequence.origin());
        }
        if let Some(gap) = split_view.take_gap(player) {
            let a = name_of(player.sequence()).unwrap_or_default();
            self.notices.warn(format!(
                "B ({}) is {} away from A ({a}): both are drawn where their files say. R shows both; \
                 `pointreel convert --transform` moves the points of one",
                split_view.name,
                significant(gap),
            ));
        }
        change.visible
    }

    /// The box around the shown frame of the other sequence, relative to the origin of the open one; empty without any.
    pub(in crate::app) fn second_bounds(&self) -> Aabb {
        let (Some(split_view), Some(player)) = (&self.features.split_view, &self.player) else {
            return Aabb::EMPTY;
        };
        let Some(frame) = split_view.companion.shown() else {
            return Aabb::EMPTY;
        };
        let shift = split_view.shift_from(player).as_vec3();
        let Aabb { min, max } = frame.frame.bounds();
        Aabb {
            min: min + shift,
            max: max + shift,
        }
    }

    /// The packet of the other sequence, if it differs from the last one.
    pub(in crate::app) fn next_packet_second(&mut self) -> Option<ScenePacket> {
        let style = self.drawn_style();
        let split_view = self.features.split_view.as_mut()?;
        let Some(frame) = split_view.companion.shown() else {
            split_view.pictures.forget_difference();
            return None;
        };
        if self.viewport.other_size_px.contains(&0) {
            return None;
        }
        let view = PictureView {
            camera: &self.camera,
            origin: split_view.companion.sequence().origin(),
            size_px: self.viewport.other_size_px,
        };
        let composed = Composed::of(Arc::clone(frame));
        let packet = split_view
            .drawing
            .next_packet(composed, &view, &style, self.shared.now)?;
        split_view.note_change(self.shared.now);
        Some(packet)
    }

    /// Returns true if all visible images have been drawn from frames that are due.
    pub(in crate::app) fn is_drawn(&self) -> bool {
        let is_drawn = |split_view: &SplitView| {
            split_view.companion.waiting_for().is_none()
                && (split_view.drawing.is_drawn() || split_view.companion.shown().is_none())
        };
        self.main.drawing.is_drawn() && self.features.split_view.as_ref().is_none_or(is_drawn)
    }

    /// Composes both visible images into one: side by side, or on both sides of the line. The first one alone if there
    /// is no other sequence, or no frame of it. With the labels that are in the window.
    pub fn joined(&self, a: RgbaImage, b: Option<RgbaImage>) -> RgbaImage {
        let Some((split_view, b)) = self.features.split_view.as_ref().zip(b) else {
            return self.with_labels(a);
        };
        if split_view.companion.shown().is_none() {
            return self.with_labels(a);
        }
        match split_view.layout {
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
                let line = (split_view.pictures.split * width as f32).round() as u32;
                let right = imageops::crop_imm(&b, line, 0, width - line, b.height());
                imageops::replace(&mut joined, &right.to_image(), i64::from(line), 0);
                self.with_labels(joined)
            }
        }
    }
}

impl SplitView {
    /// Lays both out, and pairs their frames, as in a document.
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
        .applies(|state| match state.features.split_view {
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
        state.close_split_view();
        state.end_comparison(Side::A);
    })
    .applies(|state| match state.pictures() {
        Some(_) => Ok(()),
        None => Err("Nothing is compared"),
    }),
];

impl Feature<State> for FeatureOf<Option<SplitView>> {
    fn save(&self, state: &State, document: &mut Document) {
        let wanted = || state.opening.opened.compared.clone();
        document.compare = state.compared().or_else(wanted);
    }

    fn next_deadline(&self, state: &State) -> Option<Duration> {
        let split_view = state.features.split_view.as_ref();
        split_view.and_then(|split_view| split_view.drawing.next_deadline())
    }

    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|distances: Option<FrameDistances>| {
            if let (Some(split_view), Some(distances)) = (&mut state.features.split_view, distances) {
                split_view.take_in(distances);
            }
        })
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow {
            id: None,
            menu: None,
            also: &[],
            place: Dock::Top("split view", |state: &State| state.features.split_view.is_some()),
            show: bar,
        }];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

fn bar(ui: &mut Ui, state: &mut State) {
    if let (Some(split_view), Some(player)) = (&mut state.features.split_view, &state.player) {
        match split_view_ui(ui, split_view, player) {
            Some(SplitViewRequest::Measure) => state.measure_distances(),
            Some(SplitViewRequest::Close) => state.run(Command::CLOSE_COMPARISON),
            None => {}
        }
    }
}
