//! Files and values that are missing, cut, singular, claimed or of another model.

use super::scene::Scene;
use super::{WRITERS, error_of, folder_with, read};
use pointreel::photos;
use std::fs;

#[test]
fn missing_images_are_skipped_with_their_observations() {
    // LLFF has no names: missing images have a separate test.
    for &(name, _, write, has_points) in WRITERS.iter().filter(|row| row.0 != "LLFF") {
        let scene = Scene::simple();
        let folder = tempfile::tempdir().unwrap();
        write(&scene, folder.path());
        for photo in [0, 3] {
            let beside = folder.path().join(Scene::name(photo));
            let below = folder.path().join("images").join(Scene::name(photo));
            fs::remove_file(if beside.is_file() { beside } else { below }).unwrap();
        }
        let set = read(folder.path());
        assert_eq!(set.photos.len(), 4, "{name}");
        assert!(
            set.notes.join("\n").contains("2 images were skipped"),
            "{name}: {:?}",
            set.notes
        );
        let errors: Vec<_> = set.reprojection_errors().into_iter().flatten().collect();
        assert_eq!(errors.len(), if has_points { 4 } else { 0 }, "{name}");
        assert!(errors.iter().all(|error| error.rms_px < 1e-3), "{name}: {errors:?}");
        for photo in 0..6 {
            let _ = fs::remove_file(folder.path().join(Scene::name(photo)));
        }
        let _ = fs::remove_dir_all(folder.path().join("images"));
        if has_points {
            let set = read(folder.path());
            assert!(set.photos.is_empty() && !set.points.is_empty(), "{name}");
            let notes = set.notes.join("\n");
            assert!(notes.contains("its points are shown without them"), "{name}: {notes}");
            continue;
        }
        let error = error_of(folder.path());
        assert!(error.contains("none of which can be shown"), "{name}: {error}");
        assert!(error.contains("view_00"), "{name}: {error}");
    }
}

#[test]
fn unsupported_camera_models_are_rejected_by_name() {
    let images = ("images.txt", "1 1 0 0 0 0 0 0 1 a.png\n\n");
    for model in [
        "FOV 64 48 50 50 32 24 0.1",
        "THIN_PRISM_FISHEYE 64 48 50 50 32 24 0 0 0 0 0 0 0 0",
        "MINE 64 48 1",
    ] {
        let camera = format!("1 {model}\n");
        let folder = folder_with(&[("cameras.txt", camera.as_str()), images]);
        let error = error_of(folder.path());
        let name = model.split(' ').next().unwrap();
        assert!(
            error.contains(&format!("camera model is {name}, expected SIMPLE_PINHOLE")),
            "{error}"
        );
    }
    // Binary files have numbers: 17 has a name, 99 ends the readable part.
    let binary = tempfile::tempdir().unwrap();
    Scene::simple().write_colmap_binary(binary.path());
    let file = binary.path().join("sparse/cameras.bin");
    let mut bytes = fs::read(&file).unwrap();
    bytes[12] = 99;
    fs::write(&file, &bytes).unwrap();
    let error = error_of(binary.path());
    assert!(error.contains("has model number 99, expected 0 to 6"), "{error}");
    bytes[12] = 17;
    fs::write(&file, &bytes).unwrap();
    // The points of the scene are shown without its images.
    let set = read(binary.path());
    let notes = set.notes.join("\n");
    assert_eq!((set.photos.len(), set.points.len()), (0, 40), "{notes}");
    for words in ["6 images were skipped", "camera model is EQUIRECTANGULAR"] {
        assert!(notes.contains(words), "{notes}");
    }
    fs::remove_file(binary.path().join("sparse/points3D.bin")).unwrap();
    let error = error_of(binary.path());
    assert!(error.contains("camera model is EQUIRECTANGULAR"), "{error}");
    let folder = folder_with(&[("cameras.txt", "1 PINHOLE 64 48 50 50 32\n"), images]);
    assert!(error_of(folder.path()).contains("PINHOLE, has 4 numbers, found 3"));
    let folder = folder_with(&[("cameras.txt", "2 PINHOLE 64 48 50 50 32 24\n"), images]);
    assert!(error_of(folder.path()).contains("number 1, is not among the cameras"));
}

