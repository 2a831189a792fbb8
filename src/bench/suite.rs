//! Description of a suite: all that the command line, the menu and a report show of it.

use super::report::Column;
use std::fmt;

/// Benchmark suite: one row of the table of suites, all but its loop. Two are equal when their names are.
pub struct Suite {
    /// The word for it on the command line.
    pub(crate) name: &'static str,
    /// Brief description after its name in the list of suites on the command line.
    pub(crate) brief: &'static str,
    /// Its name in the Benchmark menu.
    pub(crate) title: &'static str,
    /// Hint shown in the menu.
    pub(crate) hint: &'static str,
    /// Description in the header of a report.
    pub(crate) description: &'static str,
    /// Meaning of its numbers, and what is excluded from all of them.
    pub(crate) measured: &'static str,
    /// See [`Suite::measured`].
    pub(crate) not_measured: &'static str,
    /// Name of the primitive whose pixel coverage is reported.
    pub(crate) covered_by: &'static str,
    /// Default options of the measurement, unless overridden.
    pub(crate) defaults: Defaults,
    /// Options that it alone takes, or with a few others.
    pub(crate) takes: &'static [OptionGroup],
    /// True if it is one of the paper's suites, whose protocol then applies.
    pub(crate) is_of_paper: bool,
    /// True if a report begins with the paper's layout: one line per sequence, one column per strategy, the headline.
    pub(crate) has_paper_layout: bool,
    /// In the order of the cells of a row.
    pub(crate) columns: &'static [Column],
    /// The column that a bar chart and the paper's layout show.
    pub(crate) headline: &'static str,
    /// Title of the bar chart.
    pub(crate) bars_title: &'static str,
    /// Number of leading user-visible cells that label the bars uniquely.
    pub(crate) bar_labels: usize,
}

/// See [`crate::bench::BenchOptions`] for their meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Defaults {
    pub(crate) viewport_px: [u32; 2],
    pub(crate) viewpoints: usize,
    pub(crate) frames: usize,
}

impl Defaults {
    /// Viewpoints of the paper's protocol.
    pub(crate) const PROTOCOL_VIEWPOINTS: usize = 8;

    /// The paper's protocol.
    pub(crate) const PROTOCOL: Self = Self {
        viewport_px: [1920, 1280],
        viewpoints: Self::PROTOCOL_VIEWPOINTS,
        frames: 3,
    };
}

/// Options that only some suites have a use for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OptionGroup {
    /// Selection of the render modes to compare; there is a page of them.
    Modes,
    /// Frames per second and memory: it plays.
    Playing,
    /// Painter and renderer of a window: it opens one, and is measured by it.
    Window,
    /// Point counts of the clouds that the suite generates itself.
    Clouds,
    /// First frame to measure; in the window it is the shown one.
    FirstFrame,
    /// Selection of the held-out images.
    Photos,
}

impl Suite {
    /// The word for it on the command line.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Returns true if it uses these options.
    pub fn takes(&self, group: OptionGroup) -> bool {
        self.takes.contains(&group)
    }
}

impl PartialEq for Suite {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Suite {}

impl fmt::Debug for Suite {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Suite").field(&self.name).finish()
    }
}

impl fmt::Display for Suite {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name)
    }
}

impl serde::Serialize for Suite {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name)
    }
}
