//! Recordings of messages read to the same points as folders of images.

use super::layouts::check_frame;
use super::recording::{CAMERA, FRAMES, HEIGHT, Has, Recording, WIDTH, gray, rgb, written};
use super::ros::{Kind, Recorded, Writer, bag, mcap};
use super::{open_with, points};
use glam::{DAffine3, DVec3};
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma};
use pointreel::sequence::{OpenOptions, Sequence, SequenceError};
use pointreel::source::RgbdOptions;
use std::fs;
use std::path::Path;

/// Properties of a layout of messages.
pub(crate) const HAS: Has = Has {
    poses: false,
    times: true,
    exact_depths: true,
};

const DEPTH: &str = "/camera/depth/image_raw";
const COLOR: &str = "/camera/color/image_raw";
pub(crate) const DEPTH_FRAME: &str = "camera_depth_optical_frame";
const COLOR_FRAME: &str = "camera_color_optical_frame";

/// An image as it is recorded.
pub(crate) struct Packed {
    /// Suffix of the topic's name.
    end: &'static str,
    encoding: String,
    /// Byte order and bytes of a row, of images that are not compressed.
    raw: Option<(bool, u32)>,
    data: Vec<u8>,
}

pub(crate) fn raw(encoding: &str, pixel_bytes: usize, data: &[u8], big_endian: bool) -> Packed {
    // Rows are padded, as with some drivers.
    let row = pixel_bytes * WIDTH as usize;
    let padded = |row: &[u8]| [row, &[0xee; 6]].concat();
    Packed {
        end: "",
        encoding: encoding.to_owned(),
        raw: Some((big_endian, row as u32 + 6)),
        data: data.chunks(row).flat_map(padded).collect(),
    }
}

fn packed(end: &'static str, encoding: &str, data: &[u8]) -> Packed {
    Packed {
        end,
        encoding: encoding.to_owned(),
        raw: None,
        data: data.to_vec(),
    }
}

/// Writes the message of an image.
fn image(kind: Kind, topic: &str, frame_id: &str, time_us: u64, packed: &Packed) -> Recorded {
    let mut writer = Writer::new(kind);
    writer.header(time_us, frame_id);
    if let Some((big_endian, step)) = packed.raw {
        writer.u32(HEIGHT).u32(WIDTH).text(&packed.encoding);
        writer.u8(u8::from(big_endian)).u32(step);
    } else {
        writer.text(&packed.encoding);
    }
    Recorded {
        topic: format!("{topic}{}", packed.end),
        kind: match packed.raw {
            Some(_) => "sensor_msgs/Image",
            None => "sensor_msgs/CompressedImage",
        },
        time_us,
        bytes: writer.counted(&packed.data).message(),
    }
}

fn little(depths: &[u16]) -> Vec<u8> {
    depths.iter().flat_map(|mm| mm.to_le_bytes()).collect()
}

fn metres(depths: &[u16]) -> impl Iterator<Item = f32> {
    depths.iter().map(|&mm| match mm {
        0 => 0.0,
        u16::MAX => f32::NAN,
        mm => f32::from(mm) / 1000.0,
    })
}

/// The parameters of the quantisation precede depths; 16 bits are not quantised.
fn with_head(data: &[u8], [a, b]: [f32; 2]) -> Vec<u8> {
    [&[0; 4], &a.to_le_bytes(), &b.to_le_bytes(), data].concat()
}

/// Depths as Wilson (2017) prints it.
fn rvl(depths: &[u16]) -> Vec<u8> {
    let mut nibbles: Vec<u32> = Vec::new();
    let mut number = |mut value: u32| {
        loop {
            let more = value > 7;
            nibbles.push((value & 7) | (u32::from(more) << 3));
            value >>= 3;
            if !more {
                break;
            }
        }
    };
    let (mut at, mut last) = (0, 0i32);
    while at < depths.len() {
        let run = |from: usize, holes: bool| depths[from..].iter().take_while(|&&mm| (mm == 0) == holes).count();
        let holes = run(at, true);
        let measured = run(at + holes, false);
        number(holes as u32);
        number(measured as u32);
        for &mm in &depths[at + holes..at + holes + measured] {
            let difference = i32::from(mm) - last;
            number(((difference << 1) ^ (difference >> 31)) as u32);
            last = i32::from(mm);
        }
        at += holes + measured;
    }
    let word = |eight: &[u32]| (0..8).fold(0, |word, place| (word << 4) | eight.get(place).copied().unwrap_or(0));
    let words = nibbles.chunks(8).map(word);
    [WIDTH, HEIGHT]
        .into_iter()
        .chain(words)
        .flat_map(u32::to_le_bytes)
        .collect()
}

