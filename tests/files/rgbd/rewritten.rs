//! The recording as programs of SLAM and of fusion have it, and as scripts save it with numpy.

use super::recording::{CAMERA, FRAMES, HEIGHT, Recording, WIDTH, gray, unless_hole};
use image::ImageFormat;
use pointreel::source::RgbdOptions;
use std::fmt::Write as _;
use std::fs;
use std::io::{Cursor, Write as _};
use std::path::Path;

/// 4 × 4 numbers of the camera.
fn matrix() -> String {
    let [fx, fy, cx, cy] = CAMERA;
    format!("{fx} 0 {cx} 0\n0 {fy} {cy} 0\n0 0 1 0\n0 0 0 1\n")
}

pub(crate) fn replica(recording: &Recording, folder: &Path) -> RgbdOptions {
    fs::create_dir(folder.join("results")).unwrap();
    let mut trajectory = String::new();
    for frame in 0..FRAMES {
        recording.depth_png(&folder.join(format!("results/depth{frame:06}.png")), frame, |mm| {
            unless_hole(mm, |mm| (f64::from(mm) * 6.5535).round() as u16)
        });
        recording.color_png(&folder.join(format!("results/frame{frame:06}.png")), frame);
        trajectory += &(Recording::rows(&recording.poses[frame]).replace('\n', " ") + "\n");
    }
    fs::write(folder.join("traj.txt"), trajectory).unwrap();
    let [fx, fy, cx, cy] = CAMERA;
    let camera = serde_json::json!({"camera": {
        "w": WIDTH, "h": HEIGHT, "fx": fx, "fy": fy, "cx": cx, "cy": cy, "scale": 6553.5,
    }});
    fs::write(folder.join("cam_params.json"), camera.to_string()).unwrap();
    RgbdOptions::default()
}

fn scannet_images(recording: &Recording, folder: &Path) {
    for sub in ["depth", "color", "pose"] {
        fs::create_dir(folder.join(sub)).unwrap();
    }
    for frame in 0..FRAMES {
        recording.depth_png(&folder.join(format!("depth/{frame}.png")), frame, |mm| mm);
        recording.color_png(&folder.join(format!("color/{frame}.png")), frame);
        fs::write(
            folder.join(format!("pose/{frame}.txt")),
            Recording::rows(&recording.poses[frame]),
        )
        .unwrap();
    }
}

pub(crate) fn scannet(recording: &Recording, folder: &Path) -> RgbdOptions {
    scannet_images(recording, folder);
    fs::create_dir(folder.join("intrinsic")).unwrap();
    fs::write(folder.join("intrinsic/intrinsic_depth.txt"), matrix()).unwrap();
    RgbdOptions::default()
}

/// Without the folder of cameras, which are in the text next to the scan.
pub(crate) fn scannet_info(recording: &Recording, folder: &Path) -> RgbdOptions {
    scannet_images(recording, folder);
    let [fx, fy, cx, cy] = CAMERA;
    let name = folder.file_name().unwrap().to_str().unwrap();
    let text = format!(
        "appVersionId = 0.2.0\ncolorWidth = 1296\ndepthWidth = {WIDTH}\ndepthHeight = {HEIGHT}\nfx_depth = {fx}\n\
         fy_depth = {fy}\nmx_depth = {cx}\nmy_depth = {cy}\nsceneType = Office\n"
    );
    fs::write(folder.join(format!("{name}.txt")), text).unwrap();
    RgbdOptions::default()
}

/// Names of 7-Scenes, PGM instead of PNG, and the camera next to them.
pub(crate) fn tsdf_fusion(recording: &Recording, folder: &Path) -> RgbdOptions {
    for frame in 0..FRAMES {
        let file = |end: &str| folder.join(format!("frame-{frame:06}.{end}"));
        fs::write(file("depth.pgm"), gray(&recording.depths[frame], ImageFormat::Pnm)).unwrap();
        recording.color_png(&file("color.png"), frame);
        fs::write(file("pose.txt"), Recording::rows(&recording.poses[frame])).unwrap();
    }
    let [fx, fy, cx, cy] = CAMERA;
    let camera = format!("{fx:e} 0 {cx:e}\n0 {fy:e} {cy:e}\n0 0 1\n");
    fs::write(folder.join("camera-intrinsics.txt"), camera).unwrap();
    RgbdOptions::default()
}

