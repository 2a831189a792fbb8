//! Which camera, which units and which poses are taken where files state little, and that this is reported.

use super::recording::{FRAMES, HEIGHT, Recording, WIDTH, gray, unless_hole, written};
use super::{open, points, rewritten};
use glam::DVec3;
use image::{DynamicImage, ImageFormat};
use pointreel::check::{FindingKind, check};
use pointreel::sequence::Sequence;
use std::fs;

fn said(sequence: &Sequence) -> String {
    let lines = sequence.source().assumptions().iter().map(ToString::to_string);
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn a_guessed_camera_and_scale_are_reported_and_others_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    rewritten::slambench(&recording, folder.path());
    let known = said(&open(folder.path()));
    assert!(
        known.contains("depth scale: 5000 units per metre") && known.contains("statistics"),
        "{known}"
    );
    assert!(
        known.contains("poses: camera to world") && known.contains("pose.txt"),
        "{known}"
    );
    assert!(
        known.contains("camera: fx,fy,cx,cy") && known.contains("camera.yaml says so; file"),
        "{known}"
    );
    fs::remove_file(folder.path().join("camera.yaml")).unwrap();
    let guessed = said(&open(folder.path()));
    assert!(
        guessed.contains("camera: fx,fy,cx,cy 52.5,52.5,31.5,23.5 for images of 64 × 48 pixels")
            && guessed.contains("--intrinsics"),
        "{guessed}"
    );
    let folder = tempfile::tempdir().unwrap();
    rewritten::replica(&recording, folder.path());
    let replica = said(&open(folder.path()));
    assert!(
        replica.contains("6553.5 units per metre") && replica.contains("; file"),
        "{replica}"
    );
    // Now no file states the units, and no camera of the data set has images of this shape.
    fs::remove_file(folder.path().join("cam_params.json")).unwrap();
    let replica = said(&open(folder.path()));
    assert!(
        replica.contains("recordings of Replica have it; convention"),
        "{replica}"
    );
    assert!(replica.contains("camera: fx,fy,cx,cy 600,600"), "{replica}");
}

#[test]
fn floats_in_millimetres_are_detected_by_their_size() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    rewritten::npy_metres(&recording, folder.path());
    for frame in 0..FRAMES {
        let floats = recording.depths[frame]
            .iter()
            .map(|&mm| f32::from(unless_hole(mm, |mm| mm) % u16::MAX));
        let bytes: Vec<u8> = floats.flat_map(f32::to_le_bytes).collect();
        fs::write(
            folder.path().join(format!("depth/{frame:05}.npy")),
            rewritten::npy("<f4", &bytes),
        )
        .unwrap();
    }
    let sequence = open(folder.path());
    assert!(
        said(&sequence).contains("depth scale: 1000 units per metre"),
        "{}",
        said(&sequence)
    );
    for (found, expected) in points(&sequence.decode(2).unwrap())
        .into_iter()
        .zip(recording.points(2))
    {
        assert!(
            !expected.is_finite() || found.distance(expected) < 1e-5,
            "{found}, {expected}"
        );
    }
}

#[test]
fn a_lost_frame_or_broken_pose_only_affects_itself() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    rewritten::scannet(&recording, folder.path());
    let lost = "-inf -inf -inf -inf\n".repeat(4);
    fs::write(folder.path().join("pose/1.txt"), lost).unwrap();
    fs::write(folder.path().join("pose/2.txt"), "nothing").unwrap();
    // Files that are exported next to a scan.
    fs::write(folder.path().join("scan_vh_clean_2.ply"), "ply").unwrap();
    fs::write(folder.path().join("scan.aggregation.json"), "{}").unwrap();
    let sequence = open(folder.path());
    let poses: Vec<bool> = (0..FRAMES)
        .map(|frame| sequence.source().sensor(frame).unwrap().world_from_camera.is_some())
        .collect();
    assert_eq!(poses, [true, false, false]);
    let notes = sequence.source().notes().join("\n");
    for words in [
        "2.txt",
        "2 of 3 frames have no pose",
        "frame 2 (index 1)",
        "scan_vh_clean_2.ply",
    ] {
        assert!(notes.contains(words), "{words}: {notes}");
    }
    assert!((0..FRAMES).all(|frame| sequence.decode(frame).is_ok()));
}