/// Encodings of depths, and of colours.
pub(crate) type WriteDepth = fn(&[u16]) -> Packed;
pub(crate) type WriteColor = fn(&[[u8; 3]]) -> Packed;

/// Every encoding of depths.
pub(crate) const DEPTHS: &[(&str, WriteDepth)] = &[
    ("16UC1", |depths| raw("16UC1", 2, &little(depths), false)),
    ("mono16, big endian", |depths| {
        let swapped: Vec<u16> = depths.iter().map(|mm| mm.swap_bytes()).collect();
        raw("mono16", 2, &little(&swapped), true)
    }),
    ("32FC1", |depths| {
        let bytes: Vec<u8> = metres(depths).flat_map(f32::to_le_bytes).collect();
        raw("32FC1", 4, &bytes, false)
    }),
    ("PNG", |depths| {
        packed("/compressed", "16UC1; png compressed ", &gray(depths, ImageFormat::Png))
    }),
    ("compressedDepth", |depths| {
        let data = with_head(&gray(depths, ImageFormat::Png), [0.0; 2]);
        packed("/compressedDepth", "16UC1; compressedDepth", &data)
    }),
    ("RVL", |depths| {
        packed(
            "/compressedDepth",
            "16UC1; compressedDepth rvl",
            &with_head(&rvl(depths), [0.0; 2]),
        )
    }),
];

/// Every lossless encoding of colours.
pub(crate) const COLORS: &[(&str, WriteColor)] = &[
    ("rgb8", |colors| raw("rgb8", 3, &colors.concat(), false)),
    ("bgr8", |colors| {
        let pixels: Vec<u8> = colors.iter().flat_map(|&[r, g, b]| [b, g, r]).collect();
        raw("bgr8", 3, &pixels, false)
    }),
    ("rgba8", |colors| {
        let pixels: Vec<u8> = colors.iter().flat_map(|&[r, g, b]| [r, g, b, 7]).collect();
        raw("rgba8", 4, &pixels, false)
    }),
    ("bgra8", |colors| {
        let pixels: Vec<u8> = colors.iter().flat_map(|&[r, g, b]| [b, g, r, 7]).collect();
        raw("bgra8", 4, &pixels, false)
    }),
    ("PNG", |colors| {
        packed(
            "/compressed",
            "rgb8; png compressed bgr8",
            &rgb(colors, ImageFormat::Png),
        )
    }),
];

