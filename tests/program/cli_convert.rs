//! `pointreel check` and `pointreel convert` as a person, a script or a job runner calls them.

use glam::DVec3;
use pointreel::io;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn pointreel(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .args(arguments)
        .output()
        .unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Names of the visible files, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| !name.starts_with('.'))
        .collect();
    names.sort();
    names
}

/// Seven frames of four points, numbered from 1.
fn sequence() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for frame in 1..=7 {
        let points = format!("{frame} 0 0\n{frame} 9 0\n{frame} 0 9\n{frame} 1 1.5\n");
        fs::write(folder.path().join(format!("scan_{frame}.xyz")), points).unwrap();
    }
    folder
}

#[test]
fn check_exits_with_3_where_it_finds_something() {
    let folder = sequence();
    let clean = pointreel(&["check", text(folder.path()), "--json"]);
    let report: Value = serde_json::from_slice(&clean.stdout).unwrap();
    assert_eq!(clean.status.code(), Some(0), "{report:#}");
    assert_eq!(report["frame_count"], 7);
    assert_eq!(report["point_count"], 28);
    assert_eq!(report["findings"], serde_json::json!([]));

    fs::remove_file(folder.path().join("scan_4.xyz")).unwrap();
    fs::write(folder.path().join("scan_6.xyz"), "no numbers here\n").unwrap();
    let found = pointreel(&["check", text(folder.path()), "--json"]);
    assert_eq!(found.status.code(), Some(3));
    let report: Value = serde_json::from_slice(&found.stdout).unwrap();
    let kinds: Vec<&str> = report["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|finding| finding["kind"].as_str().unwrap())
        .collect();
    // The most severe first.
    assert_eq!(kinds, ["unreadable_frame", "number_gap"]);
    let severities = [&report["findings"][0]["severity"], &report["findings"][1]["severity"]];
    assert_eq!(severities, ["error", "warning"]);
    let said = pointreel(&["check", text(folder.path())]);
    assert_eq!(said.status.code(), Some(3));
    let words = String::from_utf8_lossy(&said.stdout).into_owned();
    let lines: Vec<&str> = words.lines().collect();
    assert!(
        lines[0].starts_with("- error: ") && lines[0].contains("scan_6.xyz"),
        "{words}"
    );
    assert!(
        lines[1].starts_with("- warning: ") && lines[1].contains("scan_3.xyz"),
        "{words}"
    );
    let summary = String::from_utf8_lossy(&said.stderr).into_owned();
    assert!(summary.lines().any(|line| line == "1 error, 1 warning"), "{summary}");
}

#[test]
fn frames_round_trip_through_every_format() {
    let folder = sequence();
    for format in ["ply", "ply-ascii", "pcd", "las", "laz", "xyz", "npy"] {
        let out = folder.path().join(format!("as {format}"));
        let output = pointreel(&["convert", text(folder.path()), text(&out), "--format", format]);
        assert!(output.status.success(), "{format}: {output:?}");
        let names = names(&out);
        assert_eq!(names.len(), 7, "{format}: {names:?}");
        for (name, x) in names.iter().zip(1..) {
            let cloud = io::read(&out.join(name)).unwrap();
            assert_eq!(cloud.positions.len(), 4, "{format}");
            let last = cloud.positions.get(3);
            let expected = DVec3::new(f64::from(x), 1.0, 1.5);
            assert!(last.distance(expected) < 1e-3, "{format}: {last}");
        }
    }
}

#[test]
fn one_frame_is_written_to_one_file_transformed_and_merged() {
    let folder = sequence();
    let one = folder.path().join("one.ply");
    let matrix = folder.path().join("move.txt");
    fs::write(&matrix, "1 0 0 1000\n0 1 0 0\n0 0 1 0\n0 0 0 1\n").unwrap();
    let arguments = [
        "convert",
        text(folder.path()),
        text(&one),
        "--frames",
        "2",
        "--transform",
        text(&matrix),
        "--voxel",
        "10",
    ];
    let output = pointreel(&arguments);
    // `move.txt` is in the folder too, as a cloud with rows of four numbers.
    assert!(output.status.success(), "{output:?}");
    let cloud = io::read(&one).unwrap();
    assert_eq!(cloud.positions.len(), 1);
    let many = pointreel(&["convert", text(folder.path()), text(&one)]);
    assert_eq!(many.status.code(), Some(1));
    let said = String::from_utf8_lossy(&many.stderr).into_owned();
    assert!(said.contains("--frames"), "{said}");
}

/// The job file as Slurm runs it: once per index of the array, in any order, one of them twice.
#[cfg(unix)]
#[test]
fn the_job_file_distributes_a_sequence() {
    let folder = sequence();
    let out = folder.path().join("out");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/convert-array.sbatch");
    let program = Path::new(env!("CARGO_BIN_EXE_pointreel"));
    let path = format!(
        "{}:{}",
        program.parent().unwrap().display(),
        std::env::var("PATH").unwrap_or_default()
    );
    let run = |task: &str| {
        let output = Command::new("bash")
            .arg(&script)
            .args([text(folder.path()), text(&out), "--format", "pcd"])
            .env("PATH", &path)
            .env("SLURM_ARRAY_TASK_ID", task)
            .env("SLURM_ARRAY_TASK_COUNT", "3")
            .env("SLURM_CPUS_PER_TASK", "1")
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    assert!(run("3").starts_with("2 frames written"));
    assert_eq!(names(&out), ["scan_3.pcd", "scan_6.pcd"]);
    assert!(run("1").starts_with("3 frames written"));
    assert!(run("1").starts_with("0 frames written"));
    assert!(run("2").starts_with("2 frames written"));
    assert_eq!(names(&out).len(), 7);
    // Outside a job array it prints how to start one.
    let alone = Command::new("bash").arg(&script).output().unwrap();
    assert!(String::from_utf8_lossy(&alone.stderr).contains("--array"));
}

/// Tasks of an array write parts of a sequence file, which are joined once all of them are there.
#[cfg(unix)]
#[test]
fn shards_of_a_sequence_file_are_parts() {
    let folder = sequence();
    let out = tempfile::tempdir().unwrap();
    let walk = out.path().join("walk.reel");
    let whole = out.path().join("whole.reel");
    let run = |arguments: &[&str]| {
        let output = pointreel(arguments);
        let said = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
        (output.status.success(), said.concat())
    };
    // All at the same time, and one of them twice.
    let tasks: Vec<_> = ["1/3", "2/3", "3/3", "2/3"]
        .into_iter()
        .map(|shard| {
            let mut task = Command::new(env!("CARGO_BIN_EXE_pointreel"));
            task.args(["convert", text(folder.path()), text(&walk), "--shard", shard]);
            (shard, task.spawn().unwrap())
        })
        .collect();
    for (shard, mut task) in tasks {
        // The duplicate may find the other one running, and reports it.
        assert!(task.wait().unwrap().success() || shard == "2/3");
    }
    let parts = [
        "walk.part-1-of-3.reel",
        "walk.part-2-of-3.reel",
        "walk.part-3-of-3.reel",
    ];
    assert_eq!(
        names(out.path()),
        parts,
        "nothing has the name of the whole, nothing is hidden"
    );
    let (is_done, said) = run(&["convert", text(folder.path()), text(&walk), "--shard", "2/3"]);
    assert!(is_done && said.contains("0 frames written"), "{said}");
    // A part that is missing, occurs twice, or belongs to another.
    let part = |index: usize| out.path().join(parts[index]);
    let joined = out.path().join("joined.reel");
    let refused = |inputs: &[&Path], reason: &str| {
        let inputs = inputs.iter().map(|path| text(path));
        let arguments: Vec<&str> = ["convert", "--join"]
            .into_iter()
            .chain(inputs)
            .chain([text(&joined)])
            .collect();
        let (is_done, said) = run(&arguments);
        assert!(
            !is_done && said.contains(reason) && !joined.exists(),
            "{reason}: {said}"
        );
    };
    refused(&[&part(0), &part(2)], "missing: 2");
    refused(&[&part(0), &part(1), &part(1), &part(2)], "both part 2 of 3");
    let other = out.path().join("other.reel");
    assert!(
        run(&[
            "convert",
            text(folder.path()),
            text(&other),
            "--shard",
            "2/3",
            "--merge"
        ])
        .0
    );
    refused(
        &[&part(0), &out.path().join("other.part-2-of-3.reel"), &part(2)],
        "other options",
    );
    let cut = out.path().join("cut.reel");
    let bytes = fs::read(part(1)).unwrap();
    fs::write(&cut, &bytes[..bytes.len() - 30]).unwrap();
    refused(&[&part(0), &cut, &part(2)], "not whole");
    fs::remove_file(cut).unwrap();
    // Another conversion does not mistake a part for its own.
    let (is_done, said) = run(&[
        "convert",
        text(folder.path()),
        text(&walk),
        "--shard",
        "2/3",
        "--bits",
        "5",
    ]);
    assert!(!is_done && said.contains("other frames or options"), "{said}");
    // In any order, and found by their names.
    let (is_done, said) = run(&[
        "convert",
        "--join",
        text(&part(2)),
        text(&part(0)),
        text(&part(1)),
        text(&joined),
    ]);
    assert!(is_done && said.contains("7 frames"), "{said}");
    let (is_done, said) = run(&["convert", "--join", text(&walk)]);
    assert!(is_done && said.contains("7 frames of 3 files"), "{said}");
    assert_eq!(fs::read(&joined).unwrap(), fs::read(&walk).unwrap());
    assert!(run(&["convert", text(folder.path()), text(&whole)]).0);
    let frames = |path: &Path| {
        let output = pointreel(&["info", text(path), "--json"]);
        let info: Value = serde_json::from_slice(&output.stdout).unwrap();
        info["frames"].as_array().unwrap().len()
    };
    assert_eq!([frames(&walk), frames(&whole)], [7, 7]);
}

#[test]
fn merging_states_its_cost_beforehand() {
    let folder = tempfile::tempdir().unwrap();
    let (every, merged) = (folder.path().join("every.reel"), folder.path().join("merged.reel"));
    let points = |path: &Path| {
        let output = pointreel(&["info", text(path), "--json"]);
        let info: Value = serde_json::from_slice(&output.stdout).unwrap();
        (
            info["reel"]["points"].as_u64().unwrap(),
            info["reel"]["points_written"].as_u64().unwrap(),
        )
    };
    let done = pointreel(&["convert", "torus:5000", text(&every)]);
    assert!(done.status.success());
    assert!(!String::from_utf8_lossy(&done.stderr).contains("merges"));
    let (retained, written) = points(&every);
    assert_eq!(retained, written);
    let done = pointreel(&["convert", "torus:5000", text(&merged), "--merge"]);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    let (left, written) = points(&merged);
    assert!(left < written, "{left} of {written}");
    let grouped = |count: u64| format!("{},{:03}", count / 1000, count % 1000);
    let price = format!(
        "merges {} of {} points per frame",
        grouped(written - left),
        grouped(written)
    );
    assert!(said.contains(&price) && said.contains(" instead of "), "{said}");
    assert!(String::from_utf8_lossy(&done.stdout).contains(&format!("{left} points (of {written}")));
}

#[test]
fn examples_are_inputs_like_files() {
    for (name, frames, attribute) in [
        ("lidar", 1, "intensity"),
        ("depth", 1, "color"),
        ("model", 83, "normal"),
    ] {
        let output = pointreel(&["info", &format!("example:{name}"), "--json"]);
        let info: Value = serde_json::from_slice(&output.stdout).unwrap();
        let listed = info["frames"].as_array().unwrap();
        assert_eq!(listed.len(), frames, "{name}");
        let attributes = listed[0]["attributes"].as_array().unwrap();
        assert!(
            attributes.iter().any(|named| named == attribute),
            "{name}: {attributes:?}"
        );
    }
    let output = pointreel(&["info", "example:dodo"]);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("an example (lidar, depth, model)"), "{said}");
}

#[test]
fn an_array_with_layers_is_converted_frame_by_frame() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("walk.npz");
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2, 3), }\n";
    let mut array = b"\x93NUMPY\x01\0".to_vec();
    array.extend((header.len() as u16).to_le_bytes());
    array.extend(header.bytes());
    array.extend((0..18).flat_map(|value: u8| f32::from(value).to_le_bytes()));
    let mut archive = zip::ZipWriter::new(fs::File::create(&input).unwrap());
    let stored = zip::write::SimpleFileOptions::default();
    archive.start_file("points.npy", stored).unwrap();
    std::io::Write::write_all(&mut archive, &array).unwrap();
    archive.finish().unwrap();
    let output = folder.path().join("frames");
    let converted = pointreel(&["convert", text(&input), text(&output), "--format", "xyz"]);
    assert!(
        converted.status.success(),
        "{}",
        String::from_utf8_lossy(&converted.stderr)
    );
    let written = names(&output);
    assert_eq!(written.len(), 3, "{written:?}");
    let last = io::read(&output.join(&written[2])).unwrap();
    assert_eq!(last.positions.get(1), DVec3::new(15.0, 16.0, 17.0));
}

#[test]
fn a_size_or_an_error_chooses_the_precision() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("walk.reel");
    let done = pointreel(&["convert", "demo:", text(&file), "--target-size", "300000"]);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.success() && said.contains("precision"), "{said}");
    let size = file.metadata().unwrap().len();
    assert!((270_000..=306_000).contains(&size), "{size}: {said}");
    let done = pointreel(&["convert", "demo:", text(&file), "--target-size", "1000", "--overwrite"]);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(!done.status.success() && said.contains("cannot be reached"), "{said}");
    for options in [["--target-error", "0"], ["--target-error", "lossless"]] {
        let done = pointreel(&["convert", "demo:", text(&file), options[0], options[1]]);
        assert_eq!(done.status.code(), Some(2), "{options:?}");
    }
    let both = pointreel(&["convert", "demo:", text(&file), "--bits", "9", "--target-size", "1MB"]);
    assert_eq!(both.status.code(), Some(2));
    // Another format has no precision.
    let cloud = folder.path().join("walk.ply");
    let done = pointreel(&[
        "convert",
        "demo:",
        text(&cloud),
        "--frames",
        "0",
        "--target-size",
        "1MB",
    ]);
    assert!(!done.status.success());
}
