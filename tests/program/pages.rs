//! Pages are true: their commands are run, and print the output shown below them.
//!
//! Commands are the lines of `console` blocks that begin with `$ `. Those of a page run one after the other in a folder
//! of their own. The lines below a command must be in its output (stdout and stderr) in this order; `…` stands for any
//! text, alone on a line for any lines.

use rayon::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A command of a page and the lines below it.
#[derive(Debug, PartialEq, Eq)]
struct Step {
    /// Line of the page, from 1.
    line: usize,
    command: String,
    shown: Vec<String>,
}

fn steps(page: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let (mut is_console, mut is_code) = (false, false);
    for (text, line) in page.lines().zip(1..) {
        if text.starts_with("```") {
            is_code = !is_code;
            is_console = is_code && text == "```console";
        } else if !is_console {
        } else if let Some(command) = text.strip_prefix("$ ") {
            steps.push(Step {
                line,
                command: command.to_owned(),
                shown: Vec::new(),
            });
        } else if let Some(step) = steps.last_mut() {
            step.shown.push(text.to_owned());
        }
    }
    steps
}

/// Returns true if `line` matches the shown line, whose `…` stand for any text.
fn is_shown_as(line: &str, shown: &str) -> bool {
    let mut parts = shown.trim_end().split('…');
    let Some(mut rest) = parts.next().and_then(|start| line.strip_prefix(start)) else {
        return false;
    };
    let mut ends_open = false;
    for part in parts {
        match rest.find(part) {
            Some(at) => rest = &rest[at + part.len()..],
            None => return false,
        }
        ends_open = part.is_empty();
    }
    ends_open || rest.trim_end().is_empty()
}

/// The first shown line that is missing from the output or out of order.
fn first_missing<'a>(answer: &str, shown: &'a [String]) -> Option<&'a str> {
    let mut lines = answer.lines();
    shown
        .iter()
        .map(String::as_str)
        .filter(|line| !["", "…"].contains(&line.trim()))
        .find(|shown| !lines.by_ref().any(|line| is_shown_as(line, shown)))
}

/// Failures of the commands of a page.
fn problems(page: &Path) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let work = folder.path().join("work");
    fs::create_dir(&work).unwrap();
    let program = Path::new(env!("CARGO_BIN_EXE_pointreel")).parent().unwrap();
    let path = std::env::join_paths(
        std::iter::once(program.to_owned()).chain(std::env::split_paths(&std::env::var_os("PATH").unwrap())),
    )
    .unwrap();
    let mut problems = Vec::new();
    for step in steps(&fs::read_to_string(page).unwrap()) {
        let output = Command::new("bash")
            .args(["-c", &format!("exec 2>&1; {}", step.command)])
            .current_dir(&work)
            .env("PATH", &path)
            .env("HOME", folder.path())
            .env_remove("XDG_CONFIG_HOME")
            .env_remove("XDG_CACHE_HOME")
            .output()
            .unwrap();
        let answer = String::from_utf8_lossy(&output.stdout);
        let place = format!("{}:{}: {}", page.display(), step.line, step.command);
        if !output.status.success() {
            problems.push(format!("{place}\n  ends with {}: {answer}", output.status));
        } else if let Some(line) = first_missing(&answer, &step.shown) {
            problems.push(format!("{place}\n  does not answer `{line}` but\n{answer}"));
        }
    }
    problems
}

fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut pages = vec![root.join("README.md"), root.join("ARCHITECTURE.md")];
    for folder in ["docs", "docs/design", "docs/notebook", "docs/quickstart"] {
        let entries = fs::read_dir(root.join(folder))
            .unwrap()
            .map(|entry| entry.unwrap().path());
        pages.extend(entries.filter(|path| path.extension().is_some_and(|extension| extension == "md")));
    }
    pages.sort();
    pages
}

#[test]
fn commands_in_pages_print_the_output_shown_below_them() {
    let pages = pages();
    assert!(pages.len() > 20, "{pages:?}");
    let wrong: Vec<String> = pages.par_iter().flat_map(|page| problems(page)).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Targets of the links of a page, without their anchors, that are files.
fn linked(page: &str) -> impl Iterator<Item = &str> {
    page.split("](")
        .skip(1)
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target.split_once('#').map_or(target, |(file, _)| file))
        .filter(|target| !target.is_empty() && !target.contains("://"))
}

#[test]
fn pages_link_to_existing_files() {
    let mut broken = Vec::new();
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        let folder = page.parent().unwrap();
        broken.extend(
            linked(&text)
                .filter(|target| !folder.join(target).exists())
                .map(|target| format!("{} links to {target}", page.display())),
        );
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn every_page_is_in_the_summary() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let summary = fs::read_to_string(root.join("SUMMARY.md")).unwrap();
    let listed: Vec<PathBuf> = linked(&summary).map(|target| root.join(target)).collect();
    let missing: Vec<PathBuf> = pages()
        .into_iter()
        .filter(|page| page.starts_with(&root) && !page.ends_with("SUMMARY.md") && !listed.contains(page))
        .collect();
    assert!(missing.is_empty(), "SUMMARY.md lacks {missing:?}");
}

#[test]
fn shown_lines_appear_in_order() {
    let page = "$ no\n```sh\n$ no\n```\n```console\n$ a b\nfirst …\n…\nlast\n$ c\n```\n";
    let steps = steps(page);
    assert_eq!(steps.len(), 2, "{steps:?}");
    assert_eq!((steps[0].line, steps[0].command.as_str()), (6, "a b"));
    let missing = |answer| first_missing(answer, &steps[0].shown);
    assert_eq!(missing("first one\nand\nlast"), None);
    assert_eq!(missing("last\nfirst one"), Some("last"));
    assert_eq!(missing("the first one\nlast"), Some("first …"));
    assert!(is_shown_as("took 3 s of 5", "took … s of …") && is_shown_as("3 ms", "… ms"));
    assert!(!is_shown_as("took 3 s of 5 m", "took … s of 5") && !is_shown_as("3 ms", "… s of"));
}
