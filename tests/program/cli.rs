//! The program as a person calls it: exit codes, one clear sentence, files that are written.

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

const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";

/// A folder with three frames of three points, moved to the right by one from frame to frame.
fn small_sequence() -> tempfile::TempDir {
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
fn render_draws_every_primitive_mode_and_strategy() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("out.png");
    let stats = folder.path().join("stats.json");
    let base = [
        "render",
        "demo:",
        "-o",
        text(&picture),
        "--size",
        "96x64",
        "--stats",
        text(&stats),
    ];
    let with = |more: &[&str]| {
        let output = pointreel(&[base.as_slice(), more].concat());
        assert!(output.status.success(), "{more:?}: {}", stderr(&output));
        let image = image::open(&picture).unwrap().to_rgba8();
        assert_eq!(image.dimensions(), (96, 64));
        let stats: Value = serde_json::from_str(&fs::read_to_string(&stats).unwrap()).unwrap();
        (image, stats)
    };
    for mode in [
        "regular",
        "no-depth",
        "visibility",
        "two-pass",
        "enlarged",
        "two-pass-enlarged",
        "sorted",
    ] {
        let (_, stats) = with(&["--splatting", mode]);
        assert_eq!(stats["splatting"], mode);
        assert!(stats["frames"][0]["render"]["drawn_instances"].as_u64().unwrap() >= 1000);
    }
    for primitive in ["surfel", "voxel", "point"] {
        let arguments = ["--primitive", primitive, "--instancing", "storage"];
        let (reference, _) = with(&arguments);
        for strategy in ["uniform", "texture", "vertex", "compute"] {
            let (image, _) = with(&["--primitive", primitive, "--instancing", strategy]);
            assert!(image == reference, "{primitive}: {strategy} draws another picture");
        }
    }
    let (_, stats) = with(&["--primitive", "voxel", "--delta", "0.5", "--lod", "2"]);
    let octree = &stats["frames"][0]["octree"];
    assert!(octree["loss"].as_f64().unwrap() <= 0.5);
    assert!(octree["emitted_voxels"].as_u64().unwrap() <= octree["leaves"].as_u64().unwrap());
    for (flags, depth, max) in [
        (["--depth", "5", "--lod", "0"], Some(5), u64::MAX),
        (["--octant-points", "8", "--lod", "0"], None, u64::MAX),
        (["--delta", "0.02", "--lod-budget", "500"], None, 500),
        (["--depth", "6", "--lod-level", "2"], Some(6), 64),
        (["--depth", "6", "--lod-time", "20"], Some(6), u64::MAX),
    ] {
        let mut arguments = vec!["--primitive", "voxel"];
        arguments.extend(flags);
        let (_, stats) = with(&arguments);
        let octree = &stats["frames"][0]["octree"];
        let emitted = octree["emitted_voxels"].as_u64().unwrap();
        assert!(emitted > 0 && emitted <= max, "{flags:?}: {emitted}");
        assert!(depth.is_none_or(|depth| octree["depth"] == depth), "{flags:?}");
    }
    let points = |shape| with(&["--primitive", "point", "--point-size", "5", "--point-shape", shape]).0;
    assert!(points("disk") != points("square"));
    let (disks, _) = with(&["--renderer", "cpu"]);
    for footprint in ["masks", "pixels"] {
        let coded = ["--renderer", "cpu", "--footprint", footprint];
        let (image, stats) = with(&[&coded[..], &["--lod", "0"]].concat());
        assert!(image != disks, "{footprint}");
        let leaves = &stats["frames"][0]["octree"]["leaves"];
        let drawn = &stats["frames"][0]["render"]["drawn_instances"];
        assert!(drawn.as_u64().unwrap() > 0 && drawn.as_u64() <= leaves.as_u64());
        let (coarse, stats) = with(&[&coded[..], &["--lod-level", "3", "--normal-bits", "15"]].concat());
        assert!(coarse != image, "{footprint}");
        let drawn = &stats["frames"][0]["render"]["drawn_instances"];
        assert!((1..=512).contains(&drawn.as_u64().unwrap()), "{footprint}: {drawn}");
        let (without, _) = with(&[&coded[..], &["--lod", "0", "--offset-bits", "0"]].concat());
        assert!(without != image, "{footprint}");
        let (gpu, _) = with(&["--renderer", "gpu", "--footprint", footprint]);
        assert!(
            gpu == with(&["--renderer", "gpu"]).0,
            "{footprint}: the GPU draws disks"
        );
    }
    let (black, _) = with(&[
        "--background",
        "#000000",
        "--frame",
        "7",
        "--azimuth",
        "-90",
        "--elevation",
        "10",
        "--distance",
        "1e6",
        "--fov",
        "30",
    ]);
    assert!(
        black.pixels().filter(|pixel| pixel.0[..3] != [0, 0, 0]).count() <= 4,
        "a speck in the distance"
    );
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
fn odd_clouds_are_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let many = "1 1 1\n".repeat(50);
    let clouds = [
        (
            "empty.ply",
            "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float \
             z\nend_header\n",
        ),
        ("one.xyz", "1 2 3\n"),
        ("equal.xyz", many.as_str()),
        ("holes.xyz", "nan nan nan\n1 2 3\ninf 0 0\n2 2 3\n2 3 3\n"),
        ("nothing.xyz", "nan nan nan\n"),
        ("line.xyz", "0 0 0\n1 1 1\n2 2 2\n3 3 3\n"),
        ("far.xyz", "10000000.001 0 0\n10000000.002 0 0\n10000000.001 0.001 0\n"),
        ("huge.xyz", "-1e11 0 0\n1e11 1e11 0\n0 1e11 1e11\n"),
        ("tiny.xyz", "-1e-11 0 0\n1e-11 1e-11 0\n0 1e-11 1e-11\n"),
    ];
    let picture = folder.path().join("o.png");
    for (name, content) in clouds {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        for primitive in ["surfel", "voxel", "point"] {
            let output = pointreel(&[
                "render",
                text(&path),
                "-o",
                text(&picture),
                "--size",
                "48x48",
                "--primitive",
                primitive,
            ]);
            assert!(output.status.success(), "{name} as {primitive}: {}", stderr(&output));
        }
    }
}

