//! The layout of `MVSNet` (Yao et al. 2018), which DTU, `BlendedMVS` and others come in: a file for each camera.
//!
//! Its README: `cams/00000007_cam.txt` belongs to the image `00000007.jpg`. Behind the word `extrinsic` follow 4 × 4
//! numbers that take the world to the camera (x right, y down, z forward), behind `intrinsic` 3 × 3, then the nearest
//! depth, the step to the next one and, in some, the number of steps and the farthest depth. Programs that write the
//! files copy the principal point of COLMAP, and its own warping takes the centre of the first pixel to be (½, ½).
//! There are no points; the depths are those that stereo tries.

use super::reader::{Claim, Reader};
use crate::photos::error::{PhotosError, read_file};
use crate::photos::found::draft::{Draft, Drafts};
use crate::photos::parts::text::Text;
use crate::photos::sets::lens::{Lens, Origin};
use glam::{DMat3, DVec2, DVec3};
use std::fs;
use std::path::{Path, PathBuf};

/// Suffix of the names of its files.
const SUFFIX: &str = "_cam.txt";

/// Folders of a scene in which its files are.
const FOLDERS: &[&str] = &["cams", "cams_1", "cameras", ""];

/// Entries of a folder that are looked at.
const MAX_ENTRIES: usize = 100_000;

/// Steps between the nearest and the farthest depth, if a file does not give their number.
const USUAL_STEPS: f64 = 192.0;

/// The folder of the cameras of a scene.
fn cameras_in(folder: &Path) -> Option<PathBuf> {
    let all = FOLDERS.iter().map(|below| folder.join(below));
    all.into_iter().find(|folder| {
        let entries = fs::read_dir(folder).into_iter().flatten();
        let mut names = entries.take(MAX_ENTRIES).flatten().map(|entry| entry.file_name());
        names.any(|name| name.to_string_lossy().ends_with(SUFFIX))
    })
}

/// A camera per file, of `MVSNet`.
pub(super) const READER: Reader = Reader {
    name: "MVSNet (cams)",
    in_folder: |folder| cameras_in(folder.path),
    of_file: |file| Ok(file.name.ends_with(SUFFIX).then(|| Claim::certain(file.folder()))),
    read,
};

/// Reads the input images of the cameras in `folder`.
fn read(folder: &Path) -> Result<Drafts, PhotosError> {
    let entries = fs::read_dir(folder).map_err(|source| PhotosError::Io {
        path: folder.into(),
        source,
    })?;
    let names = entries.take(MAX_ENTRIES).flatten();
    let mut names: Vec<String> = names.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort_unstable();
    let is_of_scene = folder
        .file_name()
        .is_some_and(|name| FOLDERS.contains(&name.to_string_lossy().as_ref()));
    let above = folder.parent().filter(|_| is_of_scene).map(Path::to_owned);
    let mut drafts = Drafts::new(folder, above.into_iter().chain([folder.to_owned()]).collect());
    for name in names {
        if let Some(photo) = name.strip_suffix(SUFFIX) {
            // A broken file costs only its own image.
            let draft = camera(&folder.join(&name), photo).unwrap_or_else(|error| {
                Draft::new(photo.to_owned(), Err(error.to_string()), DMat3::IDENTITY, DVec3::ZERO)
            });
            drafts.photos.push(draft);
        }
    }
    Ok(drafts)
}

fn camera(path: &Path, photo: &str) -> Result<Draft, PhotosError> {
    let file = read_file(path)?;
    let file = String::from_utf8_lossy(&file);
    let mut text = Text::new(path, &file);
    expect(&mut text, "extrinsic")?;
    let rows: [f64; 16] = text.numbers("a matrix of 4 × 4 numbers")?;
    expect(&mut text, "intrinsic")?;
    let k: [f64; 9] = text.numbers("a matrix of 3 × 3 numbers")?;
    let mut depths = Vec::new();
    while depths.len() < 4 && !text.is_at_end() {
        let [depth] = text.numbers("a depth")?;
        depths.push(depth);
    }
    let row = |row: usize| DVec3::new(rows[4 * row], rows[4 * row + 1], rows[4 * row + 2]);
    let turn = DMat3::from_cols(row(0), row(1), row(2)).transpose();
    let shift = DVec3::new(rows[3], rows[7], rows[11]);
    let lens = Lens::pinhole(None, DVec2::new(k[0], k[4]), Origin::Corner, DVec2::new(k[2], k[5]));
    Ok(Draft {
        depth_range: range(&depths),
        ..Draft::new(photo.to_owned(), Ok(lens), turn, shift)
    })
}

fn expect(text: &mut Text<'_>, word: &str) -> Result<(), PhotosError> {
    let found = text.word(&format!("the word `{word}`"))?;
    if found == word {
        Ok(())
    } else {
        Err(text.error(format!("expected the word `{word}`: it is not a camera of MVSNet")))
    }
}

/// The nearest and the farthest depth.
fn range(depths: &[f64]) -> Option<[f64; 2]> {
    let range = match *depths {
        [near, step] => [near, near + USUAL_STEPS * step],
        [near, step, count] => [near, near + count * step],
        [near, _, _, far] => [near, far],
        _ => return None,
    };
    (range[0] > 0.0 && range[0] < range[1] && range[1].is_finite()).then_some(range)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_depth_range_is_a_minimum_plus_steps() {
        assert_eq!(range(&[425.0, 2.5]), Some([425.0, 905.0]));
        assert_eq!(range(&[2.0, 0.5, 4.0]), Some([2.0, 4.0]));
        assert_eq!(range(&[2.0, 0.5, 4.0, 9.0]), Some([2.0, 9.0]));
        for none in [&[][..], &[1.0], &[0.0, 1.0], &[1.0, -1.0], &[1.0, 0.0, 192.0, 1.0]] {
            assert_eq!(range(none), None, "{none:?}");
        }
    }
}
