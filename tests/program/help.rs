//! The help as people read it: `-h` and `--help` of each command, and the pages of `pointreel help TOPIC`.
//!
//! `POINTREEL_UPDATE_HELP=1` writes the texts that these tests compare with.

use std::fs;
use std::path::Path;
use std::process::Command;

const COMMANDS: [&str; 9] = [
    "view",
    "render",
    "bench",
    "info",
    "check",
    "convert",
    "serve",
    "compare",
    "compare-frames",
];

const TOPICS: [&str; 7] = ["colours", "lod", "rgbd", "images", "live", "camera", "formats"];

fn help(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_help_is_unchanged() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/help");
    let is_update = std::env::var_os("POINTREEL_UPDATE_HELP").is_some();
    let mut pages: Vec<(String, Vec<&str>)> = vec![("pointreel".into(), vec!["-h"])];
    for command in COMMANDS {
        pages.push((command.into(), vec![command, "-h"]));
        pages.push((format!("{command}-all"), vec![command, "--help"]));
    }
    for topic in TOPICS {
        pages.push((format!("topic-{topic}"), vec!["help", topic]));
    }
    let mut changed = Vec::new();
    for (name, arguments) in pages {
        let path = folder.join(&name).with_extension("txt");
        let now = help(&arguments);
        if is_update {
            fs::write(&path, now).unwrap();
        } else if fs::read_to_string(&path).unwrap_or_default() != now {
            changed.push(name);
        }
    }
    assert!(
        changed.is_empty(),
        "{changed:?} changed: look at them, and run this with POINTREEL_UPDATE_HELP=1"
    );
}

#[test]
fn the_short_help_is_one_screen_of_short_lines() {
    const MAX_LINES: usize = 60;
    for command in COMMANDS {
        let short = help(&[command, "-h"]);
        let lines = short.lines().count();
        assert!(lines <= MAX_LINES, "{command} -h: {lines} lines");
        for line in short.lines().chain(help(&[command, "--help"]).lines()) {
            assert!(line.chars().count() <= 115, "{command}: {line}");
        }
    }
}

#[test]
fn help_command_matches_the_help_option() {
    assert_eq!(help(&["help", "render"]), help(&["render", "--help"]));
    assert_eq!(help(&["help", "colors"]), help(&["help", "colours"]));
}
