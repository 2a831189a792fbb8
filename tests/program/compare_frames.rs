//! `pointreel compare-frames` as a person calls it.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn pointreel(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .args(arguments)
        .env("RUST_BACKTRACE", "0")
        .output()
        .unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).trim_end().to_owned()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn frames_are_compared_point_by_point() {
    let folder = tempfile::tempdir().unwrap();
    for (name, y) in [("a_0.xyz", 0.0), ("a_1.xyz", 0.25)] {
        let lines = (0..100).map(|x| format!("{x} {y} 0\n"));
        fs::write(folder.path().join(name), lines.collect::<String>()).unwrap();
    }
    let inputs = ["compare-frames", text(folder.path()), "--from", "0"];
    let output = pointreel(&[&inputs[..], &["--to", "1", "--threshold", "0.2", "--json"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    for (key, expected) in [
        ("points", 100.0),
        ("mean", 0.25),
        ("quantile_95", 0.25),
        ("max", 0.25),
        ("share_above", 1.0),
    ] {
        assert_eq!(answer[key].as_f64(), Some(expected), "{key}");
    }
    let output = pointreel(&[&inputs[..], &["--to", "1"]].concat());
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("mean                0.25"), "{table}");
    let output = pointreel(&[&inputs[..], &["--to", "7"]].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains('7'), "{}", stderr(&output));
}