#[test]
fn a_million_declared_but_missing_images_are_an_error() {
    let par = "1000000\na.png 50 0 32 0 50 24 0 0 1 1 0 0 0 1 0 0 0 1 0 0 0\n";
    let nvm = "NVM_V3\n\n1000000\na.png 50 1 0 0 0 0 0 0 0 0\n";
    let bundle = "# Bundle file v0.3\n1000000 0\n50 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n";
    for (files, words) in [
        (
            vec![("a_par.txt", par)],
            "line 3: the file ends where the name of an image was expected",
        ),
        (
            vec![("a.nvm", nvm)],
            "line 5: the file ends where the name of an image was expected",
        ),
        (
            vec![("bundle.out", bundle), ("list.txt", "a.png")],
            "1000000 cameras, expected 1",
        ),
    ] {
        let error = error_of(folder_with(&files).path());
        assert!(error.contains(words), "{error}");
    }
    let folder = tempfile::tempdir().unwrap();
    Scene::simple().write_llff(folder.path());
    let path = folder.path().join("poses_bounds.npy");
    let mut claimed = fs::read(&path).unwrap();
    let place = claimed.windows(4).position(|text| text == b"(6, ").unwrap();
    claimed.splice(place..place + 2, *b"(1000000");
    claimed[8] += 6;
    fs::write(&path, claimed).unwrap();
    let error = error_of(folder.path());
    assert!(error.contains("1000000 rows of 17 numbers are claimed"), "{error}");
    let folder = tempfile::tempdir().unwrap();
    Scene::simple().write_colmap_binary(folder.path());
    for (file, what) in [("cameras", "cameras"), ("images", "images"), ("points3D", "points")] {
        let path = folder.path().join("sparse").join(format!("{file}.bin"));
        let whole = fs::read(&path).unwrap();
        for claim in [1_000_000, u64::MAX] {
            let mut claimed = whole.clone();
            claimed[..8].copy_from_slice(&claim.to_le_bytes());
            fs::write(&path, claimed).unwrap();
            let error = error_of(folder.path());
            assert!(
                error.contains(&format!("{claim} {what} are claimed, and the file has room for")),
                "{error}"
            );
        }
        fs::write(&path, whole).unwrap();
    }
}

#[test]
fn singular_matrices_are_not_cameras() {
    let par = |k: &str, r: &str| format!("1\na.png {k} {r} 0 0 0\n");
    let (good_k, good_r) = ("50 0 32 0 50 24 0 0 1", "1 0 0 0 1 0 0 0 1");
    for (k, r, words) in [
        ("50 0 32 0 50 24 0 0 0", good_r, "singular"),
        ("50 0 32 3 50 24 0 0 1", good_r, "singular, or none of a camera"),
        ("0 0 32 0 50 24 0 0 1", good_r, "focal lengths"),
        ("50 5 32 0 50 24 0 0 1", good_r, "skewed"),
        (good_k, "0 0 0 0 0 0 0 0 0", "determinant 0.000"),
        (good_k, "-1 0 0 0 1 0 0 0 1", "determinant -1.000"),
        (good_k, "2 0 0 0 2 0 0 0 2", "not a rotation"),
    ] {
        let error = error_of(folder_with(&[("a_par.txt", &par(k, r))]).path());
        assert!(error.contains(words), "{error}");
    }
    let nothing = "1 0 0 0 0 0 0 0 1 a.png\n\n";
    let files = [
        ("cameras.txt", "1 PINHOLE 64 48 50 50 32 24\n"),
        ("images.txt", nothing),
    ];
    assert!(error_of(folder_with(&files).path()).contains("not a rotation"));
}

/// Files that were cut anywhere, and files with a byte changed, are errors or sets, never a panic or a long wait.
#[test]
fn damage_is_an_error_or_a_smaller_set() {
    let scene = Scene {
        points: Scene::simple().points[..3].to_vec(),
        poses: Scene::simple().poses[..2].to_vec(),
        ..Scene::simple()
    };
    let mut random = 7_u32;
    for &(name, _, write, _) in WRITERS {
        let folder = tempfile::tempdir().unwrap();
        write(&scene, folder.path());
        let mut files = Vec::new();
        for place in ["", "sparse", "sparse/0"] {
            let Ok(entries) = fs::read_dir(folder.path().join(place)) else {
                continue;
            };
            let paths = entries.map(|entry| entry.unwrap().path());
            files.extend(paths.filter(|path| path.is_file() && path.extension().is_none_or(|end| end != "png")));
        }
        assert!(!files.is_empty(), "{name}");
        for file in files {
            let whole = fs::read(&file).unwrap();
            let mut attempts: Vec<Vec<u8>> = (0..whole.len()).step_by(31).map(|end| whole[..end].to_vec()).collect();
            for _ in 0..60 {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let mut changed = whole.clone();
                changed[(random >> 8) as usize % whole.len()] = random as u8;
                attempts.push(changed);
            }
            for attempt in attempts {
                fs::write(&file, attempt).unwrap();
                let Ok(Some(found)) = photos::find(folder.path()) else {
                    continue;
                };
                match found.read() {
                    Ok(set) => {
                        set.reprojection_errors();
                        set.median_neighbour_angle();
                        assert!(
                            set.photos.iter().all(|photo| photo.camera_from_world.is_finite()),
                            "{name}"
                        );
                    }
                    Err(error) => assert!(!error.to_string().is_empty()),
                }
            }
            fs::write(&file, whole).unwrap();
        }
    }
}
