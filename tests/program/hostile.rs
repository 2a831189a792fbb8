//! Files that a stranger could send: each is refused in a sentence or shown, within seconds, by every command.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A command that takes longer, even on a busy machine, hangs.
const PATIENCE: Duration = Duration::from_mins(1);

/// Output of a finished command.
fn finished(mut child: Child, what: &str) -> Output {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("{what} has not ended after {PATIENCE:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().unwrap()
}

fn run(arguments: &[&str]) -> Output {
    let child = Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    finished(child, &arguments.join(" "))
}

fn sequence_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let files = entries.map(|entry| entry.unwrap().path());
    files
        .filter(|path| path.extension().is_some_and(|extension| extension == "reel"))
        .collect()
}

#[test]
fn sequence_files_with_false_declarations_are_rejected_by_every_command() {
    let Some(folder) = super::data::shared("hostile") else {
        return;
    };
    let scratch = tempfile::tempdir().unwrap();
    for file in sequence_files(&folder) {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let copy = scratch.path().join(&name);
        std::fs::copy(&file, &copy).unwrap();
        if name.contains("1TB") {
            let sparse = std::fs::OpenOptions::new().write(true).open(&copy);
            // Not every file system supports files of that size.
            let _ = sparse.unwrap().set_len(1_099_512_628_255);
        }
        let input = copy.to_str().unwrap();
        let picture = scratch.path().join("picture.png");
        let frames = scratch.path().join(format!("frames of {name}"));
        // One has a bad name, the other a bad frame in addition to three good ones.
        let is_fine = name.contains("escapes") || name.contains("1TB");
        for arguments in [
            &["info", input][..],
            &["check", input],
            &["convert", input, frames.to_str().unwrap()],
            &[
                "render",
                input,
                "-o",
                picture.to_str().unwrap(),
                "--size",
                "32x32",
                "--renderer",
                "cpu",
            ],
        ] {
            let output = run(arguments);
            let said = String::from_utf8_lossy(&output.stderr);
            let code = output.status.code();
            assert!(matches!(code, Some(0 | 1 | 3)), "{arguments:?}: {code:?}: {said}");
            assert!(is_fine || code != Some(0), "{arguments:?}: {said}");
            assert!(!said.contains("panicked"), "{arguments:?}: {said}");
        }
    }
}
