//! Help layout: `-h` has the everyday options, `--help` all of them, each with its values and its default.

use super::line::listed_values;
use super::topics;
use super::wrap::wrapped;
use clap::{Arg, Command};

/// Characters of a text in a line of `-h`, next to the options, and of `--help`, below them.
const SHORT_WIDTH: usize = 72;
const LONG_WIDTH: usize = 90;

/// Width of a list of commands, of headings and the like.
const PAGE_WIDTH: usize = 100;

/// `command` and its commands with the texts of the help laid out.
pub(super) fn laid_out(command: Command) -> Command {
    let name = command.get_name().to_owned();
    let has_more = command.get_arguments().any(Arg::is_hide_short_help_set);
    let all = if name == "pointreel" {
        "pointreel --help".to_owned()
    } else {
        format!("pointreel {name} --help")
    };
    let topics = wrapped(&topics::line(), PAGE_WIDTH);
    let laid_out = command.mut_args(with_texts).mut_subcommands(laid_out);
    match (name.as_str(), has_more) {
        ("pointreel", _) => laid_out
            .after_help(format!("All options: {all}\n{topics}"))
            .after_long_help(topics),
        (_, true) => laid_out.after_help(format!("All options: {all}")),
        (_, false) => laid_out,
    }
}

fn with_texts(option: Arg) -> Arg {
    let Some(help) = option.get_long_help().or(option.get_help()) else {
        return option;
    };
    let help = help.to_string();
    let text = Text::of(&option, &help);
    let takes_value = option.get_action().takes_values();
    let [short, long] = [text.short(option.is_positional()), text.long()];
    option
        .help(wrapped(&short, SHORT_WIDTH))
        .long_help(wrapped(&long, LONG_WIDTH))
        .hide_default_value(takes_value)
        .hide_possible_values(takes_value)
}

/// Parts of the text of an option.
struct Text {
    help: String,
    /// In brackets, with a space before them; empty if there is none.
    default: String,
    values: String,
}

impl Text {
    fn of(option: &Arg, help: &str) -> Self {
        let takes_value = option.get_action().takes_values();
        let (help, mut default) = match help.find(" [default") {
            Some(place) => (&help[..place], help[place..].to_owned()),
            None => (help, String::new()),
        };
        let defaults = option.get_default_values();
        if takes_value && !defaults.is_empty() && default.is_empty() {
            let defaults: Vec<_> = defaults.iter().map(|value| value.to_string_lossy()).collect();
            default = format!(" [default: {}]", defaults.join(" "));
        }
        let values = if takes_value { listed_values(option) } else { Vec::new() };
        let placeholder = option.get_value_names().and_then(|names| names.first());
        let are_in_placeholder = placeholder.is_some_and(|name| name.as_str() == values.join("|"));
        let values = if values.is_empty() || are_in_placeholder {
            String::new()
        } else {
            format!(" [values: {}]", values.join(", "))
        };
        Self {
            help: help.to_owned(),
            default,
            values,
        }
    }

    fn long(&self) -> String {
        format!("{}{}{}", self.help, self.default, self.values)
    }

    /// Returns the short help that fits on a line: the first clause, with a short default. Values are always there.
    fn short(&self, is_whole: bool) -> String {
        if is_whole {
            return self.long();
        }
        let ends = ["; ", ". ", " ("];
        let end = ends.iter().filter_map(|end| self.help.find(end)).min();
        let clause = &self.help[..end.unwrap_or(self.help.len())];
        let with_default = format!("{clause}{}", self.default);
        if with_default.chars().count() <= SHORT_WIDTH {
            with_default + &self.values
        } else {
            clause.to_owned() + &self.values
        }
    }
}
