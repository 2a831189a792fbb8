//! Contents of messages beyond images of one static camera: colours that neighbours share, cameras that move, parts of
//! a sensor; in every container.

use super::layouts::check_frame;
use super::messages::{COLORS, DEPTH_FRAME, DEPTHS, HAS, Packed, WriteColor, check, one_camera, open, raw};
use super::open_with;
use super::recording::{CAMERA, FRAMES, HEIGHT, Has, Recording, WIDTH};
use super::ros::{Kind, Recorded, Writer, bag, db3, mcap};
use glam::{DAffine3, DVec3};
use pointreel::source::RgbdOptions;
use std::fs;
use std::path::Path;

/// Luma and chromas of a colour (ITU-R BT.601, as video has it).
fn yuv([r, g, b]: [u8; 3]) -> [u8; 3] {
    let [r, g, b] = [r, g, b].map(f64::from);
    let y = 0.299 * r + 0.587 * g + 0.114 * b;
    [
        16.0 + 219.0 / 255.0 * y,
        128.0 + 224.0 / 255.0 * (b - y) / 1.772,
        128.0 + 224.0 / 255.0 * (r - y) / 1.402,
    ]
    .map(|value| value.round() as u8)
}

/// Pairs of pixels with the chromas of the first of both.
fn packed_yuv(encoding: &str, colors: &[[u8; 3]], order: fn(u8, u8, u8, u8) -> [u8; 4]) -> Packed {
    let pairs = colors.chunks(2).flat_map(|pair| {
        let ([y, u, v], [other_y, ..]) = (yuv(pair[0]), yuv(pair[1]));
        order(y, u, other_y, v)
    });
    raw(encoding, 2, &pairs.collect::<Vec<_>>(), false)
}

/// All luma, then the chromas of every second pixel of every second line.
fn planes_of_yuv(encoding: &str, colors: &[[u8; 3]], order: fn(u8, u8) -> [u8; 2]) -> Packed {
    let luma = colors.iter().map(|&color| yuv(color)[0]);
    let lines = colors.chunks(WIDTH as usize).step_by(2);
    let chroma = lines.flat_map(|line| line.iter().step_by(2)).flat_map(|&color| {
        let [_, u, v] = yuv(color);
        order(u, v)
    });
    raw(encoding, 1, &luma.chain(chroma).collect::<Vec<_>>(), false)
}

/// The colours of a mosaic, two by two; samples of 16 bits have the byte before something else.
fn mosaic(encoding: &str, colors: &[[u8; 3]], channels: [[usize; 2]; 2], sample_bytes: usize) -> Packed {
    let sample = |(at, color): (usize, &[u8; 3])| {
        let (x, y) = (at % WIDTH as usize, at / WIDTH as usize);
        [0x55, color[channels[y % 2][x % 2]]][2 - sample_bytes..].to_vec()
    };
    let samples: Vec<u8> = colors.iter().enumerate().flat_map(sample).collect();
    raw(encoding, sample_bytes, &samples, false)
}

/// Chromas and filters are shared by neighbours, whose colours differ by steps of three and five.
const SHARED_COLORS: &[(&str, WriteColor)] = &[
    ("yuv422", |colors| {
        packed_yuv("yuv422", colors, |y, u, other_y, v| [u, y, v, other_y])
    }),
    ("uyvy", |colors| {
        packed_yuv("uyvy", colors, |y, u, other_y, v| [u, y, v, other_y])
    }),
    ("yuyv", |colors| {
        packed_yuv("yuyv", colors, |y, u, other_y, v| [y, u, other_y, v])
    }),
    ("yuv422_yuy2", |colors| {
        packed_yuv("yuv422_yuy2", colors, |y, u, other_y, v| [y, u, other_y, v])
    }),
    ("nv12", |colors| planes_of_yuv("nv12", colors, |u, v| [u, v])),
    ("nv21", |colors| planes_of_yuv("nv21", colors, |u, v| [v, u])),
    ("bayer_rggb8", |colors| {
        mosaic("bayer_rggb8", colors, [[0, 1], [1, 2]], 1)
    }),
    ("bayer_gbrg16", |colors| {
        mosaic("bayer_gbrg16", colors, [[1, 2], [0, 1]], 2)
    }),
];

#[test]
fn chroma_subsampled_colors_are_close() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    let path = folder.path().join("a.bag");
    for (name, color) in SHARED_COLORS {
        fs::write(&path, bag(&one_camera(Kind::Ros1, DEPTHS[0].1, *color))).unwrap();
        let sequence = open(&path);
        assert_eq!(sequence.source().notes(), [""; 0], "{name}");
        let cloud = sequence.decode(1).unwrap();
        assert_eq!(cloud.warnings, [""; 0], "{name}");
        let found = cloud.attributes.colors.unwrap();
        for (at, (found, expected)) in found.iter().zip(&recording.colors[1]).enumerate() {
            let is_near = found.iter().zip(expected).all(|(a, b)| a.abs_diff(*b) <= 9);
            assert!(is_near, "{name}, pixel {at}: {found:?}, {expected:?}");
        }
    }
}

