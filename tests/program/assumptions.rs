//! Guesses on stderr: each is a line; the user's choices are not listed.

use pointreel::assumption::Subject;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const UP: &str = "assumed up axis: y (as most models have it; fallback; change with --up)";
const PRIMITIVE: &str = "assumed primitive: point (the points are too sparse for a surface, or lie in lines or in a \
    volume; statistics; change with --primitive)";

const COLORS: &str = "assumed colours: normal (the file has no colours, so normals show the shape; statistics; change \
    with --colors)";

/// A file that states none of them.
fn cloud(folder: &Path) -> PathBuf {
    let path = folder.join("a.ply");
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    fs::write(&path, format!("{header}end_header\n0 0 0\n0 1 0\n0 0 1\n")).unwrap();
    path
}

/// The lines on stderr when `input` is rendered.
fn said(input: &Path, more: &[&str]) -> Vec<String> {
    let picture = input.with_extension("png");
    let output = Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .args(["render", input.to_str().unwrap(), "-o", picture.to_str().unwrap()])
        .args(["--size", "32x32", "--renderer", "cpu"])
        .args(more)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && picture.exists(), "{said}");
    said.lines().map(str::to_owned).collect()
}

#[test]
fn guesses_are_reported_unless_chosen_by_the_user() {
    let folder = tempfile::tempdir().unwrap();
    let cloud = cloud(folder.path());
    assert_eq!(said(&cloud, &[]), [UP, PRIMITIVE, COLORS]);
    assert_eq!(said(&cloud, &["--up", "y"]), [PRIMITIVE, COLORS]);
    assert_eq!(said(&cloud, &["--primitive", "surfel"]), [UP, COLORS]);
    assert_eq!(said(&cloud, &["--colors", "uniform"]), [UP, PRIMITIVE]);
    // Leaving the decision to the program is not a choice.
    assert_eq!(said(&cloud, &["--primitive", "auto"]), [UP, PRIMITIVE, COLORS]);
    let all = ["--up", "z", "--primitive", "point", "--colors", "height"];
    assert_eq!(said(&cloud, &all), [""; 0]);
}

#[test]
fn the_option_named_by_an_assumption_exists() {
    let help = Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .args(["view", "--help"])
        .output()
        .unwrap();
    let help = String::from_utf8_lossy(&help.stdout).into_owned();
    let options: Vec<&str> = help.split_whitespace().collect();
    for subject in Subject::all() {
        let is_there = subject.option().is_none_or(|option| options.contains(&option));
        assert!(is_there, "{subject:?}: {:?}", subject.option());
    }
}

#[test]
fn check_and_info_point_to_the_options() {
    let folder = tempfile::tempdir().unwrap();
    let cloud = cloud(folder.path());
    let output = |subcommand: &str| {
        Command::new(env!("CARGO_BIN_EXE_pointreel"))
            .args([subcommand, cloud.to_str().unwrap()])
            .output()
            .unwrap()
    };
    let options = "--up, --primitive, --colors are options of view and render";
    let checked = output("check");
    let said = String::from_utf8_lossy(&checked.stderr).into_owned();
    for line in [UP, PRIMITIVE, COLORS, options] {
        assert!(said.lines().any(|said| said == line), "{line}: {said}");
    }
    let answer = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert!(answer.lines().any(|line| line == "y is probably up"), "{answer}");
    let info = String::from_utf8_lossy(&output("info").stdout).into_owned();
    assert!(info.lines().any(|line| line == options), "{info}");
}

#[test]
fn a_session_chooses_like_options() {
    let folder = tempfile::tempdir().unwrap();
    cloud(folder.path());
    let session = folder.path().join("a.pointreel");
    let with = |more: &str| {
        let session_text = format!(r#"{{"pointreel_session": 1, "files": ["a.ply"]{more}}}"#);
        fs::write(&session, session_text).unwrap();
        said(&session, &[])
    };
    assert_eq!(with(""), [UP, PRIMITIVE, COLORS]);
    assert_eq!(with(r#", "settings": {"primitive": "surfel"}"#), [UP, COLORS]);
}
