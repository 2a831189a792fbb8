//! The real program on an X server without a screen: real keys and a real mouse go in, pixels come out.
#![allow(clippy::unwrap_used, reason = "a helper of a test that cannot go on fails the test")]
#![allow(dead_code, reason = "no test needs all of it")]

use std::io::Read as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use x11rb::connection::Connection as _;
use x11rb::protocol::xproto::{self, ConnectionExt as _};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// Software adapters compile their shaders for the first image; machines of continuous integration are slow.
pub(crate) const PATIENCE: Duration = Duration::from_mins(1);

/// Where [`Screen::picture`] looks: at the centre of the 3-D view of the smallest window that tests open.
pub(crate) const PICTURE_COLUMNS: Range<usize> = 50..600;
pub(crate) const PICTURE_ROWS: Range<usize> = 100..480;

/// A process that ends with the test.
pub(crate) struct Process(pub(crate) Child);

impl Drop for Process {
    fn drop(&mut self) {
        // It may already have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// An X server without a screen, on a display number of its own choice.
pub(crate) struct Xvfb {
    _server: Process,
    display: String,
}

impl Xvfb {
    pub(crate) fn start() -> Self {
        let mut server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "1000x700x24",
                "-nolisten",
                "tcp",
                // Without it the server restarts when its last client disconnects, and refuses new clients in the
                // meantime.
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

    /// The program, as started on this display by a user without settings.
    pub(crate) fn program(&self, home: &Path) -> Command {
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

    /// The program that is about to open a window, painted by `painter`.
    pub(crate) fn view(&self, home: &Path, painter: &str) -> Command {
        let mut command = self.program(home);
        command.args(["view", "--present", painter]);
        command
    }
}

/// Runs each function, a test that takes the painter of the window, once for each painter.
macro_rules! painted_by_each {
    ($($name:ident),+ $(,)?) => {
        $(mod $name {
            #[test]
            fn gpu() {
                super::$name("gpu");
            }

            #[test]
            fn cpu() {
                super::$name("cpu");
            }
        })+
    };
}
pub(crate) use painted_by_each;

/// The test's own connection to the server.
pub(crate) struct Screen {
    connection: RustConnection,
    pub(crate) root: xproto::Window,
    size: [u16; 2],
}

impl Screen {
    pub(crate) fn of(server: &Xvfb) -> Self {
        let (connection, number) = x11rb::connect(Some(&server.display)).unwrap();
        let screen = &connection.setup().roots[number];
        let (root, size) = (screen.root, [screen.width_in_pixels, screen.height_in_pixels]);
        Self { connection, root, size }
    }

    /// All pixels, 4 bytes each.
    pub(crate) fn pixels(&self) -> Vec<u8> {
        let [width, height] = self.size;
        self.connection
            .get_image(xproto::ImageFormat::Z_PIXMAP, self.root, 0, 0, width, height, u32::MAX)
            .unwrap()
            .reply()
            .unwrap()
            .data
    }

    /// Pixels at the centre of the 3-D view: no panel, no notice.
    pub(crate) fn picture(&self) -> Vec<u8> {
        let pixels = self.pixels();
        let stride = usize::from(self.size[0]) * 4;
        let columns = 4 * PICTURE_COLUMNS.start..4 * PICTURE_COLUMNS.end;
        PICTURE_ROWS
            .flat_map(|row| pixels[row * stride..][columns.clone()].to_vec())
            .collect()
    }

    /// Waits until `is_met` returns true for the image.
    pub(crate) fn wait_for(&self, what: &str, is_met: impl Fn(&[u8]) -> bool) -> Vec<u8> {
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

    /// Waits until nothing has moved in the image for a while.
    pub(crate) fn wait_for_rest(&self, what: &str) -> Vec<u8> {
        Self::rest_of(what, || self.picture())
    }

    /// Waits until nothing has moved on the whole screen for a while: thumbnails are there, too.
    pub(crate) fn wait_for_rest_of_all(&self, what: &str) -> Vec<u8> {
        Self::rest_of(what, || self.pixels())
    }

    fn rest_of(what: &str, look: impl Fn() -> Vec<u8>) -> Vec<u8> {
        let begin = Instant::now();
        let mut before = look();
        loop {
            std::thread::sleep(Duration::from_millis(700));
            let now = look();
            if now == before {
                return now;
            }
            assert!(begin.elapsed() < PATIENCE, "{what}");
            before = now;
        }
    }

    /// The program's window, once it is on the screen.
    pub(crate) fn window(&self) -> xproto::Window {
        let begin = Instant::now();
        loop {
            let children = self.connection.query_tree(self.root).unwrap().reply().unwrap().children;
            let viewable = children.into_iter().find(|&child| {
                let attributes = self.connection.get_window_attributes(child).unwrap().reply();
                let geometry = self.connection.get_geometry(child).unwrap().reply();
                attributes.is_ok_and(|attributes| attributes.map_state == xproto::MapState::VIEWABLE)
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
    pub(crate) fn resize(&self, window: xproto::Window, width: u32, height: u32) {
        let size = xproto::ConfigureWindowAux::new().width(width).height(height);
        self.connection
            .configure_window(window, &size)
            .unwrap()
            .check()
            .unwrap();
    }

    /// Covers a part of the screen with the window of another program, and removes it again.
    pub(crate) fn cover_for_a_moment(&self, [x, y]: [i16; 2], [width, height]: [u16; 2]) {
        let window = self.connection.generate_id().unwrap();
        let looks = xproto::CreateWindowAux::new()
            .override_redirect(1)
            .background_pixel(0x00ff_00ff);
        let class = xproto::WindowClass::INPUT_OUTPUT;
        self.connection
            .create_window(
                x11rb::COPY_DEPTH_FROM_PARENT,
                window,
                self.root,
                x,
                y,
                width,
                height,
                0,
                class,
                x11rb::COPY_FROM_PARENT,
                &looks,
            )
            .unwrap();
        self.connection.map_window(window).unwrap().check().unwrap();
        std::thread::sleep(Duration::from_millis(300));
        let over = [x, y].map(|edge| usize::try_from(edge).unwrap() + 1);
        let pixel = 4 * (over[1] * usize::from(self.size[0]) + over[0]);
        assert_eq!(self.pixels()[pixel..pixel + 3], [0xff, 0, 0xff], "it is not covered");
        self.connection.destroy_window(window).unwrap().check().unwrap();
    }

    /// Waits until the window has the keyboard, which it takes itself: there is no window manager.
    pub(crate) fn wait_for_keyboard(&self, window: xproto::Window) {
        let begin = Instant::now();
        while self.connection.get_input_focus().unwrap().reply().unwrap().focus != window {
            assert!(begin.elapsed() < PATIENCE, "the window has no keyboard");
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Presses and releases a key.
    pub(crate) fn key(&self, keysym: u32) {
        for event in [xproto::KEY_PRESS_EVENT, xproto::KEY_RELEASE_EVENT] {
            self.key_event(event, keysym);
        }
    }

    fn key_event(&self, event: u8, keysym: u32) {
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
        self.connection
            .xtest_fake_input(event, keycode, 0, x11rb::NONE, 0, 0, 0)
            .unwrap()
            .check()
            .unwrap();
    }
}

/// More than a plain background: the colours of a cloud and its shading.
pub(crate) fn has_a_cloud(picture: &[u8]) -> bool {
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

pub(crate) fn pngs(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files
        .filter(|path| path.extension().is_some_and(|extension| extension == "png"))
        .collect()
}

impl Screen {
    /// Moves the mouse, in pixels from the upper left corner.
    pub(crate) fn move_to(&self, [x, y]: [i16; 2]) {
        self.mouse(xproto::MOTION_NOTIFY_EVENT, 0, [x, y]);
    }

    /// Clicks with the left button.
    pub(crate) fn click(&self, at: [i16; 2]) {
        self.drag(&[at]);
    }

    /// Moves the mouse along `places` while the left button is down.
    pub(crate) fn drag(&self, places: &[[i16; 2]]) {
        const LEFT: u8 = 1;
        // For a user, a click takes a few frames, and egui compares one with the next.
        let beat = || std::thread::sleep(Duration::from_millis(120));
        let (first, last) = (places[0], places[places.len() - 1]);
        self.move_to(first);
        beat();
        self.mouse(xproto::BUTTON_PRESS_EVENT, LEFT, first);
        beat();
        for &place in &places[1..] {
            self.move_to(place);
            beat();
        }
        self.mouse(xproto::BUTTON_RELEASE_EVENT, LEFT, last);
        beat();
    }

    fn mouse(&self, event: u8, button: u8, [x, y]: [i16; 2]) {
        self.connection
            .xtest_fake_input(event, button, 0, self.root, x, y, 0)
            .unwrap()
            .check()
            .unwrap();
    }

    /// Holds a modifier, by its keysym, while a key is pressed.
    pub(crate) fn key_with(&self, modifier: u32, keysym: u32) {
        self.key_event(xproto::KEY_PRESS_EVENT, modifier);
        self.key(keysym);
        self.key_event(xproto::KEY_RELEASE_EVENT, modifier);
    }
}
