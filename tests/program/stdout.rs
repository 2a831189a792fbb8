//! Output that stdout does not take: a full disk is a failure, a closed reader is not.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output, Stdio};

const CUBE: &str = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 0\n1 0 1\n0 1 1\n1 1 1\n";

/// One command line per command that prints to stdout. `{out}` is replaced by a new name each time.
const ANSWERS: [&[&str]; 14] = [
    &["--help"],
    &["--version"],
    &["convert", "--help"],
    &["info", "a.xyz"],
    &["info", "--json", "a.xyz"],
    &["check", "a.xyz"],
    &["check", "--json", "a.xyz"],
    &["convert", "a.xyz", "{out}.ply"],
    &["convert", "a.xyz", "{out}.reel"],
    &["compare", "a.png", "b.png"],
    &["compare", "--json", "a.png", "b.png"],
    &["compare-frames", "a.xyz", "b.xyz", "--from", "0", "--to", "1"],
    &["render", "a.xyz", "-o", "-", "--size", "16x16", "--renderer", "cpu"],
    &[
        "render",
        "a.xyz",
        "--video",
        "{out}.gif",
        "--turntable",
        "2",
        "--size",
        "16x16",
        "--renderer",
        "cpu",
    ],
];

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.xyz", "b.xyz"] {
        fs::write(folder.path().join(name), CUBE).unwrap();
    }
    for name in ["a.png", "b.png"] {
        image::RgbaImage::new(16, 16).save(folder.path().join(name)).unwrap();
    }
    folder
}

fn run(folder: &Path, arguments: &[&str], number: usize, stdout: Stdio, stderr: Stdio) -> Output {
    let out = format!("out{number}");
    let arguments = arguments.iter().map(|argument| argument.replace("{out}", &out));
    let mut command = Command::new(env!("CARGO_BIN_EXE_pointreel"));
    command.args(arguments).current_dir(folder).env("RUST_BACKTRACE", "0");
    let child = command
        .stdin(Stdio::null())
        .stdout(stdout)
        .stderr(stderr)
        .spawn()
        .unwrap();
    child.wait_with_output().unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let folder = folder();
    for (number, arguments) in ANSWERS.iter().enumerate() {
        let full = File::create("/dev/full").unwrap();
        let output = run(folder.path(), arguments, number, full.into(), Stdio::piped());
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
        assert!(
            said.contains("error: ") && said.contains("stdout"),
            "{arguments:?}: {said}"
        );
    }
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let folder = folder();
    for (number, arguments) in ANSWERS.iter().enumerate() {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = run(folder.path(), arguments, number, writer.into(), Stdio::piped());
        let said = String::from_utf8_lossy(&output.stderr);
        let code = output.status.code();
        // For `check`, a finding.
        assert!(matches!(code, Some(0 | 3)), "{arguments:?}: {code:?}: {said}");
        assert!(
            !said.contains("error: ") && !said.contains("panicked"),
            "{arguments:?}: {said}"
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_stderr_changes_nothing() {
    let folder = folder();
    for (number, arguments) in ANSWERS.iter().enumerate() {
        let full = File::create("/dev/full").unwrap();
        let output = run(folder.path(), arguments, number, Stdio::null(), full.into());
        assert!(
            matches!(output.status.code(), Some(0 | 3)),
            "{arguments:?}: {:?}",
            output.status
        );
    }
    let full = File::create("/dev/full").unwrap();
    let output = run(folder.path(), &["info", "missing.xyz"], 0, Stdio::null(), full.into());
    assert_eq!(output.status.code(), Some(1));
}
