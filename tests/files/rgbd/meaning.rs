//! Inputs of other programs that were misread once: `../shared/data/meaning`.

use super::{open, open_with, points};
use crate::data::shared;
use glam::DVec3;
use pointreel::rgbd::Filters;
use pointreel::sequence::Sequence;
use pointreel::source::RgbdOptions;
use std::path::Path;

fn said(sequence: &Sequence) -> String {
    let lines = sequence.source().assumptions().iter().map(ToString::to_string);
    lines.collect::<Vec<_>>().join("\n")
}

/// Nearest depth of a frame, and how many pixels were measured.
fn nearest(sequence: &Sequence, frame: usize) -> (f64, usize) {
    let cloud = sequence.decode(frame).unwrap();
    let depths: Vec<f64> = points(&cloud)
        .into_iter()
        .filter(|point| point.is_finite())
        .map(|point| point.z)
        .collect();
    (depths.iter().copied().fold(f64::INFINITY, f64::min), depths.len())
}

fn place(sequence: &Sequence, frame: usize) -> Option<DVec3> {
    Some(sequence.source().sensor(frame)?.world_from_camera?.translation)
}

/// One scene was written in three layouts: 160 × 120 − 16068 pixels of frame 0 are measured, 2.691 m the nearest.
const PIXELS: usize = 3132;

fn check_scene(sequence: &Sequence) {
    assert_eq!(sequence.len(), 6);
    let (depth, count) = nearest(sequence, 0);
    assert_eq!(count, PIXELS);
    assert!((depth - 2.691).abs() < 1e-3, "{depth}");
    assert!(sequence.decode(0).unwrap().attributes.colors.is_some());
}

#[test]
fn renderings_of_replica_have_their_camera_and_poses() {
    let Some(folder) = shared("meaning/R06_replica") else {
        return;
    };
    let sequence = open(&folder);
    check_scene(&sequence);
    let expected = DVec3::new(3.920_266_311, 0.794_677_323_2, 2.0);
    assert!(place(&sequence, 0).unwrap().distance(expected) < 1e-9);
    assert!((0..6).all(|frame| place(&sequence, frame).is_some()));
    let sensor = sequence.source().sensor(0).unwrap();
    assert_eq!(sensor.rig.depth.focal_px().x, 140.0);
    assert!(
        said(&sequence).contains("6553.5 units per metre"),
        "{}",
        said(&sequence)
    );
}

#[test]
fn exports_of_scannet_have_their_cameras_and_poses() {
    let Some(folder) = shared("meaning/R07_scannet") else {
        return;
    };
    let sequence = open(&folder);
    check_scene(&sequence);
    let expected = DVec3::new(3.920_266, 0.794_677, 2.0);
    assert!(place(&sequence, 0).unwrap().distance(expected) < 1e-9);
    let has_pose: Vec<bool> = (0..6).map(|frame| place(&sequence, frame).is_some()).collect();
    assert_eq!(has_pose, [true, true, true, false, true, true]);
    let sensor = sequence.source().sensor(0).unwrap();
    assert_eq!(sensor.rig.depth.focal_px().x, 140.0);
    assert_eq!(sensor.rig.color.as_ref().unwrap().camera.focal_px().x, 280.0);
    let notes = sequence.source().notes().join("\n");
    assert!(notes.contains("1 of 6 frames have no pose"), "{notes}");
}

/// Frames that saw one thing from all sides: moved to the world, they are within its box.
#[test]
fn posed_frames_of_one_thing_are_in_one_place() {
    for name in ["meaning/R06_replica", "meaning/R07_scannet"] {
        let Some(folder) = shared(name) else { return };
        let options = RgbdOptions {
            merge: Some((0, 5)),
            ..RgbdOptions::default()
        };
        let cloud = open_with(&folder, options).unwrap().decode(0).unwrap();
        let (count, bounds) = cloud.positions.finite_bounds();
        let (min, max) = bounds.unwrap();
        assert!(count > 5 * PIXELS - 500, "{name}: {count}");
        // Computed from images and matrices by definition.
        let expected = (
            DVec3::new(-1.2008, -1.2015, -0.2288),
            DVec3::new(2.0175, 1.5001, 1.0253),
        );
        assert!(
            min.distance(expected.0) < 0.01 && max.distance(expected.1) < 0.01,
            "{name}: {min} to {max}"
        );
    }
}

#[test]
fn numpy_depths_in_metres_are_read_with_a_guessed_camera_note() {
    let Some(folder) = shared("meaning/R09_npy_depth_metres") else {
        return;
    };
    let sequence = open(&folder);
    check_scene(&sequence);
    let said = said(&sequence);
    assert!(said.contains("camera: ") && said.contains("--intrinsics"), "{said}");
    assert!(said.contains("depths in floats are metres"), "{said}");
}

/// The whole room, in rendered images as well: not the strip that is left of it in millimetres.
#[test]
fn slambook_frames_cover_the_whole_room() {
    let Some(folder) = shared("meaning/slambook_dense") else {
        return;
    };
    check_slambook(&folder);
}

fn check_slambook(folder: &Path) {
    let options = RgbdOptions {
        filters: Filters::USUAL,
        filters_are_automatic: true,
        ..RgbdOptions::default()
    };
    let sequence = open_with(folder, options).unwrap();
    assert_eq!(sequence.len(), 5);
    let (depth, count) = nearest(&sequence, 0);
    assert!((1.5..1.9).contains(&depth), "{depth}");
    assert!(count > 640 * 480 * 9 / 10, "{count}");
    let expected = DVec3::new(0.000_466_347, 0.008_953_57, -2.249_35);
    assert!(place(&sequence, 0).unwrap().distance(expected) < 1e-9);
    assert!((0..5).all(|frame| place(&sequence, frame).is_some()));
    assert!(
        said(&sequence).contains("depth scale: 5000 units per metre"),
        "{}",
        said(&sequence)
    );
}
