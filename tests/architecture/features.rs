//! Crates absent from builds with fewer features, according to cargo.

use std::collections::BTreeSet;
use std::process::Command;

const WGPU: &[&str] = &["naga", "wgpu", "wgpu-core"];
const WINDOW: &[&str] = &["egui", "egui-winit", "rfd", "softbuffer", "winit", "x11rb"];
const SQLITE: &[&str] = &["libsqlite3-sys", "rusqlite"];

/// Names of the crates that a build with `features` alone links.
fn crates(features: &[&str]) -> BTreeSet<String> {
    let tree = Command::new(env!("CARGO"))
        .args([
            "tree",
            "--locked",
            "--offline",
            "--quiet",
            "--edges=normal",
            "--prefix=none",
            "--format={p}",
        ])
        .args(features)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let lines = String::from_utf8(tree.stdout).unwrap();
    lines
        .lines()
        .filter_map(|line| line.split(' ').next())
        .map(str::to_owned)
        .collect()
}

/// The crates of `named` that a build with `features` alone has.
fn brought(features: &[&str], named: &[&[&str]]) -> Vec<String> {
    let crates = crates(features);
    named
        .concat()
        .into_iter()
        .filter(|name| crates.contains(*name))
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_core_has_no_window_no_wgpu_and_no_sqlite() {
    let none: [String; 0] = [];
    assert_eq!(brought(&["--no-default-features"], &[WGPU, WINDOW, SQLITE]), none);
    assert_eq!(
        brought(&["--no-default-features", "--features=bench"], &[WINDOW, SQLITE]),
        none
    );
    assert_eq!(
        brought(&["--no-default-features", "--features=sqlite"], &[WGPU, WINDOW]),
        none
    );
}

/// Or else these names would be wrong ones.
#[test]
fn the_program_has_them_all() {
    assert_eq!(brought(&[], &[WGPU, WINDOW, SQLITE]), [WGPU, WINDOW, SQLITE].concat());
}
