//! Untrusted input and two concurrent programs: nothing reaches the terminal but text, sessions open nothing
//! unasked, pipes and devices are refused, sources are never destroyed, and an output has one writer.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn run_in(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pointreel"));
    command
        .args(arguments)
        .current_dir(folder)
        .env("RUST_BACKTRACE", "0")
        .stdin(Stdio::null());
    command
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// It ends with exit code 1 and prints all of `expected` on stderr.
fn refused(folder: &Path, arguments: &[&str], expected: &[&str]) {
    let output = run_in(folder, arguments);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
    for expected in expected {
        assert!(said.contains(expected), "{arguments:?} lacks {expected}: {said}");
    }
}

const CUBE: &str = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 0\n1 0 1\n0 1 1\n1 1 1\n";
const SMALL: [&str; 4] = ["--size", "32x24", "--renderer", "cpu"];

/// Nothing in it moves a cursor, sets a title or reverses text.
fn assert_plain(output: &Output, what: &str) {
    for bytes in [&output.stdout, &output.stderr] {
        let text = String::from_utf8(bytes.clone()).unwrap_or_else(|_| panic!("{what}: no UTF-8"));
        let acting = text.chars().find(|&c| {
            let is_bidi = ('\u{202a}'..='\u{202e}').contains(&c) || ('\u{2066}'..='\u{2069}').contains(&c);
            (c.is_control() && c != '\n' && c != '\t') || is_bidi
        });
        assert_eq!(acting, None, "{what}: {text:?}");
    }
}

#[test]
fn file_names_cannot_control_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let mut inputs = Vec::new();
    if cfg!(unix) {
        let name = "a\u{1b}[2J\u{1b}]0;owned\u{7}\u{9b}31m\u{202e}.xyz";
        fs::write(root.join(name), "x,y,z,heat\u{1b}[31m\n0,0,0,1\n1,0,0,2\n0,1,0,3\n").unwrap();
        inputs.push(name.to_owned());
    }
    if let Some(reel) = super::data::shared("hostile/reel_name_with_terminal_escapes.reel") {
        inputs.push(reel.to_str().unwrap().to_owned());
    }
    for input in &inputs {
        let render = [&["render", input, "-o", "a.png"], &SMALL[..]].concat();
        for arguments in [
            &["info", input][..],
            &["info", "--json", input],
            &["check", "--verbose", input],
            &["convert", input, "out/"],
            &render,
            &["convert", input, "missing/folder/a.las"],
        ] {
            let output = run_in(root, arguments);
            assert_plain(&output, &format!("{arguments:?}"));
        }
        let info = run_in(root, &["info", "--json", input]);
        assert!(
            serde_json::from_slice::<serde_json::Value>(&info.stdout).is_ok(),
            "{input}"
        );
    }
}

#[test]
fn sessions_open_nothing_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir(root.join("walk")).unwrap();
    fs::write(root.join("secret.xyz"), CUBE).unwrap();
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    listener.set_nonblocking(true).unwrap();
    let address = format!("tcp://{}", listener.local_addr().unwrap());
    let session = |name: &str, file: &str| {
        let text = format!(r#"{{"pointreel_session": 1, "files": ["{file}"]}}"#);
        fs::write(root.join("walk").join(name), text).unwrap();
    };
    session("net.pointreel", &address);
    session("port.pointreel", "udp://:0");
    session("out.pointreel", "../secret.xyz");
    for (name, option, named) in [
        ("walk/net.pointreel", "--allow-network", address.as_str()),
        ("walk/port.pointreel", "--allow-network", "udp://:0"),
        ("walk/out.pointreel", "--allow-outside", "secret.xyz"),
    ] {
        refused(root, &["info", name], &[option, named]);
        refused(root, &["check", name], &[option, named]);
        refused(root, &["convert", name, "out/"], &[option, named]);
        let render = [&["render", name, "-o", "a.png"], &SMALL[..]].concat();
        refused(root, &render, &[option, named]);
    }
    assert!(listener.accept().is_err(), "somebody has connected");
    let allowed = run_in(root, &["info", "--allow-outside", "walk/out.pointreel"]);
    assert!(allowed.status.success(), "{}", said(&allowed));
    // Files in its own folder need no option.
    fs::write(root.join("walk/scan.xyz"), CUBE).unwrap();
    session("in.pointreel", "scan.xyz");
    let inside = run_in(root, &["info", "walk/in.pointreel"]);
    assert!(inside.status.success(), "{}", said(&inside));
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_rejected_before_opening() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    for name in ["a.ply", "a.reel", "a.pointreel", "a.mkv", "a.json"] {
        assert!(Command::new("mkfifo").arg(root.join(name)).status().unwrap().success());
    }
    for name in ["a.ply", "a.reel", "a.pointreel", "a.mkv"] {
        refused(root, &["info", name], &[name, "a named pipe (FIFO)"]);
    }
    refused(root, &["serve", "a.reel"], &["a.reel", "a named pipe (FIFO)"]);
    refused(root, &["info", "/dev/zero"], &["/dev/zero is a device"]);
    fs::write(root.join("scan.xyz"), CUBE).unwrap();
    let path = ["render", "scan.xyz", "--video", "a.gif", "--path", "a.json"];
    refused(root, &path, &["a named pipe (FIFO)"]);
}

