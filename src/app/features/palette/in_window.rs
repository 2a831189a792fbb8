//! The palette in the window: its entries, from all rows that there are.

use super::entry::of_settings;
use super::panel::palette_ui;
use super::{Action, Entry, Search};
use crate::app::command::Act;
use crate::app::command::{Chord, Command};
use crate::app::commands::common::{Row, group};
use crate::app::commands::{commands, row_of};
use crate::app::features::Features;
use crate::app::features::feature::{Feature, FeatureOf};
use crate::app::features::palette::Palette;
use crate::app::open_panels::PanelId;
use crate::app::panel_row::{Dock, PanelRow};
use crate::app::panels::{own_rows, panels};
use crate::app::state::State;
use crate::app::widgets::sought::seek;
use egui::Key;
use egui::Ui;

const COMMANDS: &[Row] = &[Row::new(Command::TOGGLE_PALETTE, "Find a command…", |state| {
    let search = &mut state.features.palette.search;
    *search = match search.take() {
        Some(_) => None,
        None => Some(Search::default()),
    };
})
.what("Find a command by its name")
.keys(group::FILE, "Ctrl+P", &[Chord::ctrl(Key::P)])];

impl Feature<State> for FeatureOf<Palette> {
    fn escape(&self, state: &mut State) -> bool {
        state.features.palette.search.take().is_some()
    }

    fn panels(&self) -> &'static [PanelRow<State>] {
        const PANELS: &[PanelRow<State>] = &[PanelRow {
            id: None,
            menu: None,
            also: &[],
            place: Dock::Over,
            show: palette,
        }];
        PANELS
    }

    fn commands(&self) -> &'static [Row] {
        COMMANDS
    }
}

/// Shows the command palette.
fn palette(ui: &mut Ui, state: &mut State) {
    let Some(search) = &state.features.palette.search else {
        return;
    };
    let all = entries(state, search.number());
    let recent = state.features.palette.recent.clone();
    let Some(entry) = palette_ui(ui, &mut state.features.palette.search, all, &recent) else {
        return;
    };
    state.features.palette.remember(&entry.text);
    match entry.action {
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
        Action::Type(query) => {
            let query = query.into_owned();
            state.features.palette.search = Some(Search { query, chosen: 0 });
        }
    }
}

/// All entries, for a query with this number: commands, their offers, rows of the panel of settings, values of
/// settings, panels.
pub(super) fn entries(state: &State, number: Option<f64>) -> Vec<Entry> {
    let runs = commands().filter(|row| matches!(row.act, Act::Run(_)));
    let runs = runs.map(|row| of_row(state, row));
    let offered = commands().flat_map(|row| {
        let offers = row.offers.map_or_else(Vec::new, |offers| offers(state, number));
        let why_not = row.why_not(state);
        offers.into_iter().map(move |offer| {
            let entry = Entry::of_offer(offer, row.command);
            Entry {
                why_not: why_not.or(entry.why_not),
                ..entry
            }
        })
    });
    let of_features = Features::rows::<State>().into_iter().flat_map(Feature::settings);
    let of_features = of_features.flat_map(|row| row.named);
    let panels = panels().filter_map(|row| Some((row, row.menu?, Command::panel(row.id?))));
    let panels = panels.filter(|(_, _, command)| row_of(*command).is_none());
    let panels = panels.map(|(row, title, command)| Entry {
        also: [row.also, &[]],
        ..Entry::of_command(title, command)
    });
    let rows = own_rows().chain(of_features).map(Entry::of_row);
    runs.chain(offered)
        .chain(panels)
        .chain(rows)
        .chain(of_settings(number))
        .collect()
}

/// A command, by a name that is clear outside of its menu.
fn of_row(state: &State, row: &'static Row) -> Entry {
    let title = row.title(state);
    let (text, other_name) = if title == row.title {
        (row.what.into(), title)
    } else {
        (title, row.what.into())
    };
    Entry {
        hint: row.hint,
        keys: row.keys_text(),
        other_name,
        also: [row.synonyms, &[]],
        why_not: row.why_not(state),
        ..Entry::of_command(text, row.command)
    }
}
