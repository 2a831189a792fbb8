//! Fields by their names on the command line: "any field by name".

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const NAMES: [&str; 3] = ["velocity", "C2C_absolute_distances", "segment"];

fn pointreel(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .args(arguments)
        .env("RUST_BACKTRACE", "0")
        .output()
        .unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A cloud of a grid with fields of these names.
fn cloud(folder: &Path) -> std::path::PathBuf {
    let properties: Vec<String> = ["x", "y", "z"]
        .into_iter()
        .chain(NAMES)
        .map(|name| format!("property float {name}\n"))
        .collect();
    let rows: Vec<String> = (0..100)
        .map(|place| format!("{} {} 0 {place} {} 7\n", place % 10, place / 10, -place))
        .collect();
    let path = folder.join("a.ply");
    let [properties, rows] = [properties.concat(), rows.concat()];
    let file = format!("ply\nformat ascii 1.0\nelement vertex 100\n{properties}end_header\n{rows}");
    fs::write(&path, file).unwrap();
    path
}

fn rendered(input: &Path, colors: &str, picture: &Path) -> Output {
    let arguments = [
        "render",
        text(input),
        "-o",
        text(picture),
        "--size",
        "64x48",
        "--renderer",
        "cpu",
        "--primitive",
        "point",
        "--colors",
        colors,
    ];
    pointreel(&arguments)
}

#[test]
fn points_are_colored_by_any_field() {
    let folder = tempfile::tempdir().unwrap();
    let input = cloud(folder.path());
    let mut pictures = Vec::new();
    for name in NAMES {
        let picture = folder.path().join(format!("{name}.png"));
        let output = rendered(&input, &format!("scalar:{name}"), &picture);
        assert!(
            output.status.success(),
            "{name}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        pictures.push(fs::read(picture).unwrap());
    }
    assert_ne!(pictures[0], pictures[1]);
    assert_ne!(pictures[0], pictures[2]);
}

#[test]
fn a_missing_field_is_wrong_usage() {
    let folder = tempfile::tempdir().unwrap();
    let input = cloud(folder.path());
    let picture = folder.path().join("a.png");
    let output = rendered(&input, "scalar:speed", &picture);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("`speed`"), "{said}");
    for name in NAMES {
        assert!(said.contains(name), "{said}");
    }
    assert!(!picture.exists());
}

#[test]
fn conversion_preserves_every_field() {
    let folder = tempfile::tempdir().unwrap();
    let input = cloud(folder.path());
    for extension in ["ply", "pcd", "las", "laz", "xyz", "npy"] {
        let output = folder.path().join(format!("b.{extension}"));
        let done = pointreel(&["convert", text(&input), text(&output)]);
        assert!(
            done.status.success(),
            "{extension}: {}",
            String::from_utf8_lossy(&done.stderr)
        );
        let back = pointreel::io::read(&output).unwrap();
        let names: Vec<&str> = back
            .attributes
            .scalars
            .iter()
            .map(|field| field.name.as_str())
            .collect();
        for name in NAMES {
            assert!(names.contains(&name), "{extension}: {names:?}");
        }
    }
}
