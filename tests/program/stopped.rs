//! Commands that are ended by a signal: partial output is removed, earlier files stay, and the process dies by the
//! signal.

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// Machines are busy; a condition is polled every few milliseconds.
const LONG: Duration = Duration::from_mins(2);

fn start(folder: &Path, arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pointreel"));
    command.args(arguments).current_dir(folder);
    command.env("RAYON_NUM_THREADS", "1");
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().unwrap()
}

fn send(child: &Child, signal: Signal) {
    kill(Pid::from_raw(child.id() as i32), signal).unwrap();
}

fn ended(child: &mut Child) -> ExitStatus {
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if begun.elapsed() > LONG {
            child.kill().unwrap();
            panic!("it does not end");
        }
        thread::sleep(Duration::from_millis(3));
    }
}

/// Every file in the folder, with its contents, folders with a slash.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() {
            let inner = contents(&path);
            found.insert(format!("{name}/"), Vec::new());
            found.extend(
                inner
                    .into_iter()
                    .map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)),
            );
        } else {
            // A file that is being renamed is found the next time.
            found.insert(name, fs::read(&path).unwrap_or_default());
        }
    }
    found
}

fn is_hidden(name: &str) -> bool {
    name.split('/').any(|part| part.starts_with('.'))
}

/// Frames of many points: writing them takes longer than listing the folder.
fn recording(folder: &Path, frames: usize) {
    fs::create_dir(folder.join("scan")).unwrap();
    for frame in 0..frames {
        let mut text = String::new();
        for point in 0..40_000 {
            let [x, y] = [point % 200, point / 200];
            writeln!(text, "{x} {y} {}", (x * y + 7 * frame) % 31).unwrap();
        }
        fs::write(folder.join(format!("scan/f{frame}.xyz")), text).unwrap();
    }
}

/// Starts a command whose output has the name `output`, waits until it writes a hidden file, and sends `signal`. The
/// folder is then as it was before, if the command had not ended by itself.
fn stopped(folder: &Path, arguments: &[&str], signal: Signal) {
    const TRIES: usize = 20;
    let before = contents(folder);
    for _ in 0..TRIES {
        let mut child = start(folder, arguments);
        let begun = Instant::now();
        while child.try_wait().unwrap().is_none() && !contents(folder).keys().any(|name| is_hidden(name)) {
            assert!(begun.elapsed() < LONG, "{arguments:?} writes nothing");
        }
        // Nothing proceeds until the signal is delivered.
        send(&child, Signal::SIGSTOP);
        send(&child, signal);
        send(&child, Signal::SIGCONT);
        let status = ended(&mut child);
        let after = contents(folder);
        if status.signal() == Some(signal as i32) {
            assert_eq!(
                after.keys().collect::<Vec<_>>(),
                before.keys().collect::<Vec<_>>(),
                "{arguments:?}"
            );
            assert!(after == before, "{arguments:?} has changed what was there");
            return;
        }
        assert!(status.success(), "{arguments:?}: {status:?}");
        // It had already ended by itself: try again, from the same state.
        for name in after.keys().rev().filter(|name| !before.contains_key(*name)) {
            let path = folder.join(name);
            if path.is_dir() {
                fs::remove_dir(path).unwrap();
            } else {
                fs::remove_file(path).unwrap();
            }
        }
        for (name, bytes) in before.iter().filter(|(name, _)| !name.ends_with('/')) {
            fs::write(folder.join(name), bytes).unwrap();
        }
    }
    panic!("{arguments:?} was never stopped in time");
}

