//! Recordings of an Azure Kinect: its modes, its colours, and possible faults of both.

use super::layouts::check_frame;
use super::matroska::{TrackOf, mkv};
use super::recording::{CAMERA, FRAMES, HEIGHT, Has, Recording, WIDTH, rgb, written};
use super::{open, open_with, points};
use glam::{DMat3, DVec2, DVec3};
use image::{DynamicImage, ImageBuffer, ImageFormat, Rgb};
use pointreel::source::RgbdOptions;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::time::Duration;

/// The narrow mode with binned pixels: a part of 512 × 512.
const MODE: &str = "NFOV_2X2BINNED";
const MODE_PX: [u32; 2] = [320, 288];
const MODE_SENSOR_PX: f64 = 512.0;
const MODE_OFFSET_PX: [f64; 2] = [96.0, 90.0];
/// Of 16:9, whose sensor has 1280 × 960 of its pixels.
const COLOR_PX: [u32; 2] = [1280, 720];

/// cx, cy, fx, fy in sizes of the sensor.
const DEPTH: [f64; 4] = [0.51, 0.5, 0.49, 0.48];
const COLOR: [f64; 4] = [0.5, 0.49, 0.475, 0.63];
const COLOR_AT: [f64; 3] = [-0.032, -0.002, 0.004];

fn color_turn() -> DMat3 {
    DMat3::from_rotation_x(0.1) * DMat3::from_rotation_y(-0.02)
}

fn calibration() -> Value {
    let camera = |location: &str, [width, height]: [u32; 2], [cx, cy, fx, fy]: [f64; 4], turn: DMat3, at: [f64; 3]| {
        let mut lens = vec![cx, cy, fx, fy];
        lens.extend([0.0; 10]);
        serde_json::json!({
            "Location": format!("CALIBRATION_CameraLocation{location}"),
            "SensorWidth": width, "SensorHeight": height, "MetricRadius": 1.7,
            "Intrinsics": {
                "ModelParameterCount": 14, "ModelParameters": lens,
                "ModelType": "CALIBRATION_LensDistortionModelBrownConrady",
            },
            "Rt": { "Rotation": turn.transpose().to_cols_array().to_vec(), "Translation": at.to_vec() },
        })
    };
    let cameras = [
        camera("D0", [1024, 1024], DEPTH, DMat3::IDENTITY, [0.0; 3]),
        camera("PV0", [4096, 3072], COLOR, color_turn(), COLOR_AT),
    ];
    serde_json::json!({ "CalibrationInformation": { "Cameras": cameras.to_vec(), "InertialSensors": [] } })
}

fn big_endian(depths: &[u16]) -> Vec<u8> {
    depths.iter().flat_map(|mm| mm.to_be_bytes()).collect()
}

