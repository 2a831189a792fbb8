//! `pointreel serve INPUT --live` as a person starts it, and those who connect: the program itself, and its library.

use pointreel::cloud::{Positions, RawCloud};
use pointreel::progress::Progress;
use pointreel::source::{self, Growth as _, Live as _, LiveState, LiveStream, OpenOptions, Source};
use pointreel::wire::{Kind, Message, StreamHead};
use std::fmt::Write as _;
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// Machines are busy; a condition is polled every few milliseconds.
const LONG: Duration = Duration::from_mins(2);

const FRAMES: usize = 4;

fn wait_for(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < LONG, "waited in vain for {what}");
        thread::sleep(Duration::from_millis(3));
    }
}

fn pointreel(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pointreel"));
    command.args(arguments).env("RUST_BACKTRACE", "0").output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).trim_end().to_owned()
}

/// Coloured points, each of which encodes its frame.
fn recording() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for frame in 0..FRAMES {
        let mut text =
            "ply\nformat ascii 1.0\nelement vertex 50\nproperty float x\nproperty float y\nproperty float z\n\
            property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
                .to_owned();
        for point in 0..50 {
            writeln!(text, "{frame} {} {} {point} {} 7", point % 7, point / 7, 10 * frame).unwrap();
        }
        fs::write(folder.path().join(format!("f{frame}.ply")), text).unwrap();
    }
    folder
}

/// The program, serving.
struct Serving {
    program: Child,
    url: String,
    /// Its output on stderr.
    said: Arc<Mutex<String>>,
}

impl Serving {
    fn new(input: &str, more: &[&str]) -> Self {
        let mut program = Command::new(env!("CARGO_BIN_EXE_pointreel"))
            .args(["serve", input, "--live", "--listen", "127.0.0.1:0"])
            .args(more)
            .env("RUST_BACKTRACE", "0")
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let said = Arc::<Mutex<String>>::default();
        let (heard, says) = (Arc::clone(&said), program.stderr.take().unwrap());
        let listening = thread::Builder::new().name("stderr".to_owned()).spawn(move || {
            for line in BufReader::new(says).lines().map_while(Result::ok) {
                *heard.lock().unwrap() += &(line + "\n");
            }
        });
        listening.unwrap();
        let mut answer = String::new();
        let mut answers = BufReader::new(program.stdout.take().unwrap());
        answers.read_line(&mut answer).unwrap();
        let url = answer.split_whitespace().next().unwrap_or_default().to_owned();
        assert!(url.starts_with("tcp://127.0.0.1:"), "{answer}{}", said.lock().unwrap());
        Self { program, url, said }
    }

    fn address(&self) -> SocketAddr {
        self.url.trim_start_matches("tcp://").parse().unwrap()
    }

