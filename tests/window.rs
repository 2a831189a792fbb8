//! The real window of the real program under Xvfb: real keys go in, the root window's pixels come out.
#![allow(clippy::unwrap_used, reason = "a helper of a test that cannot go on fails the test")]
#![cfg(all(unix, not(target_os = "macos")))]

#[path = "common/xvfb.rs"]
mod xvfb;

use image::RgbaImage;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use xvfb::{PATIENCE, Process, Screen, Xvfb, has_a_cloud, painted_by_each, pngs};

painted_by_each!(
    the_demo_plays_pauses_and_is_photographed,
    a_window_of_any_size_goes_on,
    settings_are_kept_for_the_next_window,
    a_screenshot_of_either_renderer_is_written_and_the_window_ends,
    a_sequence_beside_itself_is_two_equal_halves,
    what_was_covered_is_shown_again,
    a_window_on_a_display_of_another_scale_shows_a_cloud,
    a_window_measures_itself,
    a_window_on_wayland_shows_a_cloud_and_ends,
);

/// Keysyms of X11.
const SPACE: u32 = 0x20;
const P: u32 = 0x70;
const RIGHT: u32 = 0xff53;
const L: u32 = 0x6c;
const F11: u32 = 0xffc8;

/// CPU time of a process so far, in the kernel's ticks of 10 ms.
#[cfg(target_os = "linux")]
fn cpu_ticks(child: &Child) -> u64 {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
    // The name in parentheses may contain spaces; user and system time are fields 14 and 15.
    let fields: Vec<&str> = stat.rsplit_once(')').unwrap().1.split_whitespace().collect();
    fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap()
}

fn the_demo_plays_pauses_and_is_photographed(painter: &str) {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let program = server
        .view(home.path(), painter)
        .args(["--size", "1000x700"])
        .spawn()
        .unwrap();
    let mut program = Process(program);
    let screen = Screen::of(&server);

    let first = screen.wait_for("the window stays without a picture of the demo", has_a_cloud);
    screen.wait_for("the demo does not play", |picture| *picture != first);

    screen.wait_for_keyboard(screen.window());
    screen.key(SPACE);
    // Thumbnails are made while nothing plays, so this is not idle yet.
    screen.wait_for_rest_of_all("the demo does not pause");
    let paused = screen.picture();
    std::thread::sleep(Duration::from_secs(1));
    assert!(screen.picture() == paused, "a paused picture changed");

    #[cfg(target_os = "linux")]
    {
        let before = cpu_ticks(&program.0);
        std::thread::sleep(Duration::from_secs(5));
        let used = cpu_ticks(&program.0) - before;
        assert!(used <= 1, "an idle window used {used} ticks of 10 ms in 5 s");
    }

    screen.key(RIGHT);
    screen.wait_for("the next frame does not come", |picture| *picture != paused);
    screen.key(P);
    let begin = Instant::now();
    while pngs(home.path()).is_empty() {
        assert!(begin.elapsed() < PATIENCE, "no picture was saved");
        std::thread::sleep(Duration::from_millis(50));
    }
    // The name appears before the last byte is written.
    std::thread::sleep(Duration::from_millis(300));
    let saved = image::open(&pngs(home.path())[0]).unwrap().to_rgba8();
    assert!(saved.width() > 400 && saved.height() > 300);
    assert!(has_a_cloud(saved.as_raw()), "the saved picture is empty");
    assert!(
        saved.pixels().all(|pixel| pixel[3] == 255),
        "the saved picture is not opaque"
    );
    assert!(program.0.try_wait().unwrap().is_none(), "the window went on");
}

fn a_window_of_any_size_goes_on(painter: &str) {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let program = server
        .view(home.path(), painter)
        .args(["--size", "1000x700", "--paused"])
        .spawn()
        .unwrap();
    let mut program = Process(program);
    let screen = Screen::of(&server);
    screen.wait_for("the window stays without a picture", has_a_cloud);
    let window = screen.window();
    screen.wait_for_keyboard(window);
    for (width, height) in [(1, 1), (3, 700), (1000, 2), (200, 120), (4000, 3000)] {
        screen.resize(window, width, height);
        std::thread::sleep(Duration::from_millis(400));
        let status = program.0.try_wait().unwrap();
        assert!(status.is_none(), "{width}x{height}: {status:?}");
    }
    screen.resize(window, 1000, 700);
    screen.wait_for("the picture does not come back", has_a_cloud);
    let before = screen.wait_for_rest("the paused window does not rest");
    assert!(has_a_cloud(&before));

    // There is no window manager to switch to full screen; requesting it and back must do no harm.
    for _ in 0..2 {
        screen.key(F11);
        std::thread::sleep(Duration::from_millis(400));
    }
    screen.wait_for("full screen and back is another picture", |picture| *picture == before);
    screen.key(RIGHT);
    screen.wait_for("the window does not listen any more", |picture| *picture != before);
    assert!(program.0.try_wait().unwrap().is_none());
}

