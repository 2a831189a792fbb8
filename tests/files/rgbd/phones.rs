//! The recording as apps of phones export it.

use super::recording::{ALL, CAMERA, FRAMES, HEIGHT, Recording, WIDTH, rgb};
use super::{layouts::check_frame, open, points};
use glam::{DAffine3, DMat3, DMat4, DVec3};
use image::ImageFormat;
use pointreel::source::RgbdOptions;
use std::fmt::Write as _;
use std::fs;
use std::io::{Cursor, Write as _};
use std::path::Path;

fn matrix() -> String {
    let [fx, fy, cx, cy] = CAMERA;
    format!("{fx}, 0, {cx}\n0, {fy}, {cy}\n0, 0, 1\n")
}

pub(crate) fn outlier(recording: &Recording, folder: &Path) -> RgbdOptions {
    for sub in ["depth", "rgb"] {
        fs::create_dir(folder.join(sub)).unwrap();
    }
    let mut odometry = "timestamp, frame, x, y, z, qx, qy, qz, qw\n".to_owned();
    for frame in 0..FRAMES {
        recording.depth_png(&folder.join(format!("depth/{frame:06}.png")), frame, |mm| mm);
        recording.color_png(&folder.join(format!("rgb/{frame:06}.png")), frame);
        let (_, turn, at) = recording.poses[frame].to_scale_rotation_translation();
        let [x, y, z, w] = turn.to_array();
        let seconds = recording.seconds(frame);
        writeln!(
            odometry,
            "{seconds}, {frame:06}, {}, {}, {}, {x}, {y}, {z}, {w}",
            at.x, at.y, at.z
        )
        .unwrap();
    }
    fs::write(folder.join("odometry.csv"), odometry).unwrap();
    fs::write(folder.join("camera_matrix.csv"), matrix()).unwrap();
    RgbdOptions::default()
}

pub(crate) fn arkit_scenes(recording: &Recording, folder: &Path) -> RgbdOptions {
    for sub in ["lowres_depth", "lowres_wide", "lowres_wide_intrinsics"] {
        fs::create_dir(folder.join(sub)).unwrap();
    }
    let mut trajectory = String::new();
    for frame in 0..FRAMES {
        let name = format!("41069021_{}", recording.seconds(frame));
        recording.depth_png(&folder.join(format!("lowres_depth/{name}.png")), frame, |mm| mm);
        recording.color_png(&folder.join(format!("lowres_wide/{name}.png")), frame);
        let [fx, fy, cx, cy] = CAMERA;
        let camera = folder.join(format!("lowres_wide_intrinsics/{name}.pincam"));
        fs::write(camera, format!("{WIDTH} {HEIGHT} {fx} {fy} {cx} {cy}")).unwrap();
        let (_, turn, at) = recording.poses[frame].inverse().to_scale_rotation_translation();
        let turn = turn.to_scaled_axis();
        let seconds = recording.seconds(frame);
        writeln!(
            trajectory,
            "{seconds} {} {} {} {} {} {}",
            turn.x, turn.y, turn.z, at.x, at.y, at.z
        )
        .unwrap();
    }
    fs::write(folder.join("lowres_wide.traj"), trajectory).unwrap();
    RgbdOptions::default()
}

/// With y up and z backward.
fn backward(pose: &DAffine3) -> DAffine3 {
    DAffine3 {
        matrix3: pose.matrix3 * DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0)),
        ..*pose
    }
}

pub(crate) fn scanner_app(recording: &Recording, folder: &Path) -> RgbdOptions {
    for frame in 0..FRAMES {
        recording.depth_png(&folder.join(format!("depth_{frame:05}.png")), frame, |mm| mm);
        recording.color_png(&folder.join(format!("frame_{frame:05}.png")), frame);
        let [fx, fy, cx, cy] = CAMERA;
        let pose = DMat4::from(backward(&recording.poses[frame])).transpose();
        let info = serde_json::json!({
            "frame_index": frame,
            "time": recording.times_us[frame] as f64 / 1e6,
            "intrinsics": [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
            "cameraPoseARFrame": pose.to_cols_array().to_vec(),
        });
        fs::write(folder.join(format!("frame_{frame:05}.json")), info.to_string()).unwrap();
    }
    RgbdOptions::default()
}

/// `has_size`: newer versions state the size of depth images.
fn record3d(recording: &Recording, path: &Path, has_size: bool) {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    let [fx, fy, cx, cy] = CAMERA;
    let poses = recording.poses.iter().map(|pose| {
        let (_, turn, at) = backward(pose).to_scale_rotation_translation();
        let [x, y, z, w] = turn.to_array();
        vec![x, y, z, w, at.x, at.y, at.z]
    });
    let mut metadata = serde_json::json!({
        "w": WIDTH, "h": HEIGHT, "K": [fx, 0.0, 0.0, 0.0, fy, 0.0, cx, cy, 1.0], "fps": 30,
        "poses": poses.collect::<Vec<_>>(),
        "frameTimestamps": recording.times_us.iter().map(|us| *us as f64 / 1e6).collect::<Vec<_>>(),
    });
    if has_size {
        metadata["dw"] = WIDTH.into();
        metadata["dh"] = HEIGHT.into();
    }
    writer.start_file("metadata", options).unwrap();
    writer.write_all(metadata.to_string().as_bytes()).unwrap();
    for frame in 0..FRAMES {
        let metres = recording.depths[frame].iter().map(|&mm| match mm {
            0 => f32::NAN,
            u16::MAX => 0.0,
            mm => f32::from(mm) / 1000.0,
        });
        let bytes: Vec<u8> = metres.flat_map(f32::to_le_bytes).collect();
        let mut packed = Vec::new();
        lzfse_rust::encode_bytes(&bytes, &mut packed).unwrap();
        writer.start_file(format!("rgbd/{frame}.depth"), options).unwrap();
        writer.write_all(&packed).unwrap();
        // A PNG under the name that the app gives to its JPEG: contents decide, and colours stay exact.
        writer.start_file(format!("rgbd/{frame}.jpg"), options).unwrap();
        writer
            .write_all(&rgb(&recording.colors[frame], ImageFormat::Png))
            .unwrap();
    }
    fs::write(path, writer.finish().unwrap().into_inner()).unwrap();
}

#[test]
fn record3d_archives_give_the_same_recording() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    let path = folder.path().join("walk.r3d");
    record3d(&recording, &path, true);
    let sequence = open(&path);
    assert_eq!(sequence.len(), FRAMES);
    for frame in 0..FRAMES {
        check_frame("Record3D", &recording, frame, &sequence, &ALL);
    }
    // Of unknown size.
    record3d(&recording, &path, false);
    let error = super::open_with(&path, RgbdOptions::default())
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert!(error.contains("3072 depths are those of no known size"), "{error}");
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let error = super::open_with(&path, RgbdOptions::default())
        .map(|_| ())
        .unwrap_err()
        .to_string();
    assert!(error.contains("walk.r3d") && error.contains("archive"), "{error}");
}

