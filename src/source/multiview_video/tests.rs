//! A moving ball, recorded by cameras whose every ray is known, written in each layout and read again.

use super::*;
use crate::photos;
use glam::{DMat3, DVec2, DVec3};
use image::{Rgb, RgbImage};
use std::fmt::Write as _;
use std::fs;

const SIZE_PX: [u32; 2] = [120, 96];
const FOCAL_PX: f64 = 150.0;
const RADIUS: f64 = 1.0;

/// Cameras around the ball, `turn` further for each.
#[derive(Clone, Copy)]
struct MultiView {
    cameras: usize,
    step_rad: f64,
    /// Turns all cameras.
    turned_rad: f64,
    /// From one camera to the next, to the right of the centre of the row.
    shift: f64,
}

const MULTIVIEW: MultiView = MultiView {
    cameras: 4,
    step_rad: 0.2,
    turned_rad: 0.0,
    shift: 0.0,
};

/// Position of the ball.
fn ball(time_step: usize) -> DVec3 {
    DVec3::new(0.35 * time_step as f64 - 0.3, 0.1, 0.2 * time_step as f64)
}

fn color(on_ball: DVec3) -> [u8; 3] {
    let waves = |frequency: f64| {
        let [x, y, z] = (frequency * on_ball).to_array();
        DVec3::new(
            (x + 0.3 * y).sin() * (z + y).cos(),
            (y - 0.4 * z).sin(),
            (z + 0.5 * x).sin(),
        )
    };
    let color = 0.5 + 0.2 * waves(5.0) + 0.25 * waves(13.0);
    color.to_array().map(|channel| (255.0 * channel.clamp(0.0, 1.0)) as u8)
}

impl MultiView {
    /// The axes of a camera (right, down, forward) as columns, and its place.
    fn camera(self, camera: usize) -> (DMat3, DVec3) {
        let turn = self.turned_rad + self.step_rad * camera as f64;
        let center = DVec3::new(5.0 * turn.sin(), -0.6, -5.0 * turn.cos());
        let forward = -center.normalize();
        let right = DVec3::Y.cross(forward).normalize();
        let aside = self.shift * (camera as f64 - 0.5 * (self.cameras - 1) as f64);
        (
            DMat3::from_cols(right, forward.cross(right), forward),
            center + aside * right,
        )
    }

    fn textured(self, camera: usize, time_step: usize) -> RgbImage {
        let (axes, center) = self.camera(camera);
        let ball = ball(time_step);
        RgbImage::from_fn(SIZE_PX[0], SIZE_PX[1], |x, y| {
            let pixel = DVec2::new(f64::from(x), f64::from(y)) - principal();
            let ray = (axes * (pixel / FOCAL_PX).extend(1.0)).normalize();
            let toward = ball - center;
            let along = toward.dot(ray);
            let inside = RADIUS * RADIUS - (toward.length_squared() - along * along);
            if inside < 0.0 {
                return Rgb([0; 3]);
            }
            let place = center + (along - inside.sqrt()) * ray;
            Rgb(color((place - ball) / RADIUS))
        })
    }

