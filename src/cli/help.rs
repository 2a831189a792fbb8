//! How the help looks: `-h` has the options of every day, `--help` all of them, each with its values and its default.

use super::line::listed_values;
use super::topics;
use clap::{Arg, Command};

/// Characters of a text in a line of `-h`, next to the options, and of `--help`, below them.
const SHORT_WIDTH: usize = 66;
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
    let mut text = help.to_string();
    let defaults = option.get_default_values();
    let takes_value = option.get_action().takes_values();
    if takes_value && !defaults.is_empty() && !text.contains("[default") {
        let defaults: Vec<_> = defaults.iter().map(|value| value.to_string_lossy()).collect();
        text += &format!(" [default: {}]", defaults.join(" "));
    }
    let values = listed_values(&option);
    let placeholder = option.get_value_names().and_then(|names| names.first());
    if !values.is_empty() && placeholder.is_none_or(|name| name.as_str() != values.join("|")) {
        text += &format!(" [values: {}]", values.join(", "));
    }
    option
        .help(wrapped(&text, SHORT_WIDTH))
        .long_help(wrapped(&text, LONG_WIDTH))
        .hide_default_value(true)
        .hide_possible_values(true)
}

/// `text` in lines of at most `width` characters, unless a word is longer.
pub(super) fn wrapped(text: &str, width: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let mut line = lines.pop().unwrap_or_default();
        let characters = line.chars().count() + 1 + word.chars().count();
        if !line.is_empty() && characters > width {
            lines.push(line);
            line = String::new();
        } else if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
        lines.push(line);
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::command;

    #[test]
    fn options_of_every_day_are_on_one_screen() {
        const MAX_LINES: usize = 64;
        for of_command in command().get_subcommands() {
            let help = of_command.clone().render_help().to_string();
            let lines = help.lines().count();
            assert!(lines <= MAX_LINES, "{} has {lines} lines", of_command.get_name());
        }
    }

    #[test]
    fn texts_are_wrapped_at_words() {
        assert_eq!(wrapped("a bb ccc", 4), "a bb\nccc");
        assert_eq!(wrapped("longer", 4), "longer");
        assert_eq!(wrapped("", 4), "");
    }
}
