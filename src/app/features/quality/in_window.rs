//! Render mode chosen by its measured time and error, or restored with a session. The renderer and the pixel count are
//! not part of a document; such a mode's are used for the open sequence alone, and are reset with the next.

use super::MeasuredQuality;
use super::panel::{QualityRequest, quality_ui};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::settings_row::{NamedRow, SettingsPart, SettingsRow};
use crate::app::side::Side;
use crate::app::state::{MeasuredWay, State};
use crate::bench::suites;
use crate::scene::Settings;
use egui::Ui;

impl State {
    /// Draws the open sequence with the mode `way`, which was measured with it.
    pub fn draw_as_measured(&mut self, way: &Settings) {
        let before = self.usual_style(self.style);
        self.draw_as(way);
        let chosen = self.style;
        self.opening.measured_way = Some(MeasuredWay { before, chosen });
    }

    /// Settings as they are for other sequences.
    pub(in crate::app) fn usual_style(&self, style: Settings) -> Settings {
        self.opening.measured_way.map_or(style, |way| way.undone(style))
    }

    /// Returns the settings, or A's where two render modes are compared.
    pub(in crate::app) fn style_of_a(&self) -> Settings {
        let comparison = self.features.comparison.as_ref();
        let of_a = comparison.filter(|comparison| comparison.edited == Side::B);
        of_a.map_or(self.style, |comparison| comparison.other)
    }
}

impl Feature<State> for FeatureOf<MeasuredQuality> {
    /// Reads earlier measurements of the open sequence.
    fn update(&self, state: &mut State) -> bool {
        let Some(player) = &state.player else {
            return false;
        };
        state.features.quality.look(&state.graphics.adapter, player.sequence())
    }

    fn forget_sequence(&self, state: &mut State) {
        state.opening.measured_way = None;
        state.features.quality.forget();
    }

    fn settings(&self) -> &'static [SettingsRow<State>] {
        const SETTINGS: &[SettingsRow<State>] = &[SettingsRow {
            part: SettingsPart::Advanced,
            rank: 0,
            named: &[NamedRow {
                title: "Quality",
                text: "Quality: benchmark render modes…",
                hint: "Benchmarks all render modes and picks the fastest within an error limit",
                also: &[
                    "automatic quality",
                    "performance",
                    "fast",
                    "level of detail",
                    "optimize",
                ],
            }],
            show: quality,
        }];
        SETTINGS
    }
}

/// From fast to exact.
fn quality(ui: &mut Ui, state: &mut State) {
    if state.player.is_none() {
        return;
    }
    match quality_ui(ui, &mut state.features.quality, &state.style) {
        Some(QualityRequest::Measure) => state.start_default_benchmark(suites::ERROR),
        Some(QualityRequest::DrawAs(way)) => state.draw_as_measured(&way),
        None => {}
    }
}
