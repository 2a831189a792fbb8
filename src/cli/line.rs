//! The command line as people type it, in the form that clap reads.
//!
//! Options have one spelling in clap; here they get it. `--edl on` and `--edl` are both meant: clap would take the next
//! word, be it an INPUT, for a value, so that only a known value is joined to its switch.

use crate::spelling::{edit_distance, is_same_word};
use clap::builder::PossibleValue;
use clap::{Arg, ArgAction, Command};
use std::ffi::{OsStr, OsString};
use std::path::Path;

/// Options with other names in other programs, distinguished by their values.
const BY_VALUE: [(&str, IsMeant, &str); 2] = [("resolution", is_size, "size"), ("camera", is_path_of_camera, "path")];

/// True for values of the option that is meant.
type IsMeant = fn(&str) -> bool;

fn is_size(value: &str) -> bool {
    let edges = value.split_once(['x', 'X']);
    edges.is_some_and(|(width, height)| width.parse::<u32>().is_ok() && height.parse::<u32>().is_ok())
}

fn is_path_of_camera(value: &str) -> bool {
    Path::new(value)
        .extension()
        .is_some_and(|extension| extension == "json")
}

/// `words` of a command line, with the name of the program, as `command` spells its options.
pub(super) fn spelt(words: Vec<OsString>, command: &Command) -> Vec<OsString> {
    let is_option = |word: &&OsString| word.as_encoded_bytes().starts_with(b"-");
    let first = words.iter().skip(1).find(|word| !is_option(word));
    let of_command = first.and_then(|name| command.find_subcommand(name)).unwrap_or(command);
    // Of the options without a subcommand, only the global ones also belong to a subcommand.
    let global = command.get_opts().filter(|option| option.is_global_set());
    let options: Vec<&Arg> = of_command.get_opts().chain(global).collect();
    let mut words = words.into_iter().peekable();
    let mut spelt = Vec::new();
    while let Some(word) = words.next() {
        if word == "--" {
            spelt.push(word);
            break;
        }
        let Some((name, value)) = word.to_str().and_then(|word| word.strip_prefix("--")).map(parts) else {
            spelt.push(word);
            continue;
        };
        let next = words.peek().and_then(|next| next.to_str());
        let Some((name, option)) = option_of(name, value.or(next), &options) else {
            spelt.push(word);
            continue;
        };
        let next_is_value = value.is_none() && takes_next(option, words.peek().map(OsString::as_os_str));
        spelt.push(match value {
            Some(value) => format!("--{name}={value}").into(),
            None if next_is_value && option.is_require_equals_set() => joined(&name, words.next()),
            None => format!("--{name}").into(),
        });
        if next_is_value && !option.is_require_equals_set() {
            spelt.extend(words.next());
        }
    }
    spelt.extend(words);
    spelt
}

/// Name and value of `name=value`.
fn parts(word: &str) -> (&str, Option<&str>) {
    word.split_once('=')
        .map_or((word, None), |(name, value)| (name, Some(value)))
}

fn joined(name: &str, value: Option<OsString>) -> OsString {
    let mut word = OsString::from(format!("--{name}="));
    word.push(value.unwrap_or_default());
    word
}

/// The option that is meant by `name`, and its name as clap knows it.
fn option_of<'a>(name: &str, value: Option<&str>, options: &[&'a Arg]) -> Option<(String, &'a Arg)> {
    let meant = BY_VALUE.iter().find(|(it, is_meant, long)| {
        let is_there = options.iter().any(|option| option.get_long() == Some(long));
        is_same_word(it, name) && value.is_some_and(is_meant) && is_there
    });
    let name = meant.map_or(name, |(_, _, long)| long);
    let names = || {
        options
            .iter()
            .flat_map(|option| names_of(option).map(move |it| (it, *option)))
    };
    let exact = names().find(|(it, _)| it == name);
    exact.or_else(|| names().find(|(it, _)| is_same_word(it, name)))
}

/// Every long name of an option.
fn names_of(option: &Arg) -> impl Iterator<Item = String> {
    let aliases = option.get_all_aliases().unwrap_or_default();
    let names = option.get_long().into_iter().chain(aliases);
    names.map(str::to_owned).collect::<Vec<_>>().into_iter()
}

/// True if the next word is the value of an option that has none after `=`.
fn takes_next(option: &Arg, next: Option<&OsStr>) -> bool {
    let Some(next) = next else { return false };
    if option.is_require_equals_set() {
        let values = option.get_possible_values();
        return next
            .to_str()
            .is_some_and(|next| values.iter().any(|value| value.matches(next, false)));
    }
    let is_option = next.as_encoded_bytes().starts_with(b"--");
    takes_value(option) && (!is_option || option.is_allow_hyphen_values_set())
}

