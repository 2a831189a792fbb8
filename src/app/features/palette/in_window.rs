//! Commands by their names, in the window.

use super::panel::palette_ui;
use super::{Action, Palette};
use crate::app::features::feature::Feature;
use crate::app::panel_row::{Dock, PanelRow};
use crate::app::panels::without_keys;
use crate::app::presets::built_in;
use crate::app::state::State;
use crate::app::widgets::sought::seek;
use crate::app::{Benchmark, PanelId};
use egui::Ui;

impl Feature<State> for Option<Palette> {
    fn escape(state: &mut State) -> bool {
        state.features.palette.take().is_some()
    }

    fn panels() -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow {
            id: None,
            menu: None,
            place: Dock::Over,
            show: palette,
        }];
        PANELS
    }
}

/// The list of all that can be asked for.
fn palette(ui: &mut Ui, state: &mut State) {
    if state.features.palette.is_none() {
        return;
    }
    let more = without_keys();
    let presets = state.kept.presets.list().iter();
    let presets: Vec<String> = presets.map(|preset| preset.name.clone()).collect();
    let Some(action) = palette_ui(ui, &mut state.features.palette, &presets, &more) else {
        return;
    };
    match action {
        Action::Run(command) => state.run(command),
        Action::Set(key, value) => state
            .style
            .edit(&mut |described, before| if described.key == key { value } else { before }),
        Action::Take(shorthand) => state.style.take(shorthand),
        Action::BuiltIn(place) => {
            if let Some((.., style)) = built_in().get(place) {
                state.draw_as(style);
            }
        }
        Action::Preset(place) => {
            if let Some(preset) = state.kept.presets.list().get(place) {
                state.style = preset.settings;
            }
        }
        Action::Measure(suite) => {
            if !matches!(state.features.benchmark, Benchmark::Running(_)) {
                state.start_benchmark(suite);
            }
        }
        Action::ShowSetting(title) => {
            state.panels.set(PanelId::SETTINGS, true);
            seek(ui.ctx(), title);
        }
    }
}
