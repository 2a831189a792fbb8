//! Raw recordings of NYU Depth V2 (Silberman et al. 2012): `d-1294886360.208451-2996770081.pgm`, `r-….ppm`.
//!
//! The depth images are codes of a Kinect with their bytes swapped. Its two cameras were calibrated; the toolbox of the
//! data set has the numbers, whose rotation is written there with all signs turned.

use super::{Calibration, DepthCode, Folder, FoundRecording, Layout, RgbdError};
use crate::io::files::timestamps::times_of_lines;
use crate::rgbd::Distortion;
use crate::source::rgbd::calibration::Intrinsics;
use crate::source::rgbd::folder::{has_extension, name_of};
use crate::source::rgbd::pairs::by_time;
use glam::{DAffine3, DMat3, DVec3};
use std::path::{Path, PathBuf};
use std::time::Duration;

pub(super) const LAYOUT: Layout = Layout::new("NYU", find);

#[expect(clippy::unnecessary_wraps, reason = "as the layouts are that read files")]
fn find(folder: &Folder) -> Result<Option<FoundRecording>, RgbdError> {
    let depths = stamped(folder, "d-", "pgm");
    if depths.is_empty() {
        return Ok(None);
    }
    let pairs = by_time(&depths, &stamped(folder, "r-", "ppm"));
    let (times, paths): (Vec<Duration>, Vec<PathBuf>) = depths.into_iter().unzip();
    let mut found = FoundRecording::of_pairs(paths, pairs, calibration(), DepthCode::nyu());
    for (frame, time) in found.frames.iter_mut().zip(times) {
        frame.time = Some(time);
    }
    Ok(Some(found))
}

/// The images whose names begin so, with the seconds that follow.
fn stamped(folder: &Folder, begin: &str, extension: &str) -> Vec<(Duration, PathBuf)> {
    let time_of = |path: &Path| {
        let (seconds, _) = name_of(path).strip_prefix(begin)?.split_once('-')?;
        times_of_lines(seconds)?.first().copied()
    };
    let files = folder.files(|name| name.starts_with(begin) && has_extension(name, &[extension]));
    let mut stamped: Vec<(Duration, PathBuf)> = files
        .into_iter()
        .filter_map(|path| Some((time_of(&path)?, path)))
        .collect();
    stamped.sort_by_key(|(time, _)| *time);
    stamped
}

fn calibration() -> Calibration {
    let size = Some([640, 480]);
    let depth = Intrinsics {
        distortion: Distortion::Brown {
            k: [
                -9.989_723_655_308_448e-2,
                3.906_532_460_276_534_4e-1,
                -5.103_172_505_340_058e-1,
            ],
            p: [1.929_059_287_022_927_7e-3, -1.942_202_247_597_505_5e-3],
        },
        ..Intrinsics::pinhole(
            [
                582.624_481_677_379_6,
                582.691_032_709_886_4,
                313.044_758_708_047_3,
                238.443_896_266_203_86,
            ],
            size,
        )
    };
    let color = Intrinsics {
        distortion: Distortion::Brown {
            k: [
                2.079_661_531_880_906e-1,
                -5.861_382_516_391_178e-1,
                4.985_698_668_470_507e-1,
            ],
            p: [7.223_136_313_588_833e-4, 1.047_962_719_576_518e-3],
        },
        ..Intrinsics::pinhole(
            [
                518.857_901_174_501_9,
                519.469_611_121_274_9,
                325.582_449_411_190_34,
                253.736_166_334_004_65,
            ],
            size,
        )
    };
    // By columns: the inverse of the rows as printed.
    let rotation = DMat3::from_cols(
        DVec3::new(
            9.999_779_894_082_926e-1,
            5.051_841_938_615_745e-3,
            4.301_115_201_411_87e-3,
        ),
        DVec3::new(
            -5.035_991_948_081_099e-3,
            9.999_805_186_114_4e-1,
            -3.687_978_130_951_421_8e-3,
        ),
        DVec3::new(
            -4.319_662_492_306_024e-3,
            3.666_236_574_848_48e-3,
            9.999_839_494_838_554e-1,
        ),
    );
    let baseline = DVec3::new(
        -2.503_187_505_914_13e-2,
        -6.623_874_700_833_01e-4,
        2.934_231_293_584_641e-4,
    );
    Calibration {
        color: Some((color, DAffine3::from_mat3_translation(rotation, baseline))),
        ..Calibration::of_depth(depth, "the calibration of NYU Depth V2")
    }
}
