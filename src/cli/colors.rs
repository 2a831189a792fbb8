//! How points are coloured, as several verbs take it.

use crate::analysis::ColorMap;
use crate::sequence::{ColorRange, ColorSource, Coloring};
use clap::Args;

/// What is not given is as usual.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Colours")]
pub(super) struct ColorArgs {
    /// auto, file, scalar[:NAME], height[:z], normal, distance, time, class or uniform
    #[arg(long, value_name = "SOURCE")]
    colors: Option<ColorSource>,

    /// How numbers become colours: viridis, turbo, magma, grey or diverging
    #[arg(long, value_name = "MAP")]
    color_map: Option<ColorMap>,

    /// Numbers in the first and last colour, A..B, or percentiles (usually p1..p99)
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    color_range: Option<ColorRange>,

    /// Colours by the logarithms of numbers
    #[arg(long)]
    color_log: bool,
}

impl ColorArgs {
    /// `default`, but for what is given. What belongs to a source goes with it.
    pub(super) fn over(&self, default: Coloring) -> Coloring {
        let is_same = self.colors.is_none_or(|source| source == default.source);
        let usual = Coloring::default();
        let range = if is_same { default.range } else { usual.range };
        Coloring {
            source: self.colors.unwrap_or(default.source),
            map: self.color_map.unwrap_or(default.map),
            range: self.color_range.unwrap_or(range),
            is_logarithmic: self.color_log || (is_same && default.is_logarithmic),
            one_color: default.one_color,
        }
    }
}