    fn save(self, camera: usize, time_step: usize, path: &Path) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        self.textured(camera, time_step).save(path).unwrap();
    }

    /// A par file of Middlebury.
    fn write_par(self, path: &Path, name: impl Fn(usize) -> String) {
        let mut text = format!("{}\n", self.cameras);
        let [cx, cy] = principal().to_array();
        for camera in 0..self.cameras {
            let (axes, center) = self.camera(camera);
            let turn = axes.transpose();
            let rows: Vec<f64> = axes.to_cols_array().to_vec();
            let shift = -(turn * center);
            write!(text, "{} {FOCAL_PX} 0 {cx} 0 {FOCAL_PX} {cy} 0 0 1", name(camera)).unwrap();
            for number in rows.into_iter().chain(shift.to_array()) {
                write!(text, " {number}").unwrap();
            }
            text.push('\n');
        }
        fs::write(path, text).unwrap();
    }

    fn write_colmap(self, folder: &Path, name: impl Fn(usize) -> String) {
        fs::create_dir_all(folder).unwrap();
        let [cx, cy] = (principal() + 0.5).to_array();
        let [width, height] = SIZE_PX;
        let cameras = format!("1 PINHOLE {width} {height} {FOCAL_PX} {FOCAL_PX} {cx} {cy}\n");
        fs::write(folder.join("cameras.txt"), cameras).unwrap();
        let mut images = String::new();
        for camera in 0..self.cameras {
            let (axes, center) = self.camera(camera);
            let turn = axes.transpose();
            let quaternion = glam::DQuat::from_mat3(&turn);
            let [x, y, z] = (-(turn * center)).to_array();
            let [qx, qy, qz, qw] = quaternion.to_array();
            let name = name(camera);
            // One point that all cameras see, where the ball starts.
            let seen = turn * (ball(0) - center);
            let seen = DVec2::new(seen.x, seen.y) / seen.z * FOCAL_PX + principal() + 0.5;
            writeln!(
                images,
                "{} {qw} {qx} {qy} {qz} {x} {y} {z} 1 {name}\n{} {} 1",
                camera + 1,
                seen.x,
                seen.y
            )
            .unwrap();
        }
        fs::write(folder.join("images.txt"), images).unwrap();
        let [x, y, z] = ball(0).to_array();
        let track: Vec<String> = (1..=self.cameras).map(|image| format!("{image} 0")).collect();
        fs::write(
            folder.join("points3D.txt"),
            format!("1 {x} {y} {z} 9 9 9 0.1 {}\n", track.join(" ")),
        )
        .unwrap();
    }

    /// `transforms.json` of these images: name, camera, time.
    fn write_transforms(self, path: &Path, photos: &[(String, usize, Option<f64>)]) {
        let frames = photos.iter().map(|(name, camera, time)| {
            let (axes, center) = self.camera(*camera);
            let opengl = DMat3::from_cols(axes.x_axis, -axes.y_axis, -axes.z_axis);
            let rows = [0, 1, 2].map(|row| opengl.row(row).extend(center[row]).to_array());
            let mut frame = serde_json::json!({
                "file_path": name,
                "transform_matrix": [rows[0], rows[1], rows[2], [0.0, 0.0, 0.0, 1.0]],
            });
            if let Some(time) = time {
                frame["time"] = (*time).into();
            }
            frame
        });
        let [cx, cy] = (principal() + 0.5).to_array();
        let file = serde_json::json!({
            "fl_x": FOCAL_PX, "fl_y": FOCAL_PX, "cx": cx, "cy": cy, "w": SIZE_PX[0], "h": SIZE_PX[1],
            "frames": frames.collect::<Vec<_>>(),
        });
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, file.to_string()).unwrap();
    }
}

fn principal() -> DVec2 {
    DVec2::new(60.5, 46.0)
}

fn open(folder: &Path) -> Option<MultiviewVideo> {
    open_with(folder, &OpenOptions::default())
}

/// As [`crate::source::open`] does it.
fn open_with(folder: &Path, options: &OpenOptions) -> Option<MultiviewVideo> {
    let inputs = [folder.to_owned()];
    match photos::find(folder).unwrap() {
        Some(found) => {
            let calibration = found.calibration().unwrap();
            MultiviewVideo::of(calibration, &inputs, options).unwrap().ok()
        }
        None => MultiviewVideo::of_sets(&inputs, options),
    }
}

fn decoded(video: &MultiviewVideo, index: usize) -> RawCloud {
    let entry = video.entry(index);
    let frame = video.decoder().decode(index, &entry, usize::MAX, &Progress::default());
    frame.unwrap().cloud
}

/// The share of points that are on the ball of a time step: half a pixel between neighbours is a depth of 0.08.
fn share_on_ball(cloud: &RawCloud, time_step: usize) -> f64 {
    let is_on = |at: &usize| {
        let place = cloud.positions.get(*at);
        (place.distance(ball(time_step)) - RADIUS).abs() < 0.08
    };
    let count = cloud.positions.len();
    (0..count).filter(is_on).count() as f64 / count as f64
}