fn settings_are_kept_for_the_next_window(painter: &str) {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("config/pointreel/settings.json");
    // Starting from looping: the second window continues where the first one was left.
    for expected in ["ping-pong", "off"] {
        let program = server
            .view(home.path(), painter)
            .args(["--paused", "--primitive", "point"])
            .spawn()
            .unwrap();
        let _program = Process(program);
        let screen = Screen::of(&server);
        screen.wait_for("the window stays without a picture", has_a_cloud);
        screen.wait_for_keyboard(screen.window());
        screen.key(L);
        let begin = Instant::now();
        // A half-written file could not be parsed.
        let loop_mode = || {
            let text = std::fs::read(&file).ok()?;
            let stored: serde_json::Value = serde_json::from_slice(&text).unwrap();
            Some(stored["loop_mode"].as_str()?.to_owned())
        };
        while loop_mode().as_deref() != Some(expected) {
            assert!(begin.elapsed() < PATIENCE, "{expected}: {:?}", loop_mode());
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

/// The image of a window of 800 × 600 pixels, painted by `painter`, that shows points drawn by `renderer`.
fn screenshot(server: &Xvfb, home: &Path, [painter, renderer]: [&str; 2], arguments: &[&str]) -> RgbaImage {
    let file = home.join(format!("{renderer}.png"));
    let status = server
        .view(home, painter)
        .args(arguments)
        .args(["--renderer", renderer, "--primitive", "point"])
        .args(["--size", "800x600", "--screenshot"])
        .arg(&file)
        .status()
        .unwrap();
    assert!(status.success(), "{renderer}");
    image::open(file).unwrap().to_rgba8()
}

fn a_screenshot_of_either_renderer_is_written_and_the_window_ends(painter: &str) {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    for renderer in ["gpu", "cpu"] {
        let picture = screenshot(&server, home.path(), [painter, renderer], &["--after-frames", "3"]);
        assert!(has_a_cloud(picture.as_raw()), "{renderer}");
    }
}

fn a_sequence_beside_itself_is_two_equal_halves(painter: &str) {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    for renderer in ["gpu", "cpu"] {
        let arguments = ["--compare", "demo:", "--paused"];
        let picture = screenshot(&server, home.path(), [painter, renderer], &arguments);
        let (width, height) = picture.dimensions();
        assert_eq!(width % 2, 0, "no halves");
        let half = |left| image::imageops::crop_imm(&picture, left, 0, width / 2, height);
        let halves = [0, width / 2].map(|left| half(left).to_image());
        assert!(has_a_cloud(halves[0].as_raw()), "{renderer}");
        assert_eq!(halves[0], halves[1], "{renderer}");
    }
}

fn what_was_covered_is_shown_again(painter: &str) {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let program = server
        .view(home.path(), painter)
        .args(["--size", "1000x700", "--paused"])
        .spawn()
        .unwrap();
    let mut program = Process(program);
    let screen = Screen::of(&server);
    screen.wait_for("the window stays without a picture", has_a_cloud);
    screen.wait_for_keyboard(screen.window());
    let before = screen.wait_for_rest_of_all("the paused window does not rest");
    // Over the image and over the panel next to it; the server does not store covered parts.
    screen.cover_for_a_moment([300, 150], [500, 300]);
    let begin = Instant::now();
    while screen.pixels() != before {
        assert!(begin.elapsed() < PATIENCE, "a hole stays where the window was covered");
        std::thread::sleep(Duration::from_millis(50));
    }
    assert!(program.0.try_wait().unwrap().is_none());
}

fn a_window_on_a_display_of_another_scale_shows_a_cloud(painter: &str) {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    for scale in ["1.5", "2"] {
        let program = server
            .view(home.path(), painter)
            .env("WINIT_X11_SCALE_FACTOR", scale)
            .args(["--size", "1000x700", "--paused"])
            .spawn()
            .unwrap();
        let _program = Process(program);
        let screen = Screen::of(&server);
        screen.wait_for("the window stays without a picture", has_a_cloud);
    }
}

/// All pixels of the screen with a paused window painted by `painter`.
fn screen_painted_by(painter: &str, theme: &str) -> Vec<u8> {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let style = home.path().join("config/pointreel");
    std::fs::create_dir_all(&style).unwrap();
    let theme = format!("{{\"version\": 6, \"theme\": \"{theme}\"}}");
    std::fs::write(style.join("settings.json"), theme).unwrap();
    let program = server
        .view(home.path(), painter)
        .args(["--size", "1000x700", "--paused", "--renderer", "cpu"])
        .spawn()
        .unwrap();
    let _program = Process(program);
    let screen = Screen::of(&server);
    screen.wait_for("the window stays without a picture", has_a_cloud);
    screen.wait_for_keyboard(screen.window());
    screen.wait_for_rest_of_all("the paused window does not rest")
}

#[test]
fn both_painters_show_the_same_window() {
    for theme in ["dark", "light"] {
        let [gpu, cpu] = ["gpu", "cpu"].map(|painter| screen_painted_by(painter, theme));
        let pixels = gpu.chunks_exact(4).zip(cpu.chunks_exact(4));
        let is_other = |(a, b): &(&[u8], &[u8])| a[..3].iter().zip(&b[..3]).any(|(a, b)| a.abs_diff(*b) > 1);
        let others = pixels.clone().filter(is_other).count();
        // Edges of triangles fall on the other side of a pixel centre; the panel does not name the painter's adapter.
        assert!(1000 * others <= pixels.count(), "{theme}: {others} pixels differ");
    }
}

#[test]
fn a_machine_without_vulkan_has_a_window() {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    // The first library with that name on the search path is not one.
    let hidden = home.path().join("hidden");
    std::fs::create_dir(&hidden).unwrap();
    std::fs::write(hidden.join("libvulkan.so.1"), "").unwrap();
    let run = |painter: &str, renderer: &str| {
        let file = home.path().join(format!("{painter}-{renderer}.png"));
        let output = server
            .view(home.path(), painter)
            .env("LD_LIBRARY_PATH", &hidden)
            .env("RUST_LOG", "warn")
            .args(["--renderer", renderer, "--size", "800x600", "--screenshot"])
            .arg(&file)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let picture = image::open(file).ok().map(|picture| picture.to_rgba8());
        (output.status.code(), said, picture)
    };
    for (painter, renderer) in [("auto", "auto"), ("cpu", "auto"), ("cpu", "gpu")] {
        let (code, said, picture) = run(painter, renderer);
        assert_eq!(code, Some(0), "{painter} {renderer}: {said}");
        assert!(has_a_cloud(picture.unwrap().as_raw()), "{painter} {renderer}");
        // A user who requested a GPU is told that there is none.
        assert_eq!(said.contains("The CPU draws now"), renderer == "gpu", "{said}");
    }
    let (code, said, _) = run("gpu", "auto");
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("no Vulkan"), "{said}");
}

/// The rows of `bench window` with the demo.
fn measured_window(arguments: &[&str]) -> Vec<serde_json::Value> {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("window.json");
    let output = server
        .program(home.path())
        .args(["bench", "window", "demo:", "--size", "800x600"])
        .args(arguments)
        .arg("--json")
        .arg(&file)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    // Opening is covered elsewhere.
    let rows = report["rows"].as_array().unwrap().iter();
    rows.filter(|row| row["action"] != "open").cloned().collect()
}

fn a_window_measures_itself(painter: &str) {
    let rows = measured_window(&["--present", painter, "--frames", "30"]);
    let told = |key: &str| -> Vec<&str> { rows.iter().map(|row| row[key].as_str().unwrap()).collect() };
    assert_eq!(
        told("primitive"),
        [
            "point", "point", "point", "surfel", "surfel", "surfel", "voxel", "voxel", "voxel"
        ]
    );
    assert_eq!(told("action"), ["play", "turn", "scrub"].repeat(3));
    let number = |row: &serde_json::Value, key: &str| row[key].as_f64().unwrap();
    for row in &rows {
        assert!(number(row, "fps_presented") > 0.0, "{row}");
        assert!(number(row, "paint_ms_median") > 0.0, "{row}");
        match row["action"].as_str().unwrap() {
            "play" => {
                assert_eq!(number(row, "fps_asked"), 24.0);
                assert!(number(row, "frames_shown") >= 30.0, "{row}");
            }
            _ => assert!(number(row, "latency_ms_median") > 0.0, "{row}"),
        }
        // When the CPU paints, no driver is involved.
        if painter == "cpu" {
            assert_eq!(number(row, "driver_cpu_ms"), 0.0, "{row}");
        }
    }
}

/// The GPU work of an image does not depend on the GPU.
#[test]
fn an_image_and_its_panels_are_one_submission() {
    for row in measured_window(&["--present", "gpu", "--renderer", "gpu", "--frames", "72"]) {
        assert_eq!(row["gpu_submissions"], 1.0, "{row}");
        // Including the background and the window. Points have eye-dome lighting by default.
        let passes = match row["primitive"].as_str().unwrap() {
            "surfel" => 5.0,
            "point" => 4.0,
            _ => 3.0,
        };
        // When a different cut of surfels is drawn, one more pass gathers them among those resident on the GPU.
        let gathering = if row["primitive"] == "surfel" { 1.0 } else { 0.0 };
        let found = row["gpu_passes"].as_f64().unwrap();
        assert!((passes..=passes + gathering).contains(&found), "{row}");
        // The points of a frame at rest, 130 KiB, are already there; the panels are new whenever egui has run.
        if row["primitive"] == "point" && row["action"] == "turn" {
            let uploaded_kib = row["gpu_uploaded_kib"].as_f64().unwrap();
            assert!(uploaded_kib < 130.0, "{row}");
        }
    }
}

/// A Wayland compositor without a screen, and the folder of its socket.
struct Weston {
    _compositor: Process,
    folder: tempfile::TempDir,
}

impl Weston {
    const SOCKET: &str = "wayland-test";

    fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let compositor = Command::new("weston")
            .args(["--backend=headless-backend.so", "--socket", Self::SOCKET])
            .args(["--no-config", "--idle-time=0"])
            .env("XDG_RUNTIME_DIR", folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("weston opens the window of this test: apt-get install weston");
        let compositor = Process(compositor);
        let begin = Instant::now();
        while !folder.path().join(Self::SOCKET).exists() {
            assert!(begin.elapsed() < PATIENCE, "weston opens no socket");
            std::thread::sleep(Duration::from_millis(20));
        }
        Self {
            _compositor: compositor,
            folder,
        }
    }
}

/// On Wayland buffers are lent by turns, decorations are the program's own, and the surface must be dropped before the
/// connection.
fn a_window_on_wayland_shows_a_cloud_and_ends(painter: &str) {
    let weston = Weston::start();
    let home = weston.folder.path();
    let file = home.join("wayland.png");
    let output = Command::new(env!("CARGO_BIN_EXE_pointreel"))
        .current_dir(home)
        .env_remove("DISPLAY")
        .env("WAYLAND_DISPLAY", Weston::SOCKET)
        .env("XDG_RUNTIME_DIR", home)
        .env("HOME", home)
        .args(["view", "--present", painter, "--size", "800x600"])
        .args(["--after-frames", "30", "--screenshot"])
        .arg(&file)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {said}", output.status);
    assert_eq!(said, "", "nothing that a person could mend");
    let picture = image::open(file).unwrap().to_rgba8();
    assert!(has_a_cloud(picture.as_raw()));
}

#[test]
fn a_lost_device_is_opened_again() {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    for renderer in ["cpu", "gpu"] {
        let file = home.path().join(format!("{renderer}.png"));
        let output = server
            .program(home.path())
            .env("RUST_LOG", "warn")
            .args(["view", "--present", "gpu"])
            .args(["--renderer", renderer, "--size", "800x600"])
            .args(["--lose-device-after", "2", "--screenshot"])
            .arg(&file)
            .args(["--after-frames", "5"])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{renderer}: {said}");
        assert!(said.contains("device was lost"), "{renderer}: {said}");
        // A window that drew with the GPU continues with the CPU, and reports it.
        let falls_back = said.contains("The CPU draws now");
        assert_eq!(falls_back, renderer == "gpu", "{renderer}: {said}");
        let picture = image::open(file).unwrap().to_rgba8();
        assert!(has_a_cloud(picture.as_raw()), "{renderer}");
    }
}

#[test]
fn failures_to_show_end_with_an_error_message() {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let missing = server
        .program(home.path())
        .args(["view", "/nowhere/at/all"])
        .output()
        .unwrap();
    assert_eq!(missing.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("/nowhere/at/all"));

    let broken = home.path().join("broken.ply");
    std::fs::write(&broken, "ply\nformat ascii 1.0\nelement").unwrap();
    let output = server
        .program(home.path())
        .arg("view")
        .arg(&broken)
        .arg("--screenshot")
        .arg(home.path().join("never.png"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("broken.ply"));

    let without_display = server
        .program(home.path())
        .env_remove("DISPLAY")
        .arg("view")
        .output()
        .unwrap();
    assert_eq!(without_display.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&without_display.stderr).contains("pointreel render"));

    let usage = server
        .program(home.path())
        .args(["view", "--delta", "2"])
        .output()
        .unwrap();
    assert_eq!(usage.status.code(), Some(2));
}
