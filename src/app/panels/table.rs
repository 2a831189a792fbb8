//! The table of panels. A new one is a file with its function, and a row here: so it is in the window, in the menu View
//! and among the commands that are found by name. A key is a row of [`BINDINGS`](crate::app::BINDINGS), if it needs
//! one.

use super::about::about_ui;
use super::bound;
use super::help::help_ui;
use super::notices::notices_ui;
use super::presets::preset_name_ui;
use super::question::{question_ui, session_question_ui};
use super::statistics::statistics_ui;
use crate::app::command::{Command, keys_of};
use crate::app::features::assumptions::panel as assumptions;
use crate::app::features::labels::panel as labels;
use crate::app::features::palette::Entry;
use crate::app::features::photos::panel as photos;
use crate::app::{PanelId, State};
use egui::Ui;
use std::ops::RangeInclusive;

/// A panel of the window.
pub(super) struct PanelRow {
    /// By what a person opens and closes it; `None` of one that comes and goes with what it is about.
    pub(super) id: Option<PanelId>,
    /// Its item of the menu View; `None` of one that is opened from elsewhere.
    pub(super) menu: Option<&'static str>,
    pub(super) place: Dock,
    /// Shows it. A window is asked in each pass, and knows whether it is open.
    pub(super) show: fn(&mut Ui, &mut State),
}

/// Where a panel is.
pub(super) enum Dock {
    /// Beside the picture, at the left; how wide at first, and how wide it can be, points.
    Left(f32, RangeInclusive<f32>),
    /// The same at the right.
    Right(f32, RangeInclusive<f32>),
    /// A window over the picture.
    Window,
}

/// All but menu, timeline, picture and the list of commands, in the order in which they are laid out.
pub(super) const PANELS: &[PanelRow] = &[
    PanelRow {
        id: Some(PanelId::SETTINGS),
        menu: Some("Settings"),
        place: Dock::Right(312.0, 280.0..=460.0),
        show: bound::settings,
    },
    PanelRow {
        id: Some(PanelId::STATISTICS),
        menu: Some("Statistics"),
        place: Dock::Left(272.0, 240.0..=420.0),
        show: statistics_ui,
    },
    by_itself(bound::point),
    by_itself(bound::measuring),
    by_itself(bound::change),
    PanelRow {
        id: Some(PanelId::CAMERA_PATH),
        menu: Some("Camera path…"),
        place: Dock::Window,
        show: bound::camera_path,
    },
    PanelRow {
        id: Some(labels::PANEL),
        menu: Some("Labels…"),
        place: Dock::Window,
        show: bound::labels,
    },
    PanelRow {
        id: Some(photos::PANEL),
        menu: Some("Photographs…"),
        place: Dock::Window,
        show: bound::photos,
    },
    PanelRow {
        id: Some(assumptions::PANEL),
        menu: Some("Assumptions…"),
        place: Dock::Window,
        show: bound::assumptions,
    },
    window(PanelId::EXPORT, bound::export),
    window(PanelId::SAVE, bound::save),
    by_itself(notices_ui),
    window(PanelId::HELP, help_ui),
    window(PanelId::ABOUT, about_ui),
    window(PanelId::BENCHMARK, bound::benchmark),
    by_itself(preset_name_ui),
    by_itself(question_ui),
    by_itself(session_question_ui),
];

/// A window that is opened from elsewhere than the menu View.
const fn window(id: PanelId, show: fn(&mut Ui, &mut State)) -> PanelRow {
    PanelRow {
        id: Some(id),
        menu: None,
        place: Dock::Window,
        show,
    }
}

/// A window that comes and goes with what it is about.
const fn by_itself(show: fn(&mut Ui, &mut State)) -> PanelRow {
    PanelRow {
        id: None,
        menu: None,
        place: Dock::Window,
        show,
    }
}

/// The items of the menu View.
pub(super) fn menu_items() -> impl Iterator<Item = (&'static str, PanelId)> {
    PANELS.iter().filter_map(|row| Some((row.menu?, row.id?)))
}

/// Panels that are found by name and have no key.
pub(super) fn without_keys() -> Vec<Entry> {
    let commands = menu_items().map(|(text, panel)| (text, Command::TogglePanel(panel)));
    let without = commands.filter(|&(_, command)| keys_of(command).is_empty());
    without
        .map(|(text, command)| Entry::of_command(text, command))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_panel_has_two_rows_and_what_is_in_the_menu_can_be_opened() {
        for (index, row) in PANELS.iter().enumerate() {
            let others = || PANELS[index + 1..].iter();
            assert!(row.id.is_none() || others().all(|other| other.id != row.id));
            assert!(row.menu.is_none() || row.id.is_some(), "{:?}", row.menu);
            let is_window = matches!(row.place, Dock::Window);
            assert!(is_window || row.id.is_some(), "a side panel is opened");
        }
    }
}