fn pixels([width, height]: [u32; 2]) -> impl Iterator<Item = (u32, u32)> {
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

/// A tilted wall with holes.
fn depth_mm((x, y): (u32, u32)) -> u16 {
    if (x + 2 * y) % 17 == 0 {
        0
    } else {
        (1000 + x + y) as u16
    }
}

/// Red and green encode the position of a pixel of the colour image.
fn color_at((x, y): (u32, u32)) -> [u8; 3] {
    [(x / 6) as u8, (y / 4) as u8, 90]
}

fn jpeg() -> Vec<u8> {
    let pixels: Vec<u8> = pixels(COLOR_PX).flat_map(color_at).collect();
    let image = ImageBuffer::<Rgb<u8>, _>::from_raw(COLOR_PX[0], COLOR_PX[1], pixels).unwrap();
    written(&DynamicImage::ImageRgb8(image), ImageFormat::Jpeg)
}

/// Three frames 33 ms apart; colours come five milliseconds later.
#[expect(clippy::trivially_copy_pass_by_ref, reason = "tracks keep it as written")]
fn tracks(fourcc: &'static [u8; 4], color: &[u8]) -> Vec<TrackOf<'static>> {
    let depth: Vec<u16> = pixels(MODE_PX).map(depth_mm).collect();
    let times = || [0_u64, 33_333, 66_667].into_iter();
    let infrared = vec![7; 2 * depth.len()];
    vec![
        TrackOf {
            name: "COLOR",
            fourcc,
            size_px: COLOR_PX,
            frames: times().map(|time| (time + 5000, color.to_vec())).collect(),
        },
        TrackOf {
            name: "DEPTH",
            fourcc: b"b16g",
            size_px: MODE_PX,
            frames: times().map(|time| (time, big_endian(&depth))).collect(),
        },
        TrackOf {
            name: "IR",
            fourcc: b"b16g",
            size_px: MODE_PX,
            frames: times().map(|time| (time, infrared.clone())).collect(),
        },
    ]
}

fn mode_tag() -> Vec<(&'static str, String)> {
    vec![
        ("K4A_DEPTH_MODE", MODE.to_owned()),
        ("K4A_DEPTH_DELAY_NS", "0".to_owned()),
    ]
}

fn usual() -> Vec<u8> {
    mkv(&tracks(b"MJPG", &jpeg()), &mode_tag(), Some(&calibration().to_string()))
}

fn error_of(path: &Path, bytes: &[u8]) -> String {
    fs::write(path, bytes).unwrap();
    open_with(path, RgbdOptions::default()).unwrap_err().to_string()
}

/// By hand: the part of the sensor, its units, and the half pixel.
fn point((x, y): (u32, u32)) -> DVec3 {
    let z = f64::from(depth_mm((x, y))) / 1000.0;
    if z == 0.0 {
        return DVec3::NAN;
    }
    let [cx, cy, fx, fy] = DEPTH.map(|share| share * MODE_SENSOR_PX);
    let right = (f64::from(x) + 0.5 + MODE_OFFSET_PX[0] - cx) / fx;
    let down = (f64::from(y) + 0.5 + MODE_OFFSET_PX[1] - cy) / fy;
    DVec3::new(right, down, 1.0) * z
}

/// Pixel of a point in the colour camera: its sensor has 1280 × 960 pixels; 120 lines are cut at the top.
fn color_pixel(point: DVec3) -> DVec2 {
    let seen = color_turn() * point + DVec3::from_array(COLOR_AT);
    let [cx, cy, fx, fy] = COLOR;
    let x = 1280.0 * (fx * seen.x / seen.z + cx) - 0.5;
    let y = 960.0 * (fy * seen.y / seen.z + cy) - 120.0 - 0.5;
    DVec2::new(x, y)
}

#[test]
fn a_recording_has_the_points_and_colors_of_its_cameras() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("capture.mkv");
    fs::write(&path, usual()).unwrap();
    let sequence = open(&path);
    assert_eq!(sequence.source().notes(), [""; 0]);
    assert_eq!(sequence.len(), 3);
    assert_eq!(sequence.entry(2).time, Some(Duration::from_micros(66_667)));
    assert!(
        sequence.entry(1).name.starts_with("capture.mkv"),
        "{:?}",
        sequence.entry(1)
    );
    let cloud = sequence.decode(1).unwrap();
    assert_eq!(cloud.warnings, [""; 0]);
    let grid = cloud.grid.as_ref().unwrap();
    assert_eq!([grid.width(), grid.height()], MODE_PX);
    let expected: Vec<DVec3> = pixels(MODE_PX).map(point).collect();
    let found = points(&cloud);
    for (found, expected) in found.iter().zip(&expected) {
        let is_same =
            found.is_finite() == expected.is_finite() && (!found.is_finite() || found.distance(*expected) < 1e-6);
        assert!(is_same, "{found} {expected}");
    }
    let colors = cloud.attributes.colors.as_ref().unwrap();
    let mut compared = 0;
    for (point, color) in expected.iter().zip(colors) {
        // Grey means not seen by the colour camera.
        if !point.is_finite() || color[..3] == [128; 3] {
            continue;
        }
        let at = color_pixel(*point);
        // JPEG is lossy, and the steps of the pattern are six and four pixels long.
        let apart = [f64::from(color[0]) - at.x / 6.0, f64::from(color[1]) - at.y / 4.0];
        assert!(apart.iter().all(|apart| apart.abs() < 6.0), "{color:?} at {at}");
        compared += 1;
    }
    assert!(compared > 50_000, "{compared} points have colours");
    let sensor = sequence.source().sensor(0).unwrap();
    assert_eq!(sensor.rig.color.as_ref().unwrap().camera.size_px(), COLOR_PX);
    assert_eq!(sensor.world_from_camera, None);
}

/// The file of this test is one to a reader that shares no line with ours, frame by frame.
#[test]
fn another_reader_finds_the_same_frames() {
    let bytes = usual();
    let mut file = matroska_demuxer::MatroskaFile::open(std::io::Cursor::new(bytes)).unwrap();
    let names: Vec<_> = file
        .tracks()
        .iter()
        .map(|track| track.name().unwrap().to_owned())
        .collect();
    assert_eq!(names, ["COLOR", "DEPTH", "IR"]);
    let mut frame = matroska_demuxer::Frame::default();
    let depth: Vec<u16> = pixels(MODE_PX).map(depth_mm).collect();
    let mut times = Vec::new();
    while file.next_frame(&mut frame).unwrap() {
        if frame.track == 2 {
            assert_eq!(frame.data, big_endian(&depth));
            times.push(frame.timestamp);
        }
    }
    assert_eq!(times, [0, 33_333, 66_667]);
}

/// Named cameras need no calibration, and images of any size.
#[test]
fn a_recording_in_matroska_reads_to_the_same_points() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.MKV");
    let recording = Recording::new();
    let of_frames = |frame: &dyn Fn(usize) -> Vec<u8>| {
        let time = |at: usize| recording.times_us[at] - recording.times_us[0];
        (0..FRAMES).map(|at| (time(at), frame(at))).collect::<Vec<_>>()
    };
    let bgra = |at: usize| {
        recording.colors[at]
            .iter()
            .flat_map(|&[r, g, b]| [b, g, r, 255])
            .collect()
    };
    let png = |at: usize| rgb(&recording.colors[at], ImageFormat::Png);
    // The first bytes of an image determine its format.
    for (fourcc, color) in [(b"BGRA", &bgra as &dyn Fn(usize) -> Vec<u8>), (b"MJPG", &png)] {
        let tracks = [
            TrackOf {
                name: "DEPTH",
                fourcc: b"b16g",
                size_px: [WIDTH, HEIGHT],
                frames: of_frames(&|at| big_endian(&recording.depths[at])),
            },
            TrackOf {
                name: "COLOR",
                fourcc,
                size_px: [WIDTH, HEIGHT],
                frames: of_frames(color),
            },
        ];
        fs::write(&path, mkv(&tracks, &[], None)).unwrap();
        let options = RgbdOptions {
            intrinsics: Some(CAMERA.map(|number| number.to_string()).join(",")),
            ..RgbdOptions::default()
        };
        let sequence = open_with(&path, options).unwrap();
        let has = Has {
            poses: false,
            times: true,
            exact_depths: true,
        };
        for frame in 0..FRAMES {
            check_frame("Matroska", &recording, frame, &sequence, &has);
        }
        let error = open_with(&path, RgbdOptions::default()).unwrap_err().to_string();
        assert!(error.contains("a.MKV") && error.contains("--intrinsics"), "{error}");
    }
}

