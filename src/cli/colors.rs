//! How points are coloured, as several verbs take it.

use crate::analysis::ColorMap;
use crate::scene::coloring::{COLORS, LOGARITHM, MAP, RANGE};
use crate::sequence::{ColorRange, ColorSource, Coloring};
use clap::Args;

/// What is not given is as usual.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Colours")]
pub(super) struct ColorArgs {
    #[arg(long, value_name = COLORS.value_name, help = COLORS.help)]
    colors: Option<ColorSource>,

    #[arg(long, value_name = MAP.value_name, help = MAP.help_line())]
    color_map: Option<ColorMap>,

    #[arg(long, value_name = RANGE.value_name, help = RANGE.help, allow_hyphen_values = true)]
    color_range: Option<ColorRange>,

    #[arg(long, help = LOGARITHM.help)]
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
