//! COLMAP: cameras, images and points, as text or binary.
//!
//! Its manual, *Output format*: a pose takes points of the world to the camera (x right, y down, z forward), rotated by
//! the quaternion w x y z and then shifted; the centre of the first pixel is at (½, ½). The rows of a file come in any
//! order and are identified by their numbers; input images are ordered by theirs, so that text and binary files agree.
//!
//! From 3.12 on there are rigs and frames as well, which define groups that move together. The full pose of each input
//! image is still stored among the images, so these files are not read.

mod binary;
mod depth;
mod models;
mod records;
mod text;

pub use depth::colmap_depth;

use super::reader::{Claim, Reader};
use crate::photos::depth_file::{DepthFile, DepthKind};
use crate::photos::error::PhotosError;
use crate::photos::found::draft::{Draft, Drafts};
use glam::{DMat3, DQuat};
use records::{Cameras, Features, Image};
use std::fs;
use std::path::{Path, PathBuf};

/// Names of folders between the scene folder and the model folder.
const LAYOUT: &[&str] = &[
    "sparse",
    "colmap",
    "colmap_sparse",
    "colmap_text",
    "dense",
    "undistorted",
    "distorted",
];

/// Folders of a scene in which models are, or folders of them by their numbers.
const FOLDERS: &[&str] = &[
    "",
    "sparse",
    "colmap/sparse",
    "colmap_sparse",
    "colmap_text",
    "dense/0/sparse",
    "dense/sparse",
    "undistorted/sparse",
    "dslr_calibration_undistorted",
    "rig_calibration_undistorted",
    "dslr/colmap",
    // Mostly unsupported lenses: opening the scene reports that.
    "distorted/sparse",
    "dslr_calibration_jpg",
    "rig_calibration",
];

/// Maximum number of models of one scene whose numbers are tried: COLMAP creates one for each connected group of
/// images.
const MAX_MODELS: u32 = 50;

/// Names of the files of a model.
const FILES: &[&str] = &["cameras", "images", "points3d", "rigs", "frames"];

/// COLMAP, text or binary.
pub(in crate::photos::readers) const READER: Reader = Reader {
    name: "COLMAP",
    in_folder: |folder| FOLDERS.iter().find_map(|name| model_in(&folder.path.join(name))),
    of_file: |file| {
        let is_of_model = matches!(file.extension(), "bin" | "txt") && FILES.contains(&file.stem());
        Ok((is_of_model && is_in(file.folder())).then(|| Claim::certain(file.folder())))
    },
    read,
};

/// The folder itself, or the largest of the models that it has by their numbers.
fn model_in(folder: &Path) -> Option<PathBuf> {
    if is_in(folder) {
        return Some(folder.to_owned());
    }
    let numbered = (0..MAX_MODELS).map(|number| folder.join(number.to_string()));
    let size_of = |model: &PathBuf| {
        let size = |name: &str| fs::metadata(model.join(name)).map_or(0, |file| file.len());
        size("images.bin").max(size("images.txt"))
    };
    // In reverse, because the last of equals would be taken. Numbers may have gaps; folders without 0 have no models.
    let first = folder.join("0").is_dir();
    let models: Vec<PathBuf> = numbered.take_while(|_| first).filter(|model| is_in(model)).collect();
    models.into_iter().rev().max_by_key(size_of)
}

/// Returns true if the folder holds a model.
fn is_in(folder: &Path) -> bool {
    let has = |name: &str| folder.join(name).is_file();
    ["bin", "txt"]
        .iter()
        .any(|extension| has(&format!("cameras.{extension}")) && has(&format!("images.{extension}")))
}

/// Reads the input images of the model in `folder`.
fn read(folder: &Path) -> Result<Drafts, PhotosError> {
    let is_binary = folder.join("cameras.bin").is_file() && folder.join("images.bin").is_file();
    let extension = if is_binary { "bin" } else { "txt" };
    let file = |name: &str| folder.join(format!("{name}.{extension}"));
    let (cameras, mut images) = if is_binary {
        (binary::cameras(&file("cameras"))?, binary::images(&file("images"))?)
    } else {
        (text::cameras(&file("cameras"))?, text::images(&file("images"))?)
    };
    images.sort_by_key(|image| image.id);
    let features = Features {
        images: images
            .iter()
            .enumerate()
            .map(|(index, image)| (image.id, (index as u32, image.features.as_slice())))
            .collect(),
    };
    let mut drafts = Drafts::new(&file("images"), folders_above(folder));
    let points = file("points3D");
    let converted = folder.join("points3D.ply");
    if !points.is_file() && converted.is_file() {
        drafts.points_file = Some(converted);
    } else if !points.is_file() {
        drafts.notes.push(format!("no points: {} is missing", points.display()));
    } else if is_binary {
        drafts.points = binary::points(&points, &features)?;
    } else {
        drafts.points = text::points(&points, &features)?;
    }
    drafts.photos = images
        .iter()
        .map(|image| draft(image, &cameras, &drafts.folders))
        .collect();
    Ok(drafts)
}

fn draft(image: &Image, cameras: &Cameras, folders: &[PathBuf]) -> Draft {
    let lens = cameras.get(&image.camera).cloned();
    let lens = lens.unwrap_or_else(|| Err(format!("its camera, number {}, is not among the cameras", image.camera)));
    let [w, x, y, z] = image.quaternion;
    let quaternion = DQuat::from_xyzw(x, y, z, w);
    // A quaternion of zero length is not a rotation, and is refused as such.
    let turn = if !quaternion.is_finite() {
        DMat3::NAN
    } else if quaternion.length_squared() > 0.0 {
        DMat3::from_quat(quaternion.normalize())
    } else {
        DMat3::ZERO
    };
    let depth = folders.iter().find_map(|folder| depth_of(folder, &image.name));
    Draft {
        depth,
        ..Draft::new(image.name.clone(), lens, turn, image.shift)
    }
}

/// The depths of the dense stage that were checked against other views, else those that were not.
fn depth_of(folder: &Path, name: &str) -> Option<DepthFile> {
    let maps = folder.join("stereo").join("depth_maps");
    ["geometric", "photometric"].into_iter().find_map(|kind| {
        let path = maps.join(format!("{name}.{kind}.bin"));
        path.is_file().then_some(DepthFile {
            path,
            kind: DepthKind::Colmap,
            taken_by: None,
        })
    })
}

/// The folder of the model, and those above it that are part of its layout: `scene/sparse/0` belongs to `scene`. The
/// nearest comes first, as `dense` has undistorted copies of the scene's images under the same names.
fn folders_above(model: &Path) -> Vec<PathBuf> {
    let mut folders = vec![model.to_owned()];
    let mut folder = model;
    while let (Some(name), Some(parent)) = (folder.file_name(), folder.parent()) {
        let name = name.to_string_lossy();
        let is_number = name.bytes().all(|byte| byte.is_ascii_digit());
        let is_of_layout = LAYOUT.contains(&name.as_ref())
            || name.starts_with("dslr_calibration")
            || name.starts_with("rig_calibration");
        if !(is_number || is_of_layout) {
            break;
        }
        folders.push(parent.to_owned());
        folder = parent;
    }
    folders
}
