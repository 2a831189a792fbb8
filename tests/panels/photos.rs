//! Input images: they texture the shown frame once loaded, can be excluded, and their viewpoints taken.

use super::{click, window};
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use image::{Rgb, RgbImage};
use pointreel::app::{PanelId, State};
use pointreel::scene::{Choice, PhotoMode, Primitive};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Two images of a wall of points, as COLMAP writes them.
fn write_set(folder: &Path) {
    let model = folder.join("sparse/0");
    fs::create_dir_all(&model).unwrap();
    fs::create_dir_all(folder.join("images")).unwrap();
    fs::write(model.join("cameras.txt"), "1 PINHOLE 64 48 60 60 32 24\n").unwrap();
    fs::write(
        model.join("images.txt"),
        "1 1 0 0 0 0 0 4 1 left.png\n\n2 1 0 0 0 -0.5 0 4 1 right.png\n\n",
    )
    .unwrap();
    let mut points = String::new();
    for at in 0..400 {
        let [x, y] = [at % 20, at / 20].map(|step| 0.1 * f64::from(step) - 0.95);
        writeln!(points, "{} {x} {y} 0 90 90 90 0.1", at + 1).unwrap();
    }
    fs::write(model.join("points3D.txt"), points).unwrap();
    for (name, color) in [("left.png", [200, 40, 40]), ("right.png", [40, 40, 200])] {
        RgbImage::from_pixel(64, 48, Rgb(color))
            .save(folder.join("images").join(name))
            .unwrap();
    }
}

/// The same cameras, a folder each, with images of three time steps: red is the time step.
fn write_multiview_video(folder: &Path) {
    write_set(folder);
    fs::remove_dir_all(folder.join("images")).unwrap();
    let images = folder.join("sparse/0/images.txt");
    let text = fs::read_to_string(&images).unwrap();
    let text = text
        .replace("left.png", "left/0.png")
        .replace("right.png", "right/0.png");
    fs::write(images, text).unwrap();
    fs::create_dir(folder.join("points")).unwrap();
    for time_step in 0..3_u8 {
        for camera in ["left", "right"] {
            let name = folder.join(camera).join(format!("{time_step}.png"));
            fs::create_dir_all(name.parent().unwrap()).unwrap();
            RgbImage::from_pixel(64, 48, Rgb([60 * time_step, 9, 9]))
                .save(name)
                .unwrap();
        }
        let mut points = String::new();
        for at in 0..400 {
            let [x, y] = [at % 20, at / 20].map(|step| 0.1 * f64::from(step) - 0.95);
            writeln!(points, "{x} {y} 0").unwrap();
        }
        fs::write(folder.join(format!("points/{time_step}.xyz")), points).unwrap();
    }
}

/// The frame that is drawn next, and the first texel of its first input image.
fn drawn_frame(harness: &mut Harness<'_, State>) -> Option<(usize, [u8; 4])> {
    harness.state_mut().forget_picture();
    let posed_images = harness.state_mut().next_packet()?.posed_images?.posed_images;
    let texel = posed_images.all().first()?.texture.levels()[0].pixels()[0];
    Some((harness.state().player.as_ref()?.shown()?.index, texel))
}

