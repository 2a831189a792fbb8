//! Sets of calibrated images: one scene in every format, the half pixel of each, and broken sets.

mod broken;
mod layouts;
mod multiview_video;
mod scene;
mod spoilt;

use glam::{DVec2, DVec3};
use image::RgbImage;
use pointreel::photos::{self, ViewSet};
use scene::Scene;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

type Writer = fn(&Scene, &Path);

/// Every format with a writer; whether it has points.
const WRITERS: &[(&str, &str, Writer, bool)] = &[
    ("COLMAP text", "COLMAP", Scene::write_colmap_text, true),
    ("COLMAP binary", "COLMAP", Scene::write_colmap_binary, true),
    ("Bundler", "Bundler", Scene::write_bundler, true),
    ("NVM", "NVM (VisualSFM)", Scene::write_nvm, true),
    (
        "Meshroom 1.0.0",
        "Meshroom",
        |scene, folder| scene.write_meshroom(folder, [1, 0, 0]),
        true,
    ),
    (
        "Meshroom 1.2.0",
        "Meshroom",
        |scene, folder| scene.write_meshroom(folder, [1, 2, 0]),
        true,
    ),
    (
        "Meshroom 1.2.1",
        "Meshroom",
        |scene, folder| scene.write_meshroom(folder, [1, 2, 1]),
        true,
    ),
    (
        "Meshroom 1.2.4",
        "Meshroom",
        |scene, folder| scene.write_meshroom(folder, [1, 2, 4]),
        true,
    ),
    (
        "Meshroom 1.2.6",
        "Meshroom",
        |scene, folder| scene.write_meshroom(folder, [1, 2, 6]),
        true,
    ),
    (
        "Meshroom 1.2.11",
        "Meshroom",
        |scene, folder| scene.write_meshroom(folder, [1, 2, 11]),
        true,
    ),
    ("Middlebury", "Middlebury par", Scene::write_middlebury, false),
    ("transforms.json", "transforms.json", Scene::write_transforms, false),
    ("LLFF", "LLFF (poses_bounds.npy)", Scene::write_llff, false),
    (
        "OpenSfM",
        "OpenSfM (reconstruction.json)",
        |scene, folder| scene.write_opensfm(folder, "."),
        true,
    ),
];

fn read(path: &Path) -> ViewSet {
    photos::find(path).unwrap().expect("a reconstruction").read().unwrap()
}

fn error_of(path: &Path) -> String {
    photos::find(path)
        .unwrap()
        .expect("a reconstruction")
        .read()
        .unwrap_err()
        .to_string()
}

/// Writes a scene by each of the writers of these names, and compares the result of reading with it.
fn assert_projects_equally(scene: &Scene, is_able: impl Fn(&str) -> bool) {
    for &(name, format, write, has_points) in WRITERS.iter().filter(|row| is_able(row.0)) {
        let folder = tempfile::tempdir().unwrap();
        write(scene, folder.path());
        let found = photos::find(folder.path()).unwrap().unwrap();
        assert_eq!(found.format(), format, "{name}");
        let set = found.read().unwrap();
        assert_eq!(set.photos.len(), scene.poses.len(), "{name}: {:?}", set.notes);
        for (index, photo) in set.photos.iter().enumerate() {
            assert!(
                photo.path.ends_with(Scene::name(index)),
                "{name}: {}",
                photo.path.display()
            );
            assert!(photo.center().distance(scene.center(index)) < 1e-9, "{name}");
            for &point in &scene.points {
                let (found, expected) = (photo.project(point).unwrap(), scene.pixel(index, point));
                assert!(
                    found.distance(expected) < 0.01,
                    "{name}, photograph {index}: {found}, expected {expected}"
                );
            }
        }
        if !has_points {
            assert!(set.points.is_empty(), "{name}");
            continue;
        }
        assert_eq!(set.points.len(), scene.points.len(), "{name}");
        for (index, &point) in scene.points.iter().enumerate() {
            assert!(set.points.positions()[index].distance(point) < 1e-9, "{name}");
            assert_eq!(
                set.points.colors()[index],
                [index as u8, 100, 255 - index as u8],
                "{name}"
            );
            assert_eq!(set.points.track(index).len(), scene.poses.len(), "{name}");
            for seen in set.points.track(index) {
                let expected = scene.pixel(seen.photo as usize, point);
                assert!(
                    seen.pixel.as_dvec2().distance(expected) < 0.01,
                    "{name}: {seen:?}, expected {expected}"
                );
            }
        }
        for error in set.reprojection_errors() {
            let error = error.unwrap();
            assert!(
                error.count == scene.points.len() && error.behind == 0 && error.rms_px < 1e-3,
                "{name}: {error:?}"
            );
        }
    }
}

