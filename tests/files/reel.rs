//! Sequence files as a person, a script or a player meets them.

use pointreel::cloud::{Positions, RawCloud};
use pointreel::convert::{Conversion, Edit, Output, Shard, convert, join};
use pointreel::io::WriteFormat;
use pointreel::progress::Progress;
use pointreel::reel::{NewFrame, Precision, ReelOptions, ReelWriter};
use pointreel::sequence::{FrameEntry, OpenOptions, Sequence};
use pointreel::serve::{FileServer, FileServerOptions};
use serde_json::Value;
use std::fs;
use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

fn pointreel(arguments: &[&str]) -> std::process::Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_pointreel"));
    program.args(arguments).output().unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A sheet of 30 × 30 points that moves with `time`.
fn sheet(time: usize) -> RawCloud {
    let at = |index: usize| {
        let (x, z) = ((index % 30) as f32, (index / 30) as f32);
        [0.1 * x, (0.3 * x + 0.2 * time as f32).sin(), 0.1 * z]
    };
    let mut cloud = RawCloud::from_positions(Positions::F32((0..900).map(at).collect()));
    cloud.attributes.colors = Some((0..900).map(|index| [index as u8, time as u8, 7, 255]).collect());
    cloud
}

/// Frames of sheets; of those in `broken` nothing can be read.
fn sheets(count: usize, broken: &'static [u64]) -> Sequence {
    let entries = (0..count as u64).map(|number| FrameEntry {
        number: Some(number),
        ..FrameEntry::file(format!("nowhere/sheet_{number:03}.ply"))
    });
    Sequence::with_decoder(entries.collect(), |entry| match entry.number {
        Some(number) if !broken.contains(&number) => Ok(sheet(number as usize)),
        _ => Err("torn".into()),
    })
}

fn lossless(keyframes: u32) -> ReelOptions {
    ReelOptions {
        keyframes,
        ..ReelOptions::lossless()
    }
}

fn conversion(output: &Path, keyframes: u32, shard: Shard) -> Conversion {
    Conversion {
        frames: None,
        shard,
        edit: Edit::default(),
        format: WriteFormat::default(),
        output: Output::Reel(output.to_owned(), lossless(keyframes)),
        goal: None,
        overwrites: false,
        reading: String::new(),
    }
}

fn converted(sequence: &Sequence, output: &Path, keyframes: u32) -> pointreel::convert::Converted {
    convert(
        sequence,
        &conversion(output, keyframes, Shard::WHOLE),
        &Progress::default(),
    )
    .unwrap()
}

fn opened(path: &Path) -> Sequence {
    Sequence::discover(&[path.to_owned()]).unwrap()
}

/// Coordinates and colours of every frame, each as a sorted list, since the order is not preserved.
fn contents(sequence: &Sequence) -> Vec<Vec<([u32; 3], [u8; 4])>> {
    let frame = |index: usize| {
        let cloud = sequence.decode(index).unwrap();
        let colors = cloud.attributes.colors.unwrap();
        let position = |index: usize| cloud.positions.get(index).as_vec3().to_array().map(f32::to_bits);
        let mut points: Vec<_> = (0..colors.len())
            .map(|index| (position(index), colors[index]))
            .collect();
        points.sort_unstable();
        points
    };
    sequence.frames().map(frame).collect()
}

