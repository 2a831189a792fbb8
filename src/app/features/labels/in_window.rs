//! Labels in the window: put by clicks, followed, shown.

use super::Labels;
use super::marks::paint_labels;
use super::panel::{LabelsRequest, PANEL, labels_ui};
use crate::app::command::{Chord, Command, Menu};
use crate::app::commands::common::{Row, group};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::features::inspection::Tool;
use crate::app::panel_row::PanelRow;
use crate::app::side::Side;
use crate::app::state::State;
use crate::app::widgets::overlay::PictureOverlay;
use crate::document::Document;
use crate::export::draw_labels;
use crate::playback::Player;
use crate::scene::{Camera, FollowedPoint, Label, LabelOnPicture, Pick};
use crate::sequence::PreparedFrame;
use crate::timeline::PlayRange;
use egui::Key;
use egui::Ui;
use image::RgbaImage;
use std::sync::Arc;

impl State {
    /// Puts a label at a point of `frame`, which is of the sequence `side`.
    pub(in crate::app) fn put_label(&mut self, side: Side, pick: &Pick, frame: &PreparedFrame) {
        if side == Side::B {
            let text = "Labels are put at points of the open sequence, not of the compared one";
            return self.notices.hint(text);
        }
        let label = Label {
            text: String::new(),
            frame: pick.frame,
            point: Some(FollowedPoint {
                index_in_file: pick.index_in_file,
                points_in_file: Some(frame.frame.points_in_file()),
            }),
            place: Some(pick.position),
            frames: PlayRange::default(),
        };
        if !self.features.labels.put(label) {
            return self.notices.warn("There are 1000 labels: delete one first");
        }
        self.panels.set(PANEL, true);
    }

    /// Starts or ends label mode, in which clicks place labels, with the list next to the image.
    fn toggle_label_tool(&mut self) {
        self.features.inspection.toggle(Tool::Label);
        if self.features.inspection.tool == Tool::Label {
            self.panels.set(PANEL, true);
        }
    }

    /// Updates the positions of labels in the shown frame, and their occlusion. True if the next image may hide others.
    pub(in crate::app) fn follow_labels(&mut self) -> bool {
        let Some((player, frame)) = self.player.as_ref().and_then(|player| Some((player, player.shown()?))) else {
            return false;
        };
        self.features.labels.follow(frame, player.sequence().origin());
        if !self.features.labels.are_shown() {
            return false;
        }
        let (drawing, camera) = (&self.main.drawing, &self.camera);
        let picture = self.shared.counters.pictures;
        self.features
            .labels
            .note_hidden(picture, camera, |places| drawing.hides(camera, places))
    }

    /// An image of the open sequence with the labels of the window.
    pub(in crate::app) fn with_labels(&self, mut picture: RgbaImage) -> RgbaImage {
        let size_px = picture.dimensions().into();
        let shown = self.features.labels.in_picture().into_iter().enumerate();
        let on_picture = shown.filter_map(|(label, (place, text, is_hidden))| {
            let px = self.camera.to_px(place, size_px)?;
            Some((LabelOnPicture { label, px, is_hidden }, text.to_owned()))
        });
        draw_labels(&mut picture, &on_picture.collect::<Vec<_>>());
        picture
    }

    /// Shows a label: its frame, with its position at the centre of the image.
    pub(in crate::app) fn go_to_label(&mut self, index: usize) {
        let Some(label) = self.features.labels.list.get(index) else {
            return;
        };
        let (first, last) = (label.frames.first().unwrap_or(0), label.frames.last());
        let own = label.frame.max(first).min(last.unwrap_or(usize::MAX));
        let shown = self.player.as_ref().and_then(Player::shown);
        let is_shown = shown.is_some_and(|frame| label.is_in_frame(frame.index));
        let place = self.features.labels.place(index);
        if !is_shown {
            self.play_with(|player, now| player.seek(own, now));
        }
        if let Some(target_in_world) = place {
            self.glide_to(Camera {
                target_in_world,
                ..self.camera
            });
        }
    }
}

const COMMANDS: &[Row] = &[Row::new(Command::PUT_LABELS, "Label", State::toggle_label_tool)
    .what("Put labels at points")
    .hint("Clicks put labels at points, shown in the window, in images and in videos")
    .also(&["annotate", "annotation", "text", "callout", "add label", "tag", "pin"])
    .keys(group::POINTS, "N", &[Chord::plain(Key::N)])
    .in_menu(Menu::Tools)
    .on_if(|state| state.features.inspection.tool == Tool::Label)];

impl Feature<State> for FeatureOf<Labels> {
    fn shows_frame(&self, state: &State) -> bool {
        state.features.labels.are_shown()
    }

    fn forget_sequence(&self, state: &mut State) {
        state.features.labels.forget();
    }

    fn save(&self, state: &State, document: &mut Document) {
        document.labels = Arc::clone(&state.features.labels.list);
    }

    fn load(&self, state: &mut State, document: &Document) {
        state.features.labels.take(Arc::clone(&document.labels));
    }

    /// Paints the labels; of two sequences, the first one's.
    fn paint(&self, state: &State, canvas: &PictureOverlay<'_>, is_first: bool) {
        if is_first {
            paint_labels(canvas, &state.features.labels);
        }
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] =
            &[PanelRow::in_menu(PANEL, "Labels…", labels).also(&["annotations", "list of labels", "markers"])];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

fn labels(ui: &mut Ui, state: &mut State) {
    if !state.panels.has(PANEL) {
        return;
    }
    let count = state.player.as_ref().map_or(0, |player| player.sequence().len());
    let is_placing = state.features.inspection.tool == Tool::Label;
    let corner = state.viewport.rect.right_top();
    let mut is_open = true;
    let request = labels_ui(ui, &mut is_open, &mut state.features.labels, count, is_placing, corner);
    state.panels.set(PANEL, is_open);
    match request {
        Some(LabelsRequest::ToggleTool) => state.run(Command::PUT_LABELS),
        Some(LabelsRequest::GoTo(index)) => state.go_to_label(index),
        None => {}
    }
}