/// Bare colours of cameras: luma 126 and chromas of none are a grey of 128.
#[test]
fn colors_may_be_raw_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mkv");
    let [width, height] = COLOR_PX.map(|side| side as usize);
    let nv12 = [vec![199; width * height], vec![128; width * height / 2]].concat();
    let yuy2 = [199, 128].repeat(width * height);
    for (fourcc, bytes) in [(b"NV12", nv12), (b"YUY2", yuy2)] {
        fs::write(
            &path,
            mkv(&tracks(fourcc, &bytes), &mode_tag(), Some(&calibration().to_string())),
        )
        .unwrap();
        let cloud = open(&path).decode(0).unwrap();
        assert_eq!(cloud.warnings, [""; 0]);
        let colors = cloud.attributes.colors.unwrap();
        let bright = colors.iter().filter(|color| color[..3] == [213; 3]).count();
        assert!(bright > 50_000, "{bright} of {}", colors.len());
    }
}

/// A camera may be set to take depth images later than colour images, by almost a frame.
#[test]
fn a_delay_between_the_cameras_is_taken_into_account() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mkv");
    for (delay_ns, notes) in [(25_000_000_i64, 0), (0, 1), (-25_000_000, 1)] {
        let mut tracks = tracks(b"MJPG", &jpeg());
        for (time, _) in &mut tracks[1].frames {
            *time += 30_000;
        }
        // One colour image, before the first depth image.
        tracks[0].frames.truncate(1);
        let tags = [
            ("K4A_DEPTH_MODE", MODE.to_owned()),
            ("K4A_DEPTH_DELAY_NS", delay_ns.to_string()),
        ];
        fs::write(&path, mkv(&tracks, &tags, Some(&calibration().to_string()))).unwrap();
        let sequence = open(&path);
        let has_colors = sequence.decode(0).unwrap().attributes.colors.is_some();
        assert_eq!(has_colors, notes == 0, "{delay_ns}");
        let found = sequence.source().notes();
        let alone = if notes == 0 { 2 } else { 3 };
        assert!(found[0].starts_with(&format!("{alone} of 3 depth images")), "{found:?}");
    }
}

