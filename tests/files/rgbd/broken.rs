//! Recordings with something wrong: each is reported with the file, and nothing else is lost.

use super::recording::{HEIGHT, LAYOUTS, Recording, WIDTH, gray, pclzf, written};
use super::{open, open_with};
use image::{DynamicImage, ImageFormat};
use pointreel::sequence::{OpenOptions, Sequence};
use pointreel::source::RgbdOptions;
use std::fs;
use std::path::{Path, PathBuf};

/// A recording as Open3D has it.
fn recording() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (_, write, _) = LAYOUTS.iter().find(|(name, ..)| *name == "Open3D").unwrap();
    write(&Recording::new(), folder.path());
    folder
}

fn truncate(path: &Path, share: f64) {
    let bytes = fs::read(path).unwrap();
    fs::write(path, &bytes[..(share * bytes.len() as f64) as usize]).unwrap();
}

fn error_of(sequence: &Sequence, frame: usize) -> String {
    sequence.decode(frame).unwrap_err().to_string()
}

#[test]
fn a_truncated_depth_image_loses_one_frame() {
    for share in [0.0, 0.3, 0.9] {
        let folder = recording();
        truncate(&folder.path().join("depth/00001.png"), share);
        let sequence = open(folder.path());
        let error = error_of(&sequence, 1);
        assert!(
            error.contains("00001.png") && error.contains("Copy the file again"),
            "{error}"
        );
        assert!(sequence.decode(0).is_ok() && sequence.decode(2).is_ok());
    }
}

#[test]
fn a_truncated_color_image_only_loses_colors() {
    let folder = recording();
    truncate(&folder.path().join("color/00001.png"), 0.5);
    let sequence = open(folder.path());
    let cloud = sequence.decode(1).unwrap();
    assert!(cloud.positions.finite_bounds().0 > 2000);
    assert_eq!(cloud.attributes.colors, None);
    let [warning] = cloud.warnings.as_slice() else {
        panic!("{:?}", cloud.warnings);
    };
    assert!(
        warning.contains("00001.png") && warning.contains("no colours"),
        "{warning}"
    );
    assert!(sequence.decode(0).unwrap().attributes.colors.is_some());
}

#[test]
fn missing_partners_are_reported_and_their_points_read() {
    let folder = recording();
    fs::remove_file(folder.path().join("color/00001.png")).unwrap();
    fs::remove_file(folder.path().join("depth/00002.png")).unwrap();
    let sequence = open(folder.path());
    assert_eq!(sequence.len(), 2);
    let notes = sequence.source().notes();
    assert!(notes[0].starts_with("1 depth images have no colour image"), "{notes:?}");
    assert!(notes[1].contains("00002.png"), "{notes:?}");
    assert_eq!(sequence.decode(1).unwrap().attributes.colors, None);
}

#[test]
fn a_huge_image_is_rejected_before_allocation() {
    let folder = recording();
    let path = folder.path().join("depth/00000.png");
    let mut bytes = fs::read(&path).unwrap();
    bytes[16..20].copy_from_slice(&30_000_u32.to_be_bytes());
    bytes[20..24].copy_from_slice(&30_000_u32.to_be_bytes());
    fs::write(&path, &bytes).unwrap();
    let options = OpenOptions {
        read: pointreel::io::ReadOptions::default().with_max_memory(64 << 20),
        ..OpenOptions::default()
    };
    let sequence = Sequence::open(&[folder.path().to_owned()], &options).unwrap();
    let error = error_of(&sequence, 0);
    assert!(error.contains("00000.png"), "{error}");
    assert!(sequence.decode(1).is_ok(), "{:?}", sequence.decode(1).map(|_| ()));
    // The same for PCL's images, which have the size in their header, too.
    let mut huge = pclzf("depth16", &vec![0; (2 * WIDTH * HEIGHT) as usize]);
    huge[5..9].copy_from_slice(&u32::MAX.to_le_bytes());
    fs::write(&path, &huge).unwrap();
    let error = error_of(&open(folder.path()), 0);
    assert!(error.contains("4294967295 × 48"), "{error}");
}

#[test]
fn images_of_other_sizes_are_rejected_by_name() {
    let folder = recording();
    let odd = DynamicImage::new_luma16(50, 48);
    fs::write(folder.path().join("depth/00001.png"), written(&odd, ImageFormat::Png)).unwrap();
    let odd = DynamicImage::new_rgb8(100, 20);
    fs::write(folder.path().join("color/00002.png"), written(&odd, ImageFormat::Png)).unwrap();
    let sequence = open(folder.path());
    let error = error_of(&sequence, 1);
    assert!(
        error.contains("00001.png has 50 × 48 pixels, and its camera 64 × 48"),
        "{error}"
    );
    let warnings = sequence.decode(2).unwrap().warnings;
    assert!(warnings[0].contains("00002.png has 100 × 20 pixels"), "{warnings:?}");
}

#[test]
fn eight_bit_and_color_images_are_not_depths() {
    let folder = recording();
    for (image, name) in [
        (DynamicImage::new_luma8(WIDTH, HEIGHT), "grey of 8 bits"),
        (DynamicImage::new_rgb8(WIDTH, HEIGHT), "colours"),
    ] {
        fs::write(folder.path().join("depth/00000.png"), written(&image, ImageFormat::Png)).unwrap();
        let error = error_of(&open(folder.path()), 0);
        assert!(error.contains(name) && error.contains("16 bits"), "{error}");
    }
}

