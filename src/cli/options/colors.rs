//! Point colour options, shared by several subcommands.

use super::known_values::KnownValues;
use super::style_arguments::with_default;
use super::usage::UsageError;
use super::values::{ON_OFF, on_or_off};
use crate::analysis::ColorMap;
use crate::cli::terminal::warnings;
use crate::cloud::ScalarField;
use crate::scene::coloring::{COLORS, LOGARITHM, MAP, MAPS, RANGE, SOURCES};
use crate::scene::describe::Words;
use crate::sequence::{ColorRange, ColorSource, Coloring, Sequence};
use clap::Args;

/// Colour options; those not given keep their defaults.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Colours")]
pub(super) struct ColorArgs {
    #[arg(
        long,
        value_name = COLORS.value_name,
        help = with_default(COLORS.help, Some(ColorSource::default().name())),
        value_parser = KnownValues::<ColorSource>::of(words_of(SOURCES)),
    )]
    colors: Option<ColorSource>,

    #[arg(
        long,
        aliases = MAP.other_flags,
        value_name = MAP.value_name,
        help = with_default(MAP.help, Some(ColorMap::default().name())),
        value_parser = KnownValues::<ColorMap>::of(words_of(MAPS)),
    )]
    color_map: Option<ColorMap>,

    #[arg(
        long,
        value_name = RANGE.value_name,
        help = with_default(RANGE.help, Some(&ColorRange::default().to_string())),
        allow_hyphen_values = true,
    )]
    color_range: Option<ColorRange>,

    #[arg(
        long,
        value_name = "on|off",
        help = with_default(LOGARITHM.help, Some("off")),
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "on",
        value_parser = KnownValues::<bool>::new(ON_OFF, on_or_off),
        hide_short_help = true,
    )]
    color_log: Option<bool>,
}

fn words_of(words: &'static Words) -> impl Iterator<Item = &'static str> {
    words.list.iter().map(|word| word.word)
}

impl ColorArgs {
    /// The source that is given.
    pub(in crate::cli) fn source(&self) -> Option<ColorSource> {
        self.colors
    }

    /// `default`, except for given options. Settings that belong to a source are replaced with it.
    pub(in crate::cli) fn over(&self, default: Coloring) -> Coloring {
        let is_same = self.colors.is_none_or(|source| source == default.source);
        let usual = Coloring::default();
        let range = if is_same { default.range } else { usual.range };
        Coloring {
            source: self.colors.unwrap_or(default.source),
            map: self.color_map.unwrap_or(default.map),
            range: self.color_range.unwrap_or(range),
            is_logarithmic: self.color_log.unwrap_or(is_same && default.is_logarithmic),
            one_color: default.one_color,
        }
    }
}

/// Fails, with the available names, where `source` names a scalar field that neither `frame` nor the first, the median
/// and the last frame of `sequence` have. `fields` are the fields of `frame`, if it could be read. Warns where it names
/// another kind of field that they do not have.
pub(in crate::cli) fn check_source(
    source: ColorSource,
    sequence: &Sequence,
    frame: usize,
    fields: Option<&[ScalarField]>,
) -> Result<(), UsageError> {
    let kind = match source {
        ColorSource::Scalar(Some(_)) => "",
        ColorSource::Scalar(None) => "scalar fields",
        ColorSource::Time => "a scalar field of times",
        ColorSource::Class => "a scalar field of classes",
        _ => return Ok(()),
    };
    if fields.is_some_and(|fields| source.is_of_fields(fields)) {
        return Ok(());
    }
    let mut names = Vec::new();
    let mut take_names = |fields: &[ScalarField]| {
        for field in fields {
            if !names.contains(&field.name) {
                names.push(field.name.clone());
            }
        }
    };
    fields.into_iter().for_each(&mut take_names);
    let last = sequence.len().saturating_sub(1);
    let mut looked_at = vec![frame];
    for index in [0, last / 2, last] {
        if looked_at.contains(&index) && (index != frame || fields.is_some()) {
            continue;
        }
        looked_at.push(index);
        // An unreadable frame is reported where it is shown.
        let Ok(cloud) = sequence.decode(index) else {
            continue;
        };
        if source.is_of_fields(&cloud.attributes.scalars) {
            return Ok(());
        }
        take_names(&cloud.attributes.scalars);
    }
    let there = if names.is_empty() {
        "no scalar fields were found".to_owned()
    } else {
        format!("found {}", names.join(", "))
    };
    let ColorSource::Scalar(Some(name)) = source else {
        warnings::warn(&format!(
            "--colors {source}: no frame that was looked at has {kind}, other colours are shown; {there}"
        ));
        return Ok(());
    };
    Err(UsageError(format!(
        "--colors scalar:{name}: no frame that was looked at has a scalar field `{name}`; {there}"
    )))
}
