//! One recording in every layout reads to the same points.

use super::recording::{FRAMES, HEIGHT, Has, LAYOUTS, Recording, WIDTH};
use super::{open_with, points};
use glam::DVec3;
use pointreel::photos::LoadedPhotos;
use pointreel::progress::Progress;
use pointreel::source::RgbdOptions;
use std::fs;
use std::path::Path;
use std::time::Duration;

/// The folder of a layout below `root`, and the options it requires.
pub(crate) fn written(root: &Path, name: &str) -> (std::path::PathBuf, RgbdOptions) {
    let (_, write, _) = LAYOUTS.iter().find(|(known, ..)| *known == name).unwrap();
    let folder = root.join(name.replace(' ', "_"));
    fs::create_dir(&folder).unwrap();
    let options = write(&Recording::new(), &folder);
    (folder, options)
}

#[test]
fn one_recording_gives_the_same_points_in_every_layout() {
    let root = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    for (name, _, has) in LAYOUTS {
        let (folder, options) = written(root.path(), name);
        let sequence = open_with(&folder, options).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(sequence.len(), FRAMES, "{name}");
        assert_eq!(sequence.source().notes(), [""; 0], "{name}");
        for frame in 0..FRAMES {
            check_frame(name, &recording, frame, &sequence, has);
        }
    }
}

pub(crate) fn check_frame(
    name: &str,
    recording: &Recording,
    frame: usize,
    sequence: &pointreel::sequence::Sequence,
    has: &Has,
) {
    let cloud = sequence.decode(frame).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(cloud.warnings, [""; 0], "{name}");
    let found = points(&cloud);
    let expected = recording.points(frame);
    assert_eq!(found.len(), expected.len(), "{name}");
    for (at, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert_eq!(
            found.is_finite(),
            expected.is_finite(),
            "{name}, frame {frame}, pixel {at}"
        );
        // Half a step of a Kinect's code at these depths, along the ray.
        let max = if has.exact_depths { 1e-6 } else { 0.004 };
        let is_same = !expected.is_finite() || found.distance(*expected) <= max;
        assert!(is_same, "{name}, frame {frame}, pixel {at}: {found}, {expected}");
    }
    let colors: Vec<[u8; 3]> = cloud
        .attributes
        .colors
        .unwrap()
        .iter()
        .map(|&[r, g, b, _]| [r, g, b])
        .collect();
    assert!(
        colors == recording.colors[frame],
        "{name}, frame {frame}: other colours"
    );
    let grid = cloud.grid.unwrap();
    assert_eq!([grid.width(), grid.height()], [WIDTH, HEIGHT], "{name}");
    assert_eq!(cloud.sensor, Some(DVec3::ZERO), "{name}");
    let sensor = sequence.source().sensor(frame).unwrap();
    assert_eq!(sensor.rig.depth.size_px(), [WIDTH, HEIGHT], "{name}");
    let pose = sensor.world_from_camera;
    assert_eq!(pose.is_some(), has.poses, "{name}");
    if let Some(pose) = pose {
        assert!(
            pose.abs_diff_eq(recording.poses[frame], 1e-9),
            "{name}, frame {frame}: {pose}"
        );
    }
    let time = sequence.entry(frame).time;
    assert_eq!(time.is_some(), has.times, "{name}: {time:?}");
    if let (Some(time), Some(first)) = (time, sequence.entry(0).time) {
        let expected = Duration::from_micros(recording.times_us[frame] - recording.times_us[0]);
        assert!(
            time.abs_diff(first).abs_diff(expected) < Duration::from_micros(1),
            "{name}: {time:?}"
        );
    }
}

#[test]
fn posed_frames_become_one_cloud() {
    let root = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    for name in [
        "TUM",
        "7-Scenes",
        "Open3D",
        "Open3D with JSON",
        "SUN",
        "ScanNet",
        "SLAMBench",
        "Stray Scanner",
        "ARKitScenes",
        "3D Scanner App",
        "patterns",
    ] {
        let (folder, options) = written(root.path(), name);
        let options = RgbdOptions {
            merge: Some((1, 2)),
            ..options
        };
        let sequence = open_with(&folder, options).unwrap();
        assert_eq!(sequence.len(), 1);
        let cloud = sequence.decode(0).unwrap();
        let expected: Vec<DVec3> = (1..=2)
            .flat_map(|frame| {
                let world = recording.poses[frame];
                let measured = recording.points(frame).into_iter().filter(|point| point.is_finite());
                measured.map(move |point| world.transform_point3(point))
            })
            .collect();
        let found = points(&cloud);
        assert_eq!(found.len(), expected.len(), "{name}");
        for (found, expected) in found.iter().zip(&expected) {
            assert!(found.distance(*expected) < 1e-6, "{name}: {found}, {expected}");
        }
        assert_eq!(cloud.attributes.colors.unwrap().len(), found.len());
        assert_eq!((cloud.grid, cloud.sensor), (None, None));
    }
}

