//! The program as a person calls it: exit codes, one clear sentence, and the output of `info` and `bench`.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

pub(crate) fn pointreel(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .args(arguments)
        .env("RUST_BACKTRACE", "0")
        .output()
        .unwrap()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).trim_end().to_owned()
}

pub(crate) fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";

/// A folder with three frames of three points, moved to the right by one from frame to frame.
pub(crate) fn small_sequence() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for frame in 0..3 {
        let points = format!("{frame} 0 0 255 0 0\n{frame} 1 0 0 255 0\n{frame} 0 1 0 0 255\n");
        fs::write(
            folder.path().join(format!("f{}.ply", frame * 4 + 2)),
            HEADER.to_owned() + &points,
        )
        .unwrap();
    }
    folder
}

#[test]
fn help_has_headings_and_short_lines() {
    let usual = ["Options:", "Reading:", "Rendering:", "Level of detail:", "View:"];
    let of_subcommands = [
        ("view", usual.to_vec()),
        ("render", [&usual[..], &["Video:", "Other frames:"]].concat()),
    ];
    for (subcommand, headings) in of_subcommands {
        let output = pointreel(&[subcommand, "--help"]);
        assert!(output.status.success(), "{subcommand}");
        let help = String::from_utf8(output.stdout).unwrap();
        let lines: Vec<&str> = help.lines().collect();
        for heading in headings {
            let count = lines.iter().filter(|&&line| line == heading).count();
            assert_eq!(count, 1, "{subcommand}: {heading}");
        }
        for line in lines {
            assert!(line.chars().count() <= 115, "{subcommand}: {line}");
        }
    }
}