fn visible(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_sequence_round_trips_through_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let reel = folder.path().join("demo.reel");
    let done = pointreel(&[
        "convert",
        "demo:",
        text(&reel),
        "--precision",
        "lossless",
        "--keyframes",
        "5",
    ]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(String::from_utf8_lossy(&done.stdout).starts_with("24 frames written"));
    assert_eq!(visible(folder.path()), ["demo.reel"], "nothing hidden is left");

    let info = pointreel(&["info", text(&reel), "--json"]);
    let info: Value = serde_json::from_slice(&info.stdout).unwrap();
    assert_eq!(info["frames"].as_array().unwrap().len(), 24);
    assert_eq!(info["reel"]["groups"], serde_json::json!([5, 5, 5, 5, 4]));
    let bits = info["reel"]["bits_per_point"].as_f64().unwrap();
    let by_stream = info["reel"]["bits_by_stream"].as_object().unwrap();
    let sum: f64 = by_stream.values().map(|bits| bits.as_f64().unwrap()).sum();
    assert!(sum > 0.8 * bits && sum <= bits, "{sum} of {bits}");
    assert_eq!(contents(&opened(&reel)), contents(&Sequence::demo()));

    let plys = folder.path().join("plys");
    let back = pointreel(&["convert", text(&reel), text(&plys), "--format", "ply"]);
    assert!(back.status.success(), "{}", String::from_utf8_lossy(&back.stderr));
    assert_eq!(contents(&opened(&plys)), contents(&Sequence::demo()));

    // Its first bytes decide, whatever its name.
    let renamed = folder.path().join("demo.ply");
    fs::copy(&reel, &renamed).unwrap();
    assert_eq!(opened(&renamed).len(), 24);
    let check = pointreel(&["check", text(&reel)]);
    assert_eq!(
        check.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&check.stdout)
    );
}

#[test]
fn impossible_arguments_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let reel = folder.path().join("a.reel");
    converted(&sheets(2, &[]), &reel, 2);
    let said = |arguments: &[&str]| {
        let output = pointreel(arguments);
        assert!(!output.status.success(), "{arguments:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let out = folder.path().join("b.reel");
    assert!(said(&["info", text(&reel), "demo.ply"]).contains("open it alone"));
    assert!(said(&["convert", "demo:", text(&out), "--keep-order", "--merge"]).contains("lossless"));
    assert!(said(&["convert", "demo:", text(&out), "--format", "ply"]).contains("sequence file"));
    let plys = folder.path().join("plys");
    assert!(said(&["convert", "demo:", text(&plys), "--bits", "9"]).contains(".reel"));
    assert!(said(&["serve", "Cargo.toml"]).contains("pointreel convert"));
    let mut bytes = fs::read(&reel).unwrap();
    bytes[8] = 99;
    fs::write(&reel, bytes).unwrap();
    assert!(said(&["info", text(&reel)]).contains("later version"));
}

#[test]
fn unreadable_frames_are_skipped_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let reel = folder.path().join("a.reel");
    let done = converted(&sheets(7, &[0, 3, 6]), &reel, 3);
    assert_eq!((done.written, done.failed.len()), (4, 3));
    let names: Vec<String> = opened(&reel).entries().iter().map(|entry| entry.name.clone()).collect();
    let numbers: Vec<Option<u64>> = opened(&reel).entries().iter().map(|entry| entry.number).collect();
    assert_eq!(names[0], "a.reel: sheet_001.ply");
    assert_eq!(numbers, [1, 2, 4, 5].map(Some), "gaps can be seen");
}

#[test]
fn an_interrupted_conversion_resumes_where_it_ended() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, broken_off) = (folder.path().join("whole.reel"), folder.path().join("again.reel"));
    let sequence = sheets(24, &[5]);
    converted(&sequence, &whole, 2);
    let mut left = Vec::new();
    for _ in 0..30 {
        // Cancelled after eight more frames, whichever group they belong to.
        let done = Arc::new(AtomicUsize::new(0));
        let told = Arc::clone(&done);
        let progress = Progress::told_to(move |progress| {
            if told.fetch_add(1, Ordering::Relaxed) >= 8 {
                progress.cancel();
            }
        });
        let outcome = convert(&sequence, &conversion(&broken_off, 2, Shard::WHOLE), &progress).unwrap();
        left.push(outcome.left);
        if !outcome.is_cancelled {
            break;
        }
        assert!(!broken_off.exists(), "what has the name is whole");
    }
    assert!(
        left.len() > 1 && left.is_sorted() && *left.last().unwrap() > 0,
        "{left:?}"
    );
    assert_eq!(fs::read(&whole).unwrap(), fs::read(&broken_off).unwrap());
    // What already exists is not written again.
    assert_eq!(converted(&sequence, &whole, 2).left, 23);
}

