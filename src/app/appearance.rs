//! How the window looks, the picture and the panels aside.

use super::preferences::Preferences;
use super::present_choice::PresentChoice;
use egui::ThemePreference;

/// How the window looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Appearance {
    /// Whether it is light or dark.
    pub theme: ThemePreference,
    /// Who paints it.
    pub present: PresentChoice,
    /// Whether the picture has a scale bar.
    pub shows_scale_bar: bool,
    /// True while it fills the screen.
    pub full_screen: bool,
}

impl Appearance {
    /// As it was left.
    pub(super) fn of(preferences: &Preferences) -> Self {
        Self {
            theme: preferences.theme,
            present: preferences.present,
            shows_scale_bar: preferences.scale_bar,
            full_screen: false,
        }
    }
}