#[test]
fn info_reports_the_contents() {
    let folder = small_sequence();
    let output = pointreel(&["info", text(folder.path()), "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let info: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(info["origin"], serde_json::json!([0.0, 0.0, 0.0]));
    let frames = info["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 3);
    // f2, f6, f10: by number, not alphabetically.
    assert!(frames[2]["file"].as_str().unwrap().ends_with("f10.ply"));
    assert_eq!(frames[1]["index"], 1);
    assert_eq!(frames[1]["points"], 3);
    assert_eq!(frames[1]["finite_points"], 3);
    assert_eq!(frames[1]["min"], serde_json::json!([1.0, 0.0, 0.0]));
    assert_eq!(frames[1]["max"], serde_json::json!([1.0, 1.0, 1.0]));
    assert_eq!(frames[1]["attributes"], serde_json::json!(["position", "color"]));
    let table = pointreel(&["info", text(folder.path())]);
    let table = String::from_utf8_lossy(&table.stdout).into_owned();
    assert!(table.contains("3 frames"));
    assert!(!table.contains("where the others have"), "{table}");

    // An organised cloud, with a hole.
    let organised = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 2\nVIEWPOINT 0 0 0 \
        1 0 0 0\nPOINTS 4\nDATA ascii\n0 0 1\nnan nan nan\n0 1 1\n1 1 1\n";
    let image = folder.path().join("image.pcd");
    fs::write(&image, organised).unwrap();
    let table = pointreel(&["info", text(&image)]);
    let table = String::from_utf8_lossy(&table.stdout).into_owned();
    assert!(table.contains("position, organised 2 × 2, "), "{table}");
    fs::remove_file(image).unwrap();

    // A frame with only positions among coloured ones.
    fs::write(folder.path().join("f11.xyz"), "0 0 0\n1 1 1\n").unwrap();
    let table = pointreel(&["info", text(folder.path())]);
    let table = String::from_utf8_lossy(&table.stdout).into_owned();
    let expected = "frame 4 (index 3) has position where the others have position, color";
    assert!(table.contains(expected), "{table}");
}

#[test]
fn one_broken_frame_does_not_hide_the_others() {
    let folder = small_sequence();
    fs::write(
        folder.path().join("f7.ply"),
        "ply\nformat ascii 1.0\nelement vertex 1000000000000\n",
    )
    .unwrap();
    let output = pointreel(&["info", text(folder.path()), "--json"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("f7.ply"), "{}", stderr(&output));
    let info: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(info["frames"][2]["error"].as_str().unwrap().contains("f7.ply"));
    assert_eq!(info["frames"][3]["points"], 3);

    let pictures = tempfile::tempdir().unwrap();
    let pattern = pictures.path().join("new/p{frame}.png");
    let output = pointreel(&[
        "render",
        text(folder.path()),
        "-o",
        text(&pattern),
        "--frame",
        "0..3",
        "--size",
        "32x32",
    ]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("1 of 4 frames could not be rendered"),
        "{}",
        stderr(&output)
    );
    let written: Vec<bool> = (0..4)
        .map(|i| pictures.path().join(format!("new/p{i:04}.png")).exists())
        .collect();
    assert_eq!(written, [true, true, false, true]);
}

#[test]
fn broken_faces_are_reported_by_every_command_and_lose_no_point() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mesh.ply");
    let mesh = HEADER.replace(
        "end_header\n",
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n",
    ) + "0 0 0 255 0 0\n0 1 0 0 255 0\n0 0 1 0 0 255\n3 0 1 7\n";
    fs::write(&file, mesh).unwrap();
    let expected = format!(
        "{}, face 0: it names vertex 7, expected a whole number from 0 to below 3",
        file.display()
    );
    let picture = folder.path().join("a.png");
    let converted = folder.path().join("b.ply");
    for arguments in [
        &["info", text(&file)][..],
        &[
            "render",
            text(&file),
            "-o",
            text(&picture),
            "--size",
            "32x32",
            "--renderer",
            "cpu",
            "--up",
            "y",
            "--primitive",
            "point",
        ],
        &["convert", text(&file), text(&converted)],
    ] {
        let output = pointreel(arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        let said = stderr(&output);
        assert_eq!(said.matches(&expected).count(), 1, "{arguments:?}: {said}");
        assert_eq!(said.lines().count(), 1, "{arguments:?}: {said}");
        assert!(said.starts_with("warning: "), "{said}");
    }
    assert!(picture.exists());
    let output = pointreel(&["check", text(&file), "--json"]);
    assert_eq!(output.status.code(), Some(3));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["point_count"], 3);
    assert_eq!(report["findings"][0]["kind"], "unreadable_part");
    let output = pointreel(&["info", text(&converted), "--json"]);
    let info: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(info["frames"][0]["points"], 3);
    assert_eq!(info["frames"][0]["warnings"], Value::Null);
}

#[test]
fn a_hundred_warnings_of_one_kind_are_one_line() {
    let folder = small_sequence();
    for frame in 100..200 {
        let file = folder.path().join(format!("f{frame}.ply"));
        fs::write(file, format!("{HEADER}0 0 0 255 0 0\n0 {frame}")).unwrap();
    }
    let out = tempfile::tempdir().unwrap();
    for subcommand in [&["info"][..], &["convert"], &["check"]] {
        let mut arguments = subcommand.to_vec();
        arguments.push(text(folder.path()));
        if subcommand == ["convert"] {
            arguments.push(text(out.path()));
        }
        // The findings of `check` are its output.
        let said = |arguments: &[&str]| {
            let output = pointreel(arguments);
            if subcommand == ["check"] {
                String::from_utf8_lossy(&output.stdout).into_owned()
            } else {
                stderr(&output)
            }
        };
        let one = said(&arguments);
        let lines: Vec<&str> = one.lines().filter(|line| line.contains(".ply, ")).collect();
        assert_eq!(lines.len(), 1, "{subcommand:?}: {one}");
        assert!(lines[0].contains("f100.ply, vertex 1: the file ends"), "{one}");
        assert!(lines[0].contains("(and 99 more "), "{one}");
        assert!(lines[0].ends_with("; --verbose lists them)"), "{one}");
        arguments.push("--verbose");
        let all = said(&arguments);
        let lines = all.lines().filter(|line| line.contains(".ply, vertex 1: the"));
        assert_eq!(lines.count(), 100, "{subcommand:?}: {all}");
    }
}

/// An image of the small sequence by a program that was started without a login to a desktop.
fn render_without_session(renderer: &str, variables: &[(&str, &str)]) -> Output {
    let folder = small_sequence();
    let picture = folder.path().join("picture.png");
    let mut command = Command::new(env!("CARGO_BIN_EXE_pointreel"));
    command.args(["render", text(folder.path()), "-o", text(&picture)]);
    // Guesses would be printed.
    command.args(["--up", "y", "--primitive", "point"]);
    command.args(["--size", "32x32", "--renderer", renderer]);
    for name in ["XDG_RUNTIME_DIR", "DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    let output = command.envs(variables.iter().copied()).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(picture.exists());
    output
}

#[test]
fn no_warnings_appear_without_a_desktop() {
    for renderer in ["auto", "cpu", "gpu"] {
        let output = render_without_session(renderer, &[]);
        assert_eq!(stderr(&output), "", "--renderer {renderer}");
    }
}

#[test]
#[cfg(target_os = "linux")]
#[expect(clippy::print_stderr, reason = "a test that is skipped says so to who runs it")]
fn no_driver_is_opened_where_no_gpu_can_exist() {
    if ["/dev/dri", "/dev/nvidiactl", "/dev/dxg", "/dev/kfd"].map(|path| Path::new(path).exists()) != [false; 4] {
        eprintln!("skipped: this machine may have a graphics card, whose driver is opened");
        return;
    }
    // The Vulkan loader logs everything it does to stderr, from the first call on.
    let loader_tells = [("VK_LOADER_DEBUG", "all")];
    let by_adapter = render_without_session("gpu", &loader_tells);
    assert!(stderr(&by_adapter).contains("Vulkan"), "{}", stderr(&by_adapter));
    let by_processor = render_without_session("auto", &loader_tells);
    assert_eq!(stderr(&by_processor), "");
}

#[test]
fn failures_exit_with_1_and_wrong_usage_with_2() {
    let folder = small_sequence();
    let empty = tempfile::tempdir().unwrap();
    let sequence = text(folder.path());
    let cases: [(i32, &[&str], &str); 14] = [
        (1, &["info", "/no/such/place"], "/no/such/place does not exist"),
        (1, &["info", text(empty.path())], "no point cloud is in the folder"),
        (
            1,
            &["render", sequence, "-o", "/no/such/place/o.png", "--size", "8x8"],
            "/no/such/place/o.png cannot be written",
        ),
        (
            1,
            &["render", sequence, "-o", "o.png", "--frame", "9"],
            "frame 9 does not exist: the sequence has 3 frames",
        ),
        (
            1,
            &["render", sequence, "-o", "o.png", "--frame", "0..2"],
            "put {frame} into its name",
        ),
        (
            1,
            &["render", sequence, "-o", "o.png", "--size", "1000000x8"],
            "edges are from 1 to 65536 pixels long",
        ),
        (2, &["render", sequence], "--output"),
        (
            2,
            &["render", sequence, "-o", "o.png", "--splatting", "best"],
            "invalid value 'best' for '--splatting <MODE>'",
        ),
        (
            2,
            &["render", sequence, "-o", "o.png", "--size", "12"],
            "expected WIDTHxHEIGHT",
        ),
        (
            2,
            &["render", sequence, "-o", "o.png", "--delta", "0.9"],
            "from 0 to 0.6",
        ),
        (2, &["info"], "INPUT"),
        (2, &["frobnicate", "--hard"], "unexpected argument"),
        (2, &["inof", sequence], "did you mean `pointreel info`?"),
        (
            2,
            &["render", sequence, "-o", "o.png", "--lighting", "lamber"],
            "a similar value exists: 'lambert'",
        ),
    ];
    for (code, arguments, expected) in cases {
        let output = pointreel(arguments);
        let stderr = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {stderr}");
        assert!(stderr.contains(expected), "{arguments:?}: {stderr}");
        assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
        if code == 1 {
            assert_eq!(stderr.lines().count(), 1, "{arguments:?}: {stderr}");
        }
    }
}

#[test]
fn bench_without_an_input_measures_the_demo() {
    let folder = tempfile::tempdir().unwrap();
    let [json, csv] = ["table.json", "table.csv"].map(|name| folder.path().join(name));
    let mut arguments = vec!["bench", "octree", "--frames", "1", "--viewpoints", "1"];
    arguments.extend(["--repeat", "1", "--size", "64x48"]);
    arguments.extend(["--json", text(&json), "--csv", text(&csv)]);
    let output = pointreel(&arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("sequence  demo: 1 of 24 frames"));
    let report: Value = serde_json::from_slice(&fs::read(&json).unwrap()).unwrap();
    assert_eq!(report["suite"], "octree");
    assert_eq!(report["rows"][0]["sequence"], "demo");
    // A heading and one line per δ.
    assert_eq!(fs::read_to_string(&csv).unwrap().lines().count(), 4);
}

#[test]
fn bench_names_its_suites() {
    let output = pointreel(&["bench", "speed"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains(
            "expected surfels, octree, voxels, accuracy, render, play, window, error, temporal, lod, primitives, \
             coded, reel, rate, rgbd, vdts or stability"
        ),
        "{}",
        stderr(&output)
    );
}
