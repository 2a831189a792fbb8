//! Session files on the command line: `render` draws one as the window would, and errors are reported.

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

/// The bytes that `render` writes.
fn rendered(folder: &Path, arguments: &[&str]) -> Vec<u8> {
    let picture = folder.join("picture.png");
    let common = ["-o", text(&picture), "--size", "160x120", "--renderer", "cpu"];
    let output = pointreel(&[&["render"], arguments, &common].concat());
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    assert_eq!(stderr(&output), "", "{arguments:?}");
    fs::read(&picture).unwrap()
}

const VIEW: &str = "pointreel view 1: target 0 0.9 0 distance 3.5 azimuth 40 elevation 10 fov 45 up y perspective";

fn session(files: &str, more: &str) -> String {
    format!(r#"{{"pointreel_session": 1, "files": ["{files}"], "frame": 6, "view": "{VIEW}"{more}}}"#)
}

#[test]
fn a_session_draws_the_same_bytes_as_the_equivalent_options() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.pointreel");
    let settings = r#", "settings": {"primitive": "point", "point_size_px": 4.0, "grid": true},
        "clip": {"on": true, "box": [[-9, 0.5, -9], [9, 9, 9]]}"#;
    fs::write(&file, session("demo:", settings)).unwrap();
    let of_session = rendered(folder.path(), &[text(&file)]);
    let options = [
        "demo:",
        "--frame",
        "6",
        "--view",
        VIEW,
        "--primitive",
        "point",
        "--point-size",
        "4",
        "--grid",
        "--clip-box",
        "-9,0.5,-9,9,9,9",
    ];
    assert_eq!(of_session, rendered(folder.path(), &options));
    // Twice the same, and explicit options take precedence over the session.
    assert_eq!(of_session, rendered(folder.path(), &[text(&file)]));
    let given = rendered(folder.path(), &[text(&file), "--frame", "9", "--primitive", "voxel"]);
    assert_ne!(of_session, given);
    let options = [
        &["demo:", "--frame", "9", "--primitive", "voxel"],
        &options[3..5],
        &options[9..],
    ]
    .concat();
    assert_eq!(given, rendered(folder.path(), &options));
}