#[cfg(unix)]
#[test]
fn sources_are_never_destroyed() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::write(root.join("scan.xyz"), CUBE).unwrap();
    for link in ["hard.png", "hard.json", "hard.ply", "hard.gif"] {
        fs::hard_link(root.join("scan.xyz"), root.join(link)).unwrap();
    }
    std::os::unix::fs::symlink("scan.xyz", root.join("soft.png")).unwrap();
    fs::write(root.join("other.png"), CUBE).unwrap();
    fs::write(root.join("other.json"), CUBE).unwrap();
    let render = |more: &[&str], expected: &str| {
        let arguments = [&["render", "scan.xyz"], more, &SMALL[..]].concat();
        refused(root, &arguments, &[expected]);
    };
    let is_input = "is a file of the input";
    render(&["-o", "hard.png"], is_input);
    render(&["-o", "./soft.png"], is_input);
    render(&["-o", "a.png", "--stats", "hard.json"], is_input);
    render(&["--video", "hard.gif", "--turntable", "2"], is_input);
    render(&["-o", "other.png"], "is not an image or video");
    render(&["-o", "a.png", "--stats", "other.json"], "is not a JSON file");
    refused(
        root,
        &["convert", "scan.xyz", "hard.ply", "--overwrite"],
        &["where the input"],
    );
    for name in ["scan.xyz", "hard.ply", "other.png", "other.json"] {
        assert_eq!(fs::read_to_string(root.join(name)).unwrap(), CUBE, "{name}");
    }
    assert!(!root.join("a.png").exists());
    // An image may replace an image.
    for _ in 0..2 {
        let arguments = [&["render", "scan.xyz", "-o", "a.png", "--stats", "s.json"], &SMALL[..]].concat();
        let output = run_in(root, &arguments);
        assert!(output.status.success(), "{}", said(&output));
    }
}

#[test]
fn images_of_recordings_count_as_sources() {
    let Some(recording) = super::data::shared("meaning/R06_replica") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let results = folder.path().join("rec/results");
    fs::create_dir_all(&results).unwrap();
    for name in ["cam_params.json", "traj.txt"] {
        fs::copy(recording.join(name), folder.path().join("rec").join(name)).unwrap();
    }
    for entry in fs::read_dir(recording.join("results")).unwrap().flatten() {
        // Without copying permissions: the data is read-only.
        fs::write(results.join(entry.file_name()), fs::read(entry.path()).unwrap()).unwrap();
    }
    for image in ["depth000000.png", "frame000000.jpg"] {
        let output = format!("rec/results/{image}");
        let before = fs::read(results.join(image)).unwrap();
        let arguments = [&["render", "rec", "-o", &output], &SMALL[..]].concat();
        refused(folder.path(), &arguments, &[image, "is a file of the input"]);
        assert_eq!(fs::read(results.join(image)).unwrap(), before);
    }
}

#[test]
fn a_sequence_file_has_one_writer() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir(root.join("scans")).unwrap();
    for frame in 0..8 {
        let rows = (0..4000).map(|point: u32| {
            let [x, y] = [point % 64, point / 64].map(|place| f64::from(place) / 64.0);
            format!("{x} {y} {}\n", (x * 6.0 + f64::from(frame)).sin())
        });
        fs::write(root.join(format!("scans/f_{frame}.xyz")), rows.collect::<String>()).unwrap();
    }
    let arguments = ["convert", "scans", "walk.reel"];
    // While another process holds the lock, nothing is written, and its holder is named.
    let lock = root.join(".walk.reel.lock");
    let file = fs::File::create(&lock).unwrap();
    if file.try_lock().is_ok() {
        fs::write(&lock, r#"{"pid": 4711, "host": "elsewhere", "since_s": 0}"#).unwrap();
        refused(
            root,
            &arguments,
            &["walk.reel is being written by process 4711 of elsewhere"],
        );
        assert!(!root.join("walk.reel").exists());
    }
    drop(file);
    fs::remove_file(&lock).unwrap();
    let mut both = [(), ()].map(|()| {
        command(root, &arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    });
    for writer in &mut both {
        writer.wait().unwrap();
    }
    let outputs = both.map(|writer| writer.wait_with_output().unwrap());
    assert!(outputs.iter().any(|output| output.status.success()));
    for output in outputs.iter().filter(|output| !output.status.success()) {
        let said = said(output);
        assert!(
            said.contains("is being written by") || said.contains("is there already"),
            "{said}"
        );
    }
    let info = run_in(root, &["info", "--json", "walk.reel"]);
    let info: serde_json::Value = serde_json::from_slice(&info.stdout).unwrap();
    assert_eq!(info["frames"].as_array().unwrap().len(), 8);
    let left: Vec<_> = fs::read_dir(root)
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .filter(|name| name.to_string_lossy().starts_with('.'))
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_folder_of_frames_has_one_writer() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::write(root.join("cube.xyz"), CUBE).unwrap();
    fs::create_dir(root.join("out")).unwrap();
    let lock = fs::File::create(root.join("out/.pointreel-convert.1-of-1.lock")).unwrap();
    lock.lock().unwrap();
    let arguments = ["convert", "cube.xyz", "out/", "--overwrite"];
    refused(root, &arguments, &["out", "is being written by another process"]);
    drop(lock);
    let output = run_in(root, &arguments);
    assert!(output.status.success(), "{}", said(&output));
    assert!(root.join("out/cube.ply").is_file());
    assert!(!root.join("out/.pointreel-convert.1-of-1.lock").exists());
}

#[test]
fn statistics_do_not_overwrite_their_image() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::write(root.join("cube.xyz"), CUBE).unwrap();
    for stats in ["a.png", "./a.png"] {
        let render = [&["render", "cube.xyz", "-o", "a.png", "--stats", stats], &SMALL[..]].concat();
        refused(root, &render, &["a.png", "is not a JSON file"]);
        assert!(fs::read(root.join("a.png")).unwrap().starts_with(b"\x89PNG"), "{stats}");
        fs::remove_file(root.join("a.png")).unwrap();
    }
}