/// Compares poses, images and points of all time steps with the scene.
fn assert_multiview_videos(video: &MultiviewVideo, multiview: impl Fn(usize) -> MultiView, time_steps: usize) {
    assert_eq!(video.frames(), 0..time_steps);
    for time_step in 0..time_steps {
        let multiview = multiview(time_step);
        let set = video.posed_images(time_step).unwrap();
        assert!(Arc::ptr_eq(&set, &video.posed_images(time_step).unwrap()));
        assert_eq!(set.photos.len(), multiview.cameras);
        for (camera, photo) in set.photos.iter().enumerate() {
            let (axes, center) = multiview.camera(camera);
            assert!(photo.center().distance(center) < 1e-6);
            let place = ball(time_step) + DVec3::new(0.2, -0.3, 0.1);
            let seen = axes.transpose() * (place - center);
            let expected = DVec2::new(seen.x, seen.y) / seen.z * FOCAL_PX + principal();
            assert!(photo.project(place).unwrap().distance(expected) < 1e-3);
            let image = image::open(&photo.path).unwrap().into_rgb8();
            assert_eq!(
                image,
                multiview.textured(camera, time_step),
                "camera {camera} of moment {time_step}"
            );
        }
        if time_step == 1 {
            continue;
        }
        let cloud = decoded(video, time_step);
        assert!(cloud.warnings.is_empty(), "{:?}", cloud.warnings);
        assert!(cloud.positions.len() > 1000, "{} points", cloud.positions.len());
        let (own, other) = (
            share_on_ball(&cloud, time_step),
            share_on_ball(&cloud, usize::from(time_step == 0)),
        );
        // Two views alone have no third one that reveals mistakes.
        let min = if multiview.cameras > 2 { 0.9 } else { 0.8 };
        assert!(own > min && other < 0.5, "{own} on its ball, {other} on another");
    }
}

#[test]
fn a_folder_per_camera_is_a_multiview_video() {
    let folder = tempfile::tempdir().unwrap();
    // COLMAP has calibrated the first time step.
    MULTIVIEW.write_colmap(&folder.path().join("sparse/0"), |camera| {
        format!("cam{camera}/0008.png")
    });
    for camera in 0..4 {
        for time_step in 0..3 {
            let name = format!("images/cam{camera}/{:04}.png", time_step + 8);
            MULTIVIEW.save(camera, time_step, &folder.path().join(name));
        }
    }
    let video = open(folder.path()).unwrap();
    assert_multiview_videos(&video, |_| MULTIVIEW, 3);
    assert_eq!(video.entry(1).number, Some(9));
    let set = video.posed_images(1).unwrap();
    assert_eq!(set.photos[3].name, "cam3");
    // Cameras are judged by the points that calibrated them.
    let error = video.posed_images(0).unwrap().reprojection_error(3).unwrap();
    assert!(error.count == 1 && error.rms_px < 1e-3, "{error:?}");
    assert!(set.reprojection_error(3).is_none());
}

#[test]
fn a_folder_per_time_step_is_a_multiview_video() {
    let folder = tempfile::tempdir().unwrap();
    MULTIVIEW.write_par(&folder.path().join("rig_par.txt"), |camera| {
        format!("view_{camera}.png")
    });
    for (camera, time_step) in (0..4).flat_map(|camera| (0..3).map(move |time_step| (camera, time_step))) {
        let name = format!("frame_{time_step}/view_{camera}.png");
        MULTIVIEW.save(camera, time_step, &folder.path().join(name));
    }
    let video = open(folder.path()).unwrap();
    assert_multiview_videos(&video, |_| MULTIVIEW, 3);
    assert_eq!(video.entry(2).name, "frame_2");
    assert_eq!(video.posed_images(0).unwrap().photos[1].name, "view_1");
}

#[test]
fn each_time_step_may_have_its_own_calibration() {
    let folder = tempfile::tempdir().unwrap();
    let multiview = |time_step: usize| MultiView {
        turned_rad: 0.3 * time_step as f64,
        ..MULTIVIEW
    };
    for time_step in 0..3 {
        let set = folder.path().join(format!("frame_{time_step:03}"));
        let mut photos = Vec::new();
        for camera in 0..4 {
            multiview(time_step).save(camera, time_step, &set.join(format!("images/{camera}.png")));
            photos.push((format!("images/{camera}.png"), camera, None));
        }
        multiview(time_step).write_transforms(&set.join("transforms.json"), &photos);
    }
    assert_multiview_videos(&open(folder.path()).unwrap(), multiview, 3);
}

#[test]
fn a_calibration_may_state_when_each_image_was_taken() {
    let folder = tempfile::tempdir().unwrap();
    let mut photos = Vec::new();
    for (time_step, camera) in (0..3).flat_map(|time_step| (0..4).map(move |camera| (time_step, camera))) {
        let name = format!("images/{time_step}_{camera}.png");
        MULTIVIEW.save(camera, time_step, &folder.path().join(&name));
        photos.push((name, camera, Some(time_step as f64 / 2.0)));
    }
    // Their order does not matter.
    photos.reverse();
    photos.sort_by_key(|(_, camera, _)| *camera);
    MULTIVIEW.write_transforms(&folder.path().join("transforms.json"), &photos);
    let video = open(folder.path()).unwrap();
    assert_multiview_videos(&video, |_| MULTIVIEW, 3);
    assert!(!video.may_grow());
}

