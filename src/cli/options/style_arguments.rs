//! Options for the settings of an image, generated from their descriptions.

use super::known_values::KnownValues;
use crate::scene::Settings;
use crate::scene::describe::{Described, Given, Value, Values};
use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Args, Command, Error, FromArgMatches};

/// The settings that are given, by their names in files.
#[derive(Debug, Clone, Default)]
pub(super) struct StyleArgs {
    /// Given settings. Later ones take precedence: explicit settings come after those that a word expands to.
    given: Given,
}

impl StyleArgs {
    /// `default`, except for given options.
    pub(in crate::cli) fn over(&self, mut default: Settings) -> Settings {
        default.edit(&mut |described, value| {
            let given = self.given.iter().rfind(|(key, _)| *key == described.key);
            given.map_or(value, |(_, given)| *given)
        });
        default
    }
}

/// The settings and their descriptions.
fn all() -> Vec<(&'static Described, Value)> {
    Settings::default().settings()
}

fn with_options(command: Command, described: &'static Described, default: Value) -> Command {
    let option = |flag: &'static str| {
        let option = Arg::new(flag).long(flag).help_heading(described.heading);
        option.hide_short_help(!described.everyday)
    };
    match &described.values {
        // Colours belong together, and a background can be transparent: they have their own options.
        Values::Colors | Values::Background => command,
        Values::Words(_) | Values::Number(_) | Values::Environment | Values::Switch(_) => {
            let words = described.words();
            let default = described.typed(default);
            let option = option(described.flag)
                .aliases(described.other_flags)
                .help(with_default(described.help, default.as_deref()))
                .value_name(placeholder(&words, described.value_name))
                .value_parser(KnownValues::<Given>::new(words, |text| described.parse(text)));
            command.arg(if described.is_switch() {
                option.num_args(0..=1).require_equals(true).default_missing_value("on")
            } else {
                option
            })
        }
        Values::Kinds(kinds) => {
            let flags = kinds.iter().map(|kind| kind.flag);
            let group = ArgGroup::new(described.title).args(flags).multiple(false);
            let options = kinds.iter().enumerate().map(|(place, kind)| {
                let default = match default {
                    Value::Kind(chosen, number) if chosen == place => Some((number as f32).to_string()),
                    _ => None,
                };
                let help = match (&kind.number, &default) {
                    (None, Some(_)) => format!("{} [default]", kind.help),
                    (_, default) => with_default(kind.help, default.as_deref()),
                };
                let option = option(kind.flag).help(help);
                match &kind.number {
                    None => option.action(ArgAction::SetTrue),
                    Some(told) => option.value_name(told.value_name).value_parser(move |text: &str| {
                        let number = told.numbers.parse(text);
                        number.map(|number| Value::Kind(place, number))
                    }),
                }
            });
            command.args(options).group(group)
        }
    }
}

/// A text of the help with a default, as clap writes it.
pub(super) fn with_default(help: &str, default: Option<&str>) -> String {
    match default {
        Some(default) => format!("{help} [default: {default}]"),
        None => help.to_owned(),
    }
}

/// The words of an option instead of a placeholder, if they are few and short; else `name`.
pub(super) fn placeholder(words: &[&'static str], name: &'static str) -> String {
    const MAX_CHARACTERS: usize = 16;
    let list = words.join("|");
    if words.len() > 1 && list.len() <= MAX_CHARACTERS {
        list
    } else {
        name.to_owned()
    }
}

/// Returns the given value of a setting, and of others that one of its words expands to.
fn given(matches: &ArgMatches, described: &Described) -> Given {
    if let Values::Words(_) | Values::Number(_) | Values::Environment | Values::Switch(_) = described.values {
        return matches.get_one::<Given>(described.flag).cloned().unwrap_or_default();
    }
    let given = given_value(matches, described);
    given.map(|value| (described.key, value)).into_iter().collect()
}

/// Returns the given value of a setting whose options are of another kind than one with a word or a number.
fn given_value(matches: &ArgMatches, described: &Described) -> Option<Value> {
    let value = |flag| matches.get_one::<Value>(flag).copied();
    match &described.values {
        Values::Colors
        | Values::Background
        | Values::Words(_)
        | Values::Number(_)
        | Values::Environment
        | Values::Switch(_) => None,
        Values::Kinds(kinds) => kinds.iter().enumerate().find_map(|(place, kind)| {
            let is_chosen = |flag| matches.get_flag(flag).then_some(Value::Kind(place, 0.0));
            match kind.number {
                None => is_chosen(kind.flag),
                Some(_) => value(kind.flag),
            }
        }),
    }
}

impl Args for StyleArgs {
    fn augment_args(command: Command) -> Command {
        let settings = all().into_iter();
        settings.fold(command, |command, (described, default)| {
            with_options(command, described, default)
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for StyleArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let settings = all().into_iter();
        let given = settings.flat_map(|(described, _)| given(matches, described)).collect();
        Ok(Self { given })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{EyeDome, LevelStructure, Lighting, OnOff, Primitive, SplatFilter};

    fn style_of(arguments: &[&str]) -> Settings {
        let command = StyleArgs::augment_args(Command::new("pointreel"));
        let matches = command
            .try_get_matches_from([&["pointreel"], arguments].concat())
            .unwrap();
        StyleArgs::from_arg_matches(&matches).unwrap().over(Settings::default())
    }

    #[test]
    fn options_accept_former_names_and_names_from_other_programs() {
        for flag in ["--lod-structure", "--levels"] {
            assert_eq!(style_of(&[flag, "hspt"]).levels.structure, LevelStructure::Hierarchical);
        }
        for flag in ["--lighting", "--shading"] {
            assert_eq!(style_of(&[flag, "lambert"]).light.lighting, Lighting::Lambert);
        }
        for flag in ["--eye-dome", "--edl", "--edl=on"] {
            assert_eq!(style_of(&[flag]).light.eye_dome, EyeDome::On);
        }
    }

    #[test]
    fn a_switch_needs_no_value_and_wrong_values_are_rejected() {
        assert!(style_of(&["--grid"]).backdrop.grid);
        assert!(!style_of(&["--grid=off"]).backdrop.grid);
        assert_eq!(style_of(&["--shadows"]).light.shadows, OnOff::On);
        assert_eq!(
            style_of(&["--normals", "neighbors"]).surfels,
            Settings::default().surfels
        );
        let command = StyleArgs::augment_args(Command::new("pointreel"));
        let error = command
            .try_get_matches_from(["pointreel", "--lighting", "lamber"])
            .unwrap_err();
        assert!(error.to_string().contains("'lambert'"), "{error}");
    }

    #[test]
    fn explicit_settings_override_a_shorthand_for_several() {
        let of = |style: Settings| (style.primitive, style.surfels.filter);
        let short = ["--primitive", "ewa"];
        assert_eq!(of(style_of(&short)), (Primitive::Surfel.into(), SplatFilter::Ewa));
        for arguments in [
            ["--primitive", "ewa", "--splat-filter", "none"],
            ["--splat-filter", "none", "--primitive", "ewa"],
        ] {
            assert_eq!(of(style_of(&arguments)), (Primitive::Surfel.into(), SplatFilter::Off));
        }
        let wrong = StyleArgs::augment_args(Command::new("pointreel"));
        let error = wrong
            .try_get_matches_from(["pointreel", "--primitive", "cone"])
            .unwrap_err();
        assert!(error.to_string().contains("voxel, point, ewa"), "{error}");
    }
}
