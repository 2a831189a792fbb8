//! Errors in one image, or in all image files, cost these alone; dense clouds take precedence over sparse
//! reconstructions.

use super::{Scene, WRITERS, read};
use crate::data::shared;
use glam::{DMat3, DVec3};
use pointreel::sequence::{OpenOptions, Sequence};
use std::fs;
use std::path::Path;

fn opened(folder: &Path) -> Sequence {
    Sequence::open(&[folder.to_owned()], &OpenOptions::default()).unwrap()
}

fn count(sequence: &Sequence) -> usize {
    sequence.decode(0).unwrap().positions.len()
}

#[test]
fn an_image_with_an_infinite_pose_is_skipped_in_every_format() {
    let mut scene = Scene::simple();
    scene.poses[2] = (DMat3::NAN, DVec3::NAN);
    for &(name, _, write, has_points) in WRITERS {
        let folder = tempfile::tempdir().unwrap();
        write(&scene, folder.path());
        let set = read(folder.path());
        assert_eq!(set.photos.len(), 5, "{name}: {:?}", set.notes);
        assert!(set.notes.join("\n").contains("view_02"), "{name}: {:?}", set.notes);
        assert_eq!(!set.points.is_empty(), has_points, "{name}");
    }
}

#[test]
fn infinite_numbers_in_one_line_only_lose_one_image() {
    for numbers in ["-inf -inf -inf -inf", "nan nan nan nan", "0 0 0 0"] {
        let folder = tempfile::tempdir().unwrap();
        Scene::simple().write_colmap_text(folder.path());
        let path = folder.path().join("sparse/0/images.txt");
        let text = fs::read_to_string(&path).unwrap();
        let lines = text.lines().map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            match words.as_slice() {
                ["12", _, _, _, _, rest @ ..] if rest.len() == 5 => format!("12 {numbers} {}", rest.join(" ")),
                _ => line.to_owned(),
            }
        });
        fs::write(&path, lines.collect::<Vec<_>>().join("\n") + "\n").unwrap();
        let set = read(folder.path());
        assert_eq!(set.photos.len(), 5, "{numbers}: {:?}", set.notes);
    }
}

#[test]
fn points_with_infinite_positions_are_skipped_and_counted() {
    let mut scene = Scene::simple();
    scene.points[3] = DVec3::new(f64::INFINITY, 0.0, 0.0);
    for &(name, _, write, _) in WRITERS
        .iter()
        .filter(|row| ["COLMAP text", "COLMAP binary"].contains(&row.0))
    {
        let folder = tempfile::tempdir().unwrap();
        write(&scene, folder.path());
        let set = read(folder.path());
        assert_eq!((set.points.len(), set.points.skipped()), (39, 1), "{name}");
        assert!(
            set.notes.join("\n").contains("1 points have coordinates"),
            "{name}: {:?}",
            set.notes
        );
    }
}

#[test]
fn points_are_shown_where_images_are_missing() {
    let folder = tempfile::tempdir().unwrap();
    Scene::simple().write_colmap_text(folder.path());
    fs::remove_dir_all(folder.path().join("images")).unwrap();
    let sequence = opened(folder.path());
    assert_eq!(count(&sequence), 40);
    assert!(sequence.source().posed_images(0).is_none());
    let notes = sequence.source().notes().join("\n");
    assert!(notes.contains("its points are shown without them"), "{notes}");
}

fn write_cloud(path: &Path, count: usize) {
    let points = (0..count)
        .map(|at| format!("{} 0 0\n", 0.01 * at as f64))
        .collect::<Vec<_>>()
        .concat();
    let header = "property float x\nproperty float y\nproperty float z\nend_header\n";
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(
        path,
        format!("ply\nformat ascii 1.0\nelement vertex {count}\n{header}{points}"),
    )
    .unwrap();
}

#[test]
fn dense_and_sparse_points_of_a_scene_are_shown() {
    for dense in ["fused.ply", "dense/fused.ply", "dense/0/fused.ply", "scene_dense.ply"] {
        let folder = tempfile::tempdir().unwrap();
        Scene::simple().write_colmap_text(folder.path());
        write_cloud(&folder.path().join(dense), 1000);
        let sequence = opened(folder.path());
        assert_eq!(count(&sequence), 1000, "{dense}");
        assert_eq!(sequence.source().posed_images(0).unwrap().photos.len(), 6);
        let said: Vec<String> = sequence
            .source()
            .assumptions()
            .iter()
            .map(ToString::to_string)
            .collect();
        let said = said.join("\n");
        for words in [dense, "40 SfM points", "sparse/0"] {
            assert!(said.contains(words), "{words}: {said}");
        }
        assert_eq!(count(&opened(&folder.path().join("sparse/0"))), 40, "{dense}");
    }
}

#[test]
fn a_broken_dense_cloud_only_affects_itself() {
    let folder = tempfile::tempdir().unwrap();
    Scene::simple().write_colmap_text(folder.path());
    fs::write(
        folder.path().join("fused.ply"),
        "ply\nformat ascii 1.0\nelement vertex 9\n",
    )
    .unwrap();
    let cloud = opened(folder.path()).decode(0).unwrap();
    assert_eq!(cloud.positions.len(), 40);
    assert!(
        cloud.warnings.join("\n").contains("the SfM points are shown"),
        "{:?}",
        cloud.warnings
    );
}

#[test]
fn the_set_with_one_infinite_pose_is_opened_without_it() {
    let Some(folder) = shared("meaning/C07_inf_pose_one_image") else {
        return;
    };
    let sequence = opened(&folder);
    let set = sequence.source().posed_images(0).unwrap();
    assert_eq!(set.photos.len(), 5);
    assert!(set.notes.join("\n").contains("not finite"), "{:?}", set.notes);
    assert!(count(&sequence) > 100);
}