#[test]
fn one_scene_projects_identically_in_all_formats() {
    assert_projects_equally(&Scene::simple(), |_| true);
}

/// Bundler, LLFF, and Meshroom before 1.2, know one focal length; the first two no principal point either.
#[test]
fn an_off_center_principal_point_is_preserved() {
    assert_projects_equally(&Scene::off_center(), |name| {
        !["Bundler", "LLFF", "Meshroom 1.0.0"].contains(&name)
    });
    let one_focal = Scene {
        focal_px: DVec2::splat(90.0),
        ..Scene::off_center()
    };
    assert_projects_equally(&one_focal, |name| name == "Meshroom 1.0.0");
}

/// NVM distorts in the other direction (see its own test), par files and LLFF are of undistorted images.
#[test]
fn a_lens_distorts_identically_in_all_formats() {
    assert_projects_equally(&Scene::distorted(), |name| {
        !["NVM", "Middlebury", "LLFF"].contains(&name)
    });
}

#[test]
fn open_drone_map_images_are_next_to_the_opensfm_folder() {
    let (scene, folder) = (Scene::simple(), tempfile::tempdir().unwrap());
    scene.write_opensfm(folder.path(), "opensfm");
    let set = read(&folder.path().join("opensfm"));
    assert_eq!(set.photos.len(), scene.poses.len(), "{:?}", set.notes);
}

/// Images of a quarter of the calibrated size: all pixels move with the borders.
#[test]
fn downscaled_images_have_scaled_cameras() {
    for &(name, _, write, _) in WRITERS
        .iter()
        .filter(|row| row.0.starts_with("COLMAP") || row.0.starts_with("transf"))
    {
        let scene = Scene::off_center();
        let folder = tempfile::tempdir().unwrap();
        write(&scene, folder.path());
        for photo in 0..scene.poses.len() {
            RgbImage::new(16, 12)
                .save(folder.path().join("images").join(Scene::name(photo)))
                .unwrap();
        }
        let set = read(folder.path());
        for (index, photo) in set.photos.iter().enumerate() {
            assert_eq!(photo.camera.size_px(), [16, 12]);
            for &point in &scene.points {
                let expected = (scene.pixel(index, point) + 0.5) / 4.0 - 0.5;
                assert!(photo.project(point).unwrap().distance(expected) < 1e-9, "{name}");
            }
        }
        for error in set.reprojection_errors().into_iter().flatten() {
            assert!(error.rms_px < 1e-3, "{name}: {error:?}");
        }
        RgbImage::new(48, 64)
            .save(folder.path().join("images").join(Scene::name(0)))
            .unwrap();
        let set = read(folder.path());
        assert_eq!(set.photos.len(), scene.poses.len() - 1);
        assert!(
            set.notes
                .join("\n")
                .contains("it has 48 × 64 pixels but was calibrated with 64 × 48")
        );
    }
}

