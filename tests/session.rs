//! One sitting in front of the real program: open, play, scrub, change the render mode, measure, export, by real keys
//! and a real mouse. Screenshots are compared from step to step: after undo the screen must be the same as before, to
//! the last bit.
#![allow(clippy::unwrap_used, reason = "a helper of a test that cannot go on fails the test")]
#![cfg(all(unix, not(target_os = "macos")))]

#[path = "common/xvfb.rs"]
mod xvfb;

use image::RgbaImage;
use std::path::Path;
use std::time::{Duration, Instant};
use xvfb::{PATIENCE, Process, Screen, Xvfb, has_a_cloud, painted_by_each, pngs};

painted_by_each!(open_play_scrub_draw_otherwise_measure_and_export);

/// Keysyms of X11.
const SPACE: u32 = 0x20;
const HOME: u32 = 0xff50;
const ESCAPE: u32 = 0xff1b;
const SHIFT: u32 = 0xffe1;
const CTRL: u32 = 0xffe3;
const M: u32 = 0x6d;
const P: u32 = 0x70;
const Z: u32 = 0x7a;

/// Places in a window of 1000 × 700 pixels.
const BAR: [[i16; 2]; 3] = [[60, 644], [500, 644], [900, 644]];
const VOXELS: [i16; 2] = [865, 154];
const BODY: [[i16; 2]; 2] = [[345, 260], [345, 330]];
/// Over the menu, where nothing lights up.
const ASIDE: [i16; 2] = [640, 16];
/// In the window with the results.
const DELETE_ALL: [i16; 2] = [149, 541];
/// In the window that *Export* opens.
const EXPORT: [i16; 2] = [128, 457];
/// Height of the menu above the 3-D view.
const PICTURE_TOP: usize = 33;

fn open_play_scrub_draw_otherwise_measure_and_export(painter: &str) {
    let server = Xvfb::start();
    let home = tempfile::tempdir().unwrap();
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/demo");
    let program = server
        .view(home.path(), painter)
        .args(["--paused", "--size", "1000x700", "--renderer", "cpu"])
        .arg(demo)
        .spawn()
        .unwrap();
    let mut program = Process(program);
    let screen = Screen::of(&server);

    screen.wait_for("the sequence is not opened", has_a_cloud);
    screen.wait_for_keyboard(screen.window());
    screen.move_to(ASIDE);
    let opened = screen.wait_for_rest("the first picture does not settle");
    let is_as_opened = |picture: &[u8]| *picture == opened;
    let is_other = |picture: &[u8]| *picture != opened;

    screen.key(SPACE);
    screen.wait_for("it does not play", is_other);
    screen.key(SPACE);
    screen.wait_for_rest("it does not pause");

    screen.drag(&BAR);
    screen.move_to(ASIDE);
    let scrubbed = screen.wait_for_rest("scrubbing does not end");
    assert!(has_a_cloud(&scrubbed), "the last frames are not seen");
    assert!(is_other(&scrubbed), "the bar does not scrub");
    screen.key(HOME);
    screen.wait_for("the first frame is another picture now", is_as_opened);

    screen.click(VOXELS);
    screen.move_to(ASIDE);
    let voxels = screen.wait_for("voxels look as surfels do", is_other);
    assert!(has_a_cloud(&voxels), "voxels are not seen");
    screen.key_with(CTRL, Z);
    screen.wait_for("undo does not bring surfels back", is_as_opened);

    screen.key(M);
    for place in BODY {
        screen.click(place);
    }
    screen.move_to(ASIDE);
    screen.wait_for("what is measured is not marked", is_other);
    // After the first of the two marks the image has already changed.
    screen.wait_for_rest("measuring does not end");
    screen.click(DELETE_ALL);
    screen.key(ESCAPE);
    screen.wait_for("marks stay", is_as_opened);

    screen.key(P);
    let textured = new_picture(home.path(), 1);
    assert_is_on_screen(&textured, &opened);
    screen.key_with(SHIFT, P);
    screen.wait_for("no window to export from", is_other);
    screen.wait_for_rest("the window to export from does not settle");
    screen.click(EXPORT);
    let exported = new_picture(home.path(), 2);
    assert!(exported == textured, "the export is another picture than the screen's");
    assert!(program.0.try_wait().unwrap().is_none(), "the window went on");
}

/// The newest image in `folder` once there are this many.
fn new_picture(folder: &Path, count: usize) -> RgbaImage {
    let begin = Instant::now();
    loop {
        let files = pngs(folder);
        let newest = files
            .iter()
            .max_by_key(|file| file.metadata().and_then(|data| data.modified()).ok());
        // The name may appear before the last byte is written.
        if files.len() == count
            && let Some(picture) = newest.and_then(|file| image::open(file).ok())
        {
            return picture.to_rgba8();
        }
        assert!(
            begin.elapsed() < PATIENCE,
            "{} of {count} pictures were written",
            files.len()
        );
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Asserts that the screen had exactly these pixels: `seen` is the result of [`Screen::picture`], blue first.
fn assert_is_on_screen(saved: &RgbaImage, seen: &[u8]) {
    let [columns, rows] = [xvfb::PICTURE_COLUMNS, xvfb::PICTURE_ROWS];
    let pixels = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
    let differing = pixels.zip(seen.chunks_exact(4)).filter(|&((column, row), seen)| {
        let [red, green, blue, _] = saved.get_pixel(column as u32, (row - PICTURE_TOP) as u32).0;
        seen[..3] != [blue, green, red]
    });
    assert_eq!(differing.count(), 0, "pixels of the file that the screen did not show");
}
