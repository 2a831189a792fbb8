//! What a suite says of itself: all that the command line, the menu and a report show of it.

use super::report::Column;
use std::fmt;

/// What can be measured: one row of the table of suites, all but its loop. Two are equal when their names are.
pub struct Suite {
    /// The word for it on the command line.
    pub(crate) name: &'static str,
    /// What follows its name in the list of suites on the command line.
    pub(crate) brief: &'static str,
    /// Its name in the Benchmark menu.
    pub(crate) title: &'static str,
    /// What the menu says of it.
    pub(crate) hint: &'static str,
    /// What the head of a report says of it.
    pub(crate) description: &'static str,
    /// What its numbers are, and what is in none of them.
    pub(crate) measured: &'static str,
    /// See [`Suite::measured`].
    pub(crate) not_measured: &'static str,
    /// What covers the pixels whose share is reported.
    pub(crate) covered_by: &'static str,
    /// What is measured unless somebody asks for something else.
    pub(crate) defaults: Defaults,
    /// Options that it alone takes, or with a few others.
    pub(crate) takes: &'static [OptionGroup],
    /// Whether it is one of the paper's, whose protocol then holds.
    pub(crate) is_of_paper: bool,
    /// Whether a report begins with the paper's layout: a line a sequence, a column a strategy, the headline.
    pub(crate) has_paper_layout: bool,
    /// In the order of the cells of a row.
    pub(crate) columns: &'static [Column],
    /// The column that a bar chart and the paper's layout show.
    pub(crate) headline: &'static str,
    /// What the bars are.
    pub(crate) bars_title: &'static str,
    /// How many of the first cells that people see tell the bars apart.
    pub(crate) bar_labels: usize,
}

/// See [`crate::bench::BenchOptions`] for what they mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Defaults {
    pub(crate) viewport_px: [u32; 2],
    pub(crate) viewpoints: usize,
    pub(crate) frames: usize,
}

impl Defaults {
    /// Viewpoints that the paper's protocol asks for.
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
    /// Which ways to draw are compared; there is a page of them.
    Modes,
    /// Frames a second and memory: it plays.
    Playing,
    /// Who paints and draws a window: it opens one, and is measured by it.
    Window,
    /// Of how many points the clouds are that it makes itself.
    Clouds,
    /// Which frame is measured first; in the window it is the shown one.
    FirstFrame,
    /// Which photographs are left out.
    Photographs,
}

impl Suite {
    /// The word for it on the command line.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Whether it has a use for these options.
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