#[test]
fn images_from_part_of_a_trajectory_find_their_poses() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    rewritten::replica(&recording, folder.path());
    let results = folder.path().join("results");
    for frame in (0..FRAMES).rev() {
        for (begin, end) in [("depth", "png"), ("frame", "png")] {
            let name = |number: usize| results.join(format!("{begin}{number:06}.{end}"));
            fs::rename(name(frame), name(10 * frame)).unwrap();
        }
    }
    let lines = (0..30)
        .map(|line| format!("1 0 0 {line} 0 1 0 0 0 0 1 0 0 0 0 1\n"))
        .collect::<Vec<_>>()
        .concat();
    fs::write(folder.path().join("traj.txt"), lines).unwrap();
    // The image folder may be opened as well.
    for opened in [folder.path(), results.as_path()] {
        let sequence = open(opened);
        let place = |frame: usize| {
            sequence
                .source()
                .sensor(frame)
                .unwrap()
                .world_from_camera
                .unwrap()
                .translation
        };
        assert_eq!(
            [place(0), place(1), place(2)],
            [0.0, 10.0, 20.0].map(|x| DVec3::new(x, 0.0, 0.0))
        );
    }
}

#[test]
fn arrays_of_cameras_and_poses_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    rewritten::npy_metres(&recording, folder.path());
    fs::remove_file(folder.path().join("cam_K.txt")).unwrap();
    fs::remove_dir_all(folder.path().join("poses")).unwrap();
    let array = |shape: &str, numbers: &[f64]| {
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.into_bytes());
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes
    };
    let [fx, fy, cx, cy] = super::recording::CAMERA;
    let camera = array("(3, 3)", &[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]);
    fs::write(folder.path().join("intrinsics.npy"), camera).unwrap();
    let poses: Vec<f64> = recording
        .poses
        .iter()
        .flat_map(|pose| glam::DMat4::from(*pose).transpose().to_cols_array())
        .collect();
    fs::write(folder.path().join("poses.npy"), array("(3, 4, 4)", &poses)).unwrap();
    let sequence = open(folder.path());
    assert_eq!(sequence.source().notes(), [""; 0]);
    let sensor = sequence.source().sensor(2).unwrap();
    assert_eq!(sensor.rig.depth.focal_px().x, fx);
    assert!(sensor.world_from_camera.unwrap().abs_diff_eq(recording.poses[2], 1e-9));
}

#[test]
fn the_only_recording_below_a_folder_is_opened() {
    let recording = Recording::new();
    for name in ["Replica", "ScanNet", "TUM", "Stray Scanner", "ARKitScenes", "7-Scenes"] {
        let folder = tempfile::tempdir().unwrap();
        super::layouts::written(folder.path(), name);
        fs::write(folder.path().join("README.md"), "a data set").unwrap();
        assert_eq!(open(folder.path()).len(), recording.depths.len(), "{name}");
    }
}

#[test]
fn two_cameras_in_one_sequence_are_a_finding() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    rewritten::scannet(&recording, folder.path());
    let kinds = |sequence: &Sequence| {
        let findings = check(sequence, &|_| {}).findings.into_iter();
        let cameras = findings.filter(|finding| finding.kind == FindingKind::ChangedCamera);
        cameras
            .map(|finding| (finding.frames, finding.message))
            .collect::<Vec<_>>()
    };
    assert_eq!(kinds(&open(folder.path())), []);
    let half = DynamicImage::new_luma16(WIDTH / 2, HEIGHT / 2);
    fs::write(folder.path().join("depth/2.png"), written(&half, ImageFormat::Png)).unwrap();
    let found = kinds(&open(folder.path()));
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].0, [2]);
    assert!(
        found[0].1.contains("32 × 24 pixels") && found[0].1.contains("64 × 48 pixels"),
        "{}",
        found[0].1
    );
    // A different lens, for images of the same size.
    let folder = tempfile::tempdir().unwrap();
    super::phones::scanner_app(&recording, folder.path());
    let info = serde_json::json!({ "intrinsics": [40.0, 0.0, 31.5, 0.0, 40.0, 23.5, 0.0, 0.0, 1.0] });
    fs::write(folder.path().join("frame_00001.json"), info.to_string()).unwrap();
    let found = kinds(&open(folder.path()));
    assert_eq!(
        found.iter().map(|(frames, _)| frames.as_slice()).collect::<Vec<_>>(),
        [&[1]]
    );
}

#[test]
fn depths_in_unconventional_units_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    super::layouts::written(folder.path(), "TUM");
    let tum = folder.path().join("TUM");
    for frame in 0..FRAMES {
        let path = tum.join(format!("depth/{}.png", recording.seconds(frame)));
        fs::write(path, gray(&recording.depths[frame], ImageFormat::Png)).unwrap();
    }
    // A metre would be 20 cm.
    let sequence = open(&tum);
    assert!(
        said(&sequence).contains("depth scale: 1000 units per metre"),
        "{}",
        said(&sequence)
    );
}
