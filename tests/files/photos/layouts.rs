//! Folders as other programs lay them out: names without extensions, copies, results that lie elsewhere.

use super::scene::Scene;
use super::{assert_shows, error_of, folder_with, read};
use glam::{DVec2, DVec3};
use image::{Rgb, RgbImage, Rgba, RgbaImage};
use pointreel::photos::{self, PhotoImage, ViewSet};
use pointreel::progress::Progress;
use pointreel::source::{self, OpenOptions};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

const IDENTITY: &str = "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]";

fn frames(names: &[&str]) -> String {
    let frames: Vec<String> = names
        .iter()
        .map(|name| format!(r#"{{"file_path": "{name}", "transform_matrix": {IDENTITY}}}"#))
        .collect();
    frames.join(",")
}

fn save(picture: &RgbImage, path: &Path) {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    picture.save(path).unwrap();
}

fn names(set: &ViewSet) -> Vec<&str> {
    set.photos.iter().map(|photo| photo.name.as_str()).collect()
}

/// The synthetic sets of NeRF: no extensions, a file for each of three parts, transparent where nothing is.
#[test]
fn synthetic_nerf_sets_name_images_without_extensions() {
    let folder = tempfile::tempdir().unwrap();
    for part in ["train", "test"] {
        fs::create_dir(folder.path().join(part)).unwrap();
        for index in 0..2 {
            let mut picture = RgbaImage::from_pixel(8, 8, Rgba([9, 9, 9, 0]));
            picture.put_pixel(3, 3, Rgba([200, 100, 50, 255]));
            picture
                .save(folder.path().join(format!("{part}/r_{index}.png")))
                .unwrap();
        }
        let frames = frames(&[&format!("./{part}/r_0"), &format!("./{part}/r_1")]);
        let text = format!(r#"{{"camera_angle_x": 0.69, "frames": [{frames}]}}"#);
        fs::write(folder.path().join(format!("transforms_{part}.json")), text).unwrap();
    }
    let set = read(folder.path());
    assert_eq!(names(&set), ["./train/r_0", "./train/r_1"]);
    let image = PhotoImage::read(&set.photos[0]).unwrap();
    assert_eq!((image.pixels()[27], image.pixels()[0][3]), ([200, 100, 50, 255], 0));
    fs::remove_file(folder.path().join("transforms_train.json")).unwrap();
    assert_eq!(names(&read(folder.path())), ["./test/r_0", "./test/r_1"]);
}

#[test]
fn transforms_angles_may_be_vertical_or_in_degrees() {
    let angle = 2.0 * (24.0_f64 / 50.0).atan();
    for key in [
        format!(r#""camera_angle_y": {angle}"#),
        format!(r#""y_fov": {}"#, angle.to_degrees()),
        format!(r#""x_fov": {}"#, (2.0 * (32.0_f64 / 50.0).atan()).to_degrees()),
    ] {
        // With the byte order mark that Windows editors write.
        let text = format!("\u{feff}{{{key}, \"frames\": [{}]}}", frames(&["a"]));
        assert_shows(&[("transforms.json", &text)], [0.1, 0.2, -1.0], [36.5, 13.5]);
    }
}

#[test]
fn transforms_lens_models_match_in_any_case_and_others_are_rejected_by_name() {
    for model in ["PERSPECTIVE", "pinhole", "OpenCV"] {
        let text = format!(
            r#"{{"fl_x": 50, "camera_model": "{model}", "frames": [{}]}}"#,
            frames(&["a.png"])
        );
        assert_shows(&[("transforms.json", &text)], [0.0, 0.0, -1.0], [31.5, 23.5]);
    }
    for (key, name) in [
        (r#""camera_model": "EQUIRECTANGULAR""#, "EQUIRECTANGULAR"),
        (r#""ftheta_p0": 0.1"#, "ftheta_p0"),
        (r#""latlong": true"#, "latlong"),
    ] {
        let text = format!(r#"{{"fl_x": 50, {key}, "frames": [{}]}}"#, frames(&["a.png"]));
        let folder = folder_with(&[("transforms.json", &text)]);
        let error = error_of(folder.path());
        assert!(
            error.contains(&format!("camera model is {name}, expected PINHOLE")),
            "{error}"
        );
    }
}

#[test]
fn images_of_a_meshroom_project_are_found_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("MeshroomCache/StructureFromMotion/0f3a");
    Scene::simple().write_meshroom(&run, [1, 2, 6]);
    fs::rename(run.join("sfm.json"), run.join("cameras.sfm")).unwrap();
    fs::rename(run.join("images"), folder.path().join("photos")).unwrap();
    for opened in [
        folder.path().to_owned(),
        folder.path().join("MeshroomCache"),
        run.join("cameras.sfm"),
    ] {
        let set = read(&opened);
        assert_eq!(set.photos.len(), 6, "{}", opened.display());
    }
}

/// Output of `Bundle2PMVS` and COLMAP for PMVS: numbered copies, next to the names of their originals.
#[test]
fn copies_for_pmvs_are_the_images_of_the_adjacent_bundle() {
    let folder = tempfile::tempdir().unwrap();
    let camera = "50 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n";
    let nowhere = "0 0 0\n".repeat(5);
    let bundle = format!("# Bundle file v0.3\n3 0\n{camera}{nowhere}{camera}");
    fs::create_dir(folder.path().join("pmvs")).unwrap();
    fs::write(folder.path().join("pmvs/bundle.rd.out"), bundle).unwrap();
    fs::write(folder.path().join("pmvs/list.rd.txt"), "b.rd.jpg\nc.rd.jpg\na.jpg\n").unwrap();
    // The image that the second copy was made from, with its distortion.
    save(&RgbImage::new(64, 48), &folder.path().join("a.jpg"));
    for copy in ["00000000.jpg", "00000001.jpg"] {
        save(&RgbImage::new(64, 48), &folder.path().join("pmvs/visualize").join(copy));
    }
    let set = read(folder.path());
    let files: Vec<_> = set.photos.iter().map(|photo| photo.path.file_name().unwrap()).collect();
    // In the order of their names in the list.
    assert_eq!(files, ["00000001.jpg", "00000000.jpg"]);
}

#[test]
fn points_of_a_model_may_be_in_a_converted_file() {
    let files = [
        ("cameras.txt", "1 PINHOLE 64 48 50 50 32 24\n"),
        ("images.txt", "1 1 0 0 0 0 0 0 1 a.png\n\n"),
        ("points3D.ply", "ply"),
    ];
    let folder = folder_with(&files);
    let set = read(folder.path());
    assert_eq!(set.points_file, Some(folder.path().join("points3D.ply")));
    assert_eq!(set.notes, [] as [String; 0]);
    fs::remove_file(folder.path().join("points3D.ply")).unwrap();
    assert!(read(folder.path()).notes[0].contains("points3D.txt is missing"));
}

#[test]
fn a_scene_with_only_distorted_images_names_their_lens() {
    let folder = folder_with(&[]);
    let model = folder.path().join("dslr_calibration_jpg");
    fs::create_dir(&model).unwrap();
    let camera = "1 THIN_PRISM_FISHEYE 64 48 50 50 32 24 0 0 0 0 0 0 0 0\n";
    fs::write(model.join("cameras.txt"), camera).unwrap();
    fs::write(model.join("images.txt"), "1 1 0 0 0 0 0 0 1 dslr_images/a.png\n\n").unwrap();
    assert!(error_of(folder.path()).contains("camera model is THIN_PRISM_FISHEYE"));
}

#[test]
fn images_of_unsupported_formats_give_one_note_with_advice() {
    let folder = tempfile::tempdir().unwrap();
    let mut list = String::new();
    for index in 0..4 {
        writeln!(list, "{index} 1 0 0 0 0 0 0 1 {index}.heic\n").unwrap();
    }
    fs::write(folder.path().join("cameras.txt"), "1 PINHOLE 64 48 50 50 32 24\n").unwrap();
    fs::write(folder.path().join("images.txt"), list).unwrap();
    for index in 0..4 {
        fs::write(folder.path().join(format!("{index}.heic")), b"\0\0\0\x18ftypheic").unwrap();
    }
    let error = error_of(folder.path());
    assert!(
        error.contains("4 images were skipped: 0.heic, 1.heic, 2.heic and 1 more: it has an unsupported"),
        "{error}"
    );
    assert!(error.contains("convert it to JPEG, PNG or WebP"), "{error}");
    // A converted copy with the same name is used instead.
    save(&RgbImage::new(64, 48), &folder.path().join("2.jpg"));
    assert_eq!(names(&read(folder.path())), ["2.heic"]);
}

const CAM: &str = "extrinsic\n0 -1 0 2\n1 0 0 0\n0 0 1 0\n0 0 0 1\n\nintrinsic\n50 0 32\n0 60 24\n0 0 1\n\n";

/// A camera rotated by 90° about its axis: the world's x is down, its y to the left.
#[test]
fn mvsnet_cameras_count_from_the_corner_and_state_their_depths() {
    let folder = tempfile::tempdir().unwrap();
    for index in 0..2 {
        save(
            &RgbImage::new(64, 48),
            &folder.path().join(format!("images/{index:08}.jpg")),
        );
    }
    let cams = folder.path().join("cams");
    fs::create_dir(&cams).unwrap();
    fs::write(cams.join("00000000_cam.txt"), format!("{CAM}425.0 2.5\n")).unwrap();
    fs::write(cams.join("00000001_cam.txt"), format!("{CAM}2 0.5 192 9\n")).unwrap();
    fs::write(folder.path().join("pair.txt"), "2\n0\n1 1 0.5\n1\n1 0 0.5\n").unwrap();
    for opened in [folder.path().to_owned(), cams.clone(), cams.join("00000001_cam.txt")] {
        let found = photos::find(&opened).unwrap().unwrap();
        assert_eq!(found.format(), "MVSNet (cams)");
        let set = found.read().unwrap();
        assert_eq!(set.photos.len(), 2);
        let pixel = set.photos[0].project(DVec3::new(0.1, 1.8, 1.0)).unwrap();
        assert!(pixel.distance(DVec2::new(31.5 + 10.0, 23.5 + 6.0)) < 1e-9, "{pixel}");
        let ranges: Vec<_> = set.photos.iter().map(|photo| photo.depth_range).collect();
        assert_eq!(ranges, [Some([425.0, 905.0]), Some([2.0, 9.0])]);
    }
    // A broken file costs its own image, and a set of only broken files is an error.
    let reason = |name: &str| format!("{name}_cam.txt, line 1: expected the word `extrinsic`");
    fs::write(cams.join("00000001_cam.txt"), "425.0 2.5\n").unwrap();
    let set = read(folder.path());
    assert_eq!(names(&set), ["00000000"]);
    assert_eq!(set.notes.len(), 1, "{:?}", set.notes);
    assert!(set.notes[0].contains(&reason("00000001")), "{:?}", set.notes);
    fs::write(cams.join("00000000_cam.txt"), "425.0 2.5\n").unwrap();
    let error = error_of(folder.path());
    for name in ["00000000", "00000001"] {
        assert!(error.contains(&reason(name)), "{error}");
    }
}

const PAIR: &str = "cam0=[50 0 30.5; 0 50 24; 0 0 1]\ncam1=[50 0 33; 0 50 24; 0 0 1]\ndoffs=2.5\nbaseline=200\n\
                    width=64\nheight=48\nndisp=30\nvmin=2.5\nvmax=17.5\n";

/// A disparity of 7.5 is a depth of 200 · 50 / (7.5 + 2.5) = 1000.
#[test]
fn disparities_of_a_rectified_pair_become_depths() {
    let folder = folder_with(&[("calib.txt", PAIR)]);
    for index in 0..2 {
        save(&RgbImage::new(64, 48), &folder.path().join(format!("im{index}.png")));
    }
    for opened in [folder.path().to_owned(), folder.path().join("calib.txt")] {
        let set = read(&opened);
        let point = DVec3::new(40.0, -20.0, 1000.0);
        let [left, right] = [0, 1].map(|photo: usize| set.photos[photo].project(point).unwrap());
        assert!(left.distance(DVec2::new(32.5, 23.0)) < 1e-9, "{left}");
        assert!((left.x - right.x - 7.5).abs() < 1e-9 && left.y == right.y, "{right}");
        assert_eq!(set.photos[1].depth_range, Some([500.0, 2000.0]));
    }
    let broken = folder_with(&[("calib.txt", &PAIR.replace("baseline=200", "baseline=x"))]);
    assert!(
        error_of(broken.path()).contains("calib.txt, baseline: expected millimetres between the cameras, found `x`")
    );
}

#[test]
fn llff_depths_are_the_depth_range_of_its_images() {
    let folder = tempfile::tempdir().unwrap();
    Scene::simple().write_llff(folder.path());
    let file = folder.path().join("poses_bounds.npy");
    let mut bytes = fs::read(&file).unwrap();
    let end = bytes.len();
    bytes[end - 16..end - 8].copy_from_slice(&1.25_f64.to_le_bytes());
    bytes[end - 8..].copy_from_slice(&8.5_f64.to_le_bytes());
    // For the one before, the far bound is smaller than the near one.
    bytes[end - 152..end - 144].copy_from_slice(&3.0_f64.to_le_bytes());
    bytes[end - 144..end - 136].copy_from_slice(&2.0_f64.to_le_bytes());
    fs::write(&file, bytes).unwrap();
    let set = read(folder.path());
    let ranges: Vec<_> = set.photos.iter().rev().map(|photo| photo.depth_range).take(2).collect();
    assert_eq!(ranges, [Some([1.25, 8.5]), None]);
}

/// Middlebury's datasets are distributed whole, as a ring and as a sparse ring, of the same images.
#[test]
fn the_longest_of_several_par_files_is_read() {
    let folder = folder_with(&[]);
    let row = "a.png 50 0 32 0 50 24 0 0 1 1 0 0 0 1 0 0 0 1 0 0 0\n";
    fs::write(folder.path().join("aR_par.txt"), format!("1\n{row}")).unwrap();
    fs::write(folder.path().join("a_par.txt"), format!("2\n{row}{row}")).unwrap();
    fs::write(folder.path().join("aSR_par.txt"), format!("1\n{row}")).unwrap();
    assert_eq!(read(folder.path()).photos.len(), 2);
}

fn opened(path: &Path) -> Result<usize, String> {
    let inputs: Vec<PathBuf> = vec![path.to_owned()];
    let source = source::open(&inputs, &OpenOptions::default(), &Progress::default());
    let source = source.map_err(|error| error.to_string())?;
    Ok(source.posed_images(0).map_or(0, |set| set.photos.len()))
}

/// A list next to images has the extension of a cloud, and is not one.
#[test]
fn folders_above_and_next_to_sets_report_their_contents() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("data/temple");
    Scene::simple().write_middlebury(&scene);
    fs::write(folder.path().join("README.txt"), "Three views of a temple.").unwrap();
    assert_eq!(opened(&folder.path().join("data")), Ok(6));
    let other = folder.path().join("data/dino");
    Scene::simple().write_middlebury(&other);
    let error = opened(&folder.path().join("data")).unwrap_err();
    assert!(
        error.contains("data holds 2 sequences, which are not played one after the other: choose one of"),
        "{error}"
    );
    for set in [&other, &scene] {
        let name = set.file_name().unwrap().to_string_lossy();
        let choice = format!("\n  {name} (1 file): {}", set.display());
        assert!(error.contains(&choice), "{error}");
    }

    let pictures = tempfile::tempdir().unwrap();
    save(
        &RgbImage::from_pixel(4, 4, Rgb([1, 2, 3])),
        &pictures.path().join("rgb/0.png"),
    );
    fs::create_dir(pictures.path().join("pose")).unwrap();
    fs::write(pictures.path().join("intrinsics.txt"), "50 32 24 0.\n0. 0. 0.\n").unwrap();
    fs::write(pictures.path().join("bbox.txt"), "-1 -1 -1 1 1 1 .1\n").unwrap();
    let error = opened(pictures.path()).unwrap_err();
    assert!(error.contains("cameras of NSVF"), "{error}");
}
