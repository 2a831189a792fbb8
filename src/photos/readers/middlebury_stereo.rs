//! Rectified pairs of Middlebury from 2014 on, and of ETH3D: `calib.txt` next to `im0.png` and `im1.png`.
//!
//! Its page: `cam0` and `cam1` are calibration matrices `[f 0 cx; 0 f cy; 0 0 1]`; the second camera stands `baseline`
//! millimetres to the right of the first; a disparity d is at a depth of baseline · f / (d + doffs). `vmin` and `vmax`
//! are the smallest and the largest disparity. The world is that of the first camera. Centres of pixels are at
//! integers. Older pairs (2001 to 2006) came without a calibration.

use super::probe::begins_with;
use super::reader::{Claim, Reader};
use crate::photos::error::{PhotosError, read_file};
use crate::photos::found::draft::{Draft, Drafts};
use crate::photos::parts::json::side;
use crate::photos::parts::text::quoted;
use crate::photos::sets::lens::{Lens, Origin};
use glam::{DMat3, DVec2, DVec3};
use std::path::Path;

/// The name of the file.
const FILE: &str = "calib.txt";

/// Magic bytes at the beginning of the file.
const MAGIC: &[u8] = b"cam0=";

/// A rectified pair of Middlebury.
pub(super) const READER: Reader = Reader {
    name: "Middlebury stereo (calib.txt)",
    in_folder: |folder| folder.first(&[FILE]).filter(|path| begins_with(path, MAGIC)),
    of_file: |file| {
        let is_pair = file.name == FILE && begins_with(file.path, MAGIC);
        Ok(is_pair.then(|| Claim::certain(file.path)))
    },
    read,
};

/// Reads the input images of the pair that the file `path` calibrates.
fn read(path: &Path) -> Result<Drafts, PhotosError> {
    let file = read_file(path)?;
    let file = String::from_utf8_lossy(&file);
    let value = |key: &str| {
        let lines = file.lines().filter_map(|line| line.split_once('='));
        lines
            .into_iter()
            .find_map(|(name, value)| (name.trim() == key).then_some(value.trim()))
    };
    let wrong = |key: &str, expected: &str| {
        let found = value(key).map_or_else(|| "nothing".to_owned(), quoted);
        PhotosError::invalid(path, key, format!("expected {expected}, found {found}"))
    };
    let number = |key: &str| value(key)?.parse::<f64>().ok().filter(|number| number.is_finite());
    let baseline = number("baseline").ok_or_else(|| wrong("baseline", "millimetres between the cameras"))?;
    let size_px = Option::zip(number("width").and_then(side), number("height").and_then(side));
    let size_px = size_px.map(|(width, height)| [width, height]);
    let mut drafts = Drafts::new(path, vec![path.parent().unwrap_or(Path::new("")).to_owned()]);
    let mut focal = 0.0;
    for (index, key) in ["cam0", "cam1"].into_iter().enumerate() {
        let [fx, fy, cx, cy] = value(key)
            .and_then(matrix)
            .ok_or_else(|| wrong(key, "a matrix `[f 0 cx; 0 f cy; 0 0 1]`"))?;
        focal = fx;
        let lens = Lens::pinhole(size_px, DVec2::new(fx, fy), Origin::FirstPixel, DVec2::new(cx, cy));
        let shift = DVec3::new(-baseline * index as f64, 0.0, 0.0);
        let draft = Draft::new(format!("im{index}.png"), Ok(lens), DMat3::IDENTITY, shift);
        drafts.photos.push(draft);
    }
    let depth = |disparity: f64| baseline * focal / (disparity + number("doffs").unwrap_or(0.0));
    let range = Option::zip(number("vmax"), number("vmin")).map(|(max, min)| [depth(max), depth(min)]);
    let range = range.filter(|&[near, far]| near > 0.0 && near < far && far.is_finite());
    for draft in &mut drafts.photos {
        draft.depth_range = range;
    }
    Ok(drafts)
}

/// fx, fy, cx and cy of `[f 0 cx; 0 f cy; 0 0 1]`.
fn matrix(text: &str) -> Option<[f64; 4]> {
    let inside = text.strip_prefix('[')?.strip_suffix(']')?;
    let numbers = inside.split([';', ' ', ',']).filter(|word| !word.is_empty());
    let numbers: Option<Vec<f64>> = numbers.map(|word| word.parse().ok()).collect();
    let [fx, _, cx, _, fy, cy, _, _, _]: [f64; 9] = numbers?.try_into().ok()?;
    Some([fx, fy, cx, cy])
}
