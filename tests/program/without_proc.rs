//! The program where `/proc` is empty, as in some sandboxes: it reports less about itself, and does everything else.

#![cfg(target_os = "linux")]

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output};

/// Runs a command of the shell with an empty `/proc`; `None` where the system does not allow namespaces.
fn without_proc(command: &str) -> Option<Output> {
    let script = format!("mount -t tmpfs none /proc || exit 77; {command}");
    let output = Command::new("unshare")
        .args(["-rm", "sh", "-c", &script])
        .output()
        .ok()?;
    let said = String::from_utf8_lossy(&output.stderr);
    let is_refused = output.status.code() == Some(77) || said.starts_with("unshare:");
    if is_refused {
        // Not by `eprintln!`: the harness captures the output of passing tests.
        let _ = writeln!(std::io::stderr(), "skipped: {said}");
    }
    (!is_refused).then_some(output)
}

#[test]
fn every_command_works_without_proc() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.xyz");
    std::fs::write(&input, "0 0 0\n1 0 0\n0 1 0\n0 0 1\n").unwrap();
    let program = env!("CARGO_BIN_EXE_pointreel");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let input = input.display();
    for arguments in [
        format!("info {input}"),
        format!("check {input}"),
        format!("convert {input} {}", path("a.reel")),
        format!("info {}", path("a.reel")),
        format!("render {input} -o {} --size 32x32 --renderer cpu", path("a.png")),
    ] {
        let Some(output) = without_proc(&format!("exec {program} {arguments}")) else {
            return;
        };
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.success() && !said.contains("panicked"),
            "{arguments}: {said}"
        );
    }
    assert!(Path::new(&path("a.png")).exists());
}
