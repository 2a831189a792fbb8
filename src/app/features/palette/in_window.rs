//! Commands by their names, in the window.

use super::panel::palette_ui;
use super::{Action, Entry, Palette};
use crate::app::command::Act;
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group};
use crate::app::commands::{commands, row_of};
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::open_panels::PanelId;
use crate::app::panel_row::{Dock, PanelRow};
use crate::app::panels::menu_panels;
use crate::app::state::State;
use crate::app::widgets::sought::seek;
use egui::Key;
use egui::Ui;

const COMMANDS: &[Row] = &[Row::new(Command::TOGGLE_PALETTE, "Find a command…", |state| {
    state.features.palette = match state.features.palette.take() {
        Some(_) => None,
        None => Some(Palette::default()),
    };
})
.what("Find a command by its name")
.keys(group::FILE, "Ctrl+P", &[Chord::ctrl(Key::P)])];

impl Feature<State> for FeatureOf<Option<Palette>> {
    fn escape(&self, state: &mut State) -> bool {
        state.features.palette.take().is_some()
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow {
            id: None,
            menu: None,
            place: Dock::Over,
            show: palette,
        }];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

/// The list of all that can be asked for.
fn palette(ui: &mut Ui, state: &mut State) {
    if state.features.palette.is_none() {
        return;
    }
    let commands = commands_of(state);
    let presets = state.kept.presets.list().iter();
    let presets: Vec<String> = presets.map(|preset| preset.name.clone()).collect();
    let Some(action) = palette_ui(ui, &mut state.features.palette, &presets, &commands) else {
        return;
    };
    match action {
        Action::Run(command) => state.run(command),
        Action::Set(key, value) => state
            .style
            .edit(&mut |described, before| if described.key == key { value } else { before }),
        Action::Take(shorthand) => state.style.take(shorthand),
        Action::Give(command, value) => state.give_or_tell(command, &value),
        Action::ShowSetting(title) => {
            state.panels.set(PanelId::SETTINGS, true);
            seek(ui.ctx(), title);
        }
    }
}

/// The commands that have no value, and the panels, as the palette shows them.
pub(super) fn commands_of(state: &State) -> Vec<Entry> {
    let rows = commands().filter(|row| matches!(row.act, Act::Run(_)));
    let rows = rows.map(|row| Entry {
        hint: row.hint,
        keys: row.keys_text(),
        what: row.what,
        synonyms: row.synonyms,
        why_not: row.why_not(state),
        ..Entry::of_command(row.title(state), row.command)
    });
    let panels = menu_panels().map(|(title, panel)| (title, Command::panel(panel)));
    let panels = panels.filter(|&(_, command)| row_of(command).is_none());
    rows.chain(panels.map(|(title, command)| Entry::of_command(title, command)))
        .collect()
}