#[test]
fn clouds_of_extreme_scale_are_refused_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    for (scale, remedy) in [("1e30", "1e-30 times as large"), ("1e-30", "times as large")] {
        let path = folder.path().join(format!("{scale}.xyz"));
        fs::write(&path, format!("-{scale} 0 0\n{scale} {scale} 0\n0 {scale} {scale}\n")).unwrap();
        let output = pointreel(&["render", text(&path), "-o", text(&folder.path().join("o.png"))]);
        assert_eq!(output.status.code(), Some(1), "{scale}");
        assert!(stderr(&output).contains(remedy), "{scale}: {}", stderr(&output));
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

#[test]
fn a_clipped_image_only_shows_what_is_in_the_box() {
    let folder = tempfile::tempdir().unwrap();
    let render = |name: &str, more: &[&str]| {
        let file = folder.path().join(name);
        let base = ["render", "demo:", "-o", text(&file), "--size", "64x64"];
        let output = pointreel(&[&base[..], &["--renderer", "cpu"], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        image::open(&file).unwrap().to_rgba8()
    };
    let all = "--clip-box=-1e9,-1e9,-1e9,1e9,1e9,1e9";
    let none = "--clip-box=1e8,1e8,1e8,1e9,1e9,1e9";
    for primitive in ["surfel", "voxel", "point"] {
        let picture = |more: &[&str]| {
            let more = [&["--primitive", primitive], more].concat();
            render("clipped.png", &more)
        };
        let [whole, empty] = [picture(&[]), picture(&[none])];
        assert_ne!(whole, empty, "{primitive}");
        assert_eq!(picture(&[all]), whole, "{primitive}");
        assert_eq!(picture(&[all, "--clip-outside"]), empty, "{primitive}");
        assert_eq!(picture(&[none, "--clip-outside"]), whole, "{primitive}");
    }
    let output = pointreel(&["render", "demo:", "-o", "x.png", "--clip-box", "1,2,3"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("expected six numbers"));
}

#[test]
fn trails_are_drawn_and_their_breaks_reported() {
    let folder = small_sequence();
    let picture = folder.path().join("way.png");
    let render = |more: &[&str]| {
        let input = ["render", text(folder.path()), "-o", text(&picture), "--frame", "1"];
        let how = [
            "--primitive",
            "point",
            "--renderer",
            "cpu",
            "--size",
            "200x200",
            "--distance",
            "6",
            "--eye-dome",
            "off",
            "--up",
            "y",
        ];
        pointreel(&[&input[..], &how[..], more].concat())
    };
    // Only trails are orange.
    let orange = || {
        let image = image::open(&picture).unwrap().to_rgba8();
        let is_orange = |pixel: &&image::Rgba<u8>| pixel.0 == [255, 190, 60, 255];
        image.pixels().filter(is_orange).count()
    };
    assert!(render(&[]).status.success());
    assert_eq!(orange(), 0);
    let output = render(&["--trail", "0,2"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
    assert!(orange() > 20, "{}", orange());

    let output = render(&["--trail", "3"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("point 3 does not exist: frame 2 of 3 (index 1) has 3 points"),
        "{}",
        stderr(&output)
    );
    fs::write(folder.path().join("f11.xyz"), "0 0 0\n1 1 1\n").unwrap();
    let output = render(&["--trail", "1"]);
    assert!(output.status.success());
    assert!(
        stderr(&output).contains("frame 4 of 4 (index 3) has 2 points, frame 3 of 4 (index 2) has 3"),
        "{}",
        stderr(&output)
    );
}