/// A folder with one image of 64 × 48 pixels, `a.png`, and these files.
fn folder_with(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    RgbImage::new(64, 48).save(folder.path().join("a.png")).unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// The only image shows the point at this pixel.
fn assert_shows(files: &[(&str, &str)], point: [f64; 3], expected: [f64; 2]) {
    let folder = folder_with(files);
    let photo = &read(folder.path()).photos[0];
    let pixel = photo.project(DVec3::from_array(point)).unwrap();
    let is_there = pixel.distance(DVec2::from_array(expected)) < 1e-9;
    assert!(is_there, "{point:?} is at {pixel}, expected {expected:?}");
}

#[test]
fn colmap_counts_from_the_corner_and_looks_along_z() {
    let files = [
        ("cameras.txt", "1 PINHOLE 64 48 50 50 32 24\n"),
        ("images.txt", "1 1 0 0 0 0 0 0 1 a.png\n\n"),
    ];
    assert_shows(&files, [0.0, 0.0, 1.0], [31.5, 23.5]);
    assert_shows(&files, [0.1, 0.2, 1.0], [36.5, 33.5]);
}

#[test]
fn bundler_counts_from_the_center_and_looks_along_minus_z_with_y_up() {
    let bundle = "# Bundle file v0.3\n1 0\n50 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n";
    let files = [("bundle.out", bundle), ("list.txt", "a.png\n")];
    assert_shows(&files, [0.0, 0.0, -1.0], [31.5, 23.5]);
    assert_shows(&files, [0.1, 0.2, -1.0], [36.5, 13.5]);
}

#[test]
fn nvm_counts_from_the_image_center_and_looks_along_z_from_its_camera_center() {
    // A rotation by 180° about z, one unit to the right.
    let files = [("a.nvm", "NVM_V3\n\n1\na.png 50 0 0 0 1 1 0 0 0 0\n\n0\n\n0\n")];
    assert_shows(&files, [1.0, 0.0, 1.0], [31.5, 23.5]);
    assert_shows(&files, [1.1, 0.2, 1.0], [26.5, 13.5]);
    let fixed = [("a.nvm", "NVM_V3 FixedK 50 40 60 20\n\n1\na.png 1 1 0 0 0 0 0 0 0 0\n")];
    assert_shows(&fixed, [0.0, 0.0, 1.0], [39.5, 19.5]);
}

#[test]
fn meshroom_counts_from_half_the_size_in_whole_pixels() {
    let scene = r#"{"version": ["1", "2", "6"],
        "views": [{"viewId": "5", "poseId": "5", "intrinsicId": "7", "path": "/x/a.png"}],
        "intrinsics": [{"intrinsicId": "7", "width": "64", "height": "48", "sensorWidth": "32", "focalLength": "25",
            "type": "pinhole", "principalPoint": ["2", "-1"], "distortionParams": "", "pixelRatio": "1"}],
        "poses": [{"poseId": "5", "pose": {"transform": {"rotation":
            ["0", "-1", "0", "1", "0", "0", "0", "0", "1"], "center": ["1", "0", "0"]}}}]}"#;
    let files = [("sfm.json", scene)];
    assert_shows(&files, [1.0, 0.0, 1.0], [34.0, 23.0]);
    // By rows, the axes of the camera are the columns: x is (0, 1, 0), y is (−1, 0, 0).
    assert_shows(&files, [1.0, 0.1, 1.0], [39.0, 23.0]);
}

#[test]
fn par_files_count_from_the_first_pixel() {
    let par = "1\na.png 50 0 32 0 50 24 0 0 1 1 0 0 0 1 0 0 0 1 0 0 0\n";
    assert_shows(&[("a_par.txt", par)], [0.1, 0.2, 1.0], [37.0, 34.0]);
    let doubled = "1\na.png 100 0 64 0 100 48 0 0 2 1 0 0 0 1 0 0 0 1 0 0 0\n";
    assert_shows(&[("a_par.txt", doubled)], [0.1, 0.2, 1.0], [37.0, 34.0]);
}