#[test]
fn unreadable_recordings_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mkv");
    let json = calibration().to_string();
    let of = |change: fn(&mut Vec<TrackOf<'static>>), tags: &[(&str, String)], json: Option<&str>| {
        let mut tracks = tracks(b"MJPG", &jpeg());
        change(&mut tracks);
        mkv(&tracks, tags, json)
    };
    let no_change: fn(&mut Vec<TrackOf<'static>>) = |_| {};
    let wide = [("K4A_DEPTH_MODE", "WFOV_UNBINNED".to_owned())];
    let passive = [("K4A_DEPTH_MODE", "PASSIVE_IR".to_owned())];
    for (bytes, expected) in [
        (b"no film".to_vec(), "first bytes differ"),
        (of(no_change, &mode_tag(), None), "no file `calibration.json`"),
        (of(no_change, &mode_tag(), Some("{")), "`calibration.json`: EOF"),
        (of(no_change, &wide, Some(&json)), "WFOV_UNBINNED 1024 × 1024"),
        (of(|tracks| drop(tracks.remove(1)), &passive, Some(&json)), "PASSIVE_IR"),
        (
            of(|tracks| drop(tracks.remove(1)), &[], Some(&json)),
            "found `COLOR` (V_MS/VFW/FOURCC)",
        ),
        (
            of(|tracks| tracks[1].fourcc = b"FFV1", &mode_tag(), Some(&json)),
            "written as FFV1",
        ),
        (
            of(|tracks| tracks[1].size_px = [640, 480], &[], Some(&json)),
            "640 × 480",
        ),
        (
            of(|tracks| tracks[1].frames.clear(), &mode_tag(), Some(&json)),
            "no depth image",
        ),
    ] {
        let error = error_of(&path, &bytes);
        assert!(
            error.contains("a.mkv") && error.contains(expected),
            "{expected}: {error}"
        );
    }
    // Colours encoded as video cost only the colours.
    fs::write(&path, of(|tracks| tracks[0].fourcc = b"H264", &mode_tag(), Some(&json))).unwrap();
    let sequence = open(&path);
    let notes = sequence.source().notes();
    assert!(notes[0].contains("H264") && notes[0].contains("skipped"), "{notes:?}");
    assert_eq!(sequence.decode(0).unwrap().attributes.colors, None);
}

#[test]
fn damaged_images_lose_one_frame_or_its_colors() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mkv");
    let mut tracks = tracks(b"MJPG", &jpeg());
    tracks[1].frames[0].1.truncate(1000);
    tracks[0].frames[1].1.truncate(30);
    tracks[0].frames[2].1 = rgb(&Recording::new().colors[0], ImageFormat::Png);
    fs::write(&path, mkv(&tracks, &mode_tag(), Some(&calibration().to_string()))).unwrap();
    let sequence = open(&path);
    let error = sequence.decode(0).unwrap_err().to_string();
    assert!(
        error.contains("track DEPTH") && error.contains("1000 are there"),
        "{error}"
    );
    for (frame, expected) in [(1, "track COLOR"), (2, "64 × 48")] {
        let cloud = sequence.decode(frame).unwrap();
        assert!(cloud.warnings[0].contains(expected), "{:?}", cloud.warnings);
        assert_eq!(cloud.attributes.colors, None);
    }
}

#[test]
fn a_truncated_recording_has_the_frames_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mkv");
    let whole = usual();
    let mut counts = Vec::new();
    for end in (0..whole.len()).step_by(whole.len() / 37) {
        fs::write(&path, &whole[..end]).unwrap();
        if let Ok(sequence) = open_with(&path, RgbdOptions::default()) {
            assert!(sequence.source().notes().iter().any(|note| note.contains("ends early")));
            counts.push(sequence.len());
            for frame in 0..sequence.len() {
                assert!(sequence.decode(frame).is_ok());
            }
        }
    }
    assert!(
        counts.is_sorted() && counts.contains(&1) && counts.contains(&2),
        "{counts:?}"
    );
}