/// `CameraInfo` of a camera with a lens.
fn info(kind: Kind, topic: &str, frame_id: &str, (model, coefficients): (&str, &[f64])) -> Recorded {
    let [fx, fy, cx, cy] = CAMERA;
    let mut writer = Writer::new(kind);
    writer
        .header(1_000_000, frame_id)
        .u32(HEIGHT)
        .u32(WIDTH)
        .text(model)
        .u32(coefficients.len() as u32)
        .f64s(coefficients)
        .f64s(&[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0])
        .f64s(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
        .f64s(&[2.0 * fx, 0.0, cx, 0.0, 0.0, 2.0 * fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0])
        .u32(0)
        .u32(0)
        .u32(0)
        .u32(0)
        .u32(0)
        .u32(0)
        .u8(0);
    Recorded {
        topic: topic.to_owned(),
        kind: "sensor_msgs/CameraInfo",
        time_us: 1_000_000,
        bytes: writer.message(),
    }
}

const PINHOLE: (&str, &[f64]) = ("plumb_bob", &[0.0; 5]);

/// The recording with both images of one camera.
pub(crate) fn one_camera(kind: Kind, depth: WriteDepth, color: WriteColor) -> Vec<Recorded> {
    let recording = Recording::new();
    let mut messages = vec![
        info(kind, "/camera/depth/camera_info", DEPTH_FRAME, PINHOLE),
        info(kind, "/camera/color/camera_info", DEPTH_FRAME, PINHOLE),
    ];
    // The last frame first: messages are read in the order of their stamps.
    for frame in (0..FRAMES).rev() {
        let time = recording.times_us[frame];
        let depth = depth(&recording.depths[frame]);
        let color = color(&recording.colors[frame]);
        messages.push(image(kind, DEPTH, DEPTH_FRAME, time, &depth));
        messages.push(image(kind, COLOR, DEPTH_FRAME, time + 7000, &color));
    }
    messages
}

pub(crate) fn open(path: &Path) -> Sequence {
    open_with(path, RgbdOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn check(name: &str, path: &Path) {
    let sequence = open(path);
    assert_eq!(sequence.len(), FRAMES, "{name}");
    assert_eq!(sequence.source().notes(), [""; 0], "{name}");
    for frame in 0..FRAMES {
        check_frame(name, &Recording::new(), frame, &sequence, &HAS);
    }
}

#[test]
fn every_image_encoding_gives_the_same_points() {
    let folder = tempfile::tempdir().unwrap();
    for (depth_name, depth) in DEPTHS {
        for (color_name, color) in COLORS {
            let path = folder.path().join("a.bag");
            fs::write(&path, bag(&one_camera(Kind::Ros1, *depth, *color))).unwrap();
            check(&format!("bag, {depth_name}, {color_name}"), &path);
        }
        for kind in Kind::ALL {
            let path = folder.path().join("a.mcap");
            fs::write(&path, mcap(kind, &one_camera(kind, *depth, COLORS[0].1))).unwrap();
            check(&format!("MCAP {kind:?}, {depth_name}"), &path);
        }
    }
}

/// Colours of JPEG are near, one channel gives grey.
#[test]
fn lossy_colors_are_close() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Recording::new();
    let decode = |color: WriteColor| {
        let path = folder.path().join("a.bag");
        fs::write(&path, bag(&one_camera(Kind::Ros1, DEPTHS[0].1, color))).unwrap();
        open(&path).decode(1).unwrap().attributes.colors.unwrap()
    };
    let jpeg = decode(|colors| {
        packed(
            "/compressed",
            "bgr8; jpeg compressed bgr8",
            &rgb(colors, ImageFormat::Jpeg),
        )
    });
    let apart = jpeg.iter().zip(&recording.colors[1]).map(|(found, expected)| {
        let channels = found.iter().zip(expected);
        channels.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / 3.0
    });
    let mean = apart.sum::<f64>() / jpeg.len() as f64;
    assert!(mean < 6.0, "{mean}");
    let mono = decode(|colors| {
        let grey: Vec<u8> = colors.iter().map(|&[red, ..]| red).collect();
        raw("mono8", 1, &grey, false)
    });
    let expected = recording.colors[1].iter().map(|&[red, ..]| [red, red, red, 255]);
    assert!(mono.into_iter().eq(expected));
}

/// 1/z in steps, as `compressed_depth_image_transport` writes floats.
#[test]
fn inverse_depths_are_accurate_to_their_quantisation() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    let depth: WriteDepth = |depths| {
        let [a, b] = [100.0 * 101.0, 0.0f32];
        let codes: Vec<u16> = metres(depths)
            .map(|z| if z > 0.0 { (a / z + b).round() as u16 } else { 0 })
            .collect();
        let image = ImageBuffer::<Luma<u16>, _>::from_raw(WIDTH, HEIGHT, codes).unwrap();
        let png = written(&DynamicImage::ImageLuma16(image), ImageFormat::Png);
        packed(
            "/compressedDepth",
            "32FC1; compressedDepth png",
            &with_head(&png, [a, b]),
        )
    };
    fs::write(
        &path,
        mcap(Kind::CdrLittle, &one_camera(Kind::CdrLittle, depth, COLORS[0].1)),
    )
    .unwrap();
    let found = points(&open(&path).decode(0).unwrap());
    for (found, expected) in found.iter().zip(Recording::new().points(0)) {
        assert_eq!(found.is_finite(), expected.is_finite());
        // Half a step of 1/z.
        let max = 0.5 * expected.z * expected.z / 10_100.0 * 1.3 + 1e-6;
        assert!(
            !expected.is_finite() || found.distance(expected) <= max,
            "{found} {expected}"
        );
    }
}

/// Position of the colour camera relative to the depth camera.
fn color_from_depth() -> DAffine3 {
    DAffine3::from_rotation_y(0.02) * DAffine3::from_translation(DVec3::new(-0.025, 0.004, 0.001))
}

const FISHEYE: (&str, &[f64]) = ("equidistant", &[0.01, 0.002, 0.0, 0.0]);
const BROWN: (&str, &[f64]) = ("plumb_bob", &[0.1, -0.05, 0.001, 0.0, 0.0]);

/// The recording as a folder with its cameras in JSON.
fn folder_of_two(root: &Path) -> Sequence {
    let (folder, _) = super::layouts::written(root, "patterns");
    let camera = |(model, coefficients): (&str, &[f64])| {
        let [fx, fy, cx, cy] = CAMERA;
        serde_json::json!({
            "width": WIDTH, "height": HEIGHT, "fx": fx, "fy": fy, "cx": cx, "cy": cy,
            "distortion": { "model": model, "coefficients": coefficients },
        })
    };
    let mut color = camera(("fisheye", FISHEYE.1));
    let rows = glam::DMat4::from(color_from_depth()).transpose().to_cols_array();
    color["color_from_depth"] = rows.to_vec().into();
    let json = serde_json::json!({ "depth": camera(("brown", BROWN.1)), "color": color });
    let path = root.join("two.json");
    fs::write(&path, json.to_string()).unwrap();
    let options = RgbdOptions {
        depth: Some("out/z*.png".to_owned()),
        color: Some("out/c*.png".to_owned()),
        depth_scale: Some(10_000.0),
        intrinsics: Some(path.to_str().unwrap().to_owned()),
        ..RgbdOptions::default()
    };
    open_with(&folder, options).unwrap()
}

/// Both images, by the topics and frames of reference that are given.
fn images(kind: Kind, [depth, color]: [&str; 2], frames: [&str; 2], code: fn(u16) -> u16) -> Vec<Recorded> {
    let recording = Recording::new();
    let of_frame = |frame: usize| {
        let time = recording.times_us[frame];
        let depths: Vec<u16> = recording.depths[frame].iter().map(|&mm| code(mm)).collect();
        let depths = raw("mono16", 2, &little(&depths), false);
        let colors = raw("rgb8", 3, &recording.colors[frame].concat(), false);
        [
            image(kind, depth, frames[0], time, &depths),
            image(kind, color, frames[1], time, &colors),
        ]
    };
    (0..FRAMES).flat_map(of_frame).collect()
}

fn check_two(name: &str, path: &Path, expected: &Sequence) {
    let found = open(path);
    assert_eq!(found.source().notes(), [""; 0], "{name}");
    let sensors = [&found, expected].map(|sequence| sequence.source().sensor(0).unwrap());
    let [a, b] = sensors.map(|sensor| sensor.rig.color.as_ref().unwrap().color_from_depth);
    assert!(a.abs_diff_eq(b, 1e-12), "{name}: {a} {b}");
    for frame in 0..FRAMES {
        let [found, expected] = [&found, expected].map(|sequence| sequence.decode(frame).unwrap());
        let [a, b] = [&found, &expected].map(points);
        let is_same =
            |(a, b): (&DVec3, &DVec3)| a.is_finite() == b.is_finite() && (!a.is_finite() || a.distance(*b) < 1e-6);
        assert!(a.iter().zip(&b).all(is_same), "{name}, frame {frame}");
        assert_eq!(
            found.attributes.colors, expected.attributes.colors,
            "{name}, frame {frame}"
        );
    }
}

#[test]
fn two_cameras_are_joined_by_static_transforms() {
    let root = tempfile::tempdir().unwrap();
    let expected = folder_of_two(root.path());
    for kind in Kind::ALL {
        let mut messages = vec![
            info(kind, "/camera/depth/camera_info", DEPTH_FRAME, BROWN),
            info(kind, "/camera/color/camera_info", COLOR_FRAME, FISHEYE),
        ];
        // Via an intermediate frame: depth is its child, and it is a child of the colour camera.
        let link = DAffine3::from_rotation_x(0.7) * DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0));
        let links = [
            ("camera_link", DEPTH_FRAME, link),
            (COLOR_FRAME, "camera_link", color_from_depth() * link.inverse()),
        ];
        for (parent, child, parent_from_child) in links {
            let slash = if kind == Kind::Ros1 { "/" } else { "" };
            let mut writer = Writer::new(kind);
            writer.u32(1).header(1_000_000, &format!("{slash}{parent}"));
            let bytes = writer.text(child).transform(&parent_from_child).message();
            messages.push(Recorded {
                topic: "/tf_static".to_owned(),
                kind: "tf2_msgs/TFMessage",
                time_us: 1_000_000,
                bytes,
            });
        }
        messages.extend(images(kind, [DEPTH, COLOR], [DEPTH_FRAME, COLOR_FRAME], |mm| mm));
        let path = root.path().join(format!("{kind:?}.mcap"));
        fs::write(&path, mcap(kind, &messages)).unwrap();
        check_two(&format!("{kind:?}"), &path, &expected);

        // Without the links: the same position is assumed, and reported.
        messages.retain(|message| message.kind != "tf2_msgs/TFMessage");
        fs::write(&path, mcap(kind, &messages)).unwrap();
        let notes = open(&path).source().notes().join("; ");
        assert!(notes.contains("tf_static has no way"), "{notes}");
    }
}