#[test]
fn two_cameras_side_by_side_are_a_multiview_video_too() {
    let folder = tempfile::tempdir().unwrap();
    let pair = MultiView {
        cameras: 2,
        ..MULTIVIEW
    };
    pair.write_par(&folder.path().join("rig_par.txt"), |camera| {
        ["left", "right"][camera].to_owned()
    });
    for (camera, time_step) in (0..2).flat_map(|camera| (0..2).map(move |time_step| (camera, time_step))) {
        let name = format!("{}/{time_step}.png", ["left", "right"][camera]);
        pair.save(camera, time_step, &folder.path().join(name));
    }
    assert_multiview_videos(&open(folder.path()).unwrap(), |_| pair, 2);
}

/// Their target and its distance are unknown.
#[test]
fn parallel_cameras_are_a_multiview_video_too() {
    let folder = tempfile::tempdir().unwrap();
    let row = MultiView {
        cameras: 4,
        step_rad: 0.0,
        shift: 0.5,
        ..MULTIVIEW
    };
    row.write_par(&folder.path().join("rig_par.txt"), |camera| format!("cam{camera}.png"));
    for (camera, time_step) in (0..4).flat_map(|camera| [0, 1].map(|time_step| (camera, time_step))) {
        row.save(
            camera,
            time_step,
            &folder.path().join(format!("cam{camera}/{time_step}.png")),
        );
    }
    assert_multiview_videos(&open(folder.path()).unwrap(), |_| row, 2);
}

/// Three time steps by a folder for each camera.
fn multiview_by_cameras(folder: &Path) {
    MULTIVIEW.write_par(&folder.join("rig_par.txt"), |camera| format!("cam{camera}.png"));
    for camera in 0..4 {
        for time_step in 0..3 {
            MULTIVIEW.save(camera, time_step, &folder.join(format!("cam{camera}/{time_step}.png")));
        }
    }
}

#[test]
fn a_missing_image_is_skipped_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    multiview_by_cameras(folder.path());
    fs::remove_file(folder.path().join("cam0/2.png")).unwrap();
    fs::write(folder.path().join("cam3/2.png"), b"broken").unwrap();
    let video = open(folder.path()).unwrap();
    assert_eq!(video.frames(), 0..3);
    let set = video.posed_images(2).unwrap();
    let has_file: Vec<bool> = set.photos.iter().map(photos::Photo::has_file).collect();
    assert_eq!(has_file, [false, true, true, false]);
    let cloud = decoded(&video, 2);
    // One pair remains.
    assert!(share_on_ball(&cloud, 2) > 0.7);
    let warnings = cloud.warnings.join("\n");
    assert!(warnings.contains("cam0 has no image of this time step"), "{warnings}");
    assert!(
        warnings.contains("cam3 is skipped") && warnings.contains("2.png"),
        "{warnings}"
    );
    assert!(decoded(&video, 1).warnings.is_empty());
    // Loading skips missing files.
    let loaded = photos::LoadedPhotos::of(&set, 1 << 30, &Progress::default());
    let numbers: Vec<usize> = loaded
        .posed_images
        .all()
        .iter()
        .map(|posed_image| posed_image.number)
        .collect();
    assert_eq!(numbers, [1, 2]);
    assert!(loaded.notes.is_empty(), "{:?}", loaded.notes);
}

#[test]
fn a_camera_without_a_folder_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    multiview_by_cameras(folder.path());
    fs::remove_dir_all(folder.path().join("cam2")).unwrap();
    let video = open(folder.path()).unwrap();
    assert_eq!(video.about().notes, ["no folder with images was found for cam2"]);
    assert!(share_on_ball(&decoded(&video, 1), 1) > 0.9);
}