    fn has_said(&self, what: &str) -> bool {
        self.said.lock().unwrap().contains(what)
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

fn opened(url: &str) -> LiveStream {
    let options = OpenOptions {
        // No frame is dropped before it is checked.
        live_seconds: Some(3600.0),
        ..OpenOptions::default()
    };
    LiveStream::open(Path::new(url), &options, &Progress::default()).unwrap()
}

fn decoded(source: &dyn Source, index: usize) -> RawCloud {
    let entry = source.entry(index);
    let decoded = source.decoder().decode(index, &entry, usize::MAX, &Progress::default());
    decoded.unwrap().cloud
}

/// The clouds of the files that are served.
fn clouds(folder: &Path) -> Vec<RawCloud> {
    let files = source::open(&[folder.to_owned()], &OpenOptions::default(), &Progress::default()).unwrap();
    (0..FRAMES).map(|frame| decoded(&*files, frame)).collect()
}

/// Text is read in double precision; values exact in single precision are sent so.
fn are_equal(came: &RawCloud, file: &RawCloud) -> bool {
    let places = |cloud: &RawCloud| match &cloud.positions {
        Positions::F32(places) => places.iter().map(|place| place.map(f64::from)).collect(),
        Positions::F64(places) => places.clone(),
    };
    places(came) == places(file) && came.attributes == file.attributes
}

/// Compares a stream with the files; returns the number of frames.
fn assert_all_equal(stream: &LiveStream, files: &[RawCloud]) -> usize {
    stream.look_again().unwrap();
    let frames = stream.frames();
    for index in frames.clone() {
        let number = stream.entry(index).number.unwrap();
        assert!(
            are_equal(&decoded(stream, index), &files[number as usize % FRAMES]),
            "frame {number}"
        );
    }
    frames.len()
}

#[test]
fn served_points_are_received_unchanged_by_the_library_and_the_program() {
    let folder = recording();
    let serving = Serving::new(folder.path().to_str().unwrap(), &["--fps", "100"]);
    let stream = opened(&serving.url);
    let files = clouds(folder.path());
    wait_for("frames", || {
        stream.look_again().is_ok() && stream.frames().end >= 3 * FRAMES
    });
    assert!(assert_all_equal(&stream, &files) >= 3 * FRAMES);

    let output = pointreel(&["info", &serving.url, "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let info: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let first = &info["frames"][0];
    assert_eq!(first["points"], 50);
    assert_eq!(first["attributes"], serde_json::json!(["position", "color"]));
    assert_eq!(
        [&first["min"][1], &first["max"][2]],
        [&serde_json::json!(0.0), &serde_json::json!(7.0)]
    );

    let picture = folder.path().join("picture.png");
    let picture = picture.to_str().unwrap();
    let drawing = [
        "render",
        &serving.url,
        "-o",
        picture,
        "--size",
        "64x64",
        "--renderer",
        "cpu",
    ];
    let output = pointreel(&drawing);
    assert!(output.status.success(), "{}", stderr(&output));
    let drawn = image::open(picture).unwrap().to_rgb8();
    let first = drawn.get_pixel(0, 0);
    assert!(drawn.pixels().any(|pixel| pixel != first), "nothing is drawn");
    wait_for("those who came and went", || {
        serving.has_said("has connected") && serving.has_said("frames sent in")
    });
}

#[test]
fn late_clients_start_with_the_newest_frame() {
    let folder = recording();
    let serving = Serving::new(folder.path().to_str().unwrap(), &["--fps", "50"]);
    let early = opened(&serving.url);
    wait_for("frames", || early.look_again().is_ok() && early.frames().end >= 20);
    let before = early.entry(early.frames().end - 1).number.unwrap();
    let late = opened(&serving.url);
    let first = late.entry(late.frames().start).number.unwrap();
    assert!(first >= before, "{first} after {before}");
    wait_for("more", || late.look_again().is_ok() && late.frames().end >= 5);
    assert_all_equal(&late, &clouds(folder.path()));
}

/// Between a server and its clients: their traffic goes through here, until it is cut.
struct Cable {
    url: String,
    is_cut: Arc<AtomicBool>,
}

impl Cable {
    fn to(server: SocketAddr) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("tcp://{}", listener.local_addr().unwrap());
        let is_cut = Arc::new(AtomicBool::new(false));
        let cut = Arc::clone(&is_cut);
        let accepting = thread::Builder::new().name("cable".to_owned()).spawn(move || {
            for client in listener.incoming().map_while(Result::ok) {
                // Clients that connect while it is cut are accepted and receive nothing.
                let Ok(server) = TcpStream::connect(server) else { return };
                let ways = [(server.try_clone(), client.try_clone()), (Ok(client), Ok(server))];
                for (from, to) in ways {
                    let (from, to, cut) = (from.unwrap(), to.unwrap(), Arc::clone(&cut));
                    let way = thread::Builder::new().name("way".to_owned());
                    way.spawn(move || pass_on(from, to, &cut)).unwrap();
                }
            }
        });
        accepting.unwrap();
        Self { url, is_cut }
    }

    fn set_cut(&self, is_cut: bool) {
        self.is_cut.store(is_cut, Ordering::Relaxed);
    }
}

/// A few bytes at a time, so that the cut is within a message.
fn pass_on(mut from: TcpStream, mut to: TcpStream, is_cut: &AtomicBool) {
    let mut bytes = [0; 97];
    while let Ok(count) = from.read(&mut bytes) {
        if count == 0 || is_cut.load(Ordering::Relaxed) || to.write_all(&bytes[..count]).is_err() {
            break;
        }
    }
    for stream in [from, to] {
        let _ = stream.shutdown(Shutdown::Both);
    }
}

#[test]
fn a_connection_broken_within_a_message_is_restored_without_errors() {
    let folder = recording();
    let serving = Serving::new(folder.path().to_str().unwrap(), &["--fps", "100"]);
    let cable = Cable::to(serving.address());
    let stream = opened(&cable.url);
    // A second server relays what it receives, and reports on the connection.
    let relay = Serving::new(&cable.url, &[]);
    let received = |stream: &LiveStream| stream.status().received_frames;
    wait_for("frames", || received(&stream) > 10);
    for break_ in 1..=2 {
        cable.set_cut(true);
        wait_for("the break", || {
            matches!(stream.status().state, LiveState::Reconnecting(_))
        });
        wait_for("the relay to say so", || {
            let said = relay.said.lock().unwrap();
            said.matches("the connection has broken and is made again by itself")
                .count()
                >= break_
        });
        let before = received(&stream);
        cable.set_cut(false);
        wait_for("frames after the break", || received(&stream) > before + 10);
        assert_eq!(stream.status().state, LiveState::Connected);
        wait_for("the relay to be back", || {
            relay.said.lock().unwrap().matches("connected again, after").count() >= break_
        });
    }
    assert!(stream.status().reconnects >= 2);
    let files = clouds(folder.path());
    assert!(assert_all_equal(&stream, &files) > 20);
    let times: Vec<_> = stream.frames().map(|index| stream.entry(index).time).collect();
    assert!(times.is_sorted(), "{times:?}");
    // A client behind both.
    let far = opened(&relay.url);
    wait_for("frames by the relay", || {
        far.look_again().is_ok() && far.frames().end >= 5
    });
    assert!(assert_clouds_are_some_of(&far, &files) >= 5);
}

/// For a relay, which numbers frames itself: each cloud is one of the files'.
fn assert_clouds_are_some_of(stream: &LiveStream, files: &[RawCloud]) -> usize {
    let frames = stream.frames();
    for index in frames.clone() {
        let came = decoded(stream, index);
        assert!(files.iter().any(|file| are_equal(&came, file)), "frame {index}");
    }
    frames.len()
}

/// A server that sends `bytes` to every client, and then hangs up or stays silent.
fn hostile(bytes: Vec<u8>, hangs_up: bool) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let serving = thread::Builder::new().name("hostile".to_owned()).spawn(move || {
        let mut open = Vec::new();
        for mut client in listener.incoming().map_while(Result::ok) {
            let _ = client.write_all(&bytes);
            if hangs_up {
                let _ = client.shutdown(Shutdown::Write);
            }
            // Closing with unread bytes would reset the connection, and written data would be lost.
            open.push(client);
        }
    });
    serving.unwrap();
    format!("tcp://{address}")
}

/// A message of a frame without its head's clock, as specified: 32 bytes of head, then `body`.
fn points_message(body: &[u8]) -> Vec<u8> {
    let mut payload = vec![0; 32];
    payload[0] = 32;
    payload.extend(body);
    Message::new(Kind::Points, payload).encode()
}

/// Points that claim `points` points in `arrays` arrays, the first of `bytes` bytes, and have none.
fn claiming(points: u64, arrays: u32, bytes: u64) -> Vec<u8> {
    let mut body = vec![0; 80];
    body[0] = 80;
    body[4..8].copy_from_slice(&arrays.to_le_bytes());
    body[8..16].copy_from_slice(&points.to_le_bytes());
    // An unnamed array of positions.
    body.extend(1u32.to_le_bytes());
    body.extend(0u32.to_le_bytes());
    body.extend(bytes.to_le_bytes());
    body.extend(0f64.to_le_bytes());
    points_message(&body)
}

#[test]
fn invalid_servers_are_rejected_with_an_error_message() {
    let head = StreamHead {
        session: 1,
        clock_ns: 0,
        fps: 30.0,
        wall_ns: 0,
    };
    let head = head.encode();
    let after_head = |more: &[u8]| [&head, more].concat();
    let message = points_message(&[0; 80]);
    let mut changed = message.clone();
    *changed.last_mut().unwrap() ^= 1;
    let mut claims_much = message.clone();
    claims_much[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
    let mut other_version = head.clone();
    other_version[8] = 200;
    let cases = [
        (
            "another program",
            b"HTTP/1.1 400 Bad Request\r\n\r\n".to_vec(),
            "not a live stream",
        ),
        ("a later version", other_version, "version 200"),
        ("a head that breaks off", head[..20].to_vec(), "ends within"),
        ("a header that breaks off", after_head(&message[..7]), "ends within"),
        ("a message that breaks off", after_head(&message[..60]), "ends within"),
        ("a length of 4 GB", after_head(&claims_much), "claims 4294967295 bytes"),
        ("another checksum", after_head(&changed), "checksum"),
        (
            "a frame of nothing",
            after_head(&Message::new(Kind::Points, vec![]).encode()),
            "frame",
        ),
        ("2^60 points", after_head(&claiming(1 << 60, 1, 12 << 60)), ""),
        ("arrays that are not there", after_head(&claiming(1, u32::MAX, 12)), ""),
        ("bytes for other points", after_head(&claiming(5, 1, 12)), ""),
    ];
    thread::scope(|scope| {
        let asked = cases.map(|(what, bytes, expected)| {
            let hangs_up = expected == "ends within";
            let url = hostile(bytes, hangs_up);
            let asking = {
                let url = url.clone();
                scope.spawn(move || pointreel(&["info", &url]))
            };
            (what, url, expected, asking)
        });
        for (what, url, expected, asking) in asked {
            let output = asking.join().unwrap();
            let said = stderr(&output);
            assert_eq!(output.status.code(), Some(1), "{what}: {said}");
            // A wait of several seconds is announced before.
            let error = said
                .lines()
                .find(|line| !line.starts_with("waiting for the first frame of"));
            assert!(
                error.is_some_and(|line| line.starts_with("error: ") && line.contains(&url)),
                "{what}: {said}"
            );
            assert!(said.contains(expected), "{what}: {said}");
            assert!(!said.contains("panicked"), "{what}: {said}");
            assert!(output.stdout.is_empty(), "{what}");
        }
    });
}

#[cfg(target_os = "linux")]
#[test]
fn a_server_out_of_descriptors_reports_it_once_and_continues() {
    let folder = recording();
    let file = folder.path().join("a.reel");
    let converted = pointreel(&["convert", folder.path().to_str().unwrap(), file.to_str().unwrap()]);
    assert!(converted.status.success(), "{}", stderr(&converted));
    for live in [&["--live"][..], &[]] {
        let mut program = Command::new("bash")
            .args([
                "-c",
                "ulimit -n 20; exec \"$@\"",
                "bash",
                env!("CARGO_BIN_EXE_pointreel"),
            ])
            .args(["serve", file.to_str().unwrap(), "--listen", "127.0.0.1:0"])
            .args(live)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut answer = String::new();
        let mut answers = BufReader::new(program.stdout.take().unwrap());
        answers.read_line(&mut answer).unwrap();
        let address = answer.split(['/', ' ']).nth(2).unwrap().to_owned();
        let processor_s = || {
            let text = fs::read_to_string(format!("/proc/{}/stat", program.id())).unwrap();
            let fields: Vec<f64> = text.split(' ').map(|field| field.parse().unwrap_or(0.0)).collect();
            (fields[13] + fields[14]) / 100.0
        };
        let crowd: Vec<TcpStream> = (0..40).map_while(|_| TcpStream::connect(&address).ok()).collect();
        let before = processor_s();
        let mut good = TcpStream::connect(&address).unwrap();
        good.set_read_timeout(Some(LONG)).unwrap();
        // A live stream starts without a request.
        if live.is_empty() {
            good.write_all(b"GET /a.reel HTTP/1.1\r\nHost: x\r\n\r\n").unwrap();
        }
        // The head of the stream, or of the response.
        let mut head = [0; 8];
        good.read_exact(&mut head).unwrap();
        thread::sleep(Duration::from_millis(500));
        let used_s = processor_s() - before;
        assert!(used_s < 0.4, "{used_s} s of a processor within half a second");
        drop((good, crowd));
        program.kill().unwrap();
        let mut said = String::new();
        program.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        program.wait().unwrap();
        assert_eq!(said.matches("no connection can be taken").count(), 1, "{said}");
    }
}