/// As `librealsense` records: one frame of reference for all, extrinsics from a stream to each, and the unit of depths.
#[test]
fn realsense_bags_are_read() {
    let root = tempfile::tempdir().unwrap();
    let expected = folder_of_two(root.path());
    let kind = Kind::Ros1;
    let [depth, color] = ["/device_0/sensor_0/Depth_0", "/device_0/sensor_1/Color_0"];
    let mut messages = vec![
        info(
            kind,
            &format!("{depth}/info/camera_info"),
            "0",
            ("Brown Conrady", BROWN.1),
        ),
        info(
            kind,
            &format!("{color}/info/camera_info"),
            "0",
            ("Kannala Brandt4", FISHEYE.1),
        ),
    ];
    // From an infrared camera to both.
    let depth_from_infrared = DAffine3::from_rotation_z(0.3) * DAffine3::from_translation(DVec3::new(0.1, 0.0, -0.2));
    for (stream, place) in [
        (depth, depth_from_infrared),
        (color, color_from_depth() * depth_from_infrared),
    ] {
        messages.push(Recorded {
            topic: format!("{stream}/tf/0"),
            kind: "geometry_msgs/Transform",
            time_us: 0,
            bytes: Writer::new(kind).transform(&place).message(),
        });
    }
    messages.push(Recorded {
        topic: "/device_0/sensor_0/option/Depth_Units/value".to_owned(),
        kind: "std_msgs/Float32",
        time_us: 0,
        bytes: Writer::new(kind).f32(1.0 / 4096.0).message(),
    });
    let topics = [format!("{depth}/image/data"), format!("{color}/image/data")];
    let topics = topics.each_ref().map(String::as_str);
    messages.extend(images(kind, topics, ["0", "0"], |mm| mm));
    let path = root.path().join("realsense.bag");
    fs::write(&path, bag(&messages)).unwrap();
    let found = points(&open(&path).decode(0).unwrap());
    let expected_points = points(&expected.decode(0).unwrap());
    for (found, expected) in found.iter().zip(expected_points) {
        let expected = expected * 1000.0 / 4096.0;
        assert!(
            !expected.is_finite() || found.distance(expected) < 1e-6,
            "{found} {expected}"
        );
    }
    let sensor = open(&path).source().sensor(0).unwrap();
    let place = sensor.rig.color.as_ref().unwrap().color_from_depth;
    assert!(place.abs_diff_eq(color_from_depth(), 1e-12), "{place}");
}

