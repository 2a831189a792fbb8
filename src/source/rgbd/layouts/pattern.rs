//! Any layout, by patterns of the names of its images.

use super::{Calibration, DepthCode, FoundRecording, RgbdError, Units};
use crate::natural::natural_order;
use crate::source::rgbd::options::RgbdOptions;
use crate::source::rgbd::pairs::by_name;
use std::path::{Path, PathBuf};

/// The depth images in `folder` that match `depth`, with the colour images of the options. Their camera has to be named
/// too: `--intrinsics` is taken for all inputs by the caller.
pub(in crate::source::rgbd) fn by_pattern(
    folder: &Path,
    depth: &str,
    options: &RgbdOptions,
) -> Result<FoundRecording, RgbdError> {
    let Some(intrinsics) = &options.intrinsics else {
        return Err(RgbdError::Options {
            reason: format!("nothing says which camera took {depth}: name it by --intrinsics fx,fy,cx,cy or a file"),
        });
    };
    let depths = matching(folder, depth, "--depth-images")?;
    let colors = match &options.color {
        Some(color) => matching(folder, color, "--color-images")?,
        None => Vec::new(),
    };
    let pairs = by_name(&depths, &colors);
    let calibration = Calibration::of_option(intrinsics)?;
    Ok(FoundRecording {
        units: Units::Unknown,
        ..FoundRecording::of_pairs(depths, pairs, calibration, DepthCode::per_metre(1000.0))
    })
}

/// Files in `folder` that match `pattern`, in natural order.
fn matching(folder: &Path, pattern: &str, option: &str) -> Result<Vec<PathBuf>, RgbdError> {
    let wrong = |reason: String| RgbdError::Options {
        reason: format!("{option} {pattern}: {reason}"),
    };
    let whole = Path::new(&glob::Pattern::escape(&folder.to_string_lossy())).join(pattern);
    let found = glob::glob(&whole.to_string_lossy()).map_err(|error| wrong(error.to_string()))?;
    let mut paths = Vec::new();
    for path in found {
        let path = path.map_err(|error| RgbdError::Unreadable {
            path: error.path().to_path_buf(),
            reason: error.into(),
        })?;
        if path.is_file() {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        return Err(wrong(format!("no file in {} matches it", folder.display())));
    }
    paths.sort_by(|left, right| natural_order(left, right));
    Ok(paths)
}