#[test]
fn playback_waits_for_the_images_of_each_frame() {
    let folder = tempfile::tempdir().unwrap();
    write_multiview_video(folder.path());
    let mut harness = window();
    harness.state_mut().open_paths(vec![folder.path().to_owned()]);
    until_drawn(&mut harness, 2);
    let mut now = harness.state().now();
    if !harness.state().player.as_ref().unwrap().is_playing() {
        harness.state_mut().player.as_mut().unwrap().toggle(now);
    }
    let mut seen = std::collections::BTreeSet::new();
    let begin = Instant::now();
    while seen.len() < 3 {
        assert!(begin.elapsed() < Duration::from_secs(30), "only {seen:?} were drawn");
        now += Duration::from_millis(20);
        harness.state_mut().update(now);
        if harness.state().player.as_ref().unwrap().shown().is_some() {
            let (frame, texel) = drawn_frame(&mut harness).expect("no frame is drawn without its photographs");
            assert_eq!(texel[0], 60 * frame as u8, "frame {frame}");
            seen.insert(frame);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Input images in the packet that is drawn next.
fn drawn(harness: &mut Harness<'_, State>) -> usize {
    harness.state_mut().forget_picture();
    let packet = harness.state_mut().next_packet();
    let posed_images = packet.and_then(|packet| packet.posed_images);
    posed_images.map_or(0, |shown| shown.posed_images.all().len())
}

fn until_drawn(harness: &mut Harness<'_, State>, posed_images: usize) {
    let begin = Instant::now();
    while drawn(harness) != posed_images {
        assert!(
            begin.elapsed() < Duration::from_secs(30),
            "{posed_images} photographs are never drawn"
        );
        let now = harness.state().now();
        harness.state_mut().update(now);
        std::thread::sleep(Duration::from_millis(5));
    }
    harness.run();
}

/// A few hundred disks as large as the gaps between them would be the initial view of a set.
#[test]
fn points_are_drawn_until_images_are_projected_onto_a_surface() {
    let folder = tempfile::tempdir().unwrap();
    write_set(folder.path());
    for chosen in [Choice::Auto, Primitive::Surfel.into()] {
        let mut harness = window();
        harness.state_mut().open_paths(vec![folder.path().to_owned()]);
        let begin = Instant::now();
        loop {
            assert!(begin.elapsed() < Duration::from_secs(30), "photographs are never drawn");
            let now = harness.state().now();
            harness.state_mut().update(now);
            harness.state_mut().forget_picture();
            // Test windows draw whatever they open as surfels.
            harness.state_mut().style.primitive = chosen;
            let Some(packet) = harness.state_mut().next_packet() else {
                continue;
            };
            let drawn = packet.style.primitive;
            if packet.posed_images.is_some() {
                assert_eq!(drawn, Primitive::Surfel);
                break;
            }
            // A user who has chosen disks gets them once their radii are known.
            assert!(drawn == Primitive::Point || chosen == Primitive::Surfel, "{drawn}");
        }
        assert!(harness.query_by_label_contains("Reconstructing the surface").is_none());
    }
}

#[test]
fn images_can_be_projected_excluded_and_viewed_from() {
    let folder = tempfile::tempdir().unwrap();
    write_set(folder.path());
    let mut harness = window();
    harness.state_mut().open_paths(vec![folder.path().to_owned()]);
    until_drawn(&mut harness, 2);
    harness.state_mut().panels.set(PanelId::new("photographs"), true);
    harness.run();
    assert!(harness.query_by_label("2 images").is_some());
    let used = harness.get_by_role_and_label(Role::CheckBox, "Use right.png");
    used.click();
    harness.run();
    // Until the frame is built with one image, it is drawn with both.
    assert!(drawn(&mut harness) > 0);
    until_drawn(&mut harness, 1);
    click(&mut harness, "Use all");
    until_drawn(&mut harness, 2);
    // The initial view is the first image's.
    let first = harness.state().camera;
    harness.get_by_label("right.png").click();
    harness.run();
    let second = harness.state().camera;
    let moved = second.eye_in_world() - first.eye_in_world();
    assert!((moved.length() - 0.5).abs() < 1e-9, "{moved}");
    harness
        .get_by_role_and_label(Role::CheckBox, "Show camera frusta")
        .click();
    harness.run();
    // From behind both of them, without the list covering the image.
    harness.state_mut().panels.set(PanelId::new("photographs"), false);
    harness.state_mut().camera.zoom(2.0);
    harness.run();
    click(&mut harness, "View from left.png");
    assert!((harness.state().camera.eye_in_world() - first.eye_in_world()).length() < 1e-9);
    harness.state_mut().style.photos.mode = PhotoMode::Colored;
    assert_eq!(drawn(&mut harness), 0);
}