/// Nothing in it was registered: colours have a camera of their own, and depth images another.
#[test]
fn seven_scenes_colors_come_from_a_camera_next_to_the_depth_camera() {
    let root = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    let (folder, _) = written(root.path(), "7-Scenes");
    let options = RgbdOptions {
        merge: Some((0, FRAMES - 1)),
        ..RgbdOptions::default()
    };
    let sequence = open_with(&folder, options).unwrap();
    let set = sequence.source().posed_images(0).unwrap();
    assert_eq!(set.photos.len(), FRAMES);
    for (photo, pose) in set.photos.iter().zip(&recording.poses) {
        let depth = photo.depth.as_ref().unwrap();
        let taken_by = depth.taken_by.as_ref().unwrap();
        // The parameters for 640 × 480, in images of a tenth of that.
        assert!((photo.camera.focal_px().x - 52.5).abs() < 1e-9);
        assert!((taken_by.camera.focal_px().x - 58.5).abs() < 1e-9);
        let world_from_depth = photo.camera_from_world.inverse() * taken_by.photo_from_depth;
        assert!(world_from_depth.abs_diff_eq(*pose, 1e-9), "{world_from_depth}");
    }
    let loaded = LoadedPhotos::of(&set, 1 << 30, &Progress::default());
    assert_eq!(loaded.notes, [""; 0]);
    for posed_image in loaded.posed_images.all() {
        let depth = posed_image.depth.as_ref().unwrap();
        assert!(
            depth.valid_count() * 2 > depth.metres().len(),
            "{} depths",
            depth.valid_count()
        );
    }
}

/// The cameras in `info --json` are valid for `--intrinsics`.
#[test]
fn json_cameras_are_read_from_two_places() {
    let root = tempfile::tempdir().unwrap();
    let (folder, _) = written(root.path(), "patterns");
    let camera = root.path().join("two.json");
    let json = serde_json::json!({
        "depth": {
            "width": WIDTH, "height": HEIGHT, "fx": 52.5, "fy": 52.5, "cx": 31.5, "cy": 23.5,
            "distortion": { "model": "brown", "coefficients": [0.1, -0.05, 0.001, 0.0, 0.0] },
        },
        "color": {
            "width": WIDTH, "height": HEIGHT, "fx": 52.5, "fy": 52.5, "cx": 31.5, "cy": 23.5,
            "distortion": { "model": "fisheye", "coefficients": [0.01, 0.0, 0.0, 0.0] },
            "color_from_depth": [1, 0, 0, -0.025, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
        },
    });
    fs::write(&camera, json.to_string()).unwrap();
    let options = RgbdOptions {
        depth: Some("out/z*.png".to_owned()),
        color: Some("out/c*.png".to_owned()),
        depth_scale: Some(10_000.0),
        intrinsics: Some(camera.to_str().unwrap().to_owned()),
        ..RgbdOptions::default()
    };
    let sequence = open_with(&folder, options).unwrap();
    let cloud = sequence.decode(0).unwrap();
    assert_eq!(cloud.warnings, [""; 0]);
    let sensor = sequence.source().sensor(0).unwrap();
    assert_eq!(sensor.rig.depth.distortion().name(), "brown");
    let color = sensor.rig.color.as_ref().unwrap();
    assert_eq!(color.camera.distortion().name(), "fisheye");
    // Each point has the colour at its position in the other image: red and green encode that position.
    let colors = cloud.attributes.colors.as_ref().unwrap();
    let mut compared = 0;
    for (point, found) in points(&cloud).into_iter().zip(colors) {
        if !point.is_finite() || *found == [128, 128, 128, 255] {
            continue;
        }
        let at = color
            .camera
            .pixel(color.color_from_depth.transform_point3(point))
            .unwrap();
        let expected = [3.0 * at.x.clamp(0.0, 63.0), 5.0 * at.y.clamp(0.0, 47.0)];
        for (found, expected) in found.iter().zip(expected) {
            assert!((f64::from(*found) - expected).abs() <= 1.0, "{found} at {at}");
        }
        compared += 1;
    }
    assert!(compared > 2000, "{compared} points have colours");
}
