//! One recording, and how every layout has it.

use super::{phones, rewritten};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb};
use pointreel::source::RgbdOptions;
use std::fmt::Write as _;
use std::fs;
use std::io::Cursor;
use std::path::Path;
use tiff::encoder::{TiffEncoder, colortype};

pub(crate) const WIDTH: u32 = 64;
pub(crate) const HEIGHT: u32 = 48;
pub(crate) const FRAMES: usize = 3;

/// fx, fy, cx, cy: TUM's, for images a tenth as large.
pub(crate) const CAMERA: [f64; 4] = [52.5, 52.5, 31.5, 23.5];

/// Three frames of a wavy wall with holes.
pub(crate) struct Recording {
    /// Millimetres.
    pub(crate) depths: Vec<Vec<u16>>,
    pub(crate) colors: Vec<Vec<[u8; 3]>>,
    pub(crate) poses: Vec<DAffine3>,
    /// Microseconds.
    pub(crate) times_us: Vec<u64>,
}

impl Recording {
    pub(crate) fn new() -> Self {
        let pixels = || (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
        let depth = |frame: u32, (x, y): (u32, u32)| match (x + 3 * y + frame) % 13 {
            0 => 0,
            1 if x % 4 == 0 => u16::MAX,
            _ => (900 + 7 * (x / 5) + 11 * (y / 4) + 100 * frame) as u16,
        };
        let color = |frame: u32, (x, y): (u32, u32)| [(3 * x) as u8, (5 * y) as u8, (40 * frame) as u8];
        let frames = || 0..FRAMES as u32;
        let pose = |frame: u32| {
            let turn = DQuat::from_rotation_y(0.1 * f64::from(frame)) * DQuat::from_rotation_x(0.3);
            DAffine3::from_rotation_translation(turn, DVec3::new(0.2 * f64::from(frame), 1.5, -0.5))
        };
        Self {
            depths: frames()
                .map(|frame| pixels().map(|at| depth(frame, at)).collect())
                .collect(),
            colors: frames()
                .map(|frame| pixels().map(|at| color(frame, at)).collect())
                .collect(),
            poses: frames().map(pose).collect(),
            times_us: frames()
                .map(|frame| 1_305_031_102_160_407 + 33_300 * u64::from(frame))
                .collect(),
        }
    }

    /// The points of a frame by the definition; holes are NaN.
    pub(crate) fn points(&self, frame: usize) -> Vec<DVec3> {
        let [fx, fy, cx, cy] = CAMERA;
        let point = |(at, &depth): (usize, &u16)| {
            if depth == 0 || depth == u16::MAX {
                return DVec3::NAN;
            }
            let (x, y) = ((at as u32 % WIDTH) as f64, (at as u32 / WIDTH) as f64);
            let z = f64::from(depth) / 1000.0;
            DVec3::new(z * (x - cx) / fx, z * (y - cy) / fy, z)
        };
        self.depths[frame].iter().enumerate().map(point).collect()
    }

    pub(crate) fn seconds(&self, frame: usize) -> String {
        let time = self.times_us[frame];
        format!("{}.{:06}", time / 1_000_000, time % 1_000_000)
    }

    pub(crate) fn rows(pose: &DAffine3) -> String {
        let rows = DMat4::from(*pose).transpose().to_cols_array();
        rows.chunks(4).fold(String::new(), |mut text, row| {
            writeln!(text, "{} {} {} {}", row[0], row[1], row[2], row[3]).unwrap();
            text
        })
    }

    pub(crate) fn depth_png(&self, path: &Path, frame: usize, code: impl Fn(u16) -> u16) {
        fs::write(
            path,
            gray(
                &self.depths[frame].iter().map(|&mm| code(mm)).collect::<Vec<_>>(),
                ImageFormat::Png,
            ),
        )
        .unwrap();
    }

    pub(crate) fn color_png(&self, path: &Path, frame: usize) {
        fs::write(path, rgb(&self.colors[frame], ImageFormat::Png)).unwrap();
    }
}

pub(crate) fn gray(samples: &[u16], format: ImageFormat) -> Vec<u8> {
    let image = ImageBuffer::<Luma<u16>, _>::from_raw(WIDTH, HEIGHT, samples.to_vec()).unwrap();
    written(&DynamicImage::ImageLuma16(image), format)
}

pub(crate) fn rgb(pixels: &[[u8; 3]], format: ImageFormat) -> Vec<u8> {
    let image = ImageBuffer::<Rgb<u8>, _>::from_raw(WIDTH, HEIGHT, pixels.concat()).unwrap();
    written(&DynamicImage::ImageRgb8(image), format)
}

pub(crate) fn written(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Plain numbers but for those that mean nothing was measured.
pub(crate) fn unless_hole(mm: u16, code: impl Fn(u16) -> u16) -> u16 {
    if mm == 0 || mm == u16::MAX { mm } else { code(mm) }
}

fn named_camera() -> RgbdOptions {
    RgbdOptions {
        intrinsics: Some(CAMERA.map(|number| number.to_string()).join(",")),
        ..RgbdOptions::default()
    }
}

/// Writes the recording into a folder; returns the options that open it.
pub(crate) type Write = fn(&Recording, &Path) -> RgbdOptions;

/// Presence of poses, stamps and exact depths in a layout.
pub(crate) struct Has {
    pub(crate) poses: bool,
    pub(crate) times: bool,
    pub(crate) exact_depths: bool,
}

pub(crate) const ALL: Has = Has {
    poses: true,
    times: true,
    exact_depths: true,
};

/// Every layout.
pub(crate) const LAYOUTS: &[(&str, Write, Has)] = &[
    ("TUM", tum, ALL),
    (
        "ICL-NUIM",
        icl,
        Has {
            poses: false,
            times: false,
            ..ALL
        },
    ),
    ("7-Scenes", seven_scenes, Has { times: false, ..ALL }),
    ("Open3D", open3d, Has { times: false, ..ALL }),
    ("Open3D with JSON", open3d_json, Has { times: false, ..ALL }),
    ("PCL TIFF", pcl_tiff, Has { poses: false, ..ALL }),
    ("PCL PCLZF", pcl_lzf, Has { poses: false, ..ALL }),
    ("SUN", sun, Has { times: false, ..ALL }),
    (
        "NYU",
        nyu,
        Has {
            poses: false,
            exact_depths: false,
            ..ALL
        },
    ),
    (
        "Replica",
        rewritten::replica,
        Has {
            times: false,
            exact_depths: false,
            ..ALL
        },
    ),
    ("ScanNet", rewritten::scannet, Has { times: false, ..ALL }),
    (
        "ScanNet with info",
        rewritten::scannet_info,
        Has { times: false, ..ALL },
    ),
    ("TSDF fusion", rewritten::tsdf_fusion, Has { times: false, ..ALL }),
    ("NumPy metres", rewritten::npy_metres, Has { times: false, ..ALL }),
    (
        "NumPy millimetres",
        rewritten::npy_millimetres,
        Has { times: false, ..ALL },
    ),
    ("NumPy archives", rewritten::npz, Has { times: false, ..ALL }),
    ("SLAMBench", rewritten::slambench, Has { times: false, ..ALL }),
    ("Stray Scanner", phones::outlier, ALL),
    ("ARKitScenes", phones::arkit_scenes, ALL),
    ("3D Scanner App", phones::scanner_app, ALL),
    ("patterns", patterns, Has { times: false, ..ALL }),
    (
        "floats",
        floats,
        Has {
            poses: false,
            times: false,
            ..ALL
        },
    ),
];

fn tum(recording: &Recording, folder: &Path) -> RgbdOptions {
    let (mut depth, mut rgb, mut truth) = (
        "# depth maps\n".to_owned(),
        String::new(),
        "# ground truth\n".to_owned(),
    );
    for sub in ["rgb", "depth"] {
        fs::create_dir(folder.join(sub)).unwrap();
    }
    for frame in 0..FRAMES {
        let seconds = recording.seconds(frame);
        // Multiplied by five, the values still fit into 16 bits.
        recording.depth_png(&folder.join(format!("depth/{seconds}.png")), frame, |mm| {
            unless_hole(mm, |mm| 5 * mm)
        });
        writeln!(depth, "{seconds} depth/{seconds}.png").unwrap();
        // Colours are seven milliseconds later.
        let name = format!("rgb/{frame}.png");
        recording.color_png(&folder.join(&name), frame);
        let later = recording.times_us[frame] + 7000;
        writeln!(rgb, "{}.{:06} {name}", later / 1_000_000, later % 1_000_000).unwrap();
        let (_, turn, at) = recording.poses[frame].to_scale_rotation_translation();
        let [x, y, z, w] = turn.to_array();
        writeln!(truth, "{seconds} {} {} {} {x} {y} {z} {w}", at.x, at.y, at.z).unwrap();
    }
    fs::write(folder.join("depth.txt"), depth).unwrap();
    fs::write(folder.join("rgb.txt"), rgb).unwrap();
    fs::write(folder.join("groundtruth.txt"), truth).unwrap();
    RgbdOptions::default()
}

fn icl(recording: &Recording, folder: &Path) -> RgbdOptions {
    for frame in 0..FRAMES {
        let points = recording.points(frame);
        let lengths = points.iter().map(|point| match point.length() {
            length if length.is_finite() => length.to_string(),
            _ => "0".to_owned(),
        });
        let text = lengths.collect::<Vec<_>>().join(" ");
        fs::write(folder.join(format!("scene_00_{frame:04}.depth")), text).unwrap();
        recording.color_png(&folder.join(format!("scene_00_{frame:04}.png")), frame);
    }
    // The size is only given by the camera.
    let [fx, fy, cx, cy] = CAMERA;
    let camera = folder.join("../icl-camera.json");
    fs::write(
        &camera,
        format!(r#"{{"width": {WIDTH}, "height": {HEIGHT}, "fx": {fx}, "fy": {fy}, "cx": {cx}, "cy": {cy}}}"#),
    )
    .unwrap();
    RgbdOptions {
        intrinsics: Some(camera.to_str().unwrap().to_owned()),
        ..RgbdOptions::default()
    }
}

fn seven_scenes(recording: &Recording, folder: &Path) -> RgbdOptions {
    for frame in 0..FRAMES {
        let file = |end: &str| folder.join(format!("frame-{frame:06}.{end}"));
        recording.depth_png(&file("depth.png"), frame, |mm| mm);
        recording.color_png(&file("color.png"), frame);
        fs::write(file("pose.txt"), Recording::rows(&recording.poses[frame])).unwrap();
    }
    named_camera()
}

/// The images of Open3D, and its camera.
fn open3d_images(recording: &Recording, folder: &Path) {
    for sub in ["color", "depth"] {
        fs::create_dir(folder.join(sub)).unwrap();
    }
    for frame in 0..FRAMES {
        recording.depth_png(&folder.join(format!("depth/{frame:05}.png")), frame, |mm| mm);
        recording.color_png(&folder.join(format!("color/{frame:05}.png")), frame);
    }
    let [fx, fy, cx, cy] = CAMERA;
    let matrix = format!("[{fx}, 0, 0, 0, {fy}, 0, {cx}, {cy}, 1]");
    let camera = format!(r#"{{"width": {WIDTH}, "height": {HEIGHT}, "intrinsic_matrix": {matrix}}}"#);
    fs::write(folder.join("camera.json"), camera).unwrap();
}

fn open3d(recording: &Recording, folder: &Path) -> RgbdOptions {
    open3d_images(recording, folder);
    let mut log = String::new();
    for (frame, pose) in recording.poses.iter().enumerate() {
        write!(log, "{frame}\t{frame}\t{}\n{}", frame + 1, Recording::rows(pose)).unwrap();
    }
    fs::write(folder.join("trajectory.log"), log).unwrap();
    RgbdOptions::default()
}

fn open3d_json(recording: &Recording, folder: &Path) -> RgbdOptions {
    open3d_images(recording, folder);
    let parameters = recording.poses.iter().map(|pose| {
        let extrinsic = DMat4::from(pose.inverse()).to_cols_array();
        serde_json::json!({ "class_name": "PinholeCameraParameters", "extrinsic": extrinsic.to_vec() })
    });
    let json = serde_json::json!({
        "class_name": "PinholeCameraTrajectory",
        "parameters": parameters.collect::<Vec<_>>(),
    });
    fs::write(folder.join("camera_trajectory.json"), json.to_string()).unwrap();
    RgbdOptions::default()
}

/// The XML of PCL's grabbers.
fn pcl_camera(folder: &Path, time_step: &str) {
    let [fx, fy, cx, cy] = CAMERA;
    let pinhole = format!(
        "<focal_length_x>{fx}</focal_length_x><focal_length_y>{fy}</focal_length_y>\
         <principal_point_x>{cx}</principal_point_x><principal_point_y>{cy}</principal_point_y>"
    );
    let xml = format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<rgb>{pinhole}</rgb>\n\
         <depth>{pinhole}<z_multiplication_factor>0.001</z_multiplication_factor></depth>\n"
    );
    fs::write(folder.join(format!("{time_step}.xml")), xml).unwrap();
}

/// 2011-05-10 12:38:22 and the microseconds.
fn pcl_time_step(recording: &Recording, frame: usize) -> String {
    format!("frame_20110510T123822.{:06}", recording.times_us[frame] % 1_000_000)
}

fn pcl_tiff(recording: &Recording, folder: &Path) -> RgbdOptions {
    for frame in 0..FRAMES {
        let time_step = pcl_time_step(recording, frame);
        let mut depth = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut depth).unwrap();
        encoder
            .write_image::<colortype::Gray16>(WIDTH, HEIGHT, &recording.depths[frame])
            .unwrap();
        fs::write(folder.join(format!("{time_step}_depth.tiff")), depth.into_inner()).unwrap();
        let mut color = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut color).unwrap();
        encoder
            .write_image::<colortype::RGB8>(WIDTH, HEIGHT, &recording.colors[frame].concat())
            .unwrap();
        fs::write(folder.join(format!("{time_step}_rgb.tiff")), color.into_inner()).unwrap();
        pcl_camera(folder, &time_step);
    }
    RgbdOptions::default()
}

pub(crate) fn lzf(unpacked: &[u8]) -> Vec<u8> {
    let mut packed = vec![0; lzf_rust::max_compressed_size(unpacked.len())];
    let count = lzf_rust::compress(unpacked, &mut packed).unwrap();
    packed.truncate(count);
    packed
}

pub(crate) fn pclzf(kind: &str, unpacked: &[u8]) -> Vec<u8> {
    let packed = lzf(unpacked);
    let mut bytes = b"PCLZF".to_vec();
    bytes.extend([WIDTH, HEIGHT].into_iter().flat_map(u32::to_le_bytes));
    bytes.extend(format!("{kind:16}").into_bytes());
    bytes.extend((packed.len() as u32).to_le_bytes());
    bytes.extend((unpacked.len() as u32).to_le_bytes());
    bytes.extend(packed);
    bytes
}

fn pcl_lzf(recording: &Recording, folder: &Path) -> RgbdOptions {
    for frame in 0..FRAMES {
        let time_step = pcl_time_step(recording, frame);
        let depth: Vec<u8> = recording.depths[frame].iter().flat_map(|mm| mm.to_le_bytes()).collect();
        fs::write(
            folder.join(format!("{time_step}_depth.pclzf")),
            pclzf("depth16", &depth),
        )
        .unwrap();
        let colors = &recording.colors[frame];
        let planes: Vec<u8> = (0..3)
            .flat_map(|channel| colors.iter().map(move |color| color[channel]))
            .collect();
        fs::write(folder.join(format!("{time_step}_rgb.pclzf")), pclzf("rgb24", &planes)).unwrap();
        pcl_camera(folder, &time_step);
    }
    RgbdOptions::default()
}

fn sun(recording: &Recording, folder: &Path) -> RgbdOptions {
    for sub in ["image", "depth", "extrinsics"] {
        fs::create_dir(folder.join(sub)).unwrap();
    }
    let mut poses = String::new();
    for frame in 0..FRAMES {
        // The second number is a time, which differs.
        recording.depth_png(
            &folder.join(format!("depth/{:07}-{:012}.png", frame + 1, 33 * frame)),
            frame,
            |mm| mm.rotate_left(3),
        );
        recording.color_png(
            &folder.join(format!("image/{:07}-{:012}.png", frame + 1, 33 * frame + 5)),
            frame,
        );
        let rows = Recording::rows(&recording.poses[frame]);
        poses.extend(rows.split_inclusive('\n').take(3));
    }
    let [fx, fy, cx, cy] = CAMERA;
    fs::write(
        folder.join("intrinsics.txt"),
        format!("{fx} 0 {cx}\n0 {fy} {cy}\n0 0 1\n"),
    )
    .unwrap();
    fs::write(folder.join("extrinsics/20130101.txt"), poses).unwrap();
    RgbdOptions::default()
}

fn nyu(recording: &Recording, folder: &Path) -> RgbdOptions {
    for frame in 0..FRAMES {
        let seconds = recording.seconds(frame);
        let code = |mm: u16| {
            let metres = f64::from(mm) / 1000.0;
            unless_hole(mm, |_| ((1092.5 - 351.3 / metres).round() as u16).swap_bytes())
        };
        let codes: Vec<u16> = recording.depths[frame].iter().map(|&mm| code(mm)).collect();
        fs::write(
            folder.join(format!("d-{seconds}-{frame}.pgm")),
            gray(&codes, ImageFormat::Pnm),
        )
        .unwrap();
        let color = rgb(&recording.colors[frame], ImageFormat::Pnm);
        fs::write(folder.join(format!("r-{seconds}-{}.ppm", 77 + frame)), color).unwrap();
    }
    named_camera()
}

fn patterns(recording: &Recording, folder: &Path) -> RgbdOptions {
    fs::create_dir(folder.join("out")).unwrap();
    for frame in 0..FRAMES {
        recording.depth_png(&folder.join(format!("out/z{frame}.png")), frame, |mm| {
            unless_hole(mm, |mm| 10 * mm)
        });
        recording.color_png(&folder.join(format!("out/c{frame}.png")), frame);
    }
    let poses: String = recording
        .poses
        .iter()
        .map(|pose| Recording::rows(pose).replace('\n', " ") + "\n")
        .collect();
    fs::write(folder.join("poses.txt"), poses).unwrap();
    RgbdOptions {
        depth: Some("out/z*.png".to_owned()),
        color: Some("out/c*.png".to_owned()),
        depth_scale: Some(10_000.0),
        poses: Some(folder.join("poses.txt")),
        ..named_camera()
    }
}

fn floats(recording: &Recording, folder: &Path) -> RgbdOptions {
    for frame in 0..FRAMES {
        let hole = [f32::NAN, f32::INFINITY, -1.0][frame];
        let metres = recording.depths[frame].iter().map(|&mm| match mm {
            0 => 0.0,
            u16::MAX => hole,
            mm => f32::from(mm) / 1000.0,
        });
        let mut depth = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut depth).unwrap();
        encoder
            .write_image::<colortype::Gray32Float>(WIDTH, HEIGHT, &metres.collect::<Vec<_>>())
            .unwrap();
        fs::write(folder.join(format!("depth_{frame}.tif")), depth.into_inner()).unwrap();
        recording.color_png(&folder.join(format!("color_{frame}.png")), frame);
    }
    RgbdOptions {
        depth: Some("depth_*.tif".to_owned()),
        color: Some("color_*.png".to_owned()),
        ..named_camera()
    }
}