#[test]
fn transforms_count_from_the_corner_and_look_along_minus_z() {
    let with = |intrinsics: &str| {
        format!(
            r#"{{{intrinsics}, "frames": [{{"file_path": "a",
            "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}]}}"#
        )
    };
    let whole = with(r#""fl_x": 50, "cx": 32, "cy": 24, "w": 64, "h": 48"#);
    assert_shows(&[("transforms.json", &whole)], [0.0, 0.0, -1.0], [31.5, 23.5]);
    assert_shows(&[("transforms.json", &whole)], [0.1, 0.2, -1.0], [36.5, 13.5]);
    // Twice the arctangent of 32 / 50; the size comes from the file.
    let angle = with(&format!(r#""camera_angle_x": {}"#, 2.0 * (32.0_f64 / 50.0).atan()));
    assert_shows(&[("transforms_train.json", &angle)], [0.1, 0.2, -1.0], [36.5, 13.5]);
}

/// Down, right and backward are the columns; the principal point is the centre of the image.
#[test]
fn llff_looks_along_minus_its_third_column_from_the_image_center() {
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 17)}";
    let numbers = [
        0.0, 1.0, 0.0, 1.0, 48.0, 1.0, 0.0, 0.0, 0.0, 64.0, 0.0, 0.0, -1.0, 0.0, 50.0, 1.0, 2.0,
    ];
    let payload = numbers.iter().flat_map(|number: &f64| number.to_le_bytes());
    let mut file = b"\x93NUMPY\x01\0".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.bytes().chain(payload));
    let folder = folder_with(&[]);
    fs::write(folder.path().join("poses_bounds.npy"), file).unwrap();
    let photo = &read(folder.path()).photos[0];
    let pixel = |x: f64, y: f64| photo.project(DVec3::new(x, y, 1.0)).unwrap();
    assert!(pixel(1.0, 0.0).distance(DVec2::new(31.5, 23.5)) < 1e-9);
    // One unit to the right is the world's x, one down its y.
    assert!(pixel(1.1, 0.2).distance(DVec2::new(36.5, 33.5)) < 1e-9);
}

/// Copies of a quarter of the size are taken where the originals are absent, and not where another number is present.
#[test]
fn llff_images_come_from_a_folder_with_the_same_count() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::simple();
    scene.write_llff(folder.path());
    let (images, smaller) = (folder.path().join("images"), folder.path().join("images_4"));
    fs::create_dir(&smaller).unwrap();
    for photo in 0..scene.poses.len() {
        RgbImage::new(16, 12)
            .save(smaller.join(format!("image{photo:03}.png")))
            .unwrap();
    }
    assert_eq!(read(folder.path()).photos[0].camera.size_px(), [64, 48]);
    fs::remove_file(images.join(Scene::name(2))).unwrap();
    let set = read(folder.path());
    assert_eq!(set.photos[0].camera.size_px(), [16, 12]);
    for (index, photo) in set.photos.iter().enumerate() {
        for &point in &scene.points {
            let expected = (scene.pixel(index, point) + 0.5) / 4.0 - 0.5;
            assert!(photo.project(point).unwrap().distance(expected) < 1e-9);
        }
    }
    fs::remove_file(smaller.join("image001.png")).unwrap();
    let error = error_of(folder.path());
    assert!(
        error.contains("6 images are calibrated") && error.contains("5 in images, 5 in images_4"),
        "{error}"
    );
}

#[test]
fn a_file_selects_its_reconstruction() {
    for (write, file) in [
        (Scene::write_colmap_text as Writer, "sparse/0/cameras.txt"),
        (Scene::write_colmap_text, "sparse/0/points3D.txt"),
        (Scene::write_colmap_text, "sparse/0"),
        (Scene::write_colmap_text, "sparse"),
        (Scene::write_colmap_binary, "sparse/images.bin"),
        (Scene::write_bundler, "bundle.out"),
        (Scene::write_nvm, "scan.nvm"),
        (|scene, folder| scene.write_meshroom(folder, [1, 2, 6]), "sfm.json"),
        (Scene::write_middlebury, "scene_par.txt"),
        (Scene::write_transforms, "transforms.json"),
        (Scene::write_llff, "poses_bounds.npy"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        write(&Scene::simple(), folder.path());
        let path = folder.path().join(file);
        let found = photos::find(&path).unwrap();
        assert_eq!(found.expect(file).read().unwrap().photos.len(), 6, "{file}");
    }
}

#[test]
fn the_largest_of_several_models_is_read() {
    let folder = tempfile::tempdir().unwrap();
    Scene::simple().write_colmap_text(folder.path());
    fs::rename(folder.path().join("sparse/0"), folder.path().join("sparse/1")).unwrap();
    let few = Scene {
        poses: Scene::simple().poses[..2].to_vec(),
        ..Scene::simple()
    };
    few.write_colmap_text(folder.path());
    assert_eq!(read(folder.path()).photos.len(), 6);
    assert_eq!(read(&folder.path().join("sparse")).photos.len(), 6);
    assert_eq!(read(&folder.path().join("sparse/0")).photos.len(), 2);
}

/// The dense stage undistorts images under the same names.
#[test]
fn the_images_nearest_to_the_model_are_used() {
    let folder = tempfile::tempdir().unwrap();
    let dense = folder.path().join("dense");
    Scene::simple().write_photos(&folder.path().join("images"));
    Scene::simple().write_colmap_binary(&dense);
    for opened in [folder.path(), &dense, &dense.join("sparse")] {
        for photo in read(opened).photos {
            assert!(
                photo.path.starts_with(&dense),
                "{} of {}",
                photo.path.display(),
                opened.display()
            );
        }
    }
}

#[test]
fn a_meshroom_project_is_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("MeshroomCache/StructureFromMotion/0f3a");
    Scene::simple().write_meshroom(&run, [1, 2, 6]);
    fs::rename(run.join("sfm.json"), run.join("cameras.sfm")).unwrap();
    let found = photos::find(folder.path()).unwrap().unwrap();
    assert_eq!(found.format(), "Meshroom");
    assert_eq!(found.read().unwrap().photos.len(), 6);
}