fn takes_value(option: &Arg) -> bool {
    matches!(option.get_action(), ArgAction::Set | ArgAction::Append)
}

/// Words of other programs for our commands.
const SYNONYMS: [(&str, &str); 24] = [
    ("inspect", "info"),
    ("show", "view"),
    ("stat", "info"),
    ("describe", "info"),
    ("ls", "info"),
    ("list", "info"),
    ("open", "view"),
    ("play", "view"),
    ("gui", "view"),
    ("image", "render"),
    ("screenshot", "render"),
    ("export", "render"),
    ("video", "render"),
    ("animate", "render"),
    ("validate", "check"),
    ("verify", "check"),
    ("lint", "check"),
    ("transcode", "convert"),
    ("downsample", "convert"),
    ("merge", "convert"),
    ("stream", "serve"),
    ("benchmark", "bench"),
    ("diff", "compare"),
    ("version", "--version"),
];

/// A sentence about a first word that looks like a command, and is neither one nor a file.
pub(super) fn unknown_command(words: &[OsString], command: &Command) -> Option<String> {
    let word = words.get(1)?.to_str()?;
    let is_name = word.starts_with(|letter: char| letter.is_ascii_alphabetic())
        && word
            .chars()
            .all(|letter| letter.is_ascii_alphanumeric() || letter == '-' || letter == '_');
    if !is_name || command.find_subcommand(word).is_some() || word == "help" || Path::new(word).exists() {
        return None;
    }
    let synonym = SYNONYMS.iter().find(|(synonym, _)| is_same_word(synonym, word));
    let meant = match synonym {
        Some((_, name)) => name,
        None => similar(word, command.get_subcommands().map(Command::get_name))?,
    };
    Some(format!(
        "`{word}` is neither a command nor a file: did you mean `pointreel {meant}`?"
    ))
}

/// The name of which a word is a misspelling.
fn similar<'a>(word: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let max_edits = match word.len() {
        0..4 => 1,
        _ => 2,
    };
    let edits = |name: &&str| edit_distance(word, name);
    names
        .filter(|name| edits(name) <= max_edits && edits(name) < name.len().min(word.len()))
        .min_by_key(edits)
}

/// The values that a help lists.
pub(super) fn listed_values(option: &Arg) -> Vec<String> {
    let values = option.get_possible_values();
    let values = values.iter().filter(|value| !value.is_hide_set());
    values.map(PossibleValue::get_name).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::command;

    fn line(text: &str) -> Vec<OsString> {
        text.split(' ').map(OsString::from).collect()
    }

    #[test]
    fn options_are_normalised_to_the_spelling_of_clap() {
        for (typed, expected) in [
            ("p a.ply --edl on", "p a.ply --edl=on"),
            ("p --edl a.ply", "p --edl a.ply"),
            ("p --eye-dome off a.ply", "p --eye-dome=off a.ply"),
            ("p a.ply --colour-map gray", "p a.ply --color-map gray"),
            (
                "p render a.ply --frames -1 -o x.png",
                "p render a.ply --frame -1 -o x.png",
            ),
            ("p convert a.ply b --frame 3", "p convert a.ply b --frames 3"),
            ("p bench lod --frames 3 --frame 1", "p bench lod --frames 3 --frame 1"),
            ("p render a --resolution 640x480", "p render a --size 640x480"),
            ("p render a --resolution=0.5", "p render a --resolution=0.5"),
            ("p render a --camera path.json", "p render a --path path.json"),
            ("p render a --view --color b", "p render a --view --colors b"),
            ("p -- --colour x", "p -- --colour x"),
            ("p --unknown x", "p --unknown x"),
        ] {
            assert_eq!(spelt(line(typed), &command()), line(expected), "{typed}");
        }
    }

    #[test]
    fn a_mistyped_command_is_answered_with_a_suggestion() {
        let of = |text: &str| unknown_command(&line(text), &command());
        for (typed, meant) in [
            ("p inof scan", "info"),
            ("p inspect scan", "info"),
            ("p rendr scan", "render"),
            ("p compare-frame a", "compare-frames"),
            ("p benchmark", "bench"),
        ] {
            let answer = of(typed).unwrap();
            assert!(
                answer.ends_with(&format!("did you mean `pointreel {meant}`?")),
                "{answer}"
            );
        }
        for typed in [
            "p",
            "p info a",
            "p scan.ply",
            "p demo:",
            "p tcp://a",
            "p ../info",
            "p --grid",
            "p src",
            "p walk",
        ] {
            assert_eq!(of(typed), None, "{typed}");
        }
    }
}
