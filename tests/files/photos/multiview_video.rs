//! Multi-view video: a sequence whose every frame is a set of images, opened as a user does.

use super::scene::Scene;
use image::{Rgb, RgbImage};
use pointreel::check::check;
use pointreel::photos::LoadedPhotos;
use pointreel::progress::Progress;
use pointreel::sequence::Sequence;
use std::fs;
use std::path::Path;

const TIME_STEPS: usize = 3;

/// Images of one colour each: red is the time step, green the camera.
fn write_image(scene: &Scene, path: &Path, time_step: usize, camera: usize) {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let [width, height] = scene.size_px;
    let color = Rgb([50 * time_step as u8, 30 * camera as u8, 7]);
    RgbImage::from_pixel(width, height, color).save(path).unwrap();
}

/// A folder per camera next to the model of COLMAP, with points of each time step.
fn write_multiview_video(scene: &Scene, folder: &Path) {
    scene.write_colmap_text(folder);
    fs::remove_dir_all(folder.join("images")).unwrap();
    let images = folder.join("sparse/0/images.txt");
    let mut text = fs::read_to_string(&images).unwrap();
    for camera in 0..scene.poses.len() {
        text = text.replace(&Scene::name(camera), &format!("cam{camera}/0001.png"));
        for time_step in 0..TIME_STEPS {
            let name = format!("images/cam{camera}/{:04}.png", time_step + 1);
            write_image(scene, &folder.join(name), time_step, camera);
        }
    }
    fs::write(images, text).unwrap();
    fs::create_dir(folder.join("points")).unwrap();
    for time_step in 0..TIME_STEPS {
        let points = format!("{time_step} 0 0\n0 1 0\n0 0 1\n");
        fs::write(folder.join(format!("points/{:04}.xyz", time_step + 1)), points).unwrap();
    }
}

#[test]
fn multiview_video_frames_have_their_own_images_and_points() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::simple();
    write_multiview_video(&scene, folder.path());
    let sequence = Sequence::discover(&[folder.path().to_owned()]).unwrap();
    assert_eq!(sequence.len(), TIME_STEPS);
    for time_step in 0..TIME_STEPS {
        assert_eq!(sequence.entry(time_step).number, Some(time_step as u64 + 1));
        let cloud = sequence.decode(time_step).unwrap();
        assert_eq!(cloud.positions.get(0).x, time_step as f64);
        let set = sequence.source().posed_images(time_step).unwrap();
        for (camera, photo) in set.photos.iter().enumerate() {
            assert!(photo.center().distance(scene.center(camera)) < 1e-9);
            let place = scene.points[camera];
            let (found, expected) = (photo.project(place).unwrap(), scene.pixel(camera, place));
            assert!(found.distance(expected) < 0.01, "{found}, expected {expected}");
        }
        let loaded = LoadedPhotos::of(&set, 1 << 20, &Progress::default());
        for (camera, posed_image) in loaded.posed_images.all().iter().enumerate() {
            let texel = posed_image.texture.levels()[0].pixels()[0];
            assert_eq!(texel[..2], [50 * time_step as u8, 30 * camera as u8], "camera {camera}");
        }
    }
    // With the half-pixel convention of the format, cameras fit the points that calibrated them.
    let errors = sequence.source().posed_images(0).unwrap().reprojection_errors();
    assert!(
        errors
            .iter()
            .all(|error| error.is_some_and(|error| error.rms_px < 1e-3))
    );
}

#[test]
fn a_missing_image_is_a_finding_not_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    write_multiview_video(&Scene::simple(), folder.path());
    fs::remove_file(folder.path().join("images/cam2/0002.png")).unwrap();
    let sequence = Sequence::discover(&[folder.path().to_owned()]).unwrap();
    let report = check(&sequence, &|_| {});
    assert_eq!(report.frame_count, TIME_STEPS);
    let messages: Vec<&str> = report.findings.iter().map(|finding| finding.message.as_str()).collect();
    let missing = report
        .findings
        .iter()
        .find(|finding| finding.message.contains("cam2 has no image of this time step"));
    assert_eq!(missing.expect("a finding").frames, [1], "{messages:?}");
    let set = sequence.source().posed_images(1).unwrap();
    assert_eq!(set.photos.len(), 6);
    assert!(!set.photos[2].has_file());
}
