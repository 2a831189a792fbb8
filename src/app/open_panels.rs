//! Which panels are open.

/// Which panels and windows are open. In the file of settings are the panels; windows above them are not remembered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a panel that is open or not, independent of the others"
)]
pub struct OpenPanels {
    /// The settings at the right.
    #[serde(rename = "settings_panel")]
    pub settings: bool,
    /// The statistics at the left.
    #[serde(rename = "statistics_panel")]
    pub statistics: bool,
    /// What the colours mean, over the picture.
    pub legend: bool,
    /// The list of keys.
    #[serde(skip)]
    pub help: bool,
    /// The benchmark window.
    #[serde(skip)]
    pub benchmark: bool,
    /// The camera path.
    #[serde(skip)]
    pub path: bool,
    /// What is exported.
    #[serde(skip)]
    pub export: bool,
}

impl Default for OpenPanels {
    fn default() -> Self {
        Self {
            settings: true,
            statistics: false,
            legend: true,
            help: false,
            benchmark: false,
            path: false,
            export: false,
        }
    }
}
