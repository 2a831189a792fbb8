//! A section of the panel of settings that is of a feature.

use egui::Ui;

/// A section of the panel of settings of a window whose state is `S`.
#[derive(Debug)]
pub(in crate::app) struct SettingsRow<S> {
    pub(in crate::app) part: SettingsPart,
    /// From above, among the sections of the same part.
    pub(in crate::app) rank: u8,
    pub(in crate::app) show: fn(&mut Ui, &mut S),
}

/// Parts of the panel that have sections of features.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum SettingsPart {
    /// How the sequence goes on.
    Time,
    /// What of the cloud is drawn.
    Clip,
    /// The rest, which opens as it was left.
    Advanced,
}
