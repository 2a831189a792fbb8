//! Par files of the multi-view sets of Middlebury: `*_par.txt`.
//!
//! Its page: a count, then one line for each image: `name k11 k12 … k33 r11 … r33 t1 t2 t3`, and P = K·[R t]. The
//! origin of the image is its first pixel, x to the right, y down. The calibrations are made of corners found on pixels
//! counted from 0, so that centres of pixels are at integers. There are no points, and masks are for the user to
//! create.

use super::probe::Folder;
use super::reader::{Claim, Reader};
use crate::photos::error::{PhotosError, read_file};
use crate::photos::found::draft::{Draft, Drafts};
use crate::photos::parts::text::Text;
use crate::photos::sets::lens::{Lens, Origin};
use glam::{DMat3, DVec2, DVec3};
use std::fs;
use std::path::{Path, PathBuf};

/// Suffix of the names of par files.
const SUFFIX: &str = "_par.txt";

/// Maximum skew of the axes of pixels, relative to the focal length, which is not visible in any image: a tenth of a
/// pixel in a thousand.
const MAX_SKEW: f64 = 1e-4;

/// Par files of Middlebury.
pub(super) const READER: Reader = Reader {
    name: "Middlebury par",
    in_folder: largest,
    of_file: |file| Ok(file.name.ends_with(SUFFIX).then(|| Claim::certain(file.path))),
    read,
};

/// Returns the longest of several par files: `temple_par.txt` has all images, `templeR_par.txt` those of a ring.
fn largest(folder: &Folder<'_>) -> Option<PathBuf> {
    let is_one = |name: &&String| name.to_lowercase().ends_with(SUFFIX);
    let size = |path: &PathBuf| fs::metadata(path).map_or(0, |file| file.len());
    let files = folder.names().iter().filter(is_one).map(|name| folder.path.join(name));
    files.max_by_key(size)
}

/// Reads the input images of the par file `path`.
fn read(path: &Path) -> Result<Drafts, PhotosError> {
    let file = read_file(path)?;
    let file = String::from_utf8_lossy(&file);
    let mut text = Text::new(path, &file);
    let count: u64 = text.number("the number of images")?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut drafts = Drafts::new(path, vec![folder]);
    for _ in 0..count {
        let name = text.word("the name of an image")?.to_owned();
        let calibration = text.numbers("a calibration (9 numbers)")?;
        let turn = DMat3::from_cols_array(&text.numbers("a rotation (9 numbers)")?).transpose();
        let shift = DVec3::from_array(text.numbers("a translation (3 numbers)")?);
        drafts.photos.push(Draft::new(name, lens(calibration), turn, shift));
    }
    if !text.is_at_end() {
        drafts.notes.push(format!(
            "{}: {count} images are claimed, what follows was not read",
            path.display()
        ));
    }
    Ok(drafts)
}

fn lens(k: [f64; 9]) -> Result<Lens, String> {
    let [fx, skew, cx, below, fy, cy, left, under, scale] = k;
    let is_upper = [below, left, under].iter().all(|zero| zero.abs() <= 1e-9 * scale.abs());
    if scale == 0.0 || !is_upper {
        return Err("its calibration matrix is singular, or none of a camera: expected fx s cx, 0 fy cy, 0 0 1".into());
    }
    if skew.abs() > MAX_SKEW * fx.abs() {
        return Err(format!(
            "its pixels are skewed (by {skew}), expected 0: rectify the images first"
        ));
    }
    let focal_px = DVec2::new(fx, fy) / scale;
    Ok(Lens::pinhole(
        None,
        focal_px,
        Origin::FirstPixel,
        DVec2::new(cx, cy) / scale,
    ))
}