#[test]
fn joined_shards_match_a_single_conversion() {
    let folder = tempfile::tempdir().unwrap();
    let sequence = sheets(12, &[]);
    let whole = folder.path().join("whole.reel");
    converted(&sequence, &whole, 2);
    let parts: Vec<PathBuf> = (0..3)
        .map(|index| {
            let shard = Shard { index, count: 3 };
            let part = shard.part_of(&whole);
            let done = convert(&sequence, &conversion(&part, 2, shard), &Progress::default()).unwrap();
            assert_eq!(done.written, 4);
            part
        })
        .collect();
    let joined = folder.path().join("joined.reel");
    assert_eq!(join(&parts, &joined).unwrap().frames, 12);
    assert_eq!(fs::read(&whole).unwrap(), fs::read(&joined).unwrap());
}

#[test]
fn a_growing_file_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("live.reel");
    let mut writer = ReelWriter::create(&path, lossless(1)).unwrap();
    let clouds = [sheet(0), sheet(1), sheet(2)];
    let mut write = |index: usize| {
        let frame = NewFrame {
            cloud: &clouds[index],
            name: "sheet",
            time: None,
        };
        writer.write_group(&[frame]).unwrap();
    };
    write(0);
    let sequence = opened(&path);
    assert_eq!(sequence.len(), 1);
    assert_eq!(sequence.source().look_again().unwrap(), 0);
    let before = sequence.decode(0).unwrap();
    write(1);
    write(2);
    assert_eq!(sequence.source().look_again().unwrap(), 2);
    assert_eq!(sequence.len(), 3);
    assert_eq!(sequence.decode(0).unwrap(), before);
    assert_eq!(sequence.decode(2).unwrap().positions.len(), 900);
}

#[test]
fn a_truncated_file_is_shown_as_far_as_possible_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, cut) = (folder.path().join("whole.reel"), folder.path().join("cut.reel"));
    let done = pointreel(&["convert", "torus:20000", text(&whole)]);
    assert!(done.status.success());
    let bytes = fs::read(&whole).unwrap();
    let picture = folder.path().join("cut.png");
    for percent in [20, 50, 80, 95] {
        fs::write(&cut, &bytes[..bytes.len() * percent / 100]).unwrap();
        let said = |arguments: &[&str]| {
            let output = pointreel(arguments);
            let text = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
            (output.status.code(), text.concat())
        };
        let size = ["--size", "64x48", "--renderer", "cpu"];
        let render = [&["render", text(&cut), "-o", text(&picture)][..], &size].concat();
        for arguments in [&["info", text(&cut)][..], &render] {
            let (code, said) = said(arguments);
            assert_eq!(code, Some(0), "{percent} %: {said}");
            assert!(
                said.contains("ends early") && said.contains("of 20000 points"),
                "{percent} %: {said}"
            );
        }
        let (code, said) = said(&["check", text(&cut)]);
        assert!(code == Some(3) && said.contains("ends early"), "{percent} %: {said}");
        let pixels = image::open(&picture).unwrap().to_rgba8();
        let first = *pixels.get_pixel(0, 0);
        assert!(
            pixels.pixels().filter(|pixel| **pixel != first).count() > 50,
            "{percent} % draw nothing"
        );
        let info: Value = serde_json::from_slice(&pointreel(&["info", text(&cut), "--json"]).stdout).unwrap();
        assert_eq!(info["reel"]["ends_early"], true);
        let points = info["frames"][0]["points"].as_u64().unwrap();
        assert!(points > 0 && points < 20_000, "{percent} %: {points}");
    }
    // So short that there is no frame: an error, not silence.
    fs::write(&cut, &bytes[..60]).unwrap();
    let output = pointreel(&["info", text(&cut)]);
    assert!(!output.status.success() || !output.stderr.is_empty());
}

/// Runs `work` in parallel with the test.
fn beside<T: Send + 'static>(name: &str, work: impl FnOnce() -> T + Send + 'static) {
    thread::Builder::new().name(name.to_owned()).spawn(work).unwrap();
}

/// Serves `path` until the end of the test, and returns its address.
fn served(path: &Path) -> String {
    let server = FileServer::bind(path, "127.0.0.1:0".parse().unwrap(), FileServerOptions::default()).unwrap();
    let url = server.url().unwrap();
    beside("server", move || server.run());
    url
}