#[test]
fn rectified_images_have_the_projection_and_no_lens() {
    let folder = tempfile::tempdir().unwrap();
    let kind = Kind::CdrLittle;
    let [depth, color] = ["/camera/depth/image_rect_raw", "/camera/depth/color"];
    let mut messages = images(kind, [depth, color], [DEPTH_FRAME; 2], |mm| mm);
    messages.push(info(kind, "/camera/depth/camera_info", DEPTH_FRAME, BROWN));
    let path = folder.path().join("a.mcap");
    fs::write(&path, mcap(kind, &messages)).unwrap();
    let sensor = open(&path).source().sensor(0).unwrap();
    assert_eq!(sensor.rig.depth.distortion().name(), "none");
    assert_eq!(
        sensor.rig.depth.focal_px(),
        2.0 * glam::DVec2::new(CAMERA[0], CAMERA[1])
    );
}

fn with_topic(path: &Path, topic: &str) -> Result<Sequence, SequenceError> {
    let options = OpenOptions {
        topic: Some(topic.into()),
        ..OpenOptions::default()
    };
    Sequence::open(&[path.to_owned()], &options)
}

#[test]
fn point_clouds_come_first_unless_a_topic_of_images_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let kind = Kind::CdrLittle;
    let mut messages = one_camera(kind, DEPTHS[0].1, COLORS[0].1);
    messages.push(Recorded {
        topic: "/points".to_owned(),
        kind: "sensor_msgs/PointCloud2",
        time_us: 5,
        bytes: Writer::new(kind).header(5, "lidar").message(),
    });
    let path = folder.path().join("a.mcap");
    fs::write(&path, mcap(kind, &messages)).unwrap();
    assert_eq!(open(&path).len(), 1, "the cloud");
    assert_eq!(with_topic(&path, DEPTH).unwrap().len(), FRAMES);
    let error = with_topic(&path, COLOR).unwrap_err().to_string();
    assert!(error.contains("/points"), "{error}");
}

