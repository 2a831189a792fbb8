//! A section of the panel of settings that is of a feature.

use egui::Ui;

/// A section of the panel of settings of a window whose state is `S`.
#[derive(Debug)]
pub(in crate::app) struct SettingsRow<S> {
    pub(in crate::app) part: SettingsPart,
    /// From above, among the sections of the same part.
    pub(in crate::app) rank: u8,
    /// Its rows that the palette finds.
    pub(in crate::app) named: &'static [NamedRow],
    pub(in crate::app) show: fn(&mut Ui, &mut S),
}

/// A row of the panel of settings that the palette brings into view.
#[derive(Debug)]
pub(in crate::app) struct NamedRow {
    /// Its label in the panel.
    pub(in crate::app) title: &'static str,
    /// Its entry in the palette.
    pub(in crate::app) text: &'static str,
    /// A sentence about it.
    pub(in crate::app) hint: &'static str,
    /// Words of people and of other programs that find it.
    pub(in crate::app) also: &'static [&'static str],
}

/// Parts of the panel that have sections of features.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::app) enum SettingsPart {
    /// Playback of the sequence.
    Time,
    /// Clipping: the part of the cloud that is drawn.
    Clip,
    /// The rest, which opens as it was left.
    Advanced,
}