#[test]
fn unfinished_output_is_removed_and_existing_files_stay() {
    for (signal, output, arguments) in [
        (
            Signal::SIGTERM,
            "out.png",
            &[
                "render",
                "scan/f0.xyz",
                "-o",
                "out.png",
                "--size",
                "2000x2000",
                "--renderer",
                "cpu",
            ][..],
        ),
        (
            Signal::SIGHUP,
            "out.reel",
            &["convert", "scan", "out.reel", "--overwrite", "--keyframes", "1"],
        ),
        (
            Signal::SIGINT,
            "out.webp",
            &[
                "render",
                "scan",
                "--video",
                "out.webp",
                "--turntable",
                "500",
                "--size",
                "64x48",
                "--renderer",
                "cpu",
            ],
        ),
        (
            Signal::SIGTERM,
            "old.gif",
            &[
                "render",
                "scan",
                "--video",
                "new/",
                "--turntable",
                "500",
                "--size",
                "64x48",
                "--renderer",
                "cpu",
            ],
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        recording(folder.path(), 4);
        // Existing files that each command may replace.
        let old = match output {
            "out.webp" => &b"RIFF old"[..],
            "out.png" => b"\x89PNG\r\n\x1a\nold",
            _ => b"old",
        };
        fs::write(folder.path().join(output), old).unwrap();
        stopped(folder.path(), arguments, signal);
    }
}

#[test]
fn a_resumable_conversion_leaves_finished_work_and_no_lock() {
    let folder = tempfile::tempdir().unwrap();
    recording(folder.path(), 12);
    let arguments = ["convert", "scan", "out.reel", "--keyframes", "1"];
    let hidden = folder.path().join(".out.reel.unfinished");
    let mut child = start(folder.path(), &arguments);
    let begun = Instant::now();
    while fs::metadata(&hidden).map_or(0, |there| there.len()) < 4000 {
        assert!(begun.elapsed() < LONG && child.try_wait().unwrap().is_none());
    }
    send(&child, Signal::SIGTERM);
    let status = ended(&mut child);
    assert_eq!(status.signal(), Some(Signal::SIGTERM as i32), "{status:?}");
    let left: Vec<String> = contents(folder.path())
        .into_keys()
        .filter(|name| is_hidden(name))
        .collect();
    assert_eq!(left, [".out.reel.unfinished", ".out.reel.unfinished.json"]);
    assert!(!folder.path().join("out.reel").exists());
    assert!(ended(&mut start(folder.path(), &arguments)).success());
    let left: Vec<String> = contents(folder.path())
        .into_keys()
        .filter(|name| is_hidden(name))
        .collect();
    assert!(left.is_empty() && folder.path().join("out.reel").exists(), "{left:?}");
}

#[test]
fn the_second_signal_ends_at_once() {
    let folder = tempfile::tempdir().unwrap();
    recording(folder.path(), 12);
    let mut child = start(folder.path(), &["convert", "scan", "out.reel", "--overwrite"]);
    let lock = folder.path().join(".out.reel.lock");
    let begun = Instant::now();
    while !lock.exists() {
        assert!(begun.elapsed() < LONG && child.try_wait().unwrap().is_none());
    }
    send(&child, Signal::SIGTERM);
    thread::sleep(Duration::from_millis(50));
    // It may have ended by then.
    let _ = kill(Pid::from_raw(child.id() as i32), Signal::SIGINT);
    let status = ended(&mut child);
    let by = status.signal();
    assert!(
        by == Some(Signal::SIGTERM as i32) || by == Some(Signal::SIGINT as i32),
        "{status:?}"
    );
    assert!(!lock.exists());
}

#[cfg(target_os = "linux")]
#[test]
fn ignored_signals_stay_ignored() {
    let folder = tempfile::tempdir().unwrap();
    recording(folder.path(), 2);
    // As with `nohup`.
    let script = format!(
        "trap '' HUP; exec '{}' serve scan --live --listen 127.0.0.1:0",
        env!("CARGO_BIN_EXE_pointreel")
    );
    let mut command = Command::new("sh");
    command.args(["-c", &script]).current_dir(folder.path());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut line = String::new();
    std::io::BufRead::read_line(&mut std::io::BufReader::new(child.stdout.as_mut().unwrap()), &mut line).unwrap();
    assert!(line.starts_with("tcp://"), "{line}");
    send(&child, Signal::SIGHUP);
    thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none(), "a hangup has ended it");
    // A server that is asked to end has done its job.
    send(&child, Signal::SIGTERM);
    assert!(ended(&mut child).success());
}