#[test]
fn missing_and_broken_content_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let kind = Kind::Ros1;
    let whole = one_camera(kind, DEPTHS[0].1, COLORS[0].1);
    let path = folder.path().join("a.bag");
    let write = |messages: &[Recorded]| fs::write(&path, bag(messages)).unwrap();

    let bare: Vec<Recorded> = whole
        .iter()
        .filter(|message| message.kind == "sensor_msgs/Image")
        .cloned()
        .collect();
    write(&bare);
    let error = open_with(&path, RgbdOptions::default()).unwrap_err().to_string();
    assert!(error.contains("--intrinsics") && error.contains(DEPTH), "{error}");
    let named = RgbdOptions {
        intrinsics: Some(CAMERA.map(|number| number.to_string()).join(",")),
        ..RgbdOptions::default()
    };
    let sequence = open_with(&path, named).unwrap();
    check_frame("by hand", &Recording::new(), 1, &sequence, &HAS);

    // One depth and one colour image are truncated: one frame is lost, and the colours of another.
    let mut cut = whole.clone();
    for (topic, at) in [(DEPTH, 0), (COLOR, 1)] {
        let mut of_topic = cut.iter_mut().filter(|message| message.topic == topic);
        of_topic.nth(at).unwrap().bytes.truncate(5000);
    }
    write(&cut);
    let sequence = open(&path);
    let error = sequence.decode(2).unwrap_err().to_string();
    assert!(
        error.contains(DEPTH) && error.contains("truncated or damaged"),
        "{error}"
    );
    let warned = sequence.decode(1).unwrap();
    assert!(warned.warnings[0].contains("have no colours"), "{:?}", warned.warnings);
    check_frame("the whole one", &Recording::new(), 0, &sequence, &HAS);

    // Truncated anywhere, nothing panics.
    write(&whole);
    let bytes = fs::read(&path).unwrap();
    for end in (0..bytes.len()).step_by(bytes.len() / 23) {
        fs::write(&path, &bytes[..end]).unwrap();
        if let Ok(sequence) = open_with(&path, RgbdOptions::default()) {
            for frame in 0..sequence.len() {
                let _ = sequence.decode(frame);
            }
        }
    }
}
