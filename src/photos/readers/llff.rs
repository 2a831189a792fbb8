//! The layout of LLFF (Mildenhall et al. 2019, *Local Light Field Fusion*): `poses_bounds.npy` next to the images.
//!
//! Its README: a row of 17 numbers for each image. The first 15 are a matrix of 3 × 5 by rows: three columns are the
//! axes of the camera in the world, *down, right, backward*; the fourth is its position; the fifth is height, width and
//! focal length in pixels. Two numbers follow, the depths between which the scene lies: those that stereo tries. Rows
//! are in the order of the names of the images, which the file does not hold: they come from the first of the usual
//! folders with one image per row, `images` before downscaled copies. The principal point is the centre of the image.
//!
//! A multi-view video (Li et al. 2022, *Neural 3D Video Synthesis*) has a row for each camera, in the order of the
//! names of their folders.

use super::reader::{Claim, Reader};
use crate::photos::error::{PhotosError, read_file};
use crate::photos::found::draft::{Draft, Drafts};
use crate::photos::found::files::is_picture;
use crate::photos::parts::npy_table::NpyTable;
use crate::photos::sets::lens::{Lens, Origin};
use glam::{DMat3, DVec2, DVec3};
use std::fs;
use std::path::Path;

/// The name that its tools give to the file.
const FILE: &str = "poses_bounds.npy";

const COLUMNS: usize = 17;

/// Usual folders of input images; the first that has the same number of images as there are rows is taken.
const FOLDERS: &[&str] = &["images", "images_2", "images_4", "images_8", "input", "rgb", ""];

/// Usual parents of the folders of cameras.
const FOLDERS_OF_CAMERAS: &[&str] = &["", "images", "frames", "cameras", "videos"];

/// Entries of a folder that are looked at.
const MAX_ENTRIES: usize = 100_000;

/// Poses and bounds of LLFF.
pub(super) const READER: Reader = Reader {
    name: "LLFF (poses_bounds.npy)",
    in_folder: |folder| folder.first(&[FILE]),
    of_file: |file| Ok((file.name == FILE).then(|| Claim::certain(file.path))),
    read,
};

/// Reads the input images of the file `path`.
fn read(path: &Path) -> Result<Drafts, PhotosError> {
    let table = NpyTable::parse(path, &read_file(path)?)?;
    let (rows, rest) = table.numbers.as_chunks::<COLUMNS>();
    if table.columns != COLUMNS || rows.is_empty() || !rest.is_empty() {
        let problem = format!(
            "expected rows of {COLUMNS} numbers (a matrix of 3 × 5, two depths), found {} of {}: it is none of LLFF",
            table.numbers.len() / table.columns.max(1),
            table.columns
        );
        return Err(PhotosError::invalid(path, "the table", problem));
    }
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let names = names(path, &folder, rows.len())?;
    let mut drafts = Drafts::new(path, vec![folder]);
    drafts.photos = names
        .into_iter()
        .zip(rows)
        .map(|(name, row)| draft(name, row))
        .collect();
    Ok(drafts)
}

/// The names that the rows belong to, relative to the folder of the file.
fn names(path: &Path, folder: &Path, count: usize) -> Result<Vec<String>, PhotosError> {
    let mut found = Vec::new();
    for below in FOLDERS {
        let names = names_in(&folder.join(below), is_picture);
        if names.len() == count {
            let relative = |name: String| {
                if below.is_empty() {
                    name
                } else {
                    format!("{below}/{name}")
                }
            };
            return Ok(names.into_iter().map(relative).collect());
        }
        if !names.is_empty() {
            let below = if below.is_empty() { "the folder itself" } else { below };
            found.push(format!("{} in {below}", names.len()));
        }
    }
    for below in FOLDERS_OF_CAMERAS {
        let parent = folder.join(below);
        let is_of_camera = |path: &Path| path.is_dir() && !names_in(path, is_picture).is_empty();
        let names = names_in(&parent, is_of_camera);
        if names.len() == count && count > 1 {
            return Ok(names);
        }
    }
    let found = if found.is_empty() {
        "none".to_owned()
    } else {
        found.join(", ")
    };
    let problem = format!(
        "{count} images are calibrated, in the order of their names; expected the same number of files in images, \
         found {found}: put back the calibrated images and no others"
    );
    Err(PhotosError::invalid(path, "the table", problem))
}

/// Names of the entries of a folder, in the order of their bytes, as Python sorts them.
fn names_in(folder: &Path, is_one: impl Fn(&Path) -> bool) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let paths = entries.take(MAX_ENTRIES).flatten().map(|entry| entry.path());
    let names = paths.filter(|path| is_one(path));
    let mut names: Vec<String> = names
        .filter_map(|path| path.file_name()?.to_str().map(str::to_owned))
        .collect();
    names.sort_unstable();
    names
}

fn draft(name: String, row: &[f64; COLUMNS]) -> Draft {
    let column = |at: usize| DVec3::new(row[at], row[5 + at], row[10 + at]);
    let [down, right, backward, center, size] = [0, 1, 2, 3, 4].map(column);
    let axes = DMat3::from_cols(right, down, -backward);
    let side = |length: f64| (length >= 1.0 && length <= f64::from(u32::MAX)).then_some(length.round() as u32);
    let lens = match (side(size.y), side(size.x)) {
        (Some(width), Some(height)) => Ok(Lens::pinhole(
            Some([width, height]),
            DVec2::splat(size.z),
            Origin::Center,
            DVec2::ZERO,
        )),
        _ => Err(format!(
            "its height and width are {} and {}, expected pixels",
            size.x, size.y
        )),
    };
    let [near, far] = [row[COLUMNS - 2], row[COLUMNS - 1]];
    Draft {
        depth_range: (near > 0.0 && near < far && far.is_finite()).then_some([near, far]),
        ..Draft::at(name, lens, axes, center)
    }
}
