//! The benchmark of the TU München (Sturm et al. 2012): lists of images with their times, and the ground truth.

use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError, Units, sidecars};
use crate::io::files::timestamps::times_of_lines;
use crate::source::rgbd::pairs::by_time;
use crate::source::rgbd::text::read;
use std::path::{Path, PathBuf};
use std::time::Duration;

pub(super) const LAYOUT: Layout = Layout {
    is_likely,
    ..Layout::new("TUM", find)
};

/// 5000 units are a metre.
const UNITS_PER_METRE: f64 = 5000.0;

const CAMERA: [f64; 4] = [525.0, 525.0, 319.5, 239.5];

fn is_likely(folder: &Folder) -> bool {
    folder.has_file("depth.txt") && folder.has_file("rgb.txt")
}

fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    // Both lists are not a coincidence: a model next to them was made from the images.
    let is_certain = folder.has_file("rgb.txt");
    if !folder.has_file("depth.txt") || (folder.has_clouds() && !is_certain) {
        return Ok(None);
    }
    let depths = stamped(folder, "depth.txt")?;
    let colors = if folder.has_file("rgb.txt") {
        stamped(folder, "rgb.txt")?
    } else {
        Vec::new()
    };
    let pairs = by_time(&depths, &colors);
    let (times, paths): (Vec<Duration>, Vec<PathBuf>) = depths.into_iter().unzip();
    let code = DepthCode::per_metre(UNITS_PER_METRE);
    let mut notes = Vec::new();
    let calibration = sidecars::camera(folder, &mut notes)?.unwrap_or_else(|| Calibration::usual(CAMERA, "TUM"));
    let mut found = FoundRecording::of_pairs(paths, pairs, calibration, code);
    found.notes.extend(notes);
    found.units = Units::Usual("TUM");
    for (frame, time) in found.frames.iter_mut().zip(times) {
        frame.time = Some(time);
    }
    if folder.has_file("groundtruth.txt") {
        found.take_trajectory(&folder.path.join("groundtruth.txt"));
    } else {
        sidecars::take_poses(folder, &mut found)?;
    }
    Ok(Some(found))
}

/// Lines of a time and the name of a file within the folder.
fn stamped(folder: &Folder, list: &str) -> Result<Vec<(Duration, PathBuf)>, RgbdError> {
    let path = folder.path.join(list);
    let text = read(&path)?;
    let mut images = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let wrong = |reason: &str| RgbdError::Line {
            path: path.clone(),
            line: index + 1,
            reason: reason.to_owned(),
        };
        let (time, name) = line
            .split_once(char::is_whitespace)
            .ok_or_else(|| wrong("expected a time and the name of an image"))?;
        let time = times_of_lines(time).and_then(|times| times.first().copied());
        let time = time.ok_or_else(|| wrong("the time is not a number of seconds from 0 up"))?;
        let name = Path::new(name.trim());
        if !name
            .components()
            .all(|part| matches!(part, std::path::Component::Normal(_)))
        {
            return Err(wrong("expected the name of an image within this folder"));
        }
        images.push((time, folder.path.join(name)));
    }
    images.sort_by_key(|(time, _)| *time);
    Ok(images)
}