/// The recording in every container.
fn containers(root: &Path, messages: impl Fn(Kind) -> Vec<Recorded>) -> Vec<std::path::PathBuf> {
    let [bag_path, mcap_path, db3_path] = ["a.bag", "a.mcap", "a.db3"].map(|name| root.join(name));
    fs::write(&bag_path, bag(&messages(Kind::Ros1))).unwrap();
    fs::write(&mcap_path, mcap(Kind::CdrLittle, &messages(Kind::CdrLittle))).unwrap();
    db3(&db3_path, Kind::CdrLittle, &messages(Kind::CdrLittle));
    vec![bag_path, mcap_path, db3_path]
}

fn transform(kind: Kind, topic: &str, time_us: u64, [parent, child]: [&str; 2], place: &DAffine3) -> Recorded {
    let mut writer = Writer::new(kind);
    writer.u32(1).header(time_us, parent);
    Recorded {
        topic: topic.to_owned(),
        kind: "tf2_msgs/TFMessage",
        time_us,
        bytes: writer.text(child).transform(place).message(),
    }
}

/// A robot drives, the camera is mounted on it: poses are the camera's in the root of its links.
#[test]
fn poses_come_from_moving_frames() {
    let root = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    let mounted = DAffine3::from_rotation_x(0.7) * DAffine3::from_translation(DVec3::new(0.1, 0.2, 0.3));
    let driving = |kind: Kind| {
        let mut messages = one_camera(kind, DEPTHS[0].1, COLORS[0].1);
        messages.push(transform(kind, "/tf_static", 5, ["base_link", DEPTH_FRAME], &mounted));
        let nowhere = DAffine3::from_translation(DVec3::splat(99.0));
        messages.push(transform(kind, "/tf", 1_000_000, ["odom", "base_link"], &nowhere));
        for frame in (0..FRAMES).rev() {
            let place = recording.poses[frame] * mounted.inverse();
            messages.push(transform(
                kind,
                "/tf",
                recording.times_us[frame],
                ["odom", "base_link"],
                &place,
            ));
        }
        messages
    };
    let has = Has { poses: true, ..HAS };
    for path in containers(root.path(), driving) {
        let sequence = open(&path);
        assert_eq!(sequence.source().notes(), [""; 0], "{}", path.display());
        for frame in 0..FRAMES {
            check_frame(&path.display().to_string(), &recording, frame, &sequence, &has);
        }
        let merged = RgbdOptions {
            merge: Some((0, 2)),
            ..RgbdOptions::default()
        };
        assert_eq!(open_with(&path, merged).unwrap().len(), 1);
    }
    // Halfway between two stamps the camera is halfway.
    let halfway = |kind: Kind| {
        let mut messages = one_camera(kind, DEPTHS[0].1, COLORS[0].1);
        let time = recording.times_us[1];
        for (time_us, x) in [(time - 40_000, 1.0), (time + 40_000, 3.0)] {
            let place = DAffine3::from_translation(DVec3::X * x);
            messages.push(transform(kind, "/tf", time_us, ["map", DEPTH_FRAME], &place));
        }
        messages
    };
    let other_root = tempfile::tempdir().unwrap();
    for path in containers(other_root.path(), halfway) {
        let pose = open(&path).source().sensor(1).unwrap().world_from_camera.unwrap();
        assert!(pose.translation.distance(DVec3::X * 2.0) < 1e-9, "{pose}");
    }
}

/// The part of a sensor that a driver sends, two by two pixels in one: its camera is the recording's.
#[test]
fn parts_of_images_have_the_camera_of_the_sensor() {
    let root = tempfile::tempdir().unwrap();
    let [fx, fy, cx, cy] = CAMERA;
    let offset = [20_u32, 10];
    let of_sensor = |center: f64, offset: u32| 2.0 * (center + 0.5) + f64::from(offset) - 0.5;
    let info = |kind: Kind, topic: &str| {
        let mut writer = Writer::new(kind);
        writer
            .header(1_000_000, DEPTH_FRAME)
            .u32(150)
            .u32(200)
            .text("plumb_bob")
            .u32(0);
        let (cx, cy) = (of_sensor(cx, offset[0]), of_sensor(cy, offset[1]));
        writer.f64s(&[2.0 * fx, 0.0, cx, 0.0, 2.0 * fy, cy, 0.0, 0.0, 1.0]);
        writer
            .f64s(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
            .f64s(&[0.0; 12]);
        writer
            .u32(2)
            .u32(2)
            .u32(offset[0])
            .u32(offset[1])
            .u32(2 * HEIGHT)
            .u32(2 * WIDTH)
            .u8(0);
        Recorded {
            topic: topic.to_owned(),
            kind: "sensor_msgs/CameraInfo",
            time_us: 1_000_000,
            bytes: writer.message(),
        }
    };
    let messages = |kind: Kind| {
        let mut messages = one_camera(kind, DEPTHS[0].1, COLORS[0].1);
        messages.retain(|message| message.kind != "sensor_msgs/CameraInfo");
        messages.push(info(kind, "/camera/depth/camera_info"));
        messages
    };
    for path in containers(root.path(), messages) {
        check(&path.display().to_string(), &path);
    }
}
