//! Paths of an untrusted file through the program: the commands, and the window with its background loader.

use crate::kinds::{FAULTS, SETTINGS, STREAMS};
use pointreel::app::{Preferences, PreferencesFile, Presets, Recent, State, StateOptions};
use pointreel::cloud::{Positions, RawCloud};
use pointreel::io::ReadOptions;
use pointreel::scene::CameraPath;
use pointreel::sequence::{FrameEntry, OpenOptions, Sequence};
use std::ffi::OsString;
use std::io::Write as _;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Memory limit of reading (`--max-memory`).
pub(crate) const MAX_MEMORY_BYTES: u64 = 256 << 20;

/// Memory for prepared frames in the window.
const BUDGET_BYTES: usize = 64 << 20;

/// A window that shows nothing after this time is closed: that is not a fault by itself.
const LOOK: Duration = Duration::from_secs(3);

/// A path through the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    Info,
    Check,
    Render,
    Convert,
    Window,
    Settings,
    /// From a server on this machine, as a live stream.
    Connect,
    /// Commits a fault, to be found.
    Fault,
}

impl Way {
    /// Paths of a set.
    pub(crate) fn of_set(set: &str) -> &'static [Self] {
        if set == SETTINGS {
            &[Self::Settings]
        } else if set == FAULTS {
            &[Self::Fault]
        } else if set == STREAMS {
            &[
                Self::Info,
                Self::Check,
                Self::Render,
                Self::Convert,
                Self::Window,
                Self::Connect,
            ]
        } else {
            &[Self::Info, Self::Check, Self::Render, Self::Convert, Self::Window]
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Check => "check",
            Self::Render => "render",
            Self::Convert => "convert",
            Self::Window => "window",
            Self::Settings => "settings",
            Self::Connect => "connect",
            Self::Fault => "fault",
        }
    }

    /// Runs it with `input`. Outputs go to `scratch`; `number` chooses among those available.
    pub(crate) fn go(self, input: &Path, scratch: &Path, number: u64) {
        let picture = scratch.join("picture.png");
        // A sequence file, single frames in a folder, or one frame.
        let outputs = ["out.reel", "out", "out.ply", "out.las", "out.npy"];
        let output = scratch.join(outputs[(number % outputs.len() as u64) as usize]);
        let renderer = ["--size", "24x24", "--renderer", "cpu"];
        match self {
            Self::Info => subcommand("info", input, &[]),
            Self::Check => subcommand("check", input, &[]),
            Self::Render => {
                let output = [Path::new("-o"), &picture].into_iter().chain(renderer.map(Path::new));
                subcommand("render", input, &output.collect::<Vec<_>>());
            }
            Self::Convert => subcommand("convert", input, &[&output, Path::new("--overwrite")]),
            Self::Window => window(input),
            Self::Settings => settings(input),
            Self::Connect => connect(input),
            Self::Fault => fault(input),
        }
    }
}

fn subcommand(name: &str, input: &Path, rest: &[&Path]) {
    let memory = MAX_MEMORY_BYTES.to_string();
    let line = ["pointreel", name, "--max-memory", &memory].map(OsString::from);
    let paths = [input].into_iter().chain(rest.iter().copied()).map(OsString::from);
    // Any result but a panic is fine.
    let _ = pointreel::cli::run(line.into_iter().chain(paths));
}

fn options(preferences: Preferences) -> StateOptions {
    let open = OpenOptions {
        read: ReadOptions::default().with_max_memory(MAX_MEMORY_BYTES),
        ..OpenOptions::default()
    };
    StateOptions {
        preferences,
        open,
        budget_bytes: Some(BUDGET_BYTES),
        ..StateOptions::default()
    }
}

/// Opens `input` as a window does, waits until it is shown, and plays a little.
fn window(input: &Path) {
    let mut state = State::new(options(Preferences::default()));
    state.open_paths(vec![input.to_owned()]);
    let begin = Instant::now();
    let mut now = Duration::ZERO;
    while !has_settled(&state) && begin.elapsed() < LOOK {
        std::thread::sleep(Duration::from_millis(1));
        now += Duration::from_millis(5);
        state.update(now);
    }
    play(&mut state, now);
}

/// Returns true if something is shown, or never will be.
fn has_settled(state: &State) -> bool {
    let is_shown = state.player.as_ref().is_some_and(|player| player.shown().is_some());
    state.opening.failed.is_some() || state.opening.session_question.is_some() || is_shown && state.has_looked()
}

fn play(state: &mut State, mut now: Duration) {
    for _ in 0..6 {
        std::thread::sleep(Duration::from_millis(1));
        now += Duration::from_millis(40);
        state.update(now);
    }
}

/// Sends `input` to a client, which shows the frames received.
fn connect(input: &Path) {
    let bytes = std::fs::read(input).unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let serve = move || {
        if let Ok((mut client, _)) = listener.accept() {
            // It may have disconnected.
            let _ = client.write_all(&bytes);
            std::thread::sleep(Duration::from_millis(20));
        }
    };
    let server = std::thread::Builder::new()
        .name("server".to_owned())
        .spawn(serve)
        .unwrap();
    let mut state = State::new(options(Preferences::default()));
    state.open_paths(vec![format!("tcp://{address}").into()]);
    let begin = Instant::now();
    let mut now = Duration::ZERO;
    while !(server.is_finished() || has_settled(&state)) && begin.elapsed() < LOOK {
        std::thread::sleep(Duration::from_millis(1));
        now += Duration::from_millis(5);
        state.update(now);
    }
    play(&mut state, now);
    // The server would wait for a client that never connected.
    let _ = TcpStream::connect(address);
    server.join().unwrap();
}

/// Commits the fault that `input` is named after.
fn fault(input: &Path) {
    match input.file_stem().unwrap().to_str().unwrap() {
        "panics" => panic!("as asked for"),
        "aborts" => std::process::abort(),
        "fills" => drop(std::hint::black_box(vec![1u8; 2 * MAX_MEMORY_BYTES as usize])),
        other => assert_eq!(other, "is_fine"),
    }
}

/// Two frames of eight points.
fn cube() -> Sequence {
    let entries = [0, 1].map(|number| FrameEntry::file(format!("/scans/cube_{number}.ply")));
    Sequence::with_decoder(entries.to_vec(), |_| {
        let corners = (0..8).map(|corner| [0, 1, 2].map(|axis| (corner >> axis & 1) as f32));
        Ok(RawCloud::from_positions(Positions::F32(corners.collect())))
    })
}

/// Reads `file` as each of the files that a window keeps, and shows something by it.
fn settings(file: &Path) {
    let (_, preferences) = PreferencesFile::load_from(file);
    let _ = Presets::load_from(file).list().len();
    let _ = Recent::load_from(file).0.entries().len();
    if let Ok(path) = CameraPath::read(file) {
        let _ = path.to_json();
    }
    let mut state = State::new(options(preferences));
    state.open(Arc::new(cube()));
    let mut now = Duration::ZERO;
    let begin = Instant::now();
    while !has_settled(&state) && begin.elapsed() < LOOK {
        std::thread::sleep(Duration::from_millis(1));
        now += Duration::from_millis(5);
        state.update(now);
    }
    play(&mut state, now);
    let retained = serde_json::to_vec(&state.preferences()).unwrap();
    assert!(serde_json::from_slice::<serde_json::Value>(&retained).is_ok());
}
