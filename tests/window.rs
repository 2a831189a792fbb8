//! The real window of the real program under Xvfb: real keys go in, the root window's pixels come out.
#![allow(
    clippy::unwrap_used,
    reason = "a helper of a test that cannot go on fails the test"
)]
#![cfg(all(unix, not(target_os = "macos")))]

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use x11rb::connection::Connection as _;
use x11rb::protocol::xproto::{self, ConnectionExt as _};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// Software adapters compile their shaders for the first picture; machines of continuous integration are slow.
const PATIENCE: Duration = Duration::from_mins(1);

/// Keysyms of X11.
const SPACE: u32 = 0x20;
const P: u32 = 0x70;
const RIGHT: u32 = 0xff53;
const L: u32 = 0x6c;
const F11: u32 = 0xffc8;

/// A process that ends with the test.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// An X server without a screen, on a display number of its own choice.
struct Xvfb {
    _server: Process,
    display: String,
}

impl Xvfb {
    fn start() -> Self {
        let mut server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "1000x700x24",
                "-nolisten",
                "tcp",
                // Without it the server begins anew when its last client leaves, and refuses who comes meanwhile.
                "-noreset",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb opens the window of this test: apt-get install xvfb");
        let mut output = server.stdout.take().unwrap();
        let mut number = String::new();
        let mut byte = [0];
        while output.read(&mut byte).unwrap() == 1 && byte[0] != b'\n' {
            number.push(char::from(byte[0]));
        }
        assert!(!number.is_empty(), "Xvfb ended without a display");
        Self {
            _server: Process(server),
            display: format!(":{number}"),
        }
    }

    /// The program, as it would be started on this display by somebody without settings.
    fn program(&self, home: &Path) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pointreel"));
        command
            .current_dir(home)
            .env("DISPLAY", &self.display)
            .env("HOME", home)
            .env("XDG_CONFIG_HOME", home.join("config"))
            .env("XDG_RUNTIME_DIR", home)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET");
        command
    }
}

/// The test's own connection to the server.
struct Screen {
    connection: RustConnection,
    root: xproto::Window,
    size: [u16; 2],
}

impl Screen {
    fn of(server: &Xvfb) -> Self {
        let (connection, number) = x11rb::connect(Some(&server.display)).unwrap();
        let screen = &connection.setup().roots[number];
        let (root, size) = (
            screen.root,
            [screen.width_in_pixels, screen.height_in_pixels],
        );
        Self {
            connection,
            root,
            size,
        }
    }

    /// All pixels, 4 bytes each.
    fn pixels(&self) -> Vec<u8> {
        let [width, height] = self.size;
        self.connection
            .get_image(
                xproto::ImageFormat::Z_PIXMAP,
                self.root,
                0,
                0,
                width,
                height,
                u32::MAX,
            )
            .unwrap()
            .reply()
            .unwrap()
            .data
    }

    /// Pixels of the 3-D picture's middle: no panel, no notice.
    fn picture(&self) -> Vec<u8> {
        let pixels = self.pixels();
        let stride = usize::from(self.size[0]) * 4;
        (100..480)
            .flat_map(|row| pixels[row * stride + 200..row * stride + 2400].to_vec())
            .collect()
    }

