//! Bundler v0.3: `bundle.out` and the list of its images.
//!
//! Its manual: P = R·X + t, p = −P / P.z, p′ = f·(1 + k₁|p|² + k₂|p|⁴)·p in pixels from the centre of the image, x to
//! the right and y up. So a camera looks along −z with y up. A camera without a focal length was not placed. Images are
//! named by `list.txt`, one line each. For PMVS they are copied without their distortion to `visualize/00000000.jpg`,
//! in the order of the cameras that have a position, and the bundle next to it is one of the copies.

use super::probe::begins_with;
use super::reader::{Claim, Reader};
use crate::photos::error::{PhotosError, read_file};
use crate::photos::found::draft::{Draft, Drafts};
use crate::photos::parts::text::Text;
use crate::photos::sets::lens::{Lens, Origin};
use crate::photos::sets::points::Observation;
use crate::rgbd::Distortion;
use glam::{DMat3, DVec2, DVec3, Vec2};
use std::path::{Path, PathBuf};

/// Magic bytes at the beginning of the file.
const MAGIC: &[u8] = b"# Bundle file v";

/// Bundles, the usual one first.
const BUNDLES: &[&str] = &[
    "bundle.out",
    "bundle/bundle.out",
    "bundle.rd.out",
    "bundler/bundle.out",
    "pmvs/bundle.rd.out",
];

/// Bundler v0.3.
pub(super) const READER: Reader = Reader {
    name: "Bundler",
    in_folder: |folder| folder.first(BUNDLES).filter(|path| begins_with(path, MAGIC)),
    of_file: |file| {
        let is_bundle = file.extension() == "out" && begins_with(file.path, MAGIC);
        Ok(is_bundle.then(|| Claim::certain(file.path)))
    },
    read,
};

/// Reads the input images of the bundle `path`.
fn read(path: &Path) -> Result<Drafts, PhotosError> {
    let file = read_file(path)?;
    let file = String::from_utf8_lossy(&file);
    let mut text = Text::new(path, &file);
    let version = text.rest_of_line();
    if version != "# Bundle file v0.3" {
        return Err(PhotosError::invalid(
            path,
            "line 1",
            format!("expected `# Bundle file v0.3`, found `{version}`: write it with a newer Bundler"),
        ));
    }
    let camera_count: u32 = text.number("the number of cameras")?;
    let point_count: u64 = text.number("the number of points")?;
    let list = list_of(path)?;
    if list.names.len() < camera_count as usize {
        let found = list.names.len();
        return Err(text.error(format!(
            "{camera_count} cameras, expected {found}, the number of lines of {}: put the list of this bundle there",
            list.path.display()
        )));
    }
    let mut drafts = Drafts::new(path, folders(path));
    let copies = path.parent().unwrap_or(Path::new("")).join("visualize");
    let copies = copies.is_dir().then_some(copies);
    // Only placed images have copies.
    let mut placed = 0;
    for name in list.names.into_iter().take(camera_count as usize) {
        let mut photo = camera(&mut text, name)?;
        if photo.lens.is_ok() {
            photo.copy = copies.as_ref().map(|folder| folder.join(format!("{placed:08}.jpg")));
            placed += 1;
        }
        drafts.photos.push(photo);
    }
    for _ in 0..point_count {
        let position = DVec3::from_array(text.numbers("the position of a point")?);
        let color: [f64; 3] = text.numbers("the colour of a point")?;
        let count: u64 = text.number("the length of a view list")?;
        let mut track = Vec::new();
        for _ in 0..count {
            let photo = text.number("the index of a camera")?;
            text.word("the index of a key")?;
            let [x, y] = text.numbers("the place of a key")?;
            track.push(Observation {
                photo,
                pixel: Vec2::new(x as f32, -y as f32),
            });
        }
        drafts.points.push(position, color.map(|value| value as u8), track);
    }
    Ok(drafts)
}

fn camera(text: &mut Text<'_>, name: String) -> Result<Draft, PhotosError> {
    let [focal_px, k1, k2] = text.numbers("a focal length, k1 and k2")?;
    let turn = DMat3::from_cols_array(&text.numbers("a rotation")?).transpose();
    let shift = DVec3::from_array(text.numbers("a translation")?);
    let lens = if focal_px == 0.0 {
        Err("Bundler found no place for it".into())
    } else {
        Ok(Lens {
            distortion: if (k1, k2) == (0.0, 0.0) {
                Distortion::None
            } else {
                Distortion::Brown {
                    k: [k1, k2, 0.0],
                    p: [0.0; 2],
                }
            },
            ..Lens::pinhole(None, DVec2::splat(focal_px), Origin::Center, DVec2::ZERO)
        })
    };
    let down_and_forward = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    Ok(Draft::new(
        name,
        lens,
        down_and_forward * turn,
        down_and_forward * shift,
    ))
}

/// Names of the input images, in the order of cameras.
struct List {
    path: PathBuf,
    names: Vec<String>,
}

fn list_of(bundle: &Path) -> Result<List, PhotosError> {
    let name = bundle.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = name.strip_suffix(".out").unwrap_or(&name);
    let mut names = vec![format!("{name}.list.txt"), format!("{stem}.list.txt")];
    // Bundler names its undistorted output `bundle.rd.out`, and the list `list.rd.txt`.
    if let Some((_, kind)) = stem.split_once('.') {
        names.push(format!("list.{kind}.txt"));
    }
    names.extend(["list.txt", "list_tmp.txt", "list.rd.txt"].map(String::from));
    let folders = folders(bundle);
    let mut candidates = folders
        .iter()
        .flat_map(|folder| names.iter().map(|name| folder.join(name)));
    let path = candidates.find(|path| path.is_file()).ok_or_else(|| {
        PhotosError::invalid(
            bundle,
            "line 1",
            "the names of its images are missing: put list.txt next to it, with one line per image",
        )
    })?;
    let text = read_file(&path)?;
    let lines = String::from_utf8_lossy(&text);
    let names = lines
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .map(name_of)
        .collect();
    Ok(List { path, names })
}

/// The name in a line of the list: `a.jpg`, or `a.jpg 0 512.3`, whose numbers are a focal length from EXIF.
fn name_of(line: &str) -> String {
    let words: Vec<&str> = line.split_whitespace().collect();
    match words.as_slice() {
        [.., "0", focal] if words.len() > 2 && focal.parse::<f64>().is_ok() => {
            let end = line.trim_end_matches(focal).trim_end().trim_end_matches('0').trim_end();
            end.to_owned()
        }
        _ => line.to_owned(),
    }
}

/// The folder of the bundle, and the one above, as Bundler writes into a folder `bundle`.
fn folders(bundle: &Path) -> Vec<PathBuf> {
    let own = bundle.parent().unwrap_or(Path::new(""));
    let is_of_bundler = |folder: &Path| {
        let name = folder.file_name().map(|name| name.to_string_lossy().to_lowercase());
        name.is_some_and(|name| name == "bundle" || name == "bundler" || name == "pmvs")
    };
    let above = own.parent().filter(|_| is_of_bundler(own));
    [own].into_iter().chain(above).map(Path::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn focal_lengths_in_a_list_are_not_part_of_names() {
        for (line, name) in [
            ("a.jpg", "a.jpg"),
            ("./b c.jpg 0 512.25", "./b c.jpg"),
            ("a.jpg 0 600", "a.jpg"),
            ("a 0", "a 0"),
            ("0 1", "0 1"),
        ] {
            assert_eq!(name_of(line), name);
        }
    }
}
