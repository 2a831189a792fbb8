//! How the window looks, the picture and the panels aside.

use super::preferences::Preferences;
use super::present_choice::PresentChoice;
use egui::{Rect, ThemePreference, pos2};

/// How the window looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appearance {
    /// Whether it is light or dark.
    pub theme: ThemePreference,
    /// Who paints it.
    pub present: PresentChoice,
    /// Whether the picture has a scale bar.
    pub shows_scale_bar: bool,
    /// True while it fills the screen.
    pub full_screen: bool,
    /// Whether the settings that few have a use for are shown.
    pub shows_advanced: bool,
    /// Where the window of benchmarks was left, points.
    pub benchmark_place: Option<Rect>,
}

impl Appearance {
    /// As it was left.
    pub(super) fn of(preferences: &Preferences) -> Self {
        Self {
            theme: preferences.theme,
            present: preferences.present,
            shows_scale_bar: preferences.scale_bar,
            full_screen: false,
            shows_advanced: preferences.advanced,
            benchmark_place: preferences
                .benchmark_place
                .map(|[left, top, right, bottom]| Rect::from_min_max(pos2(left, top), pos2(right, bottom))),
        }
    }
}
