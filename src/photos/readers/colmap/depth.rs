//! Depth images of COLMAP's dense stage: `W&H&C&` as text, then floats, line by line from the top.

use crate::photos::error::{PhotosError, read_file};
use crate::photos::parts::bytes::Bytes;
use crate::rgbd::DepthImage;
use std::path::Path;

/// Sides of an image that is still one.
const MAX_SIDE: usize = 65_536;

/// Depths along the axis in the unit of the world, 0 where there is none, of a file in `stereo/depth_maps`.
///
/// # Errors
/// An error if the file cannot be read, has another shape or ends early.
pub fn colmap_depth(path: &Path) -> Result<DepthImage, PhotosError> {
    let file = read_file(path)?;
    let problem = || PhotosError::invalid(path, "byte 0", "expected `WIDTH&HEIGHT&1&` before the depths");
    let mut rest = file.as_slice();
    let mut side = || {
        // A side has only a few digits: other files are not searched.
        let end = rest.iter().take(12).position(|&byte| byte == b'&')?;
        let number: usize = std::str::from_utf8(&rest[..end]).ok()?.trim().parse().ok()?;
        rest = &rest[end + 1..];
        (number <= MAX_SIDE).then_some(number)
    };
    let mut sides = || Some([side()?, side()?, side()?]);
    let [width, height, channels] = sides().ok_or_else(problem)?;
    if channels != 1 || width * height == 0 {
        return Err(problem());
    }
    if rest.len() / 4 < width * height {
        return Err(PhotosError::invalid(
            path,
            format!("byte {}", file.len()),
            format!(
                "{width} × {height} depths are claimed, found {}: it may have been cut",
                rest.len() / 4
            ),
        ));
    }
    let mut bytes = Bytes::new(path, rest);
    let mut depths = Vec::with_capacity(width * height);
    for _ in 0..width * height {
        depths.push(bytes.f32()?);
    }
    DepthImage::new([width as u32, height as u32], depths).ok_or_else(problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(head: &str, depths: &[f32]) -> Result<DepthImage, PhotosError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.jpg.geometric.bin");
        let mut bytes = head.as_bytes().to_vec();
        bytes.extend(depths.iter().flat_map(|depth| depth.to_le_bytes()));
        std::fs::write(&path, bytes).unwrap();
        colmap_depth(&path)
    }

    #[test]
    fn depths_are_read_row_by_row() {
        let image = read("3&2&1&", &[1.0, 2.0, 3.0, -1.0, f32::NAN, 6.0]).unwrap();
        assert_eq!(image.size_px(), [3, 2]);
        assert_eq!(image.metres(), [1.0, 2.0, 3.0, 0.0, 0.0, 6.0]);
    }

    #[test]
    fn oversized_depth_maps_are_rejected() {
        let error = read("60000&60000&1&", &[1.0]).unwrap_err().to_string();
        assert!(error.contains("60000 × 60000 depths are claimed, found 1"), "{error}");
        for head in [
            "",
            "3&2&",
            "3&2&3&",
            "0&2&1&",
            "3 2 1",
            "99999999999&1&1&",
            "999999999999999999999&1&1&",
        ] {
            let error = read(head, &[1.0; 18]).unwrap_err().to_string();
            assert!(error.contains("expected `WIDTH&HEIGHT&1&`"), "{head}: {error}");
        }
    }
}