#[test]
fn other_folders_are_not_image_sets() {
    let folder = folder_with(&[
        ("cameras.txt", "1 PINHOLE 64 48 50 50 32 24\n"),
        ("bundle.out", "of another program"),
        ("a.nvm", "of another program"),
        ("settings.json", "{\"frames\": 3}"),
        ("notes.txt", ""),
    ]);
    assert!(photos::find(folder.path()).unwrap().is_none());
    for file in [
        "cameras.txt",
        "bundle.out",
        "settings.json",
        "notes.txt",
        "a.png",
        "missing",
    ] {
        assert!(photos::find(&folder.path().join(file)).unwrap().is_none(), "{file}");
    }
}

#[test]
fn masks_depths_and_points_files_are_found() {
    let folder = tempfile::tempdir().unwrap();
    Scene::simple().write_colmap_binary(folder.path());
    for (path, bytes) in [
        ("masks/view_00.png.png", &b""[..]),
        (
            "stereo/depth_maps/view_01.png.geometric.bin",
            &b"1&1&1&\0\0\x80\x3f"[..],
        ),
    ] {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    let set = read(folder.path());
    assert!(set.photos[0].mask.is_some() && set.photos[1].mask.is_none() && set.photos[0].depth.is_none());
    let depth = set.photos[1].depth.clone().unwrap();
    assert_eq!(depth.kind, photos::DepthKind::Colmap);
    assert_eq!(photos::colmap_depth(&depth.path).unwrap().metres(), [1.0]);

    let transforms = r#"{"fl_x": 50, "ply_file_path": "points.ply", "frames": [
        {"file_path": "a.png", "mask_path": "m.png", "depth_file_path": "d.png",
         "transform_matrix": [[2,0,0,0],[0,2,0,0],[0,0,2,0]]},
        {"file_path": "gone.png", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]},
        {"file_path": "a.png", "camera_model": "ORTHOPHOTO", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]}"#;
    let folder = folder_with(&[
        ("transforms.json", transforms),
        ("points.ply", ""),
        ("m.png", ""),
        ("d.png", ""),
    ]);
    let set = read(folder.path());
    assert_eq!(set.photos.len(), 1);
    assert!(set.points_file.is_some() && set.photos[0].mask.is_some());
    assert_eq!(
        set.photos[0].depth.as_ref().unwrap().kind,
        photos::DepthKind::Scaled(1e-3)
    );
    let notes = set.notes.join("\n");
    assert!(notes.contains("gone.png") && notes.contains("ORTHOPHOTO"), "{notes}");
}