#[test]
fn labels_are_in_images_and_the_camera_path_drives_the_video() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.pointreel");
    fs::write(&file, session("demo:", "")).unwrap();
    // The session states no primitive: it would be guessed, which is reported.
    let picture = || rendered(folder.path(), &[text(&file), "--primitive", "surfel"]);
    let without = picture();
    let label = r#", "labels": [{"text": "Gehender Mann", "at": [0, 0.9, 0]}]"#;
    fs::write(&file, session("demo:", label)).unwrap();
    assert_ne!(picture(), without);
    let key = |time_s: f64, frame: u32| {
        format!(
            r#"{{"time_s": {time_s}, "frame": {frame}, "target": [0, 0.9, 0], "distance": 4, "azimuth_deg": 0,
            "elevation_deg": 0, "fov_deg": 45}}"#
        )
    };
    let path = format!(
        r#", "camera_path": {{"pointreel_path": 1, "up": "y", "keyframes": [{}, {}]}}"#,
        key(0.0, 3),
        key(0.2, 5)
    );
    fs::write(&file, session("demo:", &path)).unwrap();
    let (video, stats) = (folder.path().join("a.gif"), folder.path().join("s.json"));
    let arguments = ["render", text(&file), "--video", text(&video), "--stats", text(&stats)];
    let output = pointreel(&[&arguments[..], &["--fps", "10", "--size", "64x48", "--renderer", "cpu"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let stats: Value = serde_json::from_slice(&fs::read(&stats).unwrap()).unwrap();
    let frames = stats["frames"].as_array().unwrap().iter();
    assert_eq!(
        frames.map(|frame| frame["index"].as_u64().unwrap()).collect::<Vec<_>>(),
        [3, 4, 5]
    );
}

#[test]
fn info_describes_a_session_and_other_commands_use_its_files() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("scans")).unwrap();
    fs::write(folder.path().join("scans/a.xyz"), "0 0 0\n1 0 0\n0 1 0\n").unwrap();
    let file = folder.path().join("walk.pointreel");
    let more = r#", "labels": [{"text": "knee", "point": 1}], "markers": [{"frame": 0}],
        "compare": {"files": ["smooth"]}"#;
    fs::write(&file, session("scans", more)).unwrap();
    let output = pointreel(&["info", text(&file)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        said.contains("frame 7 (index 6), 1 label, 0 measurements, 1 marker, 0 keyframes"),
        "{said}"
    );
    assert!(said.contains("labels: \"knee\"") && said.contains("smooth"), "{said}");
    let output = pointreel(&["info", "--json", text(&file)]);
    let info: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(info["session"]["labels"], serde_json::json!(["knee"]));
    assert_eq!(info["frames"].as_array().unwrap().len(), 1);
    let more = r#", "up": "-y", "range": {"first": 2, "last": 8}, "reading": {"fps": 12.0}, "notes": "left\nfoot",
        "settings": {"grid": true}, "trails": {"picked": true, "spread": {"points": 4, "frames": 2}}"#;
    fs::write(&file, session("scans", more)).unwrap();
    let output = pointreel(&["info", text(&file)]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let lines = [
        "up axis: -y",
        "plays: from frame 3, to frame 9",
        "reading: fps 12.0",
        "settings: grid true",
        "trails: of picked points, 4 spread over the frame",
        "notes: left, foot",
    ];
    for line in lines {
        assert!(said.contains(line), "no {line} in {said}");
    }
    let output = pointreel(&["info", "--json", text(&file)]);
    let info: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(info["session"]["notes"], "left\nfoot");
    assert_eq!(
        info["session"]["trails"],
        serde_json::json!({"of_picked": true, "kept": 0, "spread": 4})
    );
    let copy = folder.path().join("copy.ply");
    let output = pointreel(&["convert", text(&file), text(&copy)]);
    assert!(output.status.success() && copy.exists(), "{}", stderr(&output));
}

#[test]
fn errors_are_one_sentence_with_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.pointreel");
    for (text_of_file, message) in [
        ("{\n\"pointreel_session\": 9\n}", "open it with a newer pointreel"),
        (
            "{\n\"pointreel_session\": 1,\n\"files\": [\"demo:\"],\n\"labels\": [{\"text\": \"a\"}]}",
            "at line 4",
        ),
        ("solid cube", "is not a session that can be opened"),
    ] {
        fs::write(&file, text_of_file).unwrap();
        let output = pointreel(&["render", text(&file), "-o", "never.png"]);
        assert_eq!(output.status.code(), Some(1));
        let said = stderr(&output);
        assert!(said.contains(message) && said.contains("walk.pointreel"), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
    let output = pointreel(&["render", "gone.pointreel", "-o", "never.png"]);
    assert!(
        stderr(&output).contains("the session gone.pointreel cannot be read"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn without_a_view_the_up_axis_of_a_session_applies() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.pointreel");
    let of_session = |more: &str, arguments: &[&str]| {
        let text_of_file = format!(r#"{{"pointreel_session": 1, "files": ["demo:"], "frame": 6{more}}}"#);
        fs::write(&file, text_of_file).unwrap();
        rendered(
            folder.path(),
            &[&[text(&file), "--primitive", "point"], arguments].concat(),
        )
    };
    let up = r#", "up": "-z""#;
    let options = |up: &str| {
        let arguments = ["demo:", "--frame", "6", "--primitive", "point", "--up", up];
        rendered(folder.path(), &arguments)
    };
    assert_eq!(of_session(up, &[]), options("-z"));
    assert_eq!(of_session(up, &["--up", "x"]), options("x"));
    // A view contains its own up axis.
    let view = format!(r#", "view": "{VIEW}""#);
    assert_eq!(of_session(&format!("{up}{view}"), &[]), of_session(&view, &[]));
}
