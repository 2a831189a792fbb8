//! `pointreel render` makes videos and transparent images: files that are written, and refusals.

use image::AnimationDecoder as _;
use image::codecs::gif::GifDecoder;
use serde_json::Value;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pointreel"));
    command
        .args(arguments)
        .args(["--renderer", "cpu", "--size", "64x48"])
        .env("RUST_BACKTRACE", "0");
    command
}

fn render(arguments: &[&str]) -> Output {
    command(&[&["render", "demo:"], arguments].concat()).output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn succeeds(arguments: &[&str]) -> String {
    let output = render(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The frames that a run showed, by its statistics.
fn shown(stats: &Path) -> Vec<u64> {
    let stats: Value = serde_json::from_slice(&fs::read(stats).unwrap()).unwrap();
    let frames = stats["frames"].as_array().unwrap();
    frames.iter().map(|frame| frame["index"].as_u64().unwrap()).collect()
}

#[test]
fn a_turntable_turns_while_the_sequence_plays() {
    let folder = tempfile::tempdir().unwrap();
    let [video, stats] = ["a.gif", "s.json"].map(|name| folder.path().join(name));
    let [video, stats_file] = [&video, &stats].map(|path| path.to_str().unwrap());
    // The demo has 24 frames per second: one per image here, every other one there.
    let common = ["--turntable", "6", "--video", video, "--stats", stats_file];
    let said = succeeds(&[&common[..], &["--fps", "24"]].concat());
    assert!(said.contains("6 frames written to") && said.contains("a.gif"), "{said}");
    assert_eq!(shown(&stats), [0, 1, 2, 3, 4, 5]);
    let reader = BufReader::new(File::open(video).unwrap());
    let frames = GifDecoder::new(reader).unwrap().into_frames().collect_frames().unwrap();
    assert_eq!(frames.len(), 6);
    for pair in frames.windows(2) {
        assert!(pair[0].buffer() != pair[1].buffer());
    }
    succeeds(&[&common[..], &["--seconds", "0.5"]].concat());
    assert_eq!(shown(&stats), [0, 2, 4, 6, 8, 10]);
    succeeds(&[&common[..], &["--frame", "7", "--turns", "-2"]].concat());
    assert_eq!(shown(&stats), [7; 6]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn a_static_camera_shows_each_frame_once() {
    let folder = tempfile::tempdir().unwrap();
    let [pattern, stats] = ["p/{frame}.png", "s.json"].map(|name| folder.path().join(name));
    let output = pattern.to_str().unwrap();
    let said = succeeds(&["--video", output, "--frame", "4..8", "--stats", stats.to_str().unwrap()]);
    assert!(
        said.contains("5 frames") && said.contains("24.00000 per second"),
        "{said}"
    );
    assert_eq!(shown(&stats), [4, 5, 6, 7, 8]);
    // The first is the image that the command draws without a video.
    let picture = folder.path().join("one.png");
    succeeds(&["-o", picture.to_str().unwrap(), "--frame", "4"]);
    let [one, first] = [picture, folder.path().join("p/0000.png")].map(|file| image::open(file).unwrap().to_rgba8());
    assert!(one == first);
}

#[test]
fn a_camera_path_from_a_file_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let [path, video, stats] = ["p.json", "a.webp", "s.json"].map(|name| folder.path().join(name));
    let [path, video, stats_file] = [&path, &video, &stats].map(|path| path.to_str().unwrap());
    let keyframe = |time_s: f64, frame: f64, azimuth: f64| {
        format!(
            "{{\"time_s\": {time_s}, \"frame\": {frame}, \"target\": [0, 0.8, 0], \"distance\": 3, \
             \"azimuth_deg\": {azimuth}, \"elevation_deg\": 5, \"fov_deg\": 40}}"
        )
    };
    let written = |keyframes: &[String]| {
        fs::write(
            path,
            format!(
                "{{\"pointreel_path\": 1, \"ease\": true, \"up\": \"y\", \"keyframes\": [\n{}\n]}}",
                keyframes.join(",\n")
            ),
        )
        .unwrap();
    };
    written(&[
        keyframe(0.0, 8.0, 170.0),
        keyframe(1.0, 2.0, -170.0),
        keyframe(2.0, 2.0, 0.0),
    ]);
    let common = ["--path", path, "--video", video, "--stats", stats_file];
    succeeds(&[&common[..], &["--fps", "3"]].concat());
    assert_eq!(shown(&stats), [8, 6, 4, 2, 2, 2, 2]);
    // Twice as fast.
    succeeds(&[&common[..], &["--fps", "3", "--seconds", "1"]].concat());
    assert_eq!(shown(&stats), [8, 4, 2, 2]);

    written(&[keyframe(0.0, 8.0, 170.0), keyframe(0.0, 2.0, -170.0)]);
    let output = render(&common);
    assert_eq!(output.status.code(), Some(1));
    let said = stderr(&output);
    assert!(said.contains("p.json: keyframe 2 is at 0 s"), "{said}");
    fs::write(path, "{\"pointreel_path\": 1,\n\"keyframes\": 5}").unwrap();
    let said = stderr(&render(&common));
    assert!(
        said.contains("p.json is not a camera path") && said.contains("line 2"),
        "{said}"
    );
}

#[test]
fn a_transparent_background_becomes_alpha() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("a.png");
    succeeds(&["-o", picture.to_str().unwrap(), "--background", "transparent"]);
    let picture = image::open(picture).unwrap().to_rgba8();
    let count = |alpha: u8| picture.pixels().filter(|pixel| pixel.0[3] == alpha).count();
    assert!(count(0) > 1000 && count(255) > 100, "{} {}", count(0), count(255));
    let output = Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .args(["view", "demo:", "--background", "transparent"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("a window has no transparent background"));
}

#[test]
fn meaningless_options_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (gif, png) = (file("a.gif"), file("a.png"));
    let cases: &[(&[&str], i32, &str)] = &[
        (&[], 2, "--output"),
        (&["-o", &png, "--video", &gif], 2, "cannot be used with"),
        (&["-o", &png, "--turntable", "9"], 2, "cannot be used with"),
        (&["--video", &gif, "--turntable", "0"], 2, "1..=1000000"),
        (
            &["--video", &gif, "--turntable", "9", "--path", "p.json"],
            2,
            "cannot be used with",
        ),
        (
            &["--video", &gif, "--path", "p.json", "--azimuth", "3"],
            2,
            "cannot be used with",
        ),
        (&["--video", &gif, "--turns", "2"], 2, "--turntable"),
        (&["--video", &gif, "--fps", "0"], 2, "from 0.1 to 1000"),
        (&["--video", &gif, "--turntable", "9", "--fps", "60"], 1, "at most 50"),
        (
            &["--video", &gif, "--turntable", "9", "--fps", "9", "--seconds", "2"],
            1,
            "contradict",
        ),
        (
            &["--video", &gif, "--turntable", "9", "--frame", "1..2"],
            1,
            "one number",
        ),
        (&["--video", &gif, "--frame", "24"], 1, "frame 24 does not exist"),
        (&["--video", &gif, "--background", "transparent"], 1, "choose .webp"),
        (&["--video", &png], 1, "{frame}.png"),
        (&["--video", &gif, "--path", "nowhere.json"], 1, "nowhere.json"),
    ];
    for (arguments, code, expected) in cases {
        let output = render(arguments);
        assert_eq!(output.status.code(), Some(*code), "{arguments:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(expected), "{arguments:?}: {}", stderr(&output));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn without_ffmpeg_the_error_says_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.mp4");
    let output = command(&["render", "demo:", "--turntable", "3"])
        .arg("--video")
        .arg(&file)
        .env("PATH", folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let said = stderr(&output);
    assert!(said.contains("ffmpeg, which is not on the PATH"), "{said}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// An encoder that dies is a failure with its message, and the output is removed.
#[cfg(unix)]
#[test]
fn ffmpeg_errors_are_passed_on() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let bin = tempfile::tempdir().unwrap();
    let broken = bin.path().join("ffmpeg");
    fs::write(&broken, "#!/bin/sh\necho no such encoder >&2\nexit 3\n").unwrap();
    fs::set_permissions(&broken, fs::Permissions::from_mode(0o755)).unwrap();
    let output = command(&["render", "demo:", "--turntable", "30"])
        .arg("--video")
        .arg(folder.path().join("a.mp4"))
        .env("PATH", bin.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let said = stderr(&output);
    assert!(said.contains("a.mp4: no such encoder"), "{said}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// An interrupted run leaves no video: its output has a hidden name.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing_that_looks_finished() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = command(&["render", "demo:", "--turntable", "100000"])
        .arg("--video")
        .arg(folder.path().join("a.gif"))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let names = || -> Vec<String> {
        fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect()
    };
    while names().is_empty() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    // Not SIGINT, which is ignored by anything that a shell has started in the background.
    let interrupt = Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
    assert!(interrupt.unwrap().success());
    assert!(!child.wait().unwrap().success());
    assert!(names().iter().all(|name| name.starts_with('.')), "{:?}", names());
}

#[test]
fn videos_show_the_same_ghosts_and_trails_as_images() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let file = |name: &str, number: usize| {
        let file = format!("{}/{number:04}.png", place(name));
        image::open(file).unwrap().to_rgba8()
    };
    let mut plain = Vec::new();
    for (name, poses) in [
        ("plain", &[][..]),
        ("change", &["--change", "-1", "--change-range", "0.05"]),
        ("onion", &["--onion", "1", "--onion-step", "2"]),
        ("trail", &["--trail", "0,100,2000"]),
    ] {
        let [video, pictures] = ["video", "pictures"].map(|kind| place(&format!("{name}-{kind}")));
        let common = [&["--frame", "3..8"], poses].concat();
        let [video, pictures] = [video, pictures].map(|folder| format!("{folder}/{{frame}}.png"));
        succeeds(&[&common[..], &["--video", &video]].concat());
        succeeds(&[&common[..], &["-o", &pictures]].concat());
        let mut drawn = Vec::new();
        for number in 0..6 {
            let picture = file(&format!("{name}-pictures"), 3 + number);
            let of_video = image::open(video.replace("{frame}", &format!("{number:04}"))).unwrap();
            assert!(of_video.to_rgba8() == picture, "{name} {number}");
            drawn.push(picture);
        }
        // From this side a trail may be hidden in one image, but not in all.
        assert!(drawn != plain, "{name}: nothing is added");
        if name == "plain" {
            plain = drawn;
        }
    }
    // Beyond the end there is nothing to compare with: reported once per frame, however often a loop shows it.
    let video = place("a.gif");
    let arguments = ["--frame", "22..23", "--video", &video, "--change", "1"];
    let output = render(&arguments);
    assert!(output.status.success());
    let said = stderr(&output);
    let warnings = said.matches("keeps its colours: the sequence has no frame 1 later");
    assert_eq!(warnings.count(), 1, "{said}");
}
