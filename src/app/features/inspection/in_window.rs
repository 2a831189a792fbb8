//! Points that were clicked on, and measurements, in the window.

use super::marks::paint_inspection;
use super::measuring::Measurement;
use super::measuring_panel::measuring_ui;
use super::point_panel::{PointContext, point_ui};
use super::{Inspection, Tool};
use crate::app::command::{Chord, Command, Menu};
use crate::app::commands::common::{Row, group};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::features::trails::panel::trail_ui;
use crate::app::panel_row::PanelRow;
use crate::app::side::Side;
use crate::app::state::State;
use crate::app::widgets::overlay::PictureOverlay;
use crate::document::Document;
use crate::playback::Player;
use crate::scene::Pick;
use crate::sequence::PreparedFrame;
use egui::Key;
use egui::{Pos2, Ui};
use std::sync::Arc;

const COMMANDS: &[Row] = &[
    Row::new(Command::PICK_POINTS, "Point values", |state| {
        state.features.inspection.toggle(Tool::Point);
    })
    .what("Point values: show on click")
    .also(&[
        "pick",
        "query",
        "probe",
        "inspect",
        "info",
        "coordinates",
        "attributes",
        "select point",
    ])
    .hint("A click on a point shows all of its attributes")
    .keys(group::POINTS, "I", &[Chord::plain(Key::I)])
    .in_menu(Menu::Tools)
    .on_if(|state| state.features.inspection.tool == Tool::Point),
    Row::new(Command::MEASURE, "Measure", |state| {
        state.features.inspection.toggle(Tool::Measure);
    })
    .hint("Clicks on points measure distances, angles and heights")
    .also(&["ruler", "distance", "angle", "height", "length", "dimension", "tape"])
    .keys(group::POINTS, "M", &[Chord::plain(Key::M)])
    .in_menu(Menu::Tools)
    .on_if(|state| state.features.inspection.tool == Tool::Measure),
];

impl Feature<State> for FeatureOf<Inspection> {
    fn follow_frame(&self, state: &mut State) -> bool {
        if let Some(player) = &state.player
            && let Some(frame) = player.shown()
        {
            let origin = player.sequence().origin();
            state.features.inspection.follow(Side::A, frame, origin);
        }
        false
    }

    fn shows_frame(&self, state: &State) -> bool {
        state.features.inspection.picked().next().is_some()
    }

    fn forget_sequence(&self, state: &mut State) {
        state.features.inspection.forget_points();
    }

    fn save(&self, state: &State, document: &mut Document) {
        let measurements = state.features.inspection.measurements.iter();
        document.measurements.clear();
        document
            .measurements
            .extend(measurements.filter_map(Measurement::measured));
    }

    fn load(&self, state: &mut State, document: &Document) {
        state.features.inspection.show_measured(&document.measurements);
    }

    fn paint(&self, state: &State, canvas: &PictureOverlay<'_>, _is_first: bool) {
        paint_inspection(canvas, &state.features.inspection, state.length_unit());
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow::by_itself(point), PanelRow::by_itself(measuring)];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

fn point(ui: &mut Ui, state: &mut State) {
    let index_in_file = state
        .features
        .inspection
        .point
        .as_ref()
        .map(|point| point.values.index_in_file);
    let trail = state.player.as_ref().and_then(|player| {
        let time_s = |frame| player.time_s(frame);
        state.features.trails.measure(index_in_file?, time_s)
    });
    let names = state.features.split_view.as_ref().map(|split_view| {
        let name = state.sequence_name().unwrap_or_default();
        [name, split_view.name.clone()]
    });
    let side = state.features.inspection.point.as_ref().map(|point| point.anchor.side);
    let sequence = match (side, &state.features.split_view) {
        (Some(Side::B), Some(split_view)) => Some(split_view.companion.sequence()),
        _ => state.player.as_ref().map(Player::sequence),
    };
    let frame_count = sequence.map_or(0, |sequence| sequence.len());
    let context = PointContext {
        camera: &state.camera,
        names,
        trail,
        frame_count,
        unit: state.length_unit(),
    };
    let corner = state.viewport.rect.left_top();
    let trails = &mut state.features.trails;
    point_ui(ui, &mut state.features.inspection, &context, corner, |ui, anchor| {
        trail_ui(ui, trails, anchor);
    });
}

fn measuring(ui: &mut Ui, state: &mut State) {
    let up = state.camera.up.direction();
    let corner = state.viewport.rect.left_bottom();
    let unit = state.length_unit();
    measuring_ui(ui, &mut state.features.inspection, up, unit, corner);
}

impl State {
    /// The point under a place of the window, the frame that it is of, and the sequence of that, as they were drawn
    /// last.
    pub(in crate::app) fn point_at(&self, place: Pos2) -> Option<(Pick, Arc<PreparedFrame>, Side)> {
        let [rect, other_rect] = [self.viewport.rect, self.viewport.other_rect];
        let split_view = self.features.split_view.as_ref();
        let of_b = split_view.filter(|split_view| split_view.is_of_b(place, [rect, other_rect]));
        let (found, side) = match of_b {
            // Without a current frame, the previous one is not visible.
            Some(split_view) => {
                split_view.companion.shown()?;
                (split_view.drawing.point_at(place, other_rect), Side::B)
            }
            None => (self.main.drawing.point_at(place, rect), Side::A),
        };
        found.map(|(pick, frame)| (pick, frame, side))
    }

    /// Gives the point under a place of the window to the chosen tool; nothing if there is none.
    pub fn click_at(&mut self, place: Pos2) {
        if self.features.inspection.tool == Tool::Camera {
            return;
        }
        if let Some((pick, frame, side)) = self.point_at(place) {
            if self.features.inspection.tool == Tool::Label {
                return self.put_label(side, &pick, &frame);
            }
            self.features.inspection.take(side, pick, &frame);
        }
    }
}