fn refusal(inputs: &[PathBuf], rgbd: RgbdOptions) -> String {
    let options = OpenOptions {
        rgbd,
        ..OpenOptions::default()
    };
    match Sequence::open(inputs, &options) {
        Ok(_) => panic!("{inputs:?} opened"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn openni_recordings_are_rejected_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let oni = folder.path().join("walk.oni");
    fs::write(&oni, b"NI10").unwrap();
    let error = refusal(&[oni], RgbdOptions::default());
    assert!(
        error.contains("walk.oni") && error.contains("OpenNI") && error.contains("export"),
        "{error}"
    );
}

#[test]
fn invalid_cameras_and_poses_are_rejected() {
    let folder = recording();
    let inputs = [folder.path().to_owned()];
    let intrinsics = |text: &str| RgbdOptions {
        intrinsics: Some(text.to_owned()),
        ..RgbdOptions::default()
    };
    for (text, expected) in [
        ("1,2,3", "3 numbers"),
        ("none.json", "cannot be read"),
        ("0,1,2,3", "focal lengths"),
    ] {
        let error = match open_with(folder.path(), intrinsics(text)) {
            Ok(sequence) => error_of(&sequence, 0),
            Err(error) => error.to_string(),
        };
        assert!(error.contains(expected), "{text}: {error}");
    }
    fs::write(folder.path().join("camera.json"), "{\"intrinsic_matrix\": [1, 2]}").unwrap();
    let error = refusal(&inputs, RgbdOptions::default());
    assert!(
        error.contains("camera.json") && error.contains("nine numbers"),
        "{error}"
    );
    let folder = recording();
    fs::write(folder.path().join("trajectory.log"), "0 0 1\n1 0 0 0\n").unwrap();
    // Frames without poses are still frames.
    let notes = open(folder.path()).source().notes().join("\n");
    assert!(notes.contains("trajectory.log, line 1"), "{notes}");
}

#[test]
fn frames_without_poses_are_not_merged() {
    let folder = recording();
    let inputs = [folder.path().to_owned()];
    let merge = |first, last| RgbdOptions {
        merge: Some((first, last)),
        ..RgbdOptions::default()
    };
    let error = refusal(&inputs, merge(1, 3));
    assert!(
        error.contains("frame 3 does not exist: the sequence has 3 frames, 0..2 (of --merge-frames 1..3 it has 1..2)"),
        "{error}"
    );
    fs::remove_file(folder.path().join("trajectory.log")).unwrap();
    assert!(refusal(&inputs, merge(0, 2)).contains("--poses"));
    let cloud = folder.path().join("a.ply");
    fs::write(&cloud, "ply").unwrap();
    assert!(refusal(&[cloud], merge(0, 0)).contains("not a recording of depth images"));
}

#[test]
fn patterns_report_what_is_missing() {
    let folder = recording();
    let inputs = [folder.path().to_owned()];
    let depth = |pattern: &str, intrinsics: Option<&str>| RgbdOptions {
        depth: Some(pattern.to_owned()),
        intrinsics: intrinsics.map(str::to_owned),
        ..RgbdOptions::default()
    };
    assert!(refusal(&inputs, depth("depth/*.png", None)).contains("--intrinsics"));
    assert!(refusal(&inputs, depth("z*.png", Some("1,1,1,1"))).contains("no file"));
    assert!(refusal(&[PathBuf::from("nowhere")], depth("*.png", None)).contains("name that folder"));
}

#[test]
fn images_of_unsupported_formats_are_named() {
    let folder = recording();
    for frame in 0..3 {
        let image = folder.path().join(format!("depth/{frame:05}.png"));
        fs::rename(&image, image.with_extension("exr")).unwrap();
    }
    let error = refusal(&[folder.path().to_owned()], RgbdOptions::default());
    assert!(error.contains("OpenEXR") && error.contains(".npy"), "{error}");
}

#[test]
fn lists_with_broken_lines_name_the_line() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.png"), gray(&[0; 3072], ImageFormat::Png)).unwrap();
    let inputs = [folder.path().to_owned()];
    for (list, expected) in [
        ("# depth\n1.0\n", "depth.txt, line 2"),
        ("1.0 a.png\nx a.png\n", "line 2: the time"),
        ("1.0 ../secret.png\n", "within this folder"),
        ("1.0 /etc/secret.png\n", "within this folder"),
        ("# nothing\n", "no depth image"),
    ] {
        fs::write(folder.path().join("depth.txt"), list).unwrap();
        let error = refusal(&inputs, RgbdOptions::default());
        assert!(error.contains(expected), "{list}: {error}");
    }
    fs::write(folder.path().join("depth.txt"), "1.0 a.png\n2.0 missing.png\n").unwrap();
    let sequence = open(folder.path());
    assert!(sequence.decode(0).is_ok());
    assert!(error_of(&sequence, 1).contains("missing.png"));
}

#[test]
fn text_of_another_length_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene_00_0000.depth");
    for (text, expected) in [("1.0 2.0", "2 numbers"), ("1.0 x", "`x` is not a number")] {
        fs::write(&path, text).unwrap();
        let error = error_of(&open(folder.path()), 0);
        assert!(
            error.contains("scene_00_0000.depth") && error.contains(expected),
            "{error}"
        );
    }
}