#[test]
fn neighbouring_views_are_those_at_the_smallest_angles() {
    let scene = Scene::simple();
    let folder = tempfile::tempdir().unwrap();
    for write in [Scene::write_colmap_text as Writer, Scene::write_transforms] {
        let _ = fs::remove_dir_all(folder.path().join("sparse"));
        write(&scene, folder.path());
        let set = read(folder.path());
        for photo in 0..6 {
            let center = set.centers()[photo];
            assert!(center.length() < 0.5, "{center}");
            let angle = |other: usize| (scene.center(photo) - center).angle_between(scene.center(other) - center);
            let mut expected: Vec<usize> = (0..6).filter(|&other| other != photo).collect();
            expected.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)));
            let found = set.neighbours(photo, 3);
            assert_eq!(found.iter().map(|found| found.photo).collect::<Vec<_>>(), expected[..3]);
            assert!((found[0].angle - angle(expected[0])).abs() < 1e-6);
        }
        // Cameras are 0.8 apart on a circle, seen from a median position near its centre.
        let sigma = set.median_neighbour_angle().unwrap();
        assert!((0.6..1.0).contains(&sigma), "{sigma}");
    }
    assert_eq!(ViewSet::default().median_neighbour_angle(), None);
    assert!(ViewSet::default().neighbours(0, 3).is_empty());
}

/// COLMAP writes rigs and frames from 3.12 on; poses are still of the images.
#[test]
fn rigs_and_frames_alongside_a_model_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::simple();
    scene.write_colmap_binary(folder.path());
    let without = read(folder.path());
    let model = model_with(folder.path(), "cameras.bin");
    fs::write(model.join("rigs.bin"), 1_u64.to_le_bytes()).unwrap();
    fs::write(model.join("frames.bin"), [0xff; 40]).unwrap();
    for path in [
        folder.path(),
        &model,
        &model.join("rigs.bin"),
        &model.join("frames.bin"),
    ] {
        assert_eq!(read(path).photos, without.photos, "{}", path.display());
    }
}

/// The folder below `root` that has a file of this name.
fn model_with(root: &Path, name: &str) -> std::path::PathBuf {
    let below = ["", "sparse", "sparse/0"].map(|folder| root.join(folder));
    below.into_iter().find(|folder| folder.join(name).is_file()).unwrap()
}

/// nerfstudio notes the transform from COLMAP's world to its own, and has applied it to cameras and points alike.
#[test]
fn an_applied_transform_is_not_applied_again() {
    let folder = tempfile::tempdir().unwrap();
    Scene::simple().write_transforms(folder.path());
    let without = read(folder.path());
    let path = folder.path().join("transforms.json");
    let mut json: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    json["applied_transform"] = serde_json::json!([[0, 1, 0, 5], [1, 0, 0, 6], [0, 0, -1, 7]]);
    json["applied_scale"] = 3.0.into();
    json["ply_file_path"] = "sparse_pc.ply".into();
    fs::write(folder.path().join("sparse_pc.ply"), "ply\n").unwrap();
    fs::write(&path, json.to_string()).unwrap();
    let with = read(folder.path());
    assert_eq!(with.photos, without.photos);
    assert_eq!(with.points_file, Some(folder.path().join("sparse_pc.ply")));
    assert_eq!(with.notes, [""; 0]);
}

/// Each frame may be of another camera, as nerfstudio has it for rigs of a fisheye and a usual lens.
#[test]
fn fisheye_and_perspective_frames_may_share_one_file() {
    let folder = tempfile::tempdir().unwrap();
    Scene::simple().write_transforms(folder.path());
    let path = folder.path().join("transforms.json");
    let mut json: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    for (frame, (model, k4)) in [("OPENCV_FISHEYE", 0.01), ("OPENCV", 0.0), ("EQUIRECTANGULAR", 0.0)]
        .into_iter()
        .enumerate()
    {
        json["frames"][frame]["camera_model"] = model.into();
        json["frames"][frame]["k1"] = 0.1.into();
        json["frames"][frame]["k4"] = k4.into();
    }
    fs::write(&path, json.to_string()).unwrap();
    let set = read(folder.path());
    let lenses: Vec<&str> = set
        .photos
        .iter()
        .map(|photo| photo.camera.distortion().name())
        .collect();
    assert_eq!(lenses[..2], ["fisheye", "brown"]);
    assert_eq!(set.photos.len(), Scene::simple().poses.len() - 1);
    assert!(set.notes[0].contains("EQUIRECTANGULAR"), "{:?}", set.notes);
}