/// An array as numpy saves it.
pub(crate) fn npy(descr: &str, payload: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({HEIGHT}, {WIDTH}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.into_bytes());
    bytes.extend(payload);
    bytes
}

fn metres(recording: &Recording, frame: usize) -> Vec<u8> {
    let metres = recording.depths[frame].iter().map(|&mm| match mm {
        0 | u16::MAX => [f32::NAN, 0.0, f32::INFINITY][frame],
        mm => f32::from(mm) / 1000.0,
    });
    npy("<f4", &metres.flat_map(f32::to_le_bytes).collect::<Vec<u8>>())
}

fn millimetres(recording: &Recording, frame: usize) -> Vec<u8> {
    let numbers = recording.depths[frame].iter();
    npy("<u2", &numbers.flat_map(|mm| mm.to_le_bytes()).collect::<Vec<u8>>())
}

/// Images of a script: the camera as a matrix, poses as a file per frame.
fn arrays(recording: &Recording, folder: &Path, extension: &str, bytes: fn(&Recording, usize) -> Vec<u8>) {
    for sub in ["depth", "rgb", "poses"] {
        fs::create_dir(folder.join(sub)).unwrap();
    }
    for frame in 0..FRAMES {
        fs::write(
            folder.join(format!("depth/{frame:05}.{extension}")),
            bytes(recording, frame),
        )
        .unwrap();
        recording.color_png(&folder.join(format!("rgb/{frame:05}.png")), frame);
        fs::write(
            folder.join(format!("poses/{frame:05}.txt")),
            Recording::rows(&recording.poses[frame]),
        )
        .unwrap();
    }
    let [fx, fy, cx, cy] = CAMERA;
    fs::write(folder.join("cam_K.txt"), format!("{fx} 0 {cx}\n0 {fy} {cy}\n0 0 1\n")).unwrap();
}

pub(crate) fn npy_metres(recording: &Recording, folder: &Path) -> RgbdOptions {
    arrays(recording, folder, "npy", metres);
    RgbdOptions::default()
}

pub(crate) fn npy_millimetres(recording: &Recording, folder: &Path) -> RgbdOptions {
    arrays(recording, folder, "npy", millimetres);
    RgbdOptions::default()
}

pub(crate) fn npz(recording: &Recording, folder: &Path) -> RgbdOptions {
    let archive = |recording: &Recording, frame: usize| {
        let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
        writer
            .start_file("depth.npy", zip::write::SimpleFileOptions::default())
            .unwrap();
        writer.write_all(&metres(recording, frame)).unwrap();
        writer.finish().unwrap().into_inner()
    };
    arrays(recording, folder, "npz", archive);
    RgbdOptions::default()
}

/// Images counted from 1, 5,000 units per metre that no file states, and a position and a rotation per line.
pub(crate) fn slambench(recording: &Recording, folder: &Path) -> RgbdOptions {
    for sub in ["depth", "color"] {
        fs::create_dir(folder.join(sub)).unwrap();
    }
    let mut poses = String::new();
    for frame in 0..FRAMES {
        let name = frame + 1;
        recording.depth_png(&folder.join(format!("depth/{name}.png")), frame, |mm| {
            unless_hole(mm, |mm| 5 * mm)
        });
        recording.color_png(&folder.join(format!("color/{name}.png")), frame);
        let (_, turn, at) = recording.poses[frame].to_scale_rotation_translation();
        let [x, y, z, w] = turn.to_array();
        writeln!(poses, "{} {} {} {x} {y} {z} {w}", at.x, at.y, at.z).unwrap();
    }
    fs::write(folder.join("pose.txt"), poses).unwrap();
    let [fx, fy, cx, cy] = CAMERA;
    fs::write(
        folder.join("camera.yaml"),
        format!("Camera.fx: {fx}\nCamera.fy: {fy}\nCamera.cx: {cx}\nCamera.cy: {cy}\n"),
    )
    .unwrap();
    RgbdOptions::default()
}
