//! Any bytes as the files of a reconstruction with images: the first byte chooses the format, a line of `%%` parts
//! one file from the next. An image lies next to them, so that cameras are made and points seen.

#![no_main]

use libfuzzer_sys::fuzz_target;
use pointreel::photos::{self, colmap_depth};
use std::path::{Path, PathBuf};

/// The files of each format.
const FORMATS: [&[&str]; 11] = [
    &["cameras.bin", "images.bin", "points3D.bin"],
    &["cameras.txt", "images.txt", "points3D.txt"],
    &["bundle.out", "list.txt"],
    &["a.nvm"],
    &["sfm.json"],
    &["a_par.txt"],
    &["transforms.json"],
    &["a.png.geometric.bin"],
    &["poses_bounds.npy"],
    &["a_cam.txt"],
    &["calib.txt"],
];

const PART: &[u8] = b"\n%%\n";

/// An image of 8 × 6 pixels, grey.
const PICTURE: &[u8] = b"P5\n8 6\n255\n................................................";

/// A folder of their own, with the image.
fn folder() -> std::io::Result<PathBuf> {
    let folder = pointreel_fuzz::memory_folder().join(format!("pointreel-fuzz-photos-{}", std::process::id()));
    if !folder.is_dir() {
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join("a.pgm"), PICTURE)?;
    }
    Ok(folder)
}

/// The bytes of that many files.
fn parts(mut bytes: &[u8], count: usize) -> Vec<&[u8]> {
    let mut parts = Vec::new();
    while parts.len() + 1 < count {
        let Some(at) = bytes.windows(PART.len()).position(|window| window == PART) else {
            break;
        };
        parts.push(&bytes[..at]);
        bytes = &bytes[at + PART.len()..];
    }
    parts.push(bytes);
    parts
}

fn read(folder: &Path) {
    let Ok(Some(found)) = photos::find(folder) else {
        return;
    };
    // A refusal is as good as a set.
    let Ok(set) = found.read() else {
        return;
    };
    // Where no image can be shown, the points still are.
    assert!(!set.photos.is_empty() || !set.points.is_empty() || set.points_file.is_some());
    let count = set.photos.len() as u32;
    assert!((0..set.points.len()).all(|point| set.points.track(point).iter().all(|seen| seen.photo < count)));
    let _ = set.reprojection_errors();
    for photo in set.photos.iter().take(2) {
        let _ = photos::PhotoImage::read(photo);
    }
}

fuzz_target!(|data: &[u8]| {
    let (Some((&choice, bytes)), Ok(folder)) = (data.split_first(), folder()) else {
        return;
    };
    let names = FORMATS[usize::from(choice) % FORMATS.len()];
    for (name, part) in names.iter().zip(parts(bytes, names.len())) {
        if std::fs::write(folder.join(name), part).is_err() {
            return;
        }
    }
    let _ = colmap_depth(&folder.join("a.png.geometric.bin"));
    read(&folder);
    for name in names {
        let _ = std::fs::remove_file(folder.join(name));
    }
});
