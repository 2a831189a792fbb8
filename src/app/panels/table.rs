//! The table of panels: general ones, and those of the features' own tables. They appear in the window, in the menu
//! View and in the command palette.

use super::about::about_ui;
use super::help::help_ui;
use super::notices::notices_ui;
use super::presets::preset_name_ui;
use super::question::session_question_ui;
use super::settings::settings_ui;
use super::statistics::statistics_ui;
use crate::app::features::Features;
use crate::app::features::feature::Feature;
use crate::app::panel_row::{Dock, PanelRow};
use crate::app::{PanelId, State};

/// Side panels next to the image, which are laid out first.
const SPLIT_VIEW: &[PanelRow<State>] = &[
    PanelRow {
        id: Some(PanelId::SETTINGS),
        menu: Some("Settings"),
        also: &[],
        place: Dock::Right(312.0, 280.0..=460.0),
        show: settings_ui,
    },
    PanelRow {
        id: Some(PanelId::STATISTICS),
        menu: Some("Statistics"),
        also: &[],
        place: Dock::Left(272.0, 240.0..=420.0),
        show: statistics_ui,
    },
];

/// Windows of no feature.
const WINDOWS: &[PanelRow<State>] = &[
    PanelRow::by_itself(notices_ui),
    PanelRow::window(PanelId::HELP, help_ui),
    PanelRow::window(PanelId::ABOUT, about_ui),
    PanelRow::by_itself(preset_name_ui),
    PanelRow::by_itself(session_question_ui),
];

/// All but menu and image, in the order in which they are laid out.
pub(in crate::app) fn panels() -> impl Iterator<Item = &'static PanelRow<State>> {
    let of_features = Features::rows::<State>().into_iter();
    let of_features = of_features.flat_map(Feature::panels);
    SPLIT_VIEW.iter().chain(of_features).chain(WINDOWS)
}

/// The items of the menu View.
pub(in crate::app) fn menu_panels() -> impl Iterator<Item = (&'static str, PanelId)> {
    panels().filter_map(|row| Some((row.menu?, row.id?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_have_one_row_and_those_in_the_menu_can_be_opened() {
        let panels: Vec<_> = panels().collect();
        for (index, row) in panels.iter().enumerate() {
            let others = || panels[index + 1..].iter();
            assert!(row.id.is_none() || others().all(|other| other.id != row.id));
            assert!(row.menu.is_none() || row.id.is_some(), "{:?}", row.menu);
            let is_side = matches!(row.place, Dock::Left(..) | Dock::Right(..));
            assert!(!is_side || row.id.is_some(), "a side panel is opened");
        }
    }
}