/// Videos are not decoded: the size that the matrix is for is estimated from its principal point.
#[test]
fn the_camera_matrix_of_a_video_is_for_larger_images() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    outlier(&recording, folder.path());
    fs::remove_dir_all(folder.path().join("rgb")).unwrap();
    fs::write(folder.path().join("rgb.mp4"), b"film").unwrap();
    fs::create_dir(folder.path().join("confidence")).unwrap();
    // 480 × 360 is 7.5 times as large; pixel centres are at integers.
    let [fx, fy, cx, cy] = CAMERA.map(|number| 7.5 * number);
    let [cx, cy] = [cx + 3.25, cy + 3.25];
    fs::write(
        folder.path().join("camera_matrix.csv"),
        format!("{fx},0,{cx}\n0,{fy},{cy}\n0,0,1\n"),
    )
    .unwrap();
    let sequence = open(folder.path());
    let notes = sequence.source().notes().join("\n");
    assert!(
        notes.contains("rgb.mp4 is a video") && notes.contains("confidence"),
        "{notes}"
    );
    let cloud = sequence.decode(1).unwrap();
    assert_eq!(cloud.attributes.colors, None);
    for (found, expected) in points(&cloud).into_iter().zip(recording.points(1)) {
        assert!(
            !expected.is_finite() || found.distance(expected) < 1e-5,
            "{found}, {expected}"
        );
    }
    let said: Vec<String> = sequence
        .source()
        .assumptions()
        .iter()
        .map(ToString::to_string)
        .collect();
    assert!(
        said.iter().any(|line| line.contains("images of 480 × 360 pixels")),
        "{said:?}"
    );
}

/// Videos of phones have more images than the depth camera, and larger ones.
#[test]
fn colors_of_a_larger_image_fall_on_their_points() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    scanner_app(&recording, folder.path());
    let mut large = image::RgbImage::new(4 * WIDTH, 4 * HEIGHT);
    for (x, y, pixel) in large.enumerate_pixels_mut() {
        let at = (y / 4 * WIDTH + x / 4) as usize;
        pixel.0 = recording.colors[0][at];
    }
    for frame in 0..FRAMES {
        fs::remove_file(folder.path().join(format!("frame_{frame:05}.png"))).unwrap();
        large.save(folder.path().join(format!("frame_{frame:05}.png"))).unwrap();
        let [fx, fy, cx, cy] = CAMERA.map(|number| 4.0 * number);
        let info = serde_json::json!({ "intrinsics": [fx, 0.0, cx + 1.5, 0.0, fy, cy + 1.5, 0.0, 0.0, 1.0] });
        fs::write(folder.path().join(format!("frame_{frame:05}.json")), info.to_string()).unwrap();
    }
    large.save(folder.path().join("frame_00099.png")).unwrap();
    let sequence = open(folder.path());
    assert_eq!(sequence.source().notes(), [""; 0]);
    let cloud = sequence.decode(0).unwrap();
    let colors = cloud.attributes.colors.as_ref().unwrap();
    let mut compared = 0;
    for ((point, expected), (color, expected_color)) in points(&cloud)
        .into_iter()
        .zip(recording.points(0))
        .zip(colors.iter().zip(&recording.colors[0]))
    {
        if expected.is_finite() && color[..3] != [128; 3] {
            assert!(point.distance(expected) < 1e-5, "{point}, {expected}");
            let apart = color
                .iter()
                .zip(expected_color)
                .map(|(found, expected)| found.abs_diff(*expected))
                .max();
            assert!(apart.unwrap() <= 3, "{color:?}, {expected_color:?}");
            compared += 1;
        }
    }
    assert!(compared > 2000, "{compared} points have colours");
}
