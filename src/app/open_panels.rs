//! Panel visibility: the open panels.

use super::widgets::tool_window::tool_id;
use egui::{Context, Id};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// A panel or window that a user opens and closes, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct PanelId(&'static str);

impl PanelId {
    /// The settings at the right.
    pub const SETTINGS: Self = Self("settings");
    /// The statistics at the left.
    pub const STATISTICS: Self = Self("statistics");
    /// Colour legend, over the image.
    pub const LEGEND: Self = Self("legend");
    /// The list of keys.
    pub const HELP: Self = Self("help");
    /// The start dialog of a benchmark.
    pub const BENCHMARK_SETUP: Self = Self("benchmark setup");
    /// The benchmark window.
    pub const BENCHMARK: Self = Self("benchmark");
    /// The camera path.
    pub const CAMERA_PATH: Self = Self("camera path");
    /// Export panel.
    pub const EXPORT: Self = Self("export");
    /// About panel: the program, and where it runs.
    pub const ABOUT: Self = Self("about");
    /// Settings for saving the sequence.
    pub const SAVE: Self = Self("save");

    /// Its name.
    pub(super) const fn name(self) -> &'static str {
        self.0
    }

    /// A panel that only its row names.
    pub const fn new(name: &'static str) -> Self {
        Self(name)
    }
}

/// The panels that are open.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenPanels {
    open: BTreeSet<PanelId>,
    /// Windows over the image in the last pass, the topmost last.
    windows: Vec<PanelId>,
}

impl OpenPanels {
    /// Returns true if `panel` is open.
    pub fn has(&self, panel: PanelId) -> bool {
        self.open.contains(&panel)
    }

    /// Opens `panel`, or closes it.
    pub fn set(&mut self, panel: PanelId, is_open: bool) {
        if is_open {
            self.open.insert(panel);
        } else {
            self.open.remove(&panel);
        }
    }

    /// Opens `panel`, or closes it if it is open.
    pub fn toggle(&mut self, panel: PanelId) {
        self.set(panel, !self.has(panel));
    }

    /// Looks which of them are windows, and in which order they lie over each other. Call after the panels.
    pub(super) fn note_order(&mut self, ctx: &Context) {
        let of_layer = |id: Id| self.open.iter().copied().find(|panel| tool_id(ctx, panel.name()) == id);
        self.windows = ctx.memory(|memory| memory.layer_ids().filter_map(|layer| of_layer(layer.id)).collect());
    }

    /// Closes the window that lies over all others; false if there is none.
    pub(super) fn close_topmost(&mut self) -> bool {
        let topmost = std::iter::from_fn(|| self.windows.pop()).find(|panel| self.open.contains(panel));
        topmost.is_some_and(|panel| self.open.remove(&panel))
    }

    /// Those that are remembered.
    pub fn remembered(&self) -> RememberedPanels {
        RememberedPanels {
            settings: self.has(PanelId::SETTINGS),
            statistics: self.has(PanelId::STATISTICS),
            legend: self.has(PanelId::LEGEND),
        }
    }
}

impl From<RememberedPanels> for OpenPanels {
    fn from(remembered: RememberedPanels) -> Self {
        let mut open = Self {
            open: BTreeSet::new(),
            windows: Vec::new(),
        };
        open.set(PanelId::SETTINGS, remembered.settings);
        open.set(PanelId::STATISTICS, remembered.statistics);
        open.set(PanelId::LEGEND, remembered.legend);
        open
    }
}

/// The panels in the file of settings; windows above them are not remembered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct RememberedPanels {
    /// The settings at the right.
    #[serde(rename = "settings_panel")]
    pub settings: bool,
    /// The statistics at the left.
    #[serde(rename = "statistics_panel")]
    pub statistics: bool,
    /// Visibility of the colour legend, over the image.
    pub legend: bool,
}

impl Default for RememberedPanels {
    fn default() -> Self {
        Self {
            settings: true,
            statistics: false,
            legend: true,
        }
    }
}
