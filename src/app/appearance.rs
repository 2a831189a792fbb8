//! Appearance of the window, except the rendered image and the panels.

use super::preferences::Preferences;
use super::present_choice::PresentChoice;
use egui::{Rect, ThemePreference, pos2};

/// Appearance of the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appearance {
    /// Light or dark theme.
    pub theme: ThemePreference,
    /// Presentation method that paints the window.
    pub present: PresentChoice,
    /// Visibility of the scale bar in the image.
    pub shows_scale_bar: bool,
    /// True while it fills the screen.
    pub full_screen: bool,
    /// Visibility of the advanced settings, which few need.
    pub shows_advanced: bool,
    /// Last position of the benchmark window, points.
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