#[test]
fn a_file_on_the_web_is_a_sequence_like_any_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two words.reel");
    converted(&sheets(9, &[]), &path, 3);
    let url = served(&path);
    assert_eq!(contents(&opened(Path::new(&url))), contents(&opened(&path)));
    let info = pointreel(&["info", &url, "--json"]);
    let info: Value = serde_json::from_slice(&info.stdout).unwrap();
    assert_eq!(info["frames"][4]["points"], 900);
    for (wrong, said) in [
        (url.replace("two", "too"), "no such file"),
        ("https://127.0.0.1:1/a.reel".to_owned(), "https"),
    ] {
        let error = Sequence::discover(&[wrong.into()]).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
}

/// Forwards connections to `address`, each of which is cut after `max_bytes` of answers.
fn breaking_proxy(address: String, max_bytes: usize) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let own = listener.local_addr().unwrap().to_string();
    beside("proxy", move || {
        for client in listener.incoming().map_while(Result::ok) {
            let server = TcpStream::connect(&address).unwrap();
            let (mut from_client, mut to_server) = (client.try_clone().unwrap(), server.try_clone().unwrap());
            beside("to the server", move || std::io::copy(&mut from_client, &mut to_server));
            let (mut from_server, mut to_client) = (server, client);
            beside("to the client", move || {
                let mut sent = 0;
                let mut piece = [0; 512];
                while let Ok(count @ 1..) = from_server.read(&mut piece) {
                    if sent > max_bytes || to_client.write_all(&piece[..count]).is_err() {
                        break;
                    }
                    sent += count;
                }
                let _ = to_client.shutdown(std::net::Shutdown::Both);
            });
        }
    });
    own
}

#[test]
fn a_broken_connection_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.reel");
    converted(&sheets(6, &[]), &path, 3);
    let size = fs::metadata(&path).unwrap().len();
    let url = served(&path);
    let address = url
        .strip_prefix("http://")
        .unwrap()
        .split('/')
        .next()
        .unwrap()
        .to_owned();
    let proxy = breaking_proxy(address.clone(), 4000);
    assert!(size > 3 * 4000, "{size} bytes break");
    let broken = Sequence::discover(&[url.replace(&address, &proxy).into()]).unwrap();
    assert_eq!(contents(&broken), contents(&opened(&path)));
}

#[test]
fn reading_respects_the_rate_limit_per_second() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.reel");
    converted(&sheets(4, &[]), &path, 1);
    let bits = 8.0 * fs::metadata(&path).unwrap().len() as f64;
    let options = OpenOptions {
        max_bits_per_s: Some(4.0 * bits),
        ..OpenOptions::default()
    };
    let start = std::time::Instant::now();
    let sequence = Sequence::open(&[served(&path).into()], &options).unwrap();
    contents(&sequence);
    // Everything is requested at least once, the end of the file before its groups.
    assert!(start.elapsed().as_secs_f64() >= 0.2, "{:?}", start.elapsed());
}

#[test]
fn coarse_levels_match_the_requested_ones() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("torus.reel");
    let options = ReelOptions {
        precision: Precision::SamplingDensity,
        ..ReelOptions::default()
    };
    let torus = Sequence::discover(&["torus:20000".into()]).unwrap();
    let whole = Conversion {
        output: Output::Reel(path.clone(), options),
        ..conversion(&path, 1, Shard::WHOLE)
    };
    convert(&torus, &whole, &Progress::default()).unwrap();
    let sequence = opened(&path);
    let source = sequence.source();
    let file = source.reel().unwrap();
    let levels = file.frame(0).unwrap().level_points.to_vec();
    assert!(levels.len() > 5 && levels.is_sorted(), "{levels:?}");
    let mut decoder = source.decoder();
    for (place, &points) in levels.iter().enumerate() {
        let frame = decoder
            .decode(0, &source.entry(0), points, &Progress::default())
            .unwrap();
        assert_eq!(frame.cloud.positions.len(), points);
        let finer = levels.get(place + 1).copied().unwrap_or(usize::MAX);
        assert_eq!(frame.level.unwrap().points_of_finer, finer);
        if finer < usize::MAX {
            let same = decoder
                .decode(0, &source.entry(0), finer - 1, &Progress::default())
                .unwrap();
            assert_eq!(same.cloud, frame.cloud);
        }
    }
}
