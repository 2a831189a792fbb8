//! Two render modes in the window: their bar, and when their images are compared.

use super::PicturePair;
use super::panel::{ComparisonRequest, comparison_ui};
use super::{Comparison, PictureDifference};
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::panel_row::{Dock, PanelRow};
use crate::app::side::Side;
use crate::app::state::{State, WindowRequest};
use crate::app::work::outcome::Outcome;
use egui::Key;
use egui::Ui;
use std::time::Duration;

const COMMANDS: &[Row] = &[
    Row::new(Command::TOGGLE_COMPARISON, "Compare A/B", State::toggle_comparison)
        .what("Compare A/B: two render modes")
        .also(&["split screen", "diff", "side by side", "before and after"])
        .keys(group::VIEW, "C", &[Chord::plain(Key::C)])
        .on_if(|state| state.features.comparison.is_some()),
];

impl Feature<State> for FeatureOf<Option<Comparison>> {
    /// Updates the comparison, of two sequences as well.
    fn update(&self, state: &mut State) -> bool {
        let now = state.now();
        let is_due = state.pictures_mut().is_some_and(|pair| pair.is_due(now));
        if is_due {
            state.request(WindowRequest::Compare);
        }
        is_due
    }

    fn next_deadline(&self, state: &State) -> Option<Duration> {
        state.pictures().and_then(PicturePair::next_deadline)
    }

    fn shows_frame(&self, state: &State) -> bool {
        state.pictures().is_some()
    }

    fn take(&self, state: &mut State, outcome: Outcome) -> Result<(), Outcome> {
        outcome.give(|difference: PictureDifference| {
            if let Some(pictures) = state.pictures_mut() {
                pictures.take_in(difference);
            }
        })
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow {
            id: None,
            menu: None,
            also: &[],
            place: Dock::Top("comparison", |state: &State| state.features.comparison.is_some()),
            show: bar,
        }];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

fn bar(ui: &mut Ui, state: &mut State) {
    if let Some(comparison) = &mut state.features.comparison {
        match comparison_ui(ui, comparison) {
            Some(ComparisonRequest::Edit(side)) => state.edit_side(side),
            Some(ComparisonRequest::Use(side)) => state.end_comparison(side),
            None => {}
        }
    }
}

impl State {
    pub(in crate::app) fn toggle_comparison(&mut self) {
        if self.features.split_view.is_some() {
            let text = "Two sequences are compared: File, Close comparison ends that";
            return self.notices.hint(text);
        }
        if self.features.comparison.is_some() {
            self.end_comparison(Side::A);
        } else {
            self.features.comparison = Some(Comparison::new(self.style));
        }
    }

    /// Back to one image, drawn as `side` was.
    pub(in crate::app) fn end_comparison(&mut self, side: Side) {
        self.edit_side(side);
        self.features.comparison = None;
    }

    /// Selects the side, of two compared render modes, to which the settings apply from now on.
    pub(in crate::app) fn edit_side(&mut self, side: Side) {
        if let Some(comparison) = self
            .features
            .comparison
            .as_mut()
            .filter(|comparison| comparison.edited != side)
        {
            comparison.edited = side;
            std::mem::swap(&mut comparison.other, &mut self.style);
        }
    }

    /// Compares the image of the window's settings, or of the open sequence, with the other one.
    pub fn compare_pictures(&self, edited: image::RgbaImage, other: image::RgbaImage) {
        let edited_side = self.features.comparison.as_ref().map(|comparison| comparison.edited);
        let pair = match edited_side {
            Some(Side::B) => [other, edited],
            Some(Side::A) | None => [edited, other],
        };
        if let Some(pictures) = self.pictures() {
            pictures.compare(pair, &self.shared.tasks);
        }
    }

    /// Returns the two images next to each other, if there are two.
    pub fn pictures(&self) -> Option<&PicturePair> {
        let split_view = self.features.split_view.as_ref().map(|split_view| &split_view.pictures);
        let comparison = self.features.comparison.as_ref();
        split_view.or(comparison.map(|comparison| &comparison.pictures))
    }

    pub(in crate::app) fn pictures_mut(&mut self) -> Option<&mut PicturePair> {
        let split_view = self
            .features
            .split_view
            .as_mut()
            .map(|split_view| &mut split_view.pictures);
        let comparison = self.features.comparison.as_mut();
        split_view.or(comparison.map(|comparison| &mut comparison.pictures))
    }
}