    /// Waits until `is_met` says yes of the picture.
    fn wait_for(&self, what: &str, is_met: impl Fn(&[u8]) -> bool) -> Vec<u8> {
        let begin = Instant::now();
        loop {
            let picture = self.picture();
            if is_met(&picture) {
                return picture;
            }
            assert!(begin.elapsed() < PATIENCE, "{what}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Waits until nothing has moved for a while.
    fn wait_for_rest(&self, what: &str) -> Vec<u8> {
        let begin = Instant::now();
        let mut before = self.picture();
        loop {
            std::thread::sleep(Duration::from_millis(700));
            let now = self.picture();
            if now == before {
                return now;
            }
            assert!(begin.elapsed() < PATIENCE, "{what}");
            before = now;
        }
    }

    /// The program's window, once it is on the screen.
    fn window(&self) -> xproto::Window {
        let begin = Instant::now();
        loop {
            let children = self
                .connection
                .query_tree(self.root)
                .unwrap()
                .reply()
                .unwrap()
                .children;
            let viewable = children.into_iter().find(|&child| {
                let attributes = self
                    .connection
                    .get_window_attributes(child)
                    .unwrap()
                    .reply();
                let geometry = self.connection.get_geometry(child).unwrap().reply();
                attributes
                    .is_ok_and(|attributes| attributes.map_state == xproto::MapState::VIEWABLE)
                    && geometry.is_ok_and(|geometry| geometry.width > 100)
            });
            if let Some(window) = viewable {
                return window;
            }
            assert!(begin.elapsed() < PATIENCE, "no window was opened");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Gives the window another size, as its edge drawn by the mouse would.
    fn resize(&self, window: xproto::Window, width: u32, height: u32) {
        let size = xproto::ConfigureWindowAux::new()
            .width(width)
            .height(height);
        self.connection
            .configure_window(window, &size)
            .unwrap()
            .check()
            .unwrap();
    }

    /// Waits until the window has the keyboard, which it takes itself: there is no window manager.
    fn wait_for_keyboard(&self, window: xproto::Window) {
        let begin = Instant::now();
        while self
            .connection
            .get_input_focus()
            .unwrap()
            .reply()
            .unwrap()
            .focus
            != window
        {
            assert!(begin.elapsed() < PATIENCE, "the window has no keyboard");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Presses and releases a key.
    fn key(&self, keysym: u32) {
        let setup = self.connection.setup();
        let (first, last) = (setup.min_keycode, setup.max_keycode);
        let mapping = self
            .connection
            .get_keyboard_mapping(first, last - first + 1)
            .unwrap()
            .reply()
            .unwrap();
        let width = usize::from(mapping.keysyms_per_keycode);
        let row = mapping
            .keysyms
            .chunks(width)
            .position(|row| row[0] == keysym)
            .expect("the keyboard has the key");
        let keycode = first + row as u8;
        for event in [xproto::KEY_PRESS_EVENT, xproto::KEY_RELEASE_EVENT] {
            self.connection
                .xtest_fake_input(event, keycode, 0, x11rb::NONE, 0, 0, 0)
                .unwrap()
                .check()
                .unwrap();
        }
    }
}

/// More than a plain background: what a cloud and its shading leave.
fn has_a_cloud(picture: &[u8]) -> bool {
    let mut colors: Vec<[u8; 3]> = picture
        .chunks_exact(4)
        .map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    let bright = colors
        .iter()
        .filter(|color| color.iter().any(|&channel| channel > 120))
        .count();
    let all = colors.len();
    colors.sort_unstable();
    colors.dedup();
    colors.len() > 500 && bright * 50 > all
}

fn pngs(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    files
        .filter(|path| path.extension().is_some_and(|extension| extension == "png"))
        .collect()
}

/// Processor time of a process so far, in the kernel's ticks of 10 ms.
#[cfg(target_os = "linux")]
fn cpu_ticks(child: &Child) -> u64 {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
    // The name in parentheses may have spaces; user and system time are fields 14 and 15.
    let fields: Vec<&str> = stat
        .rsplit_once(')')
        .unwrap()
        .1
        .split_whitespace()
        .collect();
    fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap()
}

#[test]
fn the_demo_plays_pauses_and_is_photographed() {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let program = server
        .program(home.path())
        .args(["view", "--size", "1000x700"])
        .spawn()
        .unwrap();
    let mut program = Process(program);
    let screen = Screen::of(&server);

    let first = screen.wait_for(
        "the window stays without a picture of the demo",
        has_a_cloud,
    );
    screen.wait_for("the demo does not play", |picture| *picture != first);

    screen.wait_for_keyboard(screen.window());
    screen.key(SPACE);
    let paused = screen.wait_for_rest("the demo does not pause");
    std::thread::sleep(Duration::from_secs(1));
    assert!(screen.picture() == paused, "a paused picture changed");

    #[cfg(target_os = "linux")]
    {
        let before = cpu_ticks(&program.0);
        std::thread::sleep(Duration::from_secs(3));
        let used = cpu_ticks(&program.0) - before;
        assert!(
            used <= 1,
            "an idle window used {used} ticks of 10 ms in 3 s"
        );
    }

    screen.key(RIGHT);
    screen.wait_for("the next frame does not come", |picture| *picture != paused);
    screen.key(P);
    let begin = Instant::now();
    while pngs(home.path()).is_empty() {
        assert!(begin.elapsed() < PATIENCE, "no picture was saved");
        std::thread::sleep(Duration::from_millis(50));
    }
    // The name is there before the last byte.
    std::thread::sleep(Duration::from_millis(300));
    let saved = image::open(&pngs(home.path())[0]).unwrap().to_rgba8();
    assert!(saved.width() > 400 && saved.height() > 300);
    assert!(has_a_cloud(saved.as_raw()), "the saved picture is empty");
    assert!(
        saved.pixels().all(|pixel| pixel[3] == 255),
        "the saved picture is not opaque"
    );
    assert!(
        program.0.try_wait().unwrap().is_none(),
        "the window went on"
    );
}

#[test]
fn a_window_of_any_size_goes_on() {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let program = server
        .program(home.path())
        .args(["view", "--size", "1000x700", "--paused"])
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

    // Nobody carries out full screen here; asking for it and back must do no harm.
    for _ in 0..2 {
        screen.key(F11);
        std::thread::sleep(Duration::from_millis(400));
    }
    screen.wait_for("full screen and back is another picture", |picture| {
        *picture == before
    });
    screen.key(RIGHT);
    screen.wait_for("the window does not listen any more", |picture| {
        *picture != before
    });
    assert!(program.0.try_wait().unwrap().is_none());
}

#[test]
fn settings_are_kept_for_the_next_window() {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("config/pointreel/settings.json");
    // From looping on: the second window goes on where the first one was left.
    for expected in ["ping-pong", "off"] {
        let program = server
            .program(home.path())
            .args(["view", "--paused", "--primitive", "point"])
            .spawn()
            .unwrap();
        let _program = Process(program);
        let screen = Screen::of(&server);
        screen.wait_for("the window stays without a picture", has_a_cloud);
        screen.wait_for_keyboard(screen.window());
        screen.key(L);
        let begin = Instant::now();
        // Half a file would not be read.
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

#[test]
fn a_screenshot_of_either_renderer_is_written_and_the_window_ends() {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    for renderer in ["gpu", "cpu"] {
        let file = home.path().join(format!("{renderer}.png"));
        let status = server
            .program(home.path())
            .args(["view", "--renderer", renderer, "--primitive", "point"])
            .args(["--size", "800x600", "--screenshot"])
            .arg(&file)
            .args(["--after-frames", "3"])
            .status()
            .unwrap();
        assert!(status.success(), "{renderer}");
        let picture = image::open(file).unwrap().to_rgba8();
        assert!(has_a_cloud(picture.as_raw()), "{renderer}");
    }
}

#[test]
fn a_sequence_beside_itself_is_two_equal_halves() {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    for renderer in ["gpu", "cpu"] {
        let file = home.path().join(format!("{renderer}.png"));
        let status = server
            .program(home.path())
            .args(["view", "--compare", "demo:", "--paused"])
            .args(["--renderer", renderer, "--primitive", "point"])
            .args(["--size", "800x600", "--screenshot"])
            .arg(&file)
            .status()
            .unwrap();
        assert!(status.success(), "{renderer}");
        let picture = image::open(file).unwrap().to_rgba8();
        let (width, height) = picture.dimensions();
        assert_eq!(width % 2, 0, "no halves");
        let half = |left| image::imageops::crop_imm(&picture, left, 0, width / 2, height);
        let halves = [0, width / 2].map(|left| half(left).to_image());
        assert!(has_a_cloud(halves[0].as_raw()), "{renderer}");
        assert_eq!(halves[0], halves[1], "{renderer}");
    }
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
            .args(["view", "--renderer", renderer, "--size", "800x600"])
            .args(["--lose-device-after", "2", "--screenshot"])
            .arg(&file)
            .args(["--after-frames", "5"])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{renderer}: {said}");
        assert!(said.contains("device was lost"), "{renderer}: {said}");
        // Who drew with the graphics card goes on with the processor, and is told.
        let falls_back = said.contains("The processor draws now");
        assert_eq!(falls_back, renderer == "gpu", "{renderer}: {said}");
        let picture = image::open(file).unwrap().to_rgba8();
        assert!(has_a_cloud(picture.as_raw()), "{renderer}");
    }
}

#[test]
fn what_cannot_be_shown_ends_with_a_sentence() {
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