#[test]
fn points_of_a_time_step_come_from_its_file() {
    let folder = tempfile::tempdir().unwrap();
    multiview_by_cameras(folder.path());
    fs::create_dir(folder.path().join("points")).unwrap();
    for time_step in [0, 2] {
        let text = format!("{time_step} 0 0\n{time_step} 1 0\n");
        fs::write(folder.path().join(format!("points/{time_step}.xyz")), text).unwrap();
    }
    let video = open(folder.path()).unwrap();
    for time_step in [0, 2] {
        let cloud = decoded(&video, time_step);
        assert_eq!(cloud.positions.len(), 2);
        assert_eq!(cloud.positions.get(1).to_array(), [time_step as f64, 1.0, 0.0]);
        assert!(video.entry(time_step).path.ends_with(format!("points/{time_step}.xyz")));
    }
    assert!(decoded(&video, 1).positions.len() > 1000);
    let dense = OpenOptions {
        dense: true,
        ..OpenOptions::default()
    };
    let video = open_with(folder.path(), &dense).unwrap();
    assert!(decoded(&video, 0).positions.len() > 1000);
}

#[test]
fn images_of_one_time_step_are_not_a_multiview_video() {
    // A moving camera: several images of one folder are named.
    let folder = tempfile::tempdir().unwrap();
    MULTIVIEW.write_par(&folder.path().join("rig_par.txt"), |camera| {
        format!("{}/{}.png", ["left", "right"][camera % 2], camera / 2)
    });
    for camera in 0..4 {
        let name = format!("{}/{}.png", ["left", "right"][camera % 2], camera / 2);
        MULTIVIEW.save(camera, 0, &folder.path().join(name));
    }
    assert!(open(folder.path()).is_none());
    // Smaller copies of the images.
    let folder = tempfile::tempdir().unwrap();
    MULTIVIEW.write_par(&folder.path().join("rig_par.txt"), |camera| format!("{camera}.png"));
    for camera in 0..4 {
        for copy in ["images_2", "images_4", "scaled_2", "scaled_4", "images"] {
            MULTIVIEW.save(camera, 0, &folder.path().join(format!("{copy}/{camera}.png")));
        }
    }
    assert!(open(folder.path()).is_none());
    fs::remove_dir_all(folder.path().join("images")).unwrap();
    fs::remove_dir_all(folder.path().join("scaled_4")).unwrap();
    assert!(open(folder.path()).is_none());
    // Folders of scans contain no calibrations.
    let folder = tempfile::tempdir().unwrap();
    for name in ["scan_1", "scan_2"] {
        fs::create_dir(folder.path().join(name)).unwrap();
    }
    assert!(open(folder.path()).is_none());
    // A single moving camera has a time for each image.
    let folder = tempfile::tempdir().unwrap();
    let photos: Vec<(String, usize, Option<f64>)> = (0..5)
        .map(|camera| (format!("{camera}.png"), camera, Some(camera as f64)))
        .collect();
    MULTIVIEW.write_transforms(&folder.path().join("transforms.json"), &photos);
    assert!(open(folder.path()).is_none());
}

#[test]
fn new_time_steps_are_added_once_complete() {
    let folder = tempfile::tempdir().unwrap();
    multiview_by_cameras(folder.path());
    let video = open(folder.path()).unwrap();
    assert!(video.may_grow());
    let mut decoder = video.decoder();
    let save = |camera: usize, time_step: usize, age: Duration| {
        let path = folder.path().join(format!("cam{camera}/{time_step}.png"));
        MULTIVIEW.save(camera, time_step, &path);
        let file = fs::File::options().write(true).open(path).unwrap();
        file.set_modified(std::time::SystemTime::now() - age).unwrap();
    };
    let second = Duration::from_secs(1);
    assert_eq!(video.look_again().unwrap(), 0);
    (0..3).for_each(|camera| save(camera, 3, second));
    assert_eq!(video.look_again().unwrap(), 0, "the fourth camera is waited for");
    save(3, 3, second);
    (0..4).for_each(|camera| save(camera, 4, Duration::ZERO));
    assert_eq!(video.look_again().unwrap(), 1, "the next is being written");
    (0..4).for_each(|camera| save(camera, 4, second));
    (0..2).for_each(|camera| save(camera, 5, 10 * second));
    assert_eq!(video.look_again().unwrap(), 2, "the other cameras of the last are late");
    assert_eq!(video.look_again().unwrap(), 0);
    assert_eq!(video.frames(), 0..6);
    // A decoder held by a thread knows the new ones.
    let entry = video.entry(4);
    let frame = decoder.decode(4, &entry, usize::MAX, &Progress::default()).unwrap();
    assert!(share_on_ball(&frame.cloud, 4) > 0.9);
    assert!(decoder.decode(9, &entry, usize::MAX, &Progress::default()).is_err());
}
